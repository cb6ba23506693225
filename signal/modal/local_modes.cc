#include "signal/modal/local_modes.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <tuple>
#include <utility>

#include "signal/estimation/groups.h"
#include "signal/numerics/numbers.h"
#include "signal/refinement/modal_basis.h"
#include "signal/refinement/modal_noise.h"

namespace rigfit::signal {
namespace {

using Complex = std::complex<double>;
using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Eigen::VectorXcd;
using Eigen::VectorXd;

/// Share of the points that must show a mode.
constexpr double kShareOfPoints = 0.3;
/// Misfit relative to the FRFs around a mode. A global fit that leaves less has found the modes
/// that are there; measured structures are not linear to much better.
constexpr double kSmallMisfit = 0.01;
/// A twentieth of a half bandwidth changes a peak by 5 % at its flanks.
constexpr double kScatterThatMatters = 0.05;

PointPoleOptions point_options(const ModalOptions& options, std::size_t points) {
  PointPoleOptions result;
  result.clusters = options.clusters;
  result.max_damping_ratio = options.lscf.max_damping_ratio;
  // Work of all diagrams, order^4 each, bounded to that of 16 points of order 40.
  const double order = 40 * std::pow(16.0 / std::max(16.0, static_cast<double>(points)), 0.25);
  result.max_order = std::min(options.lscf.max_order, static_cast<int>(order));
  return result;
}

/// Mean over points; +-1.96 standard deviations hold 95 %.
MeanOverPoints mean_of(const std::vector<double>& value, const std::vector<double>& std) {
  std::vector<double> variance;
  for (std::size_t i = 0; i < value.size(); ++i) {
    variance.push_back(std::pow(std::max(std[i], 1e-12 * std::abs(value[i])), 2));
  }
  const GroupMean mean = mean_over_groups(value, variance);
  const double wider = coverage_factor(0.95, mean.degrees) / coverage_factor(0.95, 0);
  return {{mean.mean, wider * std::sqrt(mean.variance)},
          std::sqrt(mean.between_variance),
          mean.cochran_Q,
          mean.chance};
}

/// Values over the points of a track.
void average(LocalMode& mode) {
  std::vector<double> decay, decay_std, frequency, frequency_std;
  for (const PointPole& point : mode.points) {
    decay.push_back(-point.pole.real());
    decay_std.push_back(point.std_re);
    frequency.push_back(point.pole.imag());
    frequency_std.push_back(point.std_im);
  }
  mode.decay = mean_of(decay, decay_std);
  mode.frequency = mean_of(frequency, frequency_std);
}

double total_significance(const LocalMode& mode) {
  return std::accumulate(mode.points.begin(), mode.points.end(), 0.0,
                         [](double sum, const PointPole& p) { return sum + p.significance; });
}

/// Widest drift between points, half-power bandwidths.
constexpr double kDriftBandwidths = 20;

/// Distance when two poles may be one mode, negative when not.
double link_distance(const ModalBand& band, const PointPole& a, const PointPole& b) {
  const double ha = band.window - a.pole.real(), hb = band.window - b.pole.real();
  const double apart = std::abs(a.pole - b.pole) / (ha + hb + 0.5 * kTwoPi * band.spacing_hz);
  if (apart < 1) return apart;
  const bool clear = a.explained > 0.8 && b.explained > 0.8;
  const bool alike = std::max(ha, hb) < 2.5 * std::min(ha, hb);
  const bool within = std::abs(a.pole.imag() - b.pole.imag()) < kDriftBandwidths * (ha + hb);
  return clear && alike && within ? apart : -1;
}

/// Poles of different points that are one mode, by point: nearest pairs first, at most one of a
/// point, so that a close pair counts as two modes only where the same points show both.
std::vector<std::vector<PointPole>> link_points(const ModalBand& band,
                                                std::vector<PointPole> poles) {
  std::sort(poles.begin(), poles.end(),
            [](const auto& a, const auto& b) { return a.pole.imag() < b.pole.imag(); });
  std::vector<std::tuple<double, std::size_t, std::size_t>> pairs;
  for (std::size_t i = 0; i < poles.size(); ++i) {
    for (std::size_t j = i + 1; j < poles.size(); ++j) {
      // Broad poles reach furthest; beyond a fifth of the frequency nothing is one mode.
      if (poles[j].pole.imag() > 1.5 * poles[i].pole.imag()) break;
      if (poles[i].point == poles[j].point) continue;
      const double distance = link_distance(band, poles[i], poles[j]);
      if (distance >= 0) pairs.emplace_back(distance, i, j);
    }
  }
  std::sort(pairs.begin(), pairs.end());
  std::vector<std::size_t> owner(poles.size());
  std::iota(owner.begin(), owner.end(), std::size_t{0});
  std::vector<std::vector<std::size_t>> members(poles.size());
  for (std::size_t i = 0; i < poles.size(); ++i) members[i] = {i};
  for (const auto& [distance, i, j] : pairs) {
    const std::size_t a = owner[i], b = owner[j];
    if (a == b) continue;
    const bool shared = std::any_of(members[a].begin(), members[a].end(), [&](std::size_t m) {
      return std::any_of(members[b].begin(), members[b].end(),
                         [&](std::size_t n) { return poles[m].point == poles[n].point; });
    });
    if (shared) continue;
    for (const std::size_t n : members[b]) owner[n] = a;
    members[a].insert(members[a].end(), members[b].begin(), members[b].end());
    members[b].clear();
  }
  std::vector<std::vector<PointPole>> tracks;
  for (const auto& group : members) {
    if (group.empty()) continue;
    std::vector<PointPole> track;
    for (const std::size_t m : group) track.push_back(poles[m]);
    std::sort(track.begin(), track.end(),
              [](const auto& a, const auto& b) { return a.point < b.point; });
    tracks.push_back(std::move(track));
  }
  return tracks;
}

}  // namespace

std::vector<LocalMode> find_local_modes(const ModalBand& band, const std::vector<Complex>& common,
                                        const ModalOptions& options) {
  std::vector<LocalMode> modes;
  const auto points = columns_of_points(band);
  const auto count = static_cast<Index>(points.size());
  const PointPoleOptions with = point_options(options, points.size());
  std::vector<PointPole> all;
  for (Index i = 0; i < count; ++i) {
    for (PointPole& pole :
         point_poles(band, band.lines.H(Eigen::all, points[static_cast<std::size_t>(i)]), i, common,
                     with)) {
      all.push_back(std::move(pole));
    }
  }
  const double needed =
      count < 2 ? 1 : std::max(2.0, std::ceil(kShareOfPoints * static_cast<double>(count)));
  for (std::vector<PointPole>& track : link_points(band, std::move(all))) {
    if (static_cast<double>(track.size()) < needed) continue;
    modes.emplace_back().points = std::move(track);
    average(modes.back());
  }
  std::sort(modes.begin(), modes.end(), [](const auto& a, const auto& b) {
    return a.frequency.value.value < b.frequency.value.value;
  });
  return modes;
}

std::vector<MatrixXcd> frfs_of_points(const ModalBand& band) {
  std::vector<MatrixXcd> all;
  for (const auto& columns : columns_of_points(band)) {
    all.push_back(band.lines.H(Eigen::all, columns));
  }
  return all;
}

std::vector<LocalMode> check_groups(const ModalBand& band, const std::vector<MatrixXcd>& groups,
                                    const VectorXcd& poles, const ModalOptions& options) {
  std::vector<LocalMode> modes(static_cast<std::size_t>(poles.size()));
  PointPoleOptions with = point_options(options, groups.size());
  with.max_order = 0;
  with.twin_misfit = 0;  // the global fit has chosen them
  const std::vector<Complex> common(poles.begin(), poles.end());
  for (std::size_t i = 0; i < groups.size(); ++i) {
    for (const PointPole& found : point_poles(band, groups[i], Index(i), common, with)) {
      Index nearest = 0;
      (poles.array() - found.pole).abs().minCoeff(&nearest);
      LocalMode& mode = modes[static_cast<std::size_t>(nearest)];
      const bool near = std::abs(poles[nearest] - found.pole) <
                        2 * (2 * band.window - poles[nearest].real() - found.pole.real());
      if (near && (mode.points.empty() || mode.points.back().point != found.point)) {
        mode.points.push_back(found);
      }
    }
  }
  for (LocalMode& mode : modes) {
    if (!mode.points.empty()) average(mode);
  }
  return modes;
}

void join_split_modes(const ModalBand& band, const VectorXcd& poles,
                      std::vector<LocalMode>& modes) {
  for (std::size_t r = 0; r < modes.size(); ++r) {
    for (std::size_t q = 0; q < r; ++q) {
      const Complex a = poles[static_cast<Index>(r)], b = poles[static_cast<Index>(q)];
      auto &more = modes[r].points.size() > modes[q].points.size() ? modes[r] : modes[q],
           &fewer = &more == &modes[r] ? modes[q] : modes[r];
      const bool both =
          std::any_of(more.points.begin(), more.points.end(), [&](const PointPole& one) {
            return std::any_of(fewer.points.begin(), fewer.points.end(),
                               [&](const PointPole& other) { return one.point == other.point; });
          });
      if (both || fewer.points.empty() || std::abs(a - b) > 2 * band.window - a.real() - b.real()) {
        continue;
      }
      more.points.insert(more.points.end(), fewer.points.begin(), fewer.points.end());
      fewer.points.clear();
      average(more);
    }
  }
}

namespace {

bool points_differ(const LocalMode& mode) {
  return mode.points.size() > 1 &&
         std::min(mode.decay.excess_chance, mode.frequency.excess_chance) < 1e-4;
}

/// Between points, over the mode's half bandwidth: less does not move a fit of all FRFs together.
bool scatter_matters(const LocalMode& mode) {
  return mode.frequency.between_std > kScatterThatMatters * mode.decay.value.value ||
         mode.decay.between_std > kScatterThatMatters * mode.decay.value.value;
}

}  // namespace

bool has_twins(const ModalBand& band, const VectorXcd& poles) {
  if (std::min(band.lines.inputs, band.lines.H.cols() / band.lines.inputs) > 1) return false;
  if (band.lines.H.cols() < 2) return false;
  for (Index r = 0; r < poles.size(); ++r) {
    for (Index q = 0; q < r; ++q) {
      const double halves = 2 * band.window - poles[r].real() - poles[q].real();
      if (std::abs(poles[r].imag() - poles[q].imag()) < 0.5 * halves) return true;
    }
  }
  return false;
}

bool global_fit_holds(const ModalBand& band, const std::vector<LocalMode>& checked,
                      const FoundModes& found) {
  const MatrixXcd misfit = band.lines.H - found.model;
  for (std::size_t r = 0; r < checked.size(); ++r) {
    if (part_left(band, misfit, found.fit.poles[static_cast<Index>(r)]) < kSmallMisfit) continue;
    if (points_differ(checked[r]) && scatter_matters(checked[r])) return false;
  }
  return true;
}

FoundModes as_found_modes(const ModalBand& band, const std::vector<LocalMode>& local,
                          const FrfNoise& noise) {
  FoundModes found;
  const auto count = static_cast<Index>(local.size());
  const MatrixXcd& H = band.lines.H;
  ModalRefineResult& fit = found.fit;
  fit.end = StepsEnd::converged;
  fit.poles.resize(count);
  for (Index r = 0; r < count; ++r) {
    const LocalMode& mode = local[static_cast<std::size_t>(r)];
    fit.poles[r] = {-mode.decay.value.value, mode.frequency.value.value};
  }
  ModalRefineOptions held;
  held.max_iterations = 0;
  const FrfNoise unknown = noise_unknown(H, band.lines.inputs, band.correlation_lines);
  fit.residues = refine_modes(band.lines, unknown, fit.poles, held).residues;
  if (fit.residues.size() == 0) fit.residues.setZero(count, H.cols());
  found.covariance.full_rank = true;
  found.covariance.poles = MatrixXd::Zero(2 * count, 2 * count);
  found.covariance.residue_std_re = fit.residues.cwiseAbs();
  found.covariance.significance.resize(count);
  const auto points = columns_of_points(band);
  for (Index r = 0; r < count; ++r) {
    const LocalMode& mode = local[static_cast<std::size_t>(r)];
    found.covariance.poles(2 * r, 2 * r) = std::pow(mode.decay.value.std, 2);
    found.covariance.poles(2 * r + 1, 2 * r + 1) = std::pow(mode.frequency.value.std, 2);
    found.covariance.significance[r] = total_significance(mode);
    for (const PointPole& point : mode.points) {
      const auto& columns = points[static_cast<std::size_t>(point.point)];
      for (std::size_t i = 0; i < columns.size(); ++i) {
        const auto at = static_cast<Index>(i);
        fit.residues(r, columns[i]) = point.residues[at];
        found.covariance.residue_std_re(r, columns[i]) = point.residue_std[at];
      }
    }
    found.presence.push_back(static_cast<double>(mode.points.size()) /
                             static_cast<double>(points.size()));
  }
  found.covariance.residue_std_im = found.covariance.residue_std_re;
  const MatrixXcd without = synthesise(band.lines.s, band.lines.power, fit.poles, fit.residues,
                                       VectorXcd::Zero(H.cols()), VectorXcd::Zero(H.cols()));
  FrfLines beside = band.lines;
  beside.H -= without;
  const ModalRefineResult rest = refine_modes(beside, unknown, VectorXcd(0));
  fit.lower = rest.lower;
  fit.upper = rest.upper;
  fit.background = rest.background;
  found.model = fitted_frfs(band.lines, fit);
  found.noise = noise_from_residuals(found.model, H - found.model, VectorXd::Zero(H.rows()),
                                     band.lines.inputs, band.correlation_lines);
  found.noise.lead = noise.lead;
  const double frfs = static_cast<double>(H.cols());
  found.penalty = (2 * frfs + 2) * std::log(2 * static_cast<double>(H.rows()) * frfs);
  return found;
}

}  // namespace rigfit::signal
