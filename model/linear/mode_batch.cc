#include "model/linear/mode_batch.h"

#include <Eigen/QR>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "model/linear/modal_analysis.h"
#include "model/linear/modes.h"
#include "model/linear/segment_extrapolation.h"

namespace rigfit::model {
namespace {

constexpr std::size_t kMostPilots = 12, kScenesPerPilot = 25, kFewestPilots = 6;
constexpr int kBeside = 2;           // modes found above those asked for
constexpr int kMostDegree = 3;       // of the polynomials
constexpr int kCoarse = 12;          // segments of a chain that shows the phases
constexpr double kPilotShare = 0.2;  // of the error asked for, given to the pilots

/// Chains of these times the first numbers of a sequence, taken to no length by Neville's value of
/// them all; by rising cost. 0: none.
using ChainSet = std::array<int, 3>;
constexpr int kCommon = 8;  // in all
constexpr std::array<ChainSet, 5> kSets{{{8, 0, 0}, {4, 8, 0}, {4, 6, 8}, {6, 8, 12}, {8, 16, 24}}};

/// Weight of one chain's value in Neville's (Lagrange at h = 0 in h^2).
double weight(const ChainSet& set, int factor) {
  double out = 1;
  for (const int other : set) {
    if (other == 0 || other == factor) continue;
    out *= double(factor * factor) / double(factor * factor - other * other);
  }
  return out;
}

/// ln f of the modes of each motion; empty: no equilibrium.
using Logs = std::vector<Eigen::VectorXd>;

Logs logs_of(const Scene& scene, const ModesOptions& options, const std::vector<int>& segments) {
  Logs out;
  const ChainModes modes = find_modes(scene, options, segments);
  if (modes.equilibrium.status != EquilibriumStatus::converged) return out;
  for (const MotionModes& motion : modes.motions) {
    out.emplace_back((motion.omega2.array().sqrt() / (2 * M_PI)).log());
  }
  return out;
}

Logs scaled(Logs logs, double factor) {
  for (auto& motion : logs) motion *= factor;
  return logs;
}

/// sum += factor x logs, of the modes that both have; false: they have not the same motions.
bool add(Logs& sum, double factor, const Logs& logs) {
  if (sum.size() != logs.size()) return false;
  for (std::size_t k = 0; k < sum.size(); ++k) {
    const Eigen::Index both = std::min(sum[k].size(), logs[k].size());
    sum[k] = (sum[k].head(both) + factor * logs[k].head(both)).eval();
  }
  return true;
}

double lowest(const Logs& logs) {
  double out = std::numeric_limits<double>::infinity();
  for (const auto& motion : logs) {
    if (motion.size() > 0) out = std::min(out, motion[0]);
  }
  return out;
}

/// A polynomial in ln f of one mode's correction, and how well it predicts what it has not seen.
struct Correction {
  Eigen::VectorXd coefficients;
  double centre = 0, scale = 1;
  double error = std::numeric_limits<double>::infinity();

  [[nodiscard]] double at(double log_hz) const {
    const double u = (log_hz - centre) / scale;
    double sum = 0;
    for (Eigen::Index k = coefficients.size(); k-- > 0;) sum = sum * u + coefficients[k];
    return sum;
  }
};

Eigen::VectorXd fitted(const Eigen::MatrixXd& powers, const Eigen::VectorXd& y) {
  return powers.colPivHouseholderQr().solve(y);
}

Correction correction_of(const Eigen::VectorXd& log_hz, const Eigen::VectorXd& y) {
  Correction best;
  const Eigen::Index points = y.size();
  best.centre = log_hz.mean();
  best.scale = std::max((log_hz.array() - best.centre).abs().maxCoeff(), 1e-12);
  const Eigen::VectorXd u = (log_hz.array() - best.centre) / best.scale;
  Eigen::MatrixXd powers(points, kMostDegree + 1);
  for (Eigen::Index k = 0; k <= kMostDegree; ++k) powers.col(k) = u.array().pow(double(k));
  for (Eigen::Index terms = 1; terms <= kMostDegree + 1 && terms + 2 <= points; ++terms) {
    double error = 0;
    for (Eigen::Index out = 0; out < points; ++out) {
      Eigen::MatrixXd rest(points - 1, terms);
      Eigen::VectorXd right(points - 1);
      for (Eigen::Index i = 0, row = 0; i < points; ++i) {
        if (i == out) continue;
        rest.row(row) = powers.row(i).head(terms);
        right[row++] = y[i];
      }
      error =
          std::max(error, std::abs(powers.row(out).head(terms).dot(fitted(rest, right)) - y[out]));
    }
    if (error >= best.error) continue;
    best.error = error;
    best.coefficients = fitted(powers.leftCols(terms), y);
  }
  return best;
}

class Batch {
 public:
  Batch(std::span<const Scene> scenes, const ModesOptions& options, double accuracy)
      : scenes_(scenes), options_(options), accuracy_(accuracy) {
    options_.band_hz.reset();
    options_.segments.reset();
    wide_ = options_;
    wide_.count += kBeside;
    out_.frequency_hz.setZero(static_cast<Eigen::Index>(scenes.size()), options.count);
    out_.solved.assign(scenes.size(), false);
  }

