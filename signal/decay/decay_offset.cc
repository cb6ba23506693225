#include "signal/decay/decay_offset.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>

#include "signal/numerics/numbers.h"
#include "signal/sinusoids/decay_search.h"
#include "signal/sinusoids/residual_noise.h"

namespace rigfit::signal {
namespace {

using Eigen::Index;

// Slower than this over the window, an offset is a drift, which the background has.
constexpr double kLeastFall = 1;
// Steps end at this share of a standard uncertainty.
constexpr double kStepInStd = 1e-2;
constexpr int kMostOffsetSteps = 20;
constexpr Index kRows = 8192;  // rows of the Jacobian that are held at a time

/// Columns beside the fit's own, and what they have left when the fit's columns are taken out.
struct Beside {
  Eigen::MatrixXd cross;     // J'E
  Eigen::MatrixXd gram;      // E'E - E'J (J'J)^-1 J'E
  Eigen::VectorXd gradient;  // E' residual

  /// `columns(first, count)`: rows of E.
  template <class Columns>
  Beside(const DampedSinusoidsFit& fit, std::span<const Index> missing, Index count,
         const Columns& columns)
      : cross(Eigen::MatrixXd::Zero(fit.jacobian_gram.rows(), count)),
        gram(Eigen::MatrixXd::Zero(count, count)),
        gradient(Eigen::VectorXd::Zero(count)) {
    auto lost = missing.begin();
    for (Index first = 0; first < fit.samples; first += kRows) {
      const Index rows = std::min(kRows, fit.samples - first);
      Eigen::MatrixXd e = columns(first, rows);
      for (; lost != missing.end() && *lost < first + rows; ++lost) e.row(*lost - first).setZero();
      cross += fit.jacobian_rows(first, rows).transpose() * e;
      gram += e.transpose() * e;
      gradient += e.transpose() * fit.residual.segment(first, rows);
    }
    // What lies in the fit's columns would be left with rounding alone.
    const Eigen::VectorXd least = 1e-9 * gram.diagonal();
    gram -= cross.transpose() * fit.unit_covariance * cross;
    gram.diagonal() = gram.diagonal().cwiseMax(least);
  }
};

/// Of B and of b.
Beside beside_offset(const DampedSinusoidsFit& fit, std::span<const Index> missing,
                     const DecayingOffset& offset) {
  return {fit, missing, 2, [&](Index first, Index count) {
            const Eigen::ArrayXd shape = DecayingOffset{1, offset.rate}.at_samples(first, count);
            const Eigen::ArrayXd time = Eigen::ArrayXd::LinSpaced(
                count, static_cast<double>(first), static_cast<double>(first + count - 1));
            Eigen::MatrixXd columns(count, 2);
            columns << shape.matrix(), (-offset.amplitude * time * shape).matrix();
            return columns;
          }};
}

/// The rate, of those a factor of 2 apart, whose offset explains most.
DecayingOffset first_offset(const DampedSinusoidsFit& fit, std::span<const Index> missing,
                            double fastest) {
  const double slowest = 2 * kLeastFall / static_cast<double>(fit.samples);
  const auto count = static_cast<Index>(std::floor(std::log2(fastest / slowest))) + 1;
  const auto rate = [&](Index k) { return std::ldexp(slowest, static_cast<int>(k)); };
  const Beside all(fit, missing, count, [&](Index first, Index rows) {
    Eigen::MatrixXd columns(rows, count);
    for (Index k = 0; k < count; ++k) {
      columns.col(k) = DecayingOffset{1, rate(k)}.at_samples(first, rows);
    }
    return columns;
  });
  Index best = 0;
  const Eigen::ArrayXd left = all.gram.diagonal().array().max(1e-300);
  (all.gradient.array().square() / left).maxCoeff(&best);
  return {all.gradient(best) / left(best), rate(best)};
}

}  // namespace

Eigen::ArrayXd DecayingOffset::at_samples(Index first, Index count) const {
  const double start = -rate * static_cast<double>(first);
  return amplitude *
         Eigen::ArrayXd::LinSpaced(count, start, start - rate * static_cast<double>(count - 1))
             .exp();
}

std::optional<DecayingOffset> decaying_offset(const DecaySamples& samples,
                                              const DampedSinusoidsFit& fit, double false_alarm) {
  if (fit.unit_covariance.size() == 0) return {};
  double slowest_mode = std::numeric_limits<double>::infinity();
  for (const auto pole : fit.poles) slowest_mode = std::min(slowest_mode, std::abs(pole));
  // What falls within half a cycle is the impact, or a mode.
  const double fastest = 2 * slowest_mode / kTwoPi;
  const double n = static_cast<double>(fit.samples);
  if (!(fastest * n > 2 * kLeastFall)) return {};
  DecayingOffset offset = first_offset(fit, samples.missing, fastest);
  DampedSinusoidsFit joint = fit;
  for (int step = 0; step < kMostOffsetSteps; ++step) {
    Eigen::VectorXd left = samples.values - offset.at_samples(0, fit.samples).matrix();
    for (const Index j : samples.missing) left(j) = 0;
    joint = fit_damped_sinusoids(left, joint.poles, {}, samples.missing);
    if (joint.unit_covariance.size() == 0 || joint.degrees < 3) return {};
    const Beside both = beside_offset(joint, samples.missing, offset);
    const Eigen::Matrix2d gram = both.gram;
    const Eigen::Vector2d delta = gram.inverse() * both.gradient;
    const double squared = both.gradient.dot(delta) * static_cast<double>(joint.degrees - 2) /
                           std::max(joint.residual_sum_squares, 1e-300);
    if (!std::isfinite(squared)) return {};
    if (squared < kStepInStd * kStepInStd) break;
    offset.amplitude += delta(0);
    offset.rate = std::clamp(offset.rate + delta(1), 0.5 * offset.rate, 2 * offset.rate);
    if (!(offset.rate * n > kLeastFall && offset.rate < fastest)) return {};
  }
  const double explained = fit.residual_sum_squares - joint.residual_sum_squares;
  const double noise =
      residual_noise(joint.residual, joint.degrees - 2).white_equivalent(offset.rate / kTwoPi);
  if (!(explained > detection_threshold(fit.samples, false_alarm) * noise)) return {};
  return offset;
}

Eigen::MatrixXd covariance_beside_offset(const DampedSinusoidsFit& fit,
                                         const DecayingOffset& offset,
                                         std::span<const Index> missing) {
  if (fit.unit_covariance.size() == 0) return {};
  const Beside both = beside_offset(fit, missing, offset);
  const Eigen::Matrix2d gram = both.gram;
  if (!(gram.determinant() > 1e-12 * gram(0, 0) * gram(1, 1))) return {};
  const Eigen::MatrixXd shared = fit.unit_covariance * both.cross;
  return fit.unit_covariance + shared * gram.inverse() * shared.transpose();
}

}  // namespace rigfit::signal
