#include "model/linear/segment_choice.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "model/algebra/eigenpairs.h"

namespace rigfit::model {
namespace {

constexpr int kFewest = 4, kFirst = 12, kRounds = 16;
constexpr int kAsymptotic = 6;  // from here on errors fall by their leading order

double total(const std::vector<int>& segments) {
  return std::accumulate(segments.begin(), segments.end(), 0.0);
}

/// The lowest omega^2 of each motion, as many as asked; empty when there is no equilibrium.
std::vector<Eigen::VectorXd> lowest(const Scene& scene, const ModesOptions& options,
                                    const std::vector<int>& segments,
                                    const std::vector<int>& counts) {
  const ChainModes prepared = prepare_motions(scene, options, segments);
  std::vector<Eigen::VectorXd> out;
  if (prepared.motions.size() != counts.size()) return out;
  for (std::size_t k = 0; k < counts.size(); ++k) {
    out.push_back(
        lowest_eigenpairs(prepared.motions[k].stiffness, prepared.motions[k].mass, counts[k])
            .values);
  }
  return out;
}

/// Wave number of a wave of omega: EI k^4 + T k^2 = m omega^2.
double wave_number(const Member& member, double tension, double omega) {
  const double EI = std::max(member.EI[0], member.EI[1]);
  const double inertia = member.mass_per_length * omega * omega;
  tension = std::max(tension, 0.0);
  if (!(EI > 0)) return tension > 0 ? std::sqrt(inertia / tension) : 0;
  // (-T + sqrt(T^2 + 4 EI m omega^2)) / (2 EI), without cancellation.
  const double root = std::sqrt(tension * tension + 4 * EI * inertia);
  return std::sqrt(2 * inertia / (tension + root));
}

}  // namespace

ResolutionError resolution_error(const Scene& scene, const ModesOptions& options,
                                 const ChainModes& modes, const std::vector<int>& segments) {
  ResolutionError out;
  const std::size_t asked = modes.order.size();
  for (std::size_t i = 0; i < asked; ++i) out.extrapolated_hz.push_back(modes.frequency_hz(i));
  if (asked == 0) {
    out.known = true;
    return out;
  }
  // Where each motion's modes stand among its lowest ones.
  std::vector<int> offset(modes.motions.size(), 0), counts(modes.motions.size(), 0);
  for (const auto& which : modes.order) {
    int& count = counts[std::size_t(which.motion)];
    count = std::max(count, which.mode + 1);
  }
  for (std::size_t k = 0; k < counts.size(); ++k) {
    const MotionModes& motion = modes.motions[k];
    if (options.band_hz && options.band_hz->first > 0 && counts[k] > 0) {
      offset[k] = count_below(motion.stiffness, motion.mass, motion.omega2[0] * (1 - 1e-9));
    }
    if (counts[k] > 0) counts[k] += offset[k];
  }
  std::vector<std::vector<Eigen::VectorXd>> others;
  Eigen::Matrix3d powers;
  powers.row(0).setOnes();
  // Very short chains are not yet on the asymptote: those twice and four times as long are.
  const bool few = *std::min_element(segments.begin(), segments.end()) < kAsymptotic;
  for (int level = 1; level <= 2; ++level) {
    const double factor = few ? 2 * level : 1 + 0.5 * level;
    std::vector<int> changed;
    for (const int n : segments) {
      changed.push_back(std::max(3, static_cast<int>(std::lround(n * factor))));
    }
    const double h = total(segments) / total(changed);
    powers.row(level) << 1, h * h, h * h * h * h;
    others.push_back(lowest(scene, options, changed, counts));
    if (others.back().size() != counts.size()) return out;
  }
  out.known = true;
  const Eigen::PartialPivLU<Eigen::Matrix3d> fit(powers);
  for (std::size_t i = 0; i < asked; ++i) {
    const auto& which = modes.order[i];
    const auto k = std::size_t(which.motion);
    const Eigen::Index row = which.mode + offset[k];
    if (others[0][k].size() <= row || others[1][k].size() <= row) {
      out.known = false;
      continue;
    }
    const Eigen::Vector3d f(std::sqrt(modes.motions[k].omega2[which.mode]),
                            std::sqrt(others[0][k][row]), std::sqrt(others[1][k][row]));
    const double limit = fit.solve(f)[0];
    out.extrapolated_hz[i] = limit / (2 * M_PI);
    out.relative = std::max(out.relative, std::abs(f[0] / limit - 1));
  }
  return out;
}

std::vector<double> wave_phases(const Scene& scene, const ChainModes& modes) {
  const Equilibrium rest = describe(*modes.chain, modes.equilibrium, scene);
  const double omega = 2 * M_PI * modes.frequency_hz(modes.order.size() - 1);
  std::vector<double> phase;
  phase.reserve(scene.members.size());
  for (std::size_t m = 0; m < scene.members.size(); ++m) {
    phase.push_back(rest.members[m].unstretched_length_m *
                    wave_number(scene.members[m], rest.members[m].tension_N, omega));
  }
  return phase;
}

SegmentChoice choose_segments(const Scene& scene, const ModesOptions& options) {
  SegmentChoice choice;
  const double accuracy = options.accuracy.value_or(scene.accuracy);
  const std::size_t members = scene.members.size();
  std::vector<bool> free(members, false);
  choice.segments.resize(members);
  bool any = false;
  for (std::size_t m = 0; m < members; ++m) {
    choice.segments[m] =
        options.accuracy ? 0 : options.segments.value_or(scene.members[m].segments);
    free[m] = choice.segments[m] <= 0;
    any = any || free[m];
  }
  // What stands only just may have buckled when cut coarsely.
  for (const int n : {12, 48, 192}) {
    for (std::size_t m = 0; m < members; ++m) {
      if (free[m]) choice.segments[m] = n;
    }
    choice.modes = find_modes(scene, options, choice.segments);
    if (!any || choice.modes.equilibrium.status != EquilibriumStatus::buckled) break;
  }
  if (!any || choice.modes.order.empty()) {
    if (options.error_estimate) {
      choice.error = resolution_error(scene, options, choice.modes, choice.segments);
    }
    return choice;
  }

  // Shares by the phase of the highest wave asked for.
  const std::vector<double> phase = wave_phases(scene, choice.modes);
  double largest = 0;
  for (std::size_t m = 0; m < members; ++m) {
    if (free[m]) largest = std::max(largest, phase[m]);
  }
  const auto share_out = [&](int n) {
    std::vector<int> segments = choice.segments;
    for (std::size_t m = 0; m < members; ++m) {
      if (!free[m]) continue;
      const double part = largest > 0 ? std::max(0.25, phase[m] / largest) : 1;
      segments[m] = std::max(kFewest, static_cast<int>(std::ceil(n * part)));
    }
    return segments;
  };
  SegmentChoice best;
  int n = kFirst;
  for (int round = 0; round < kRounds; ++round) {
    SegmentChoice trial;
    trial.segments = share_out(n);
    trial.modes = find_modes(scene, options, trial.segments);
    trial.error.relative = 1;
    if (trial.modes.order.size() >= choice.modes.order.size()) {
      auto error = resolution_error(scene, options, trial.modes, trial.segments);
      if (error.known) trial.error = std::move(error);
    }
    const double ratio = trial.error.relative / accuracy;
    if (best.segments.empty() || trial.error.relative < best.error.relative) {
      best = std::move(trial);
    }
    if (ratio <= 1 || n == kMostSegments) break;
    // Between second and fourth order.
    n = std::min(kMostSegments,
                 static_cast<int>(std::ceil(n * std::clamp(std::cbrt(ratio), 1.2, 4.0))));
  }
  return best;
}

}  // namespace rigfit::model