  ModeBatch run() {
    if (scenes_.empty()) return std::move(out_);
    std::vector<bool> left(scenes_.size(), true);
    if (scenes_.size() > 2 * kFewestPilots && start_from_first()) solve(left);
    for (std::size_t i = 0; i < scenes_.size(); ++i) {
      if (left[i]) extrapolate(i);
    }
    return std::move(out_);
  }

 private:
  bool start_from_first() {
    const ChainModes coarse =
        find_modes(scenes_[0], options_, std::vector<int>(scenes_[0].members.size(), kCoarse));
    if (coarse.order.empty()) return false;
    start_ = sequence_start(scenes_[0], coarse);
    return true;
  }

  void extrapolate(std::size_t i) {
    Scene scene = scenes_[i];
    scene.accuracy = accuracy_;
    for (Member& member : scene.members) member.segments = 0;
    ModesOptions own = options_;
    own.damped = own.shapes = false;
    const ModalAnalysis found = analyse_modes(scene, own);
    const auto count = static_cast<std::size_t>(options_.count);
    if (found.modes.size() < count) return;
    out_.solved[i] = true;
    ++out_.extrapolated;
    out_.relative_error_estimate =
        std::max(out_.relative_error_estimate, found.relative_error_estimate);
    for (std::size_t k = 0; k < count; ++k) {
      out_.frequency_hz(Eigen::Index(i), Eigen::Index(k)) = found.modes[k].frequency_hz;
    }
  }

  /// Scenes at even ranks of the first frequency, both ends among them.
  [[nodiscard]] std::vector<std::size_t> pilots(const std::vector<Logs>& logs) const {
    std::vector<std::size_t> alike;
    for (std::size_t i = 0; i < logs.size(); ++i) {
      if (!logs[i].empty() && logs[i].size() == logs[0].size()) alike.push_back(i);
    }
    std::stable_sort(alike.begin(), alike.end(), [&](std::size_t a, std::size_t b) {
      return lowest(logs[a]) < lowest(logs[b]);
    });
    const std::size_t wanted =
        std::clamp(scenes_.size() / kScenesPerPilot, kFewestPilots, kMostPilots);
    if (alike.size() < wanted) return {};
    std::vector<std::size_t> out;
    for (std::size_t k = 0; k < wanted; ++k) {
      out.push_back(alike[k * (alike.size() - 1) / (wanted - 1)]);
    }
    return out;
  }

  Logs chain_logs(std::size_t i, int factor) const {
    std::vector<int> segments = start_.first;
    for (int& n : segments) n *= factor;
    return scenes_[i].members.size() == segments.size() ? logs_of(scenes_[i], wide_, segments)
                                                        : Logs{};
  }

  /// All scenes as the cheapest set of chains that meets the accuracy; false: there is none.
  bool solve(std::vector<bool>& left) {
    std::vector<Logs> common;
    common.reserve(scenes_.size());
    for (std::size_t i = 0; i < scenes_.size(); ++i) common.push_back(chain_logs(i, kCommon));
    const std::vector<std::size_t> chosen = pilots(common);
    if (chosen.empty() || common[0].empty() || !extrapolate_pilots(chosen)) return false;
    const auto value_of = [&](std::size_t i, const ChainSet& set) {
      Logs out = scaled(common[i], weight(set, kCommon));
      for (const int factor : set) {
        if (factor == 0 || factor == kCommon) continue;
        if (!add(out, weight(set, factor), chain_logs(i, factor))) return Logs{};
      }
      return out;
    };
    for (const ChainSet& set : kSets) {
      std::vector<Logs> logs;
      logs.reserve(chosen.size());
      for (const std::size_t pilot : chosen) logs.push_back(value_of(pilot, set));
      double error = pilot_error_;
      const auto corrections = corrections_of(logs, error);
      if (!(error <= accuracy_)) continue;
      out_.segments = start_.first;
      for (int& n : out_.segments) n *= *std::max_element(set.begin(), set.end());
      out_.relative_error_estimate = error;
      for (std::size_t i = 0; i < scenes_.size(); ++i) {
        const Logs own = common[i].empty() ? Logs{} : value_of(i, set);
        if (own.size() == corrections.size()) left[i] = !take(i, own, corrections);
      }
      return true;
    }
    return false;
  }

