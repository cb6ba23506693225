#include "signal/modal/local_modes.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "signal/numerics/numbers.h"
#include "signal/refinement/modal_noise.h"
#include "signal/refinement/residues.h"

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
/// Correlation of the misfit at neighbouring lines beyond that of noise.
constexpr double kLikeNoise = 0.2;
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

/// Values over the points of a track.
void average(LocalMode& mode, Index points) {
  const auto n = static_cast<Index>(mode.points.size());
  VectorXd decay(n), decay_std(n), frequency(n), frequency_std(n), order(n);
  double misfit = 0, correlation = 0;
  for (Index i = 0; i < n; ++i) {
    const PointPole& point = mode.points[static_cast<std::size_t>(i)];
    decay[i] = -point.pole.real();
    decay_std[i] = point.std_re;
    frequency[i] = point.pole.imag();
    frequency_std[i] = point.std_im;
    order[i] = static_cast<double>(point.point);
    misfit += point.misfit * point.misfit;
    correlation += point.line_correlation;
  }
  mode.decay = mean_over_points(decay, decay_std, order, points);
  mode.frequency = mean_over_points(frequency, frequency_std, order, points);
  mode.misfit = std::sqrt(misfit / static_cast<double>(std::max<Index>(n, 1)));
  mode.line_correlation = correlation / static_cast<double>(std::max<Index>(n, 1));
}

double total_significance(const LocalMode& mode) {
  return std::accumulate(mode.points.begin(), mode.points.end(), 0.0,
                         [](double sum, const PointPole& p) { return sum + p.significance; });
}

/// Lowest and highest Im p of a track, widened by its half bandwidth.
bool covers(const LocalMode& mode, const ModalBand& band, Complex pole) {
  const double half = band.window + mode.decay.value.value + band.window - pole.real();
  const auto [low, high] = std::minmax_element(
      mode.points.begin(), mode.points.end(),
      [](const auto& a, const auto& b) { return a.pole.imag() < b.pole.imag(); });
  return pole.imag() > low->pole.imag() - half && pole.imag() < high->pole.imag() + half;
}

}  // namespace

LocalModes find_local_modes(const ModalBand& band, const std::vector<Complex>& common,
                            const ModalOptions& options) {
  LocalModes result;
  const auto points = columns_of_points(band);
  const auto count = static_cast<Index>(points.size());
  const PointPoleOptions with = point_options(options, points.size());
  std::vector<PointPole> all;
  for (Index i = 0; i < count; ++i) {
    for (PointPole& pole :
         point_poles(band, points[static_cast<std::size_t>(i)], i, common, with)) {
      all.push_back(std::move(pole));
    }
  }
  const double needed =
      count < 2 ? 1 : std::max(2.0, std::ceil(kShareOfPoints * static_cast<double>(count)));
  for (std::vector<PointPole>& track : link_points(band, std::move(all))) {
    LocalMode mode;
    mode.points = std::move(track);
    average(mode, count);
    const Complex pole(-mode.decay.value.value, mode.frequency.value.value);
    const double half = band.window + mode.decay.value.value;
    const double scatter = mode.frequency.between_std / half;
    const double share = static_cast<double>(mode.points.size()) / static_cast<double>(count);
    if (static_cast<double>(mode.points.size()) < needed) {
      result.weak.push_back({pole, "points",
                             fmt::format("{} of {} points show it, of which {:.0f} are asked",
                                         mode.points.size(), count, needed)});
      continue;
    }
    if (count > 1 && share < 0.8 && scatter > 0.4) {
      result.weak.push_back(
          {pole, "scatter",
           fmt::format("its frequency scatters by {:.1f} half bandwidths over the {} of {} points "
                       "that show it: neither one mode of all nor one of few",
                       scatter, mode.points.size(), count)});
      continue;
    }
    result.modes.push_back(std::move(mode));
  }
  if (count > 1) {
    std::vector<Index> every;
    for (const auto& columns : points) every.insert(every.end(), columns.begin(), columns.end());
    PointPoleOptions joint = with;
    joint.max_order = 0;
    for (PointPole& pole : point_poles(band, every, 0, common, joint)) {
      if (pole.explained < 0.5 || pole.misfit > 0.5 ||
          std::any_of(result.modes.begin(), result.modes.end(),
                      [&](const LocalMode& mode) { return covers(mode, band, pole.pole); })) {
        continue;
      }
      LocalMode mode;
      mode.together = true;
      mode.points.push_back(std::move(pole));
      average(mode, 1);
      result.modes.push_back(std::move(mode));
    }
  }
  std::sort(result.modes.begin(), result.modes.end(), [](const auto& a, const auto& b) {
    return a.frequency.value.value < b.frequency.value.value;
  });
  return result;
}

