#include "signal/modal/mode_hits.h"

#include <fmt/format.h>
#include <gsl/gsl_cdf.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <utility>
#include <vector>

#include "signal/estimation/groups.h"
#include "signal/modal/local_modes.h"
#include "signal/numerics/numbers.h"

namespace rigfit::signal {
namespace {

using Complex = std::complex<double>;
using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Eigen::VectorXcd;
using Eigen::VectorXd;

constexpr double kMode = 0.05, kAll = 0.01;  // chances where hits agree
constexpr double kShareOfHits = 2.0 / 3;     // that must show a mode

/// Hits on one point.
struct HitsOnInput {
  std::vector<MatrixXcd> H;  ///< on the lines of the band
  VectorXd weight;           ///< in the average; sum 1
};

std::vector<HitsOnInput> hits_of(const FrfSet& frfs, const ModalBand& band) {
  std::vector<HitsOnInput> all;
  for (std::size_t i = 0; i < frfs.inputs.size(); ++i) {
    std::vector<double> weights;
    HitsOnInput& hits = all.emplace_back();
    for (std::size_t h = 0; h < frfs.by_hit.size(); ++h) {
      MatrixXcd H = frfs.by_hit[h](
          band.rows, Eigen::seq(static_cast<Index>(i), Eigen::last, band.lines.inputs));
      if (!H.allFinite()) continue;
      hits.H.push_back(std::move(H));
      const bool known = i < frfs.hit_impulse.size() && h < frfs.hit_impulse[i].size();
      weights.push_back(known ? std::pow(frfs.hit_impulse[i][h], 2) : kNaN);
    }
    hits.weight = Eigen::Map<const VectorXd>(weights.data(), std::ssize(weights));
    if (!hits.weight.allFinite() || !(hits.weight.array() > 0).all()) hits.weight.setOnes();
    hits.weight /= std::max(hits.weight.sum(), 1e-300);
  }
  return all;
}

/// Chi-square of the scatter between hits over their own errors, and its degrees of freedom.
std::pair<double, double> scatter_of(const LocalMode& own) {
  const double others = std::max(0.0, static_cast<double>(own.points.size()) - 1);
  return {own.decay.Q + own.frequency.Q, 2 * others};
}

bool beyond_chance(std::pair<double, double> scatter, double chance) {
  return scatter.second > 0 && gsl_cdf_chisq_Q(scatter.first, scatter.second) < chance;
}

/// Raises the standard deviations of a mode.
void widen(double f_std, double z_std, std::size_t r, ModalModel& model) {
  IdentifiedMode& mode = model.modes[r];
  const double factor[2] = {std::max(1.0, f_std / mode.frequency_hz.std),
                            std::max(1.0, z_std / mode.damping_ratio.std)};
  for (Index part = 0; part < 2; ++part) {
    if (!std::isfinite(factor[part])) continue;
    const auto row = static_cast<Index>(2 * r) + part;
    model.pole_covariance.row(row) *= factor[part];
    model.pole_covariance.col(row) *= factor[part];
    (part == 0 ? mode.frequency_hz : mode.damping_ratio).std *= factor[part];
  }
  // Errors of residues go with those of the poles.
  const double most = std::max(factor[0], factor[1]);
  if (std::isfinite(most)) mode.shape_std *= most;
}

/// Raises the standard deviations of the shapes where the hits' FRFs around a mode scatter in size
/// and phase by more than noise, all lines together (a gain, a place that is not met): jackknife of
/// their parts of the average's fit.
void widen_shapes(const ModalBand& band, const std::vector<HitsOnInput>& all,
                  const FoundModes& found, ModalModel& model) {
  if (band.H_std.size() == 0 || found.model.size() == 0) return;
  for (IdentifiedMode& mode : model.modes) {
    Index input = 0;
    mode.participation.cwiseAbs().maxCoeff(&input);
    const HitsOnInput& hits = all[static_cast<std::size_t>(input)];
    const auto count = std::ssize(hits.H);
    const auto [first, lines] = lines_around(band, mode.pole_rad_s, 1);
    if (count < 2 || lines < 1) continue;
    const auto degrees = static_cast<double>(count - 1);
    const Eigen::ArrayXd weight = hits.weight, pull = weight / (1 - weight);
    double squares = 0;
    const Index responses = mode.shape.size();
    MatrixXd variance(responses, 2);
    for (Index o = 0; o < responses; ++o) {
      const Index c = o * band.lines.inputs + input;
      const VectorXcd fit = found.model.col(c).segment(first, lines);
      const double size = std::max(fit.squaredNorm(), 1e-300);
      Eigen::ArrayXcd part(count);
      for (Index h = 0; h < count; ++h) {
        const auto at = static_cast<std::size_t>(h);
        part[h] = fit.dot(hits.H[at].col(o).segment(first, lines)) / size;
      }
      const Eigen::ArrayXcd moved = pull * (part - (part * weight).sum());  // without one hit
      variance.row(o) << moved.real().square().sum(), moved.imag().square().sum();
      variance.row(o) *= degrees / static_cast<double>(count);
      const double noise =
          fit.cwiseAbs().cwiseProduct(band.H_std.col(c).segment(first, lines)).squaredNorm();
      squares += variance.row(o).sum() * size * size / std::max(noise, 1e-300);
    }
    if (!(gsl_cdf_chisq_Q(degrees * squares, degrees * 2 * static_cast<double>(responses)) <
          kAll)) {
      continue;
    }
    variance *= std::pow(coverage_factor(0.95, degrees) / coverage_factor(0.95, 0), 2);
    for (Index o = 0; o < responses; ++o) {
      const double re = std::norm(mode.shape[o].real()), im = std::norm(mode.shape[o].imag());
      auto std = mode.shape_std.row(o);
      std[0] = std::sqrt(std[0] * std[0] + re * variance(o, 0) + im * variance(o, 1));
      std[1] = std::sqrt(std[1] * std[1] + im * variance(o, 0) + re * variance(o, 1));
    }
  }
}

}  // namespace

void allow_for_hits(const FrfSet& frfs, const ModalBand& band, const FoundModes& found, bool local,
                    const ModalOptions& options, ModalModel& model) {
  if (frfs.by_hit.size() < 2 || frfs.by_hit.front().rows() <= band.rows.back()) return;
  VectorXcd poles(std::ssize(model.modes));
  for (Index r = 0; r < poles.size(); ++r) {
    poles[r] = model.modes[static_cast<std::size_t>(r)].pole_rad_s;
  }
  const std::vector<HitsOnInput> all = hits_of(frfs, band);
  widen_shapes(band, all, found, model);
  std::vector<MatrixXcd> every;
  for (const HitsOnInput& hits : all) {
    if (hits.H.size() > 1) every.insert(every.end(), hits.H.begin(), hits.H.end());
  }
  std::vector<LocalMode> own_modes = check_groups(band, every, poles, options);
  const bool several = band.lines.inputs > 1;
  if (local || !several) join_split_modes(band, false, own_modes);
  // A hit, which is of one reference, may show two modes whose resonances touch as one.
  const auto touched = [&](std::size_t r) {
    return !local && several && is_touched(band, poles, static_cast<Index>(r), 1);
  };
  std::pair<double, double> sum{0, 0};
  for (std::size_t r = 0; r < own_modes.size(); ++r) {
    const auto [squares, degrees] = touched(r) ? std::pair(0.0, 0.0) : scatter_of(own_modes[r]);
    sum.first += squares, sum.second += degrees;
  }
  const bool all_differ = beyond_chance(sum, kAll);
  const double times = std::sqrt(sum.first / std::max(sum.second, 1.0));
  double largest = 0;
  bool means = false;
  for (std::size_t r = 0; r < own_modes.size(); ++r) {
    const LocalMode& own = own_modes[r];
    IdentifiedMode& mode = model.modes[r];
    const bool unknown = touched(r) || own.points.size() < 2;
    const Complex pole = mode.pole_rad_s;
    const double omega = std::abs(pole);
    const bool own_differ = !unknown && beyond_chance(scatter_of(own), kMode);
    const auto shown = std::count_if(own.points.begin(), own.points.end(), [&](const auto& hit) {
      return std::abs(hit.pole - pole) < band.window - pole.real();
    });
    if (!unknown) {
      mode.between_hits = {static_cast<int>(shown), own.frequency.between_std / kTwoPi,
                           own.decay.between_std / omega, all_differ || own_differ};
    }
    if (!all_differ && !own_differ) continue;
    largest = std::max(largest, mode.between_hits.frequency_std_hz / mode.frequency_hz.value);
    if (!touched(r) &&
        static_cast<double>(shown) < kShareOfHits * static_cast<double>(every.size())) {
      mode.doubt = fmt::format("only {} of {} single hits show it", shown, every.size());
    } else if (own_differ) {
      means = true;
      set_pole(mode, {-own.decay.value.value, own.frequency.value.value}, band.window);
    }
    if (unknown) {
      widen(times * mode.frequency_hz.std, times * mode.damping_ratio.std, r, model);
    } else {
      widen(own.frequency.value.std / kTwoPi, own.decay.value.std / omega, r, model);
    }
  }
  if (!all_differ || !(largest > 0)) return;
  model.notes.push_back(
      {"hits_disagree",
       fmt::format(
           "frequencies differ from hit to hit by up to {:.2g} % (one standard deviation), modes "
           "{:.1f} times as much as noise gives: the structure, the hammer or the place struck "
           "changes; {}error bars are those of the scatter between hits",
           100 * largest, times,
           means ? "values are means over the hits where their own poles differ, " : ""),
       ""});
}

}  // namespace rigfit::signal