  /// By motion and mode, where it is needed and every pilot has it; the largest error is added to
  /// `error`.
  [[nodiscard]] std::vector<std::vector<Correction>> corrections_of(const std::vector<Logs>& logs,
                                                                    double& error) const {
    std::vector<std::vector<Correction>> out(logs[0].size());
    double worst = 0;
    for (std::size_t motion = 0; motion < out.size(); ++motion) {
      for (Eigen::Index mode = 0; mode < needed_[motion]; ++mode) {
        Eigen::VectorXd x(static_cast<Eigen::Index>(logs.size())), y(x.size());
        bool all = true;
        for (std::size_t p = 0; p < logs.size() && all; ++p) {
          const Logs& limit = pilots_[p];
          all = motion < logs[p].size() && mode < logs[p][motion].size() && motion < limit.size() &&
                mode < limit[motion].size() && limit[motion][mode] != 0;
          if (!all) break;
          x[static_cast<Eigen::Index>(p)] = logs[p][motion][mode];
          y[static_cast<Eigen::Index>(p)] = limit[motion][mode] - logs[p][motion][mode];
        }
        if (!all) break;
        out[motion].push_back(correction_of(x, y));
        worst = std::max(worst, out[motion].back().error);
      }
    }
    error += worst;
    return out;
  }

  /// Limits of the pilots' ln f by motion and mode; false: one has none.
  bool extrapolate_pilots(const std::vector<std::size_t>& chosen) {
    for (const std::size_t i : chosen) {
      const ExtrapolatedModes found =
          extrapolate_modes(scenes_[i], wide_, start_, kPilotShare * accuracy_);
      if (!found.known) return false;
      Logs limit;
      for (const MotionModes& motion : found.modes.motions) {
        limit.emplace_back(Eigen::VectorXd::Zero(motion.omega2.size()));
      }
      for (std::size_t k = 0; k < found.modes.order.size(); ++k) {
        const auto& which = found.modes.order[k];
        limit[static_cast<std::size_t>(which.motion)][which.mode] = std::log(found.frequency_hz[k]);
      }
      // Those among the first asked for, in any pilot.
      needed_.resize(std::max(needed_.size(), limit.size()), 0);
      const std::size_t asked =
          std::min(found.modes.order.size(), static_cast<std::size_t>(options_.count));
      for (std::size_t k = 0; k < asked; ++k) {
        const auto& which = found.modes.order[k];
        int& needed = needed_[static_cast<std::size_t>(which.motion)];
        needed = std::max(needed, which.mode + 1);
      }
      pilot_error_ = std::max(pilot_error_, found.relative_error);
      pilots_.push_back(std::move(limit));
    }
    return true;
  }

  /// The corrected frequencies of one scene; false: a mode among the first has no correction.
  bool take(std::size_t i, const Logs& logs,
            const std::vector<std::vector<Correction>>& corrections) {
    std::vector<std::pair<double, bool>> hz;
    for (std::size_t motion = 0; motion < logs.size(); ++motion) {
      const auto& own = corrections[motion];
      for (Eigen::Index mode = 0; mode < logs[motion].size(); ++mode) {
        const auto k = static_cast<std::size_t>(mode);
        const bool corrected = k < own.size();
        const double log_hz = logs[motion][mode];
        hz.emplace_back(std::exp(log_hz + (corrected ? own[k].at(log_hz) : 0.0)), corrected);
      }
    }
    std::sort(hz.begin(), hz.end());
    const auto count = static_cast<std::size_t>(options_.count);
    if (hz.size() < count) return false;
    for (std::size_t k = 0; k < count; ++k) {
      if (!hz[k].second) return false;
      out_.frequency_hz(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(k)) = hz[k].first;
    }
    out_.solved[i] = true;
    return true;
  }

  std::span<const Scene> scenes_;
  ModesOptions options_, wide_;
  double accuracy_;
  SequenceStart start_;
  std::vector<Logs> pilots_;  // their limits
  std::vector<int> needed_;   // modes of each motion
  double pilot_error_ = 0;
  ModeBatch out_;
};

}  // namespace

ModeBatch batch_modes(std::span<const Scene> scenes, const ModesOptions& options, double accuracy) {
  return Batch(scenes, options, accuracy).run();
}

}  // namespace rigfit::model
