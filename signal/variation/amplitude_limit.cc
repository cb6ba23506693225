#include "signal/variation/amplitude_limit.h"

#include <fmt/format.h>
#include <gsl/gsl_cdf.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <optional>
#include <string>

#include "signal/numerics/numbers.h"
#include "signal/variation/amplitude_trend.h"
#include "signal/variation/mode_changes.h"
#include "signal/variation/point_poles.h"

namespace rigfit::signal {
namespace {
using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::VectorXd;

constexpr double kCertain = 0.01, kPossible = 0.2;
/// Squared impulses that differ by less than this part tell nothing.
constexpr double kAlike = 1e-3;
/// Change of the FRFs to small amplitude, of them, beyond which a first order does not tell it.
constexpr double kSmallChange = 0.5;

/// Power of what goes with the squared impulse and of the rest.
struct Powers {
  double with_size = 0, rest = 0;
  int points = 0, freedom = 0;
  /// Of the mean over hits, and of its change to small amplitude, noise subtracted.
  double mean = 0, change = 0;
};

/// Single hits' FRFs on one input, lines `first` to `last` (exclusive), lines and responses below
/// each other, each response by its own rms: one column a hit.
MatrixXcd hits_on(const FrfSet& frfs, std::size_t input, Index first, Index last) {
  const auto responses = static_cast<Index>(frfs.responses.size());
  const Index lines = last - first;
  MatrixXcd all(lines * responses, static_cast<Index>(frfs.hit_impulse[input].size()));
  for (Index o = 0; o < responses; ++o) {
    const Index column = frfs.column(o, static_cast<Index>(input));
    for (Index h = 0; h < all.cols(); ++h) {
      all.col(h).segment(o * lines, lines) =
          frfs.by_hit[static_cast<std::size_t>(h)].col(column).segment(first, lines);
    }
    const double norm = all.middleRows(o * lines, lines).norm();
    if (norm > 0) all.middleRows(o * lines, lines) /= norm;
  }
  return all;
}

void add_point(const MatrixXcd& hits, const std::vector<double>& impulse, Powers& powers) {
  const Index n = hits.cols();
  VectorXd x = Eigen::Map<const VectorXd>(impulse.data(), n).cwiseAbs2();
  const double largest = x.maxCoeff(), x_mean = x.mean();
  x.array() -= x_mean;
  const double xx = x.squaredNorm();
  if (!(xx > kAlike * kAlike * largest * largest) || !hits.allFinite()) return;
  const Eigen::VectorXcd mean = hits.rowwise().mean();
  const MatrixXcd away = hits.colwise() - mean;
  const double with_size = (away * x).squaredNorm() / xx;
  const double rest = std::max(0.0, away.squaredNorm() - with_size);
  powers.with_size += with_size;
  powers.rest += rest;
  powers.mean += mean.squaredNorm();
  powers.change += x_mean * x_mean / xx * (with_size - rest / static_cast<double>(n - 2));
  powers.freedom += static_cast<int>(n) - 2;
  ++powers.points;
}

Powers powers_between(const FrfSet& frfs, double low_hz, double high_hz) {
  Powers powers;
  if (frfs.by_hit.size() < 3) return powers;
  const Index kept = std::min(frfs.by_hit.front().rows(), frfs.frequency_hz.size());
  Index first = 0, last = 0;
  for (Index k = 0; k < kept; ++k) {
    if (frfs.frequency_hz[k] < low_hz) first = k + 1;
    if (frfs.frequency_hz[k] <= high_hz) last = k + 1;
  }
  for (std::size_t i = 0; last > first && i < frfs.hit_impulse.size(); ++i) {
    const std::size_t n = frfs.hit_impulse[i].size();
    if (n < 3 || n > frfs.by_hit.size()) continue;
    add_point(hits_on(frfs, i, first, last), frfs.hit_impulse[i], powers);
  }
  return powers;
}

/// Change of the FRFs within the half bandwidth of a mode from the test to small amplitude, of
/// them: how far they are from linear.
double change_around(const FrfSet& frfs, const IdentifiedMode& mode) {
  const double f = mode.pole_rad_s.imag() / kTwoPi;
  const double spacing = frfs.frequency_hz[1] - frfs.frequency_hz[0];
  const double measured = frfs.exponential_decay_rate_1_s - mode.pole_rad_s.real();
  const double half = std::max(measured / kTwoPi, 1.5 * spacing);
  const Powers powers = powers_between(frfs, f - half, f + half);
  return powers.mean > 0 ? std::sqrt(std::max(0.0, powers.change) / powers.mean) : 0;
}

/// Values of a mode by hit, with amplitudes. Empty where sizes are not known.
std::vector<ValueOfHit> values_of_hits(const FrfSet& frfs, const ModeOfHits& hits,
                                       const IdentifiedMode& mode,
                                       const std::vector<std::vector<double>>& values, double std) {
  std::vector<ValueOfHit> list;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double along = std::abs(mode.participation[static_cast<Index>(i)]);
    for (std::size_t h = 0; h < values[i].size(); ++h) {
      const std::size_t hit = hits.hit[i][h];
      if (i >= frfs.hit_impulse.size() || hit >= frfs.hit_impulse[i].size()) return {};
      list.push_back({i, std::abs(frfs.hit_impulse[i][hit]) * along, {values[i][h], std}});
    }
  }
  return list;
}

double largest_hit(const FrfSet& frfs) {
  double largest = 0;
  for (const auto& point : frfs.hit_impulse) {
    for (const double impulse : point) largest = std::max(largest, std::abs(impulse));
  }
  return largest;
}

/// The stronger mode whose resonance overlaps with mode r, 0: there is none.
double overlapping(const ModalModel& model, std::size_t r) {
  const IdentifiedMode& mode = model.modes[r];
  const auto peak = [](const IdentifiedMode& of) {
    return of.shape.norm() * of.participation.norm() / -of.pole_rad_s.real();
  };
  for (std::size_t q = 0; q < model.modes.size(); ++q) {
    const IdentifiedMode& other = model.modes[q];
    const double apart = std::abs(other.pole_rad_s.imag() - mode.pole_rad_s.imag());
    const double halves = -other.pole_rad_s.real() - mode.pole_rad_s.real();
    if (q != r && apart < halves && peak(other) > peak(mode)) return other.frequency_hz.value;
  }
  return 0;
}

void note_limit(const IdentifiedMode& mode, std::vector<Note>& notes) {
  notes.push_back(
      {"frequency_depends_on_amplitude",
       fmt::format("hits of other sizes give other frequencies: {:+.3g} Hz per (N s)^2; {:.6g} Hz "
                   "at the amplitudes of the test, {:.6g} +- {:.2g} Hz, as given, at small "
                   "amplitude; a non-linear spring or joint looks like this",
                   mode.amplitude.slope.value, mode.amplitude.frequency_of_test_hz,
                   mode.frequency_hz.value, mode.frequency_hz.std),
       fmt::format("{:.4g} Hz", mode.frequency_hz.value)});
}

/// Raises a standard deviation so that its interval reaches `to`.
void reach(Estimate& value, Index row, double to, Eigen::MatrixXd& covariance) {
  set_std(value, row, std::max(value.std, std::abs(to - value.value) / 1.96), covariance);
}

/// A mode of a test whose FRFs go with the size of the hits by `chance`.
void limit_of_hits(const FrfSet& frfs, const ModeOfHits& hits, double chance, std::size_t r,
                   ModalModel& model) {
  IdentifiedMode& mode = model.modes[r];
  const auto frequency =
      amplitude_trend(values_of_hits(frfs, hits, mode, hits.frequency_hz, hits.noise_frequency_hz));
  const auto damping = amplitude_trend(
      values_of_hits(frfs, hits, mode, hits.damping_ratio, hits.noise_damping_ratio));
  const double f = mode.frequency_hz.value;
  if (!frequency || !damping) {
    add_doubt(mode, "the structure is not linear and single hits do not show it");
    return;
  }
  mode.amplitude = {false, frequency->chance, frequency->slope, largest_hit(frfs), f};
  const auto row = static_cast<Index>(2 * r);
  if (!(chance < kCertain)) {
    if (!mode.between_hits.beyond_noise) return;
    reach(mode.frequency_hz, row, frequency->small.value, model.pole_covariance);
    reach(mode.damping_ratio, row + 1, damping->small.value, model.pole_covariance);
    return;
  }
  const double first_order = change_around(frfs, mode);
  if (first_order > kSmallChange) {
    add_doubt(mode, fmt::format("{:.0f} % of the FRFs around it go with the squared size of the "
                                "hits: too much to tell small amplitude, or what a non-linear "
                                "spring makes of other modes",
                                100 * first_order));
    return;
  }
  if (const double other = overlapping(model, r); other > 0) {
    add_doubt(mode, fmt::format("the structure is not linear, and what that makes of the stronger "
                                "mode at {:.5g} Hz looks like a second one",
                                other));
    return;
  }
  const double bandwidth = 2 * mode.damping_ratio.value * f;
  if (!(std::abs(0.5 * (frequency->small.value + frequency->strongest) - f) < bandwidth) ||
      !(damping->small.value > 0)) {
    add_doubt(mode, fmt::format("single hits of a structure that is not linear show it at {:.5g} "
                                "to {:.5g} Hz",
                                frequency->small.value, frequency->strongest));
    return;
  }
  mode.amplitude.found = true;
  set_frequency_and_damping(mode, frequency->small.value, damping->small.value,
                            frfs.exponential_decay_rate_1_s);
  // The next order of the series in squared impulses, over the half bandwidth.
  const double next = mode.damping_ratio.value * first_order * first_order;
  set_std(mode.frequency_hz, row, std::hypot(frequency->small.std, next * f),
          model.pole_covariance);
  set_std(mode.damping_ratio, row + 1, std::hypot(damping->small.std, next), model.pole_covariance);
  note_limit(mode, model.notes);
}

/// Frequencies of points struck once each, by their impulses; without, by the shape alone.
std::vector<ValueOfHit> values_of_points(const FrfSet& frfs, const IdentifiedMode& mode,
                                         bool& sizes_known) {
  std::vector<ValueOfHit> list;
  sizes_known = true;
  for (const ModeAtPoint& point : mode.points) {
    const auto at = static_cast<std::size_t>(point.order);
    if (point.order >= mode.participation.size()) return {};
    const bool known = at < frfs.hit_impulse.size() && !frfs.hit_impulse[at].empty();
    sizes_known = sizes_known && known;
    double square = 0;
    for (std::size_t h = 0; known && h < frfs.hit_impulse[at].size(); ++h) {
      square +=
          std::pow(frfs.hit_impulse[at][h], 2) / static_cast<double>(frfs.hit_impulse[at].size());
    }
    list.push_back({at, std::sqrt(square), point.frequency_hz});
  }
  for (ValueOfHit& value : list) {
    value.amplitude = (sizes_known ? value.amplitude : 1) *
                      std::abs(mode.participation[static_cast<Index>(value.point)]);
  }
  return list;
}

void limit_of_points(const FrfSet& frfs, std::size_t r, ModalModel& model) {
  IdentifiedMode& mode = model.modes[r];
  if (mode.refinement == "global" || !(mode.between_points_std_hz > 0)) return;
  bool sizes_known = false;
  const auto trend = amplitude_trend(values_of_points(frfs, mode, sizes_known));
  if (!trend) return;
  const double f = mode.frequency_hz.value;
  mode.amplitude = {false, trend->chance, trend->slope, largest_hit(frfs), f};
  const auto row = static_cast<Index>(2 * r);
  if (!sizes_known) {
    if (trend->chance < kCertain &&
        std::abs(trend->small.value - f) > 1.96 * mode.frequency_hz.std) {
      add_doubt(mode, fmt::format("its frequency goes with the squared amplitude of the points, "
                                  "from {:.6g} Hz at small amplitude to {:.6g} Hz at the "
                                  "strongest: a non-linear spring or joint looks like this",
                                  trend->small.value, trend->strongest));
    }
  } else if (trend->chance < kCertain) {
    mode.amplitude.found = true;
    set_frequency_and_damping(mode, trend->small.value, mode.damping_ratio.value,
                              frfs.exponential_decay_rate_1_s);
    set_std(mode.frequency_hz, row, trend->small.std, model.pole_covariance);
    note_limit(mode, model.notes);
  } else if (trend->chance < kPossible) {
    reach(mode.frequency_hz, row, trend->small.value, model.pole_covariance);
  }
}

}  // namespace

double chance_of_size_dependence(const FrfSet& frfs, double low_hz, double high_hz) {
  const Powers powers = powers_between(frfs, low_hz, high_hz);
  if (powers.freedom < 1 || !(powers.with_size > 0)) return 1;
  if (!(powers.rest > 0)) return 0;
  const double F = powers.with_size / powers.points / (powers.rest / powers.freedom);
  return gsl_cdf_fdist_Q(F, powers.points, powers.freedom);
}

void allow_for_amplitude(const FrfSet& frfs, const ModalBand& band,
                         const std::vector<ModeOfHits>& hits, ModalModel& model) {
  if (model.modes.empty()) return;
  const double low = band.frequency_hz[0], high = band.frequency_hz[band.frequency_hz.size() - 1];
  const double chance = chance_of_size_dependence(frfs, low, high);
  const bool by_hits = chance < kPossible;
  if (!by_hits && !points_are_inputs(band)) return;
  for (std::size_t r = 0; r < model.modes.size(); ++r) {
    if (model.modes[r].doubtful) continue;
    if (!by_hits) {
      limit_of_points(frfs, r, model);
    } else if (r < hits.size()) {
      limit_of_hits(frfs, hits[r], chance, r, model);
    }
  }
}

}  // namespace rigfit::signal