std::vector<LocalMode> check_points(const ModalBand& band, const VectorXcd& poles,
                                    const ModalOptions& options) {
  std::vector<LocalMode> modes(static_cast<std::size_t>(poles.size()));
  const auto points = columns_of_points(band);
  PointPoleOptions with = point_options(options, points.size());
  with.max_order = 0;
  with.twin_misfit = 0;  // the global fit has chosen them
  const std::vector<Complex> common(poles.begin(), poles.end());
  for (std::size_t i = 0; i < points.size(); ++i) {
    for (const PointPole& found : point_poles(band, points[i], Index(i), common, with)) {
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
    if (!mode.points.empty()) average(mode, static_cast<Index>(points.size()));
  }
  return modes;
}

namespace {

/// Share of the FRFs within the half bandwidth of each mode that a global fit leaves.
VectorXd misfit_around_modes(const ModalBand& band, const FoundModes& found) {
  const MatrixXcd& H = band.lines.H;
  VectorXd share(found.fit.poles.size());
  for (Index r = 0; r < share.size(); ++r) {
    const double centre = found.fit.poles[r].imag() / kTwoPi;
    const double half =
        std::max((band.window - found.fit.poles[r].real()) / kTwoPi, band.spacing_hz);
    double above = 0, below = 0;
    for (Index k = 0; k < H.rows(); ++k) {
      if (std::abs(band.frequency_hz[k] - centre) > half) continue;
      above += (H.row(k) - found.model.row(k)).squaredNorm();
      below += H.row(k).squaredNorm();
    }
    share[r] = below > 0 ? std::sqrt(above / below) : 0;
  }
  return share;
}

bool points_differ(const LocalMode& mode) {
  return mode.points.size() > 1 &&
         std::min(mode.decay.excess_chance, mode.frequency.excess_chance) < 1e-4;
}

/// Between points, over the mode's half bandwidth: less does not move a fit of all FRFs together.
bool scatter_matters(const LocalMode& mode) {
  return mode.frequency.between_std > kScatterThatMatters * mode.decay.value.value ||
         mode.decay.between_std > kScatterThatMatters * mode.decay.value.value;
}

bool lines_correlate(const LocalMode& mode) {
  // At least 17 lines a point: the mean correlation of noise scatters by a sixth of one point's.
  const double chance = 4 / std::sqrt(17.0 * static_cast<double>(mode.points.size()));
  return !mode.points.empty() && mode.line_correlation > std::max(0.3, chance);
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
                      const FoundModes& found, double excess) {
  if (!found.covariance.full_rank) return false;
  const VectorXd left = misfit_around_modes(band, found);
  if (left.size() == 0) return true;
  if (left.maxCoeff() < kSmallMisfit) return true;
  if (excess > kLikeNoise && has_twins(band, found.fit.poles)) return false;
  for (std::size_t r = 0; r < checked.size(); ++r) {
    if (left[static_cast<Index>(r)] < kSmallMisfit) continue;
    if (points_differ(checked[r]) && scatter_matters(checked[r])) return false;
  }
  return true;
}

void widen_to_points(const std::vector<LocalMode>& checked, Index points, double least_misfit,
                     FoundModes& found) {
  MatrixXd& covariance = found.covariance.poles;
  for (std::size_t i = 0; i < checked.size(); ++i) {
    const LocalMode& mode = checked[i];
    const auto r = static_cast<Index>(i);
    const double share = static_cast<double>(mode.points.size()) / static_cast<double>(points);
    if (mode.points.empty() || mode.misfit < least_misfit) continue;
    const bool differ = points_differ(mode) && scatter_matters(mode) && share > kShareOfPoints &&
                        mode.points.size() > 2;
    if (!differ && !lines_correlate(mode)) continue;
    const double wanted[2] = {mode.decay.value.std, mode.frequency.value.std};
    for (Index part = 0; part < 2; ++part) {
      const Index row = 2 * r + part;
      const double factor = std::max(1.0, wanted[part] / std::sqrt(covariance(row, row)));
      covariance.row(row) *= factor;
      covariance.col(row) *= factor;
    }
  }
}

FoundModes as_found_modes(const ModalBand& band, const LocalModes& local, const FrfNoise& noise,
                          const std::vector<PoleCluster>& clusters) {
  FoundModes found;
  const auto count = static_cast<Index>(local.modes.size());
  const MatrixXcd& H = band.lines.H;
  ModalRefineResult& fit = found.fit;
  fit.end = RefineEnd::converged;
  fit.poles.resize(count);
  for (Index r = 0; r < count; ++r) {
    const LocalMode& mode = local.modes[static_cast<std::size_t>(r)];
    fit.poles[r] = {-mode.decay.value.value, mode.frequency.value.value};
  }
  const ResidueResult linear = fit_residues(band.lines.s, band.lines.power, H, fit.poles);
  fit.residues = linear.residues;
  found.covariance.full_rank = true;
  found.covariance.poles = MatrixXd::Zero(2 * count, 2 * count);
  found.covariance.residue_std_re = fit.residues.cwiseAbs();
  found.covariance.significance.resize(count);
  const auto points = columns_of_points(band);
  for (Index r = 0; r < count; ++r) {
    const LocalMode& mode = local.modes[static_cast<std::size_t>(r)];
    found.covariance.poles(2 * r, 2 * r) = std::pow(mode.decay.value.std, 2);
    found.covariance.poles(2 * r + 1, 2 * r + 1) = std::pow(mode.frequency.value.std, 2);
    found.covariance.significance[r] = total_significance(mode);
    std::vector<Index> every;
    for (const auto& columns : points) every.insert(every.end(), columns.begin(), columns.end());
    for (const PointPole& point : mode.points) {
      const auto& columns = mode.together ? every : points[static_cast<std::size_t>(point.point)];
      for (std::size_t i = 0; i < columns.size(); ++i) {
        const auto at = static_cast<Index>(i);
        fit.residues(r, columns[i]) = point.residues[at];
        found.covariance.residue_std_re(r, columns[i]) = point.residue_std[at];
      }
    }
    double presence = mode.together ? 0
                                    : static_cast<double>(mode.points.size()) /
                                          static_cast<double>(points.size());
    for (const PoleCluster& cluster : clusters) {
      const Complex pole = cluster.pole_rad_s + band.window;
      if (covers(mode, band, pole)) presence = std::max(presence, cluster.presence);
    }
    found.presence.push_back(presence);
  }
  found.covariance.residue_std_im = found.covariance.residue_std_re;
  const MatrixXcd without = synthesise(band.lines.s, band.lines.power, fit.poles, fit.residues,
                                       VectorXcd::Zero(H.cols()), VectorXcd::Zero(H.cols()));
  FrfLines beside = band.lines;
  beside.H -= without;
  const ModalRefineResult rest = refine_modes(
      beside, noise_unknown(beside.H, beside.inputs, band.correlation_lines), VectorXcd(0));
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
