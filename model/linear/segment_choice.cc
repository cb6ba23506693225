#include "model/linear/segment_extrapolation.h"

#include <numeric>

#include "model/algebra/eigenpairs.h"

namespace rigfit::model {

double neville(const std::vector<double>& h, const std::vector<double>& f, std::size_t first,
               std::size_t last) {
  std::vector<double> column(f.begin() + static_cast<std::ptrdiff_t>(first),
                             f.begin() + static_cast<std::ptrdiff_t>(last) + 1);
  for (std::size_t d = 1; d < column.size(); ++d) {
    for (std::size_t k = 0; k + d < column.size(); ++k) {
      const double ratio = h[first + k] / h[first + k + d];
      column[k] = column[k + 1] + (column[k + 1] - column[k]) / (ratio * ratio - 1);
    }
  }
  return column[0];
}

namespace {

constexpr int kFewest = 4, kFirst = 12, kRounds = 16;
constexpr int kAsymptotic = 6;  // from here on errors fall by their leading order

double total(const std::vector<int>& segments) {
  return std::accumulate(segments.begin(), segments.end(), 0.0);
}

/// The lowest omega^2 of each motion, as many as asked; empty when there is no equilibrium.
std::vector<VectorXd> lowest(const Scene& scene, const ModesOptions& options,
                             const std::vector<int>& segments, const std::vector<int>& counts) {
  const ChainModes prepared = prepare_motions(scene, options, segments);
  std::vector<VectorXd> out;
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

/// The error of `out.modes`.
void estimate_error(const Scene& scene, const ModesOptions& options, ResolvedModes& out) {
  const ChainModes& modes = out.modes;
  const std::size_t asked = modes.order.size();
  out.known = asked == 0;
  if (out.known) return;
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
  std::vector<std::vector<VectorXd>> others;
  const std::vector<int> segments = modes.chain->segment_counts();
  std::vector<double> h{1 / total(segments)};
  // Very short chains are not yet on the asymptote: those twice and four times as long are.
  const bool few = *std::ranges::min_element(segments) < kAsymptotic;
  for (int level = 1; level <= 2; ++level) {
    const double factor = few ? 2 * level : 1 + 0.5 * level;
    std::vector<int> changed;
    for (const int n : segments) {
      changed.push_back(std::max(3, static_cast<int>(std::lround(n * factor))));
    }
    h.push_back(1 / total(changed));
    others.push_back(lowest(scene, options, changed, counts));
    if (others.back().size() != counts.size()) return;
  }
  out.known = true;
  for (std::size_t i = 0; i < asked; ++i) {
    const auto& which = modes.order[i];
    const auto k = std::size_t(which.motion);
    const Index row = which.mode + offset[k];
    if (others[0][k].size() <= row || others[1][k].size() <= row) {
      out.known = false;
      continue;
    }
    const auto hz = [](double omega2) { return std::sqrt(omega2) / (2 * M_PI); };
    out.limit_hz[i] =
        neville(h, {out.frequency_hz[i], hz(others[0][k][row]), hz(others[1][k][row])}, 0, 2);
    out.relative_error =
        std::max(out.relative_error, std::abs(out.frequency_hz[i] / out.limit_hz[i] - 1));
  }
}

/// Modes of the chain with these segments, without an error as yet.
ResolvedModes modes_with(const Scene& scene, const ModesOptions& options,
                         const std::vector<int>& segments) {
  ResolvedModes out;
  out.modes = find_modes(scene, options, segments);
  for (std::size_t i = 0; i < out.modes.order.size(); ++i) {
    out.frequency_hz.push_back(out.modes.frequency_hz(i));
  }
  out.limit_hz = out.frequency_hz;
  return out;
}

}  // namespace

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

ResolvedModes choose_segments(const Scene& scene, const ModesOptions& options) {
  ResolvedModes choice;
  const double accuracy = options.accuracy.value_or(scene.accuracy);
  const std::size_t members = scene.members.size();
  std::vector<bool> free(members, false);
  std::vector<int> segments(members);
  bool any = false;
  for (std::size_t m = 0; m < members; ++m) {
    segments[m] = options.accuracy ? 0 : options.segments.value_or(scene.members[m].segments);
    free[m] = segments[m] <= 0;
    any = any || free[m];
  }
  // What stands only just may have buckled when cut coarsely.
  for (const int n : {12, 48, 192}) {
    for (std::size_t m = 0; m < members; ++m) {
      if (free[m]) segments[m] = n;
    }
    choice = modes_with(scene, options, segments);
    if (!any || choice.modes.equilibrium.status != EquilibriumStatus::buckled) break;
  }
  if (!any || choice.modes.order.empty()) {
    if (options.error_estimate) estimate_error(scene, options, choice);
    return choice;
  }

  // Shares by the phase of the highest wave asked for.
  const std::vector<double> phase = wave_phases(scene, choice.modes);
  double largest = 0;
  for (std::size_t m = 0; m < members; ++m) {
    if (free[m]) largest = std::max(largest, phase[m]);
  }
  const std::size_t wanted = choice.modes.order.size();
  int n = kFirst;
  for (int round = 0; round < kRounds; ++round) {
    for (std::size_t m = 0; m < members; ++m) {
      if (!free[m]) continue;
      const double part = largest > 0 ? std::max(0.25, phase[m] / largest) : 1;
      segments[m] = std::max(kFewest, static_cast<int>(std::ceil(n * part)));
    }
    ResolvedModes trial = modes_with(scene, options, segments);
    if (trial.modes.order.size() >= wanted) estimate_error(scene, options, trial);
    if (!trial.known) trial.relative_error = 1, trial.limit_hz = trial.frequency_hz;
    const double ratio = trial.relative_error / accuracy;
    if (round == 0 || trial.relative_error < choice.relative_error) choice = std::move(trial);
    if (ratio <= 1 || n == kMostSegments) break;
    // Between second and fourth order.
    n = std::min(kMostSegments,
                 static_cast<int>(std::ceil(n * std::clamp(std::cbrt(ratio), 1.2, 4.0))));
  }
  return choice;
}

}  // namespace rigfit::model
