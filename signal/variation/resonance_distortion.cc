#include "signal/variation/resonance_distortion.h"

#include <fmt/format.h>
#include <gsl/gsl_cdf.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

#include "signal/numerics/factorisations.h"
#include "signal/numerics/numbers.h"
#include "signal/refinement/local_fit.h"
#include "signal/variation/mode_changes.h"

namespace rigfit::signal {
namespace {

using Complex = std::complex<double>;
using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::VectorXcd;
using Eigen::VectorXd;

constexpr double kReach = 6;      // half width of the window, half bandwidths of the mode
constexpr Index kLeastLines = 8;  // and at least so many lines on either side
constexpr int kOrder = 2;         // of the polynomial
/// Tested a hit; those with the largest residues, where noise is least and the amplitude largest.
constexpr std::size_t kFrfs = 4;
constexpr double kDistorted = 1e-4;
/// Of the FRFs around a mode: measured structures are not linear to much better.
constexpr double kLeastShare = 1e-3;
constexpr double kMoreDamped = 1.5;  // the second pole of a distorted resonance: three times

/// Lines around a mode and the poles beside it.
struct Surroundings {
  Index first = 0, count = 0;
  VectorXcd neighbours;
};

Surroundings surroundings_of(const ModalBand& band, const ModalModel& model, std::size_t r) {
  const Complex pole = model.modes[r].pole_rad_s;
  const double half = band.window - pole.real();
  const double reach =
      std::max(kReach * half, kTwoPi * static_cast<double>(kLeastLines) * band.spacing_hz);
  Surroundings around;
  const VectorXd omega = kTwoPi * band.frequency_hz;
  const auto low = std::lower_bound(omega.begin(), omega.end(), pole.imag() - reach);
  const auto high = std::upper_bound(low, omega.end(), pole.imag() + reach);
  around.first = low - omega.begin();
  around.count = high - low;
  std::vector<Complex> near;
  for (std::size_t q = 0; q < model.modes.size(); ++q) {
    const IdentifiedMode& other = model.modes[q];
    const double width = band.window - other.pole_rad_s.real();
    const double apart = std::abs(other.pole_rad_s.imag() - pole.imag());
    const bool same = other.doubtful && apart < width && width > 1.5 * half;
    if (q != r && !same && apart < reach + 3 * width) near.push_back(other.pole_rad_s);
  }
  around.neighbours = Eigen::Map<const VectorXcd>(near.data(), static_cast<Index>(near.size()));
  return around;
}

/// Variance of a mean of correlated lines over that of independent ones: Bartlett's weights, or the
/// sum c coth c of the correlation by an exponential window (modal_noise.h), whichever is more.
double inflation_of(const VectorXcd& left, double c) {
  const Index lags = std::min<Index>(8, left.size() / 5);
  const double power = left.squaredNorm();
  const double known = c > 1e-6 ? c / std::tanh(c) : 1;
  double sum = 1;
  for (Index d = 1; d <= lags && power > 0; ++d) {
    const double rho = left.head(left.size() - d).dot(left.tail(left.size() - d)).real() / power;
    sum += 2 * (1 - static_cast<double>(d) / (static_cast<double>(lags) + 1)) * rho;
  }
  return std::max(known, sum);
}

/// One FRF on the lines `s` with its pole.
ResonanceDistortion test_of(const VectorXcd& s, const VectorXcd& H, Complex pole,
                            const VectorXcd& neighbours, const ModalBand& band) {
  ResonanceDistortion result;
  const double window = band.window;
  const Index lines = s.size(), fixed = neighbours.size(), columns = 4 + fixed + kOrder;
  if (lines < columns + 8) return result;
  MatrixXcd basis(lines, columns);  // background, neighbours, resonance, its shift, second pole
  const double low = s[0].imag(), high = s[lines - 1].imag();
  const VectorXd x = (2 * s.imag().array() - low - high) / (high - low);
  basis.col(0).setOnes();
  for (int j = 1; j <= kOrder; ++j) {
    basis.col(j) = basis.col(j - 1).cwiseProduct(x.cast<Complex>());
  }
  for (Index q = 0; q < fixed; ++q) {
    basis.col(kOrder + 1 + q) = (s.array() - neighbours[q]).inverse();
  }
  const double decay = -pole.real();
  basis.col(columns - 3) = (s.array() - pole).inverse();
  basis.col(columns - 2) = (window + decay) * basis.col(columns - 3).array().square();
  basis.col(columns - 1) = (s.array() - pole + 2 * decay).inverse();
  const VectorXd length = basis.colwise().norm().transpose();
  for (Index j = 0; j < columns; ++j) basis.col(j) /= length[j];
  const auto [Q, R] = thin_qr(basis);
  if (!(R.diagonal().cwiseAbs().minCoeff() > 1e-9)) return result;
  const VectorXcd moments = Q.adjoint() * H;
  const VectorXcd left = H - Q * moments;
  const VectorXd free = (1 - Q.rowwise().squaredNorm().array()).cwiseMax(0.05);
  const double freedom = static_cast<double>(lines - columns);
  const VectorXd weight = Q.col(columns - 1).cwiseAbs2();
  const double variance =
      inflation_of(left, band.correlation_lines) *
      std::max(left.squaredNorm() / freedom,
               (weight.array() * left.array().abs2() / free.array().square()).sum());
  const double floor = 1e-24 * H.squaredNorm();
  const double F = std::norm(moments[columns - 1]) / std::max(variance, floor);
  result.chance = gsl_cdf_fdist_Q(F, 2, 2 * freedom);
  const MatrixXcd inverse =
      R.triangularView<Eigen::Upper>().solve(MatrixXcd::Identity(columns, columns));
  VectorXcd found = inverse * moments;
  for (Index j = 0; j < columns; ++j) found[j] /= length[j];
  const Complex second = found[columns - 1], main = found[columns - 3];
  result.shift = (window + decay) * found[columns - 2] / main;
  result.small_pole = pole + result.shift;
  result.small_std = (window + decay) / length[columns - 2] / std::abs(main) *
                     std::sqrt(0.5 * variance * inverse.row(columns - 2).squaredNorm());
  result.b = -second / (main + second);
  result.share = std::abs(moments[columns - 1]) / std::max(H.norm(), 1e-300);
  return result;
}

/// The FRFs in which a mode's residue is largest: columns of the set.
std::vector<Index> strongest_columns(const FrfSet& frfs, const IdentifiedMode& mode) {
  std::vector<std::pair<double, Index>> all;
  all.reserve(static_cast<std::size_t>(frfs.H.cols()));
  for (Index o = 0; o < mode.shape.size(); ++o) {
    for (Index i = 0; i < mode.participation.size(); ++i) {
      all.emplace_back(-std::abs(mode.shape[o] * mode.participation[i]), frfs.column(o, i));
    }
  }
  const std::size_t kept = std::min(kFrfs, all.size());
  std::partial_sort(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(kept), all.end());
  std::vector<Index> columns;
  columns.reserve(kept);
  for (std::size_t k = 0; k < kept; ++k) columns.push_back(all[k].second);
  return columns;
}

/// FRFs to test on the lines around a mode: single hits where they are known.
std::vector<VectorXcd> frfs_to_test(const FrfSet& frfs, const ModalBand& band,
                                    const Surroundings& around, const IdentifiedMode& mode) {
  const std::vector<Index> columns = strongest_columns(frfs, mode);
  const auto begin = frfs.frequency_hz.begin();
  const double first_hz = band.frequency_hz[around.first];
  const Index at = std::lower_bound(begin, frfs.frequency_hz.end(), first_hz) - begin;
  std::vector<VectorXcd> found;
  found.reserve(columns.size() * std::max<std::size_t>(1, frfs.by_hit.size()));
  const auto add = [&](const Eigen::Ref<const VectorXcd>& column) {
    if (column.allFinite() && !column.isZero(0)) found.emplace_back(column);
  };
  for (const MatrixXcd& hit : frfs.by_hit) {
    if (at + around.count > hit.rows()) continue;
    for (const Index c : columns) add(hit.col(c).segment(at, around.count));
  }
  if (!found.empty()) return found;
  for (const Index c : columns) add(band.lines.H.col(c).segment(around.first, around.count));
  return found;
}

double peak_of(const IdentifiedMode& mode) {
  return mode.shape.norm() * mode.participation.norm() / -mode.pole_rad_s.real();
}

/// The mode under whose resonance a more damped pole lies; -1: there is none.
std::ptrdiff_t mode_above(const ModalModel& model, std::size_t r) {
  const Complex pole = model.modes[r].pole_rad_s;
  for (std::size_t a = 0; a < model.modes.size(); ++a) {
    const Complex other = model.modes[a].pole_rad_s;
    if (a != r && std::abs(pole.imag() - other.imag()) < -pole.real() &&
        pole.real() < kMoreDamped * other.real()) {
      return static_cast<std::ptrdiff_t>(a);
    }
  }
  return -1;
}

/// The largest peak that products of the distorted modes make at mode r.
double peak_of_products(const ModalModel& model, std::size_t r,
                        const std::vector<ResonanceDistortion>& found, double chance) {
  const Complex pole = model.modes[r].pole_rad_s;
  double forces = 0, passed_on = 0;
  for (std::size_t a = 0; a < model.modes.size(); ++a) {
    const IdentifiedMode& mode = model.modes[a];
    if (a == r) continue;
    if (found[a].chance < chance) {
      forces += 8.0 / 3 * std::abs(mode.pole_rad_s) * -mode.pole_rad_s.real() *
                std::abs(found[a].b) * peak_of(mode);
    }
    if (peak_of(mode) > peak_of(model.modes[r])) {
      passed_on =
          std::max(passed_on, 1 / std::abs(mode.pole_rad_s * mode.pole_rad_s - pole * pole));
    }
  }
  return forces * passed_on;
}

/// Intervals of a mode reach to its values at small amplitude.
void reach_small_amplitude(const ResonanceDistortion& found, std::size_t r, ModalModel& model) {
  IdentifiedMode& mode = model.modes[r];
  if (mode.doubtful || mode.amplitude.found || !(found.small_std > 0)) return;
  const double omega = std::abs(mode.pole_rad_s);
  const auto row = static_cast<Index>(2 * r);
  const double frequency = (std::abs(found.shift.imag()) / 1.96 + found.small_std) / kTwoPi;
  const double damping = (std::abs(found.shift.real()) / 1.96 + found.small_std) / omega;
  set_std(mode.frequency_hz, row, std::max(mode.frequency_hz.std, frequency),
          model.pole_covariance);
  set_std(mode.damping_ratio, row + 1, std::max(mode.damping_ratio.std, damping),
          model.pole_covariance);
}

/// The lower one of two: at least half of the values are no larger.
double median_of(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>((values.size() - 1) / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// Medians over FRFs. Twice that of chances is a chance, whatever the FRFs share. The shift is a
/// mean, as the mode's value is one over points and hits of different amplitude.
ResonanceDistortion over_frfs(const std::vector<ResonanceDistortion>& all) {
  ResonanceDistortion result;
  if (all.empty()) return result;
  const auto median = [&](auto value) {
    std::vector<double> values;
    values.reserve(all.size());
    for (const ResonanceDistortion& one : all) values.push_back(value(one));
    return median_of(std::move(values));
  };
  result.chance = std::min(1.0, 2 * median([](const auto& one) { return one.chance; }));
  result.b = {median([](const auto& one) { return one.b.real(); }),
              median([](const auto& one) { return one.b.imag(); })};
  for (const ResonanceDistortion& one : all) {
    result.shift += one.shift / static_cast<double>(all.size());
  }
  result.small_pole = {median([](const auto& one) { return one.small_pole.real(); }),
                       median([](const auto& one) { return one.small_pole.imag(); })};
  result.small_std = median([](const auto& one) { return one.small_std; });
  result.share = median([](const auto& one) { return one.share; });
  return result;
}

}  // namespace

ResonanceDistortion resonance_distortion(const FrfSet& frfs, const ModalBand& band,
                                         const ModalModel& model, std::size_t r) {
  const Surroundings around = surroundings_of(band, model, r);
  if (around.count < 2 * kLeastLines) return {};
  const VectorXcd s = band.lines.s.segment(around.first, around.count);
  VectorXcd start(1);
  start[0] = model.modes[r].pole_rad_s;
  const double half = band.window - start[0].real();
  std::vector<ResonanceDistortion> all;
  LocalFitOptions options;
  options.background_order = kOrder;
  for (const VectorXcd& H : frfs_to_test(frfs, band, around, model.modes[r])) {
    const LocalFit fit = fit_locally(s, H, VectorXd::Ones(1), start, around.neighbours, options);
    if (!fit.usable || std::abs(fit.poles[0] - start[0]) > 2 * half) continue;
    all.push_back(test_of(s, H, fit.poles[0], around.neighbours, band));
  }
  return over_frfs(all);
}

void allow_for_distortion(const FrfSet& frfs, const ModalBand& band, ModalModel& model) {
  std::vector<IdentifiedMode>& modes = model.modes;
  std::vector<ResonanceDistortion> found(modes.size());
  const double chance = kDistorted / std::max(1.0, static_cast<double>(modes.size()));
  const auto distorted = [&](std::size_t r) {
    return found[r].chance < chance && found[r].share > kLeastShare;
  };
  bool any = false;
  for (std::size_t r = 0; r < modes.size(); ++r) {
    if (!modes[r].doubtful) found[r] = resonance_distortion(frfs, band, model, r);
    any = any || distorted(r) || modes[r].amplitude.found;
  }
  if (!any) return;
  for (std::size_t r = 0; r < modes.size(); ++r) {
    if (modes[r].doubtful) found[r] = resonance_distortion(frfs, band, model, r);
  }
  for (std::size_t r = 0; r < modes.size(); ++r) {
    const std::ptrdiff_t above = modes[r].doubtful ? -1 : mode_above(model, r);
    if (above < 0) continue;
    const auto a = static_cast<std::size_t>(above);
    add_doubt(modes[r], fmt::format("under the resonance of the mode at {:.5g} Hz and {:.1f} times "
                                    "as damped: a structure that is not linear shows one mode so",
                                    modes[a].frequency_hz.value,
                                    modes[r].pole_rad_s.real() / modes[a].pole_rad_s.real()));
    found[a] = resonance_distortion(frfs, band, model, a);
  }
  double largest = 0, at = 0;
  for (std::size_t r = 0; r < modes.size(); ++r) {
    reach_small_amplitude(found[r], r, model);
    if (distorted(r) && std::abs(found[r].b) > largest) {
      largest = std::abs(found[r].b), at = modes[r].frequency_hz.value;
    }
  }
  for (std::size_t r = 0; r < modes.size(); ++r) {
    const double products = peak_of_products(model, r, found, chance);
    if (modes[r].doubtful || peak_of(modes[r]) > products) continue;
    add_doubt(modes[r],
              "its peak is no larger than what distorted resonances of stronger modes "
              "make at sums and differences of their frequencies");
  }
  if (!(largest > 0)) return;
  model.notes.push_back(
      {"resonances_distorted",
       fmt::format("resonances have the shape of a structure that is not linear: frequency or "
                   "damping go with the amplitude, by {:.2g} half bandwidths at {:.5g} Hz; hits of "
                   "other sizes tell small amplitude",
                   2 * largest, at),
       ""});
}

}  // namespace rigfit::signal
