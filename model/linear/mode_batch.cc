#include "model/linear/mode_batch.h"

#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "model/linear/modal_analysis.h"
#include "model/linear/mode_description.h"
#include "model/linear/mode_following.h"
#include "model/linear/modes.h"
#include "model/linear/segment_extrapolation.h"

namespace rigfit::model {
namespace {

constexpr std::size_t kMostPilots = 16, kScenesPerPilot = 14, kFewestPilots = 6;
constexpr int kBeside = 2;           // modes found above those asked for
constexpr int kMostComponents = 3;   // principal ones of ln f
constexpr int kCoarse = 12;          // segments of a chain that shows the phases
constexpr double kPilotShare = 0.2;  // of the error asked for, given to the pilots

/// Chains of these times the first numbers of a sequence, taken to no length by Neville's value of
/// them all; by rising cost. 0: none.
using ChainSet = std::array<int, 4>;
constexpr int kCommon = 4;  // in all
constexpr std::array<ChainSet, 10> kSets{{{4, 0, 0, 0},
                                          {2, 4, 0, 0},
                                          {3, 4, 0, 0},
                                          {2, 3, 4, 0},
                                          {2, 4, 6, 0},
                                          {3, 4, 6, 0},
                                          {2, 3, 4, 6},
                                          {4, 6, 8, 0},
                                          {3, 4, 6, 8},
                                          {4, 6, 8, 12}}};

/// Weight of one chain's value in Neville's (Lagrange at h = 0 in h^2).
double weight(const ChainSet& set, int factor) {
  double out = 1;
  for (const int other : set) {
    if (other == 0 || other == factor) continue;
    out *= double(factor * factor) / double(factor * factor - other * other);
  }
  return out;
}

/// ln f of the modes of each motion, in the reference's order; empty: no equilibrium.
using Logs = std::vector<Eigen::VectorXd>;

/// The shapes of the scene that all others' modes are ordered by.
struct Reference {
  std::vector<Eigen::MatrixXd> shapes;  // by motion
  std::vector<Eigen::VectorXd> omega2;
  std::vector<std::vector<ModePlane>> planes;
};

/// By motion, where each of the reference's modes is among `modes`; up to the first that is not.
std::vector<std::vector<int>> order_by(const Reference& reference, const ChainModes& modes,
                                       const std::vector<int>& samples) {
  std::vector<std::vector<int>> out;
  if (modes.motions.size() != reference.shapes.size()) return out;
  for (std::size_t k = 0; k < modes.motions.size(); ++k) {
    const MotionModes& motion = modes.motions[k];
    std::vector<int>& found = out.emplace_back(
        following_modes(reference.shapes[k], sampled_shapes(modes, motion, samples),
                        reference.omega2[k], motion.omega2));
    found.erase(std::find(found.begin(), found.end(), -1), found.end());
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

/// Scenes by their first principal components of ln f, each of unit largest size.
struct Components {
  std::vector<std::size_t> scenes;
  Eigen::MatrixXd at;  // scenes x components
};

/// Of the scenes that have the first one's motions; `least`: standard deviation of ln f from which
/// a component counts.
Components components_of(const std::vector<Logs>& logs, double least) {
  Components out;
  std::vector<Eigen::Index> sizes;
  for (const auto& motion : logs[0]) sizes.push_back(motion.size());
  for (std::size_t i = 0; i < logs.size(); ++i) {
    if (logs[i].empty() || logs[i].size() != sizes.size()) continue;
    out.scenes.push_back(i);
    for (std::size_t k = 0; k < sizes.size(); ++k) {
      sizes[k] = std::min(sizes[k], logs[i][k].size());
    }
  }
  const auto rows = static_cast<Eigen::Index>(out.scenes.size());
  Eigen::MatrixXd all(rows, std::accumulate(sizes.begin(), sizes.end(), Eigen::Index{0}));
  for (Eigen::Index row = 0; row < rows; ++row) {
    Eigen::Index column = 0;
    for (std::size_t k = 0; k < sizes.size(); ++k) {
      all.row(row).segment(column, sizes[k]) =
          logs[out.scenes[std::size_t(row)]][k].head(sizes[k]).transpose();
      column += sizes[k];
    }
  }
  all.rowwise() -= all.colwise().mean().eval();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(
      all.transpose() * all / double(std::max<Eigen::Index>(rows, 1)));
  const Eigen::Index most = std::min<Eigen::Index>(kMostComponents, all.cols());
  Eigen::Index count = std::min<Eigen::Index>(1, most);
  while (count < most && eigen.eigenvalues()[all.cols() - 1 - count] > least * least) {
    ++count;
  }
  out.at = all * eigen.eigenvectors().rightCols(count).rowwise().reverse();
  for (Eigen::Index k = 0; k < count; ++k) {
    const double largest = out.at.col(k).cwiseAbs().maxCoeff();
    if (largest > 0) out.at.col(k) /= largest;
  }
  return out;
}

/// Products of powers up to `degree` of the first `components`, 1 first.
Eigen::VectorXd monomials(const Eigen::VectorXd& x, int components, int degree) {
  std::vector<double> out{1};
  std::size_t begin = 0;
  std::vector<int> highest{0};  // component of each product's last factor
  for (int d = 1; d <= degree; ++d) {
    const std::size_t end = out.size();
    for (std::size_t i = begin; i < end; ++i) {
      for (int c = highest[i]; c < components; ++c) {
        out.push_back(out[i] * x[c]);
        highest.push_back(c);
      }
    }
    begin = end;
  }
  return Eigen::Map<Eigen::VectorXd>(out.data(), static_cast<Eigen::Index>(out.size()));
}

/// A polynomial in the components of one mode's correction, and how well it predicts what it has
/// not seen.
struct Correction {
  Eigen::VectorXd coefficients;
  int components = 1, degree = 0;
  double error = std::numeric_limits<double>::infinity();

  [[nodiscard]] double at(const Eigen::VectorXd& x) const {
    return coefficients.dot(monomials(x, components, degree));
  }
};

/// `x`: points x components. The error of leaving one out is the residual over 1 - its leverage.
Correction correction_of(const Eigen::MatrixXd& x, const Eigen::VectorXd& y) {
  Correction best;
  const Eigen::Index points = y.size();
  for (int components = 1; components <= x.cols(); ++components) {
    for (int degree = 0; degree <= 3; ++degree) {
      const Eigen::Index terms = monomials(x.row(0).transpose(), components, degree).size();
      if (terms + 2 > points) break;
      Eigen::MatrixXd powers(points, terms);
      for (Eigen::Index i = 0; i < points; ++i) {
        powers.row(i) = monomials(x.row(i).transpose(), components, degree).transpose();
      }
      const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(powers);
      if (qr.rank() < terms) continue;
      const Eigen::VectorXd coefficients = qr.solve(y);
      const Eigen::MatrixXd q = qr.householderQ() * Eigen::MatrixXd::Identity(points, terms);
      const Eigen::VectorXd room = (1 - q.rowwise().squaredNorm().array()).max(1e-12);
      const double error = ((powers * coefficients - y).array() / room.array()).abs().maxCoeff();
      if (error >= best.error) continue;
      best = {coefficients, components, degree, error};
    }
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
    out_.plane.resize(scenes.size());
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
    start_ = sequence_start(scenes_[0], coarse, accuracy_);
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
      out_.plane[i].push_back(found.modes[k].plane);
    }
  }

  /// Rows of `components_` that lie farthest apart, the outermost first.
  [[nodiscard]] std::vector<Eigen::Index> pilots() const {
    const Eigen::Index rows = components_.at.rows();
    const std::size_t wanted =
        std::clamp(scenes_.size() / kScenesPerPilot, kFewestPilots, kMostPilots);
    if (rows < static_cast<Eigen::Index>(2 * wanted)) return {};
    std::vector<Eigen::Index> out(1);
    Eigen::VectorXd distance = components_.at.rowwise().squaredNorm();
    distance.maxCoeff(&out[0]);
    distance.setConstant(std::numeric_limits<double>::infinity());
    while (out.size() < wanted) {
      const Eigen::RowVectorXd last = components_.at.row(out.back());
      distance = distance.cwiseMin((components_.at.rowwise() - last).rowwise().squaredNorm());
      out.push_back(0);
      distance.maxCoeff(&out.back());
    }
    return out;
  }

  Logs chain_logs(std::size_t i, int factor) const {
    Logs out;
    if (scenes_[i].members.size() != start_.stretches.size()) return out;
    const ChainModes modes = find_chain_modes(scenes_[i], wide_, start_.chain(factor, wide_));
    const auto order = order_by(reference_, modes, start_.samples);
    for (std::size_t k = 0; k < order.size(); ++k) {
      const Eigen::VectorXd log_hz = (modes.motions[k].omega2.array().sqrt() / (2 * M_PI)).log();
      out.emplace_back(log_hz(order[k]));
    }
    return out;
  }

  void set_reference() {
    ChainModes first = find_chain_modes(scenes_[0], wide_, start_.chain(kCommon, wide_));
    first.order.clear();
    for (std::size_t k = 0; k < first.motions.size(); ++k) {
      const MotionModes& motion = first.motions[k];
      reference_.shapes.push_back(sampled_shapes(first, motion, start_.samples));
      reference_.omega2.push_back(motion.omega2);
      for (int mode = 0; mode < int(motion.omega2.size()); ++mode) {
        first.order.push_back({int(k), mode});
      }
    }
    ModesOptions bare = wide_;
    bare.damped = bare.shapes = false;
    const auto described = natural_modes(first, scenes_[0], bare);
    reference_.planes.resize(first.motions.size());
    for (std::size_t i = 0; i < described.size(); ++i) {
      const auto motion = std::size_t(first.order[i].motion);
      reference_.planes[motion].push_back(described[i].plane);
    }
  }

  /// All scenes as the cheapest set of chains that meets the accuracy; false: there is none.
  bool solve(std::vector<bool>& left) {
    set_reference();
    std::vector<Logs> common;
    common.reserve(scenes_.size());
    for (std::size_t i = 0; i < scenes_.size(); ++i) common.push_back(chain_logs(i, kCommon));
    if (common[0].empty()) return false;
    components_ = components_of(common, accuracy_);
    std::vector<std::size_t> chosen;
    for (const Eigen::Index row : pilots()) {
      chosen.push_back(components_.scenes[std::size_t(row)]);
      pilot_at_.conservativeResize(pilot_at_.rows() + 1, components_.at.cols());
      pilot_at_.bottomRows<1>() = components_.at.row(row);
    }
    if (chosen.empty() || !extrapolate_pilots(chosen)) return false;
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
      out_.segments = start_.segments(*std::max_element(set.begin(), set.end()));
      out_.relative_error_estimate = error;
      for (std::size_t row = 0; row < components_.scenes.size(); ++row) {
        const std::size_t i = components_.scenes[row];
        const Logs own = value_of(i, set);
        if (own.size() != corrections.size()) continue;
        left[i] = !take(i, own, corrections, components_.at.row(Eigen::Index(row)).transpose());
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
        Eigen::VectorXd y(static_cast<Eigen::Index>(logs.size()));
        bool all = true;
        for (std::size_t p = 0; p < logs.size() && all; ++p) {
          const Logs& limit = pilots_[p];
          all = motion < logs[p].size() && mode < logs[p][motion].size() && motion < limit.size() &&
                mode < limit[motion].size() && limit[motion][mode] != 0;
          if (!all) break;
          y[static_cast<Eigen::Index>(p)] = limit[motion][mode] - logs[p][motion][mode];
        }
        if (!all) break;
        out[motion].push_back(correction_of(pilot_at_, y));
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
      Logs sorted;
      for (const MotionModes& motion : found.modes.motions) {
        sorted.emplace_back(Eigen::VectorXd::Zero(motion.omega2.size()));
      }
      for (std::size_t k = 0; k < found.modes.order.size(); ++k) {
        const auto& which = found.modes.order[k];
        sorted[static_cast<std::size_t>(which.motion)][which.mode] =
            std::log(found.frequency_hz[k]);
      }
      const auto order = order_by(reference_, found.modes, start_.samples);
      if (order.empty()) return false;
      Logs limit;
      for (std::size_t k = 0; k < order.size(); ++k) limit.emplace_back(sorted[k](order[k]));
      // Those among the first asked for, in any pilot.
      needed_.resize(std::max(needed_.size(), limit.size()), 0);
      const std::size_t asked =
          std::min(found.modes.order.size(), static_cast<std::size_t>(options_.count));
      for (std::size_t k = 0; k < asked; ++k) {
        const auto& which = found.modes.order[k];
        const auto motion = static_cast<std::size_t>(which.motion);
        const auto place = std::find(order[motion].begin(), order[motion].end(), which.mode);
        if (place == order[motion].end()) return false;
        needed_[motion] =
            std::max(needed_[motion], static_cast<int>(place - order[motion].begin()) + 1);
      }
      pilot_error_ = std::max(pilot_error_, found.relative_error);
      pilots_.push_back(std::move(limit));
    }
    return true;
  }

  /// The corrected frequencies of one scene; false: a mode among the first has no correction.
  bool take(std::size_t i, const Logs& logs,
            const std::vector<std::vector<Correction>>& corrections, const Eigen::VectorXd& at) {
    struct Found {
      double hz;
      bool corrected;
      ModePlane plane;
    };
    std::vector<Found> hz;
    for (std::size_t motion = 0; motion < logs.size(); ++motion) {
      const auto& own = corrections[motion];
      for (Eigen::Index mode = 0; mode < logs[motion].size(); ++mode) {
        const auto k = static_cast<std::size_t>(mode);
        const bool corrected = k < own.size();
        const double log_hz = logs[motion][mode];
        hz.push_back({std::exp(log_hz + (corrected ? own[k].at(at) : 0.0)), corrected,
                      reference_.planes[motion][k]});
      }
    }
    std::sort(hz.begin(), hz.end(),
              [](const Found& one, const Found& other) { return one.hz < other.hz; });
    const auto count = static_cast<std::size_t>(options_.count);
    if (hz.size() < count) return false;
    for (std::size_t k = 0; k < count; ++k) {
      if (!hz[k].corrected) return false;
    }
    for (std::size_t k = 0; k < count; ++k) {
      out_.frequency_hz(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(k)) = hz[k].hz;
      out_.plane[i].push_back(hz[k].plane);
    }
    out_.solved[i] = true;
    return true;
  }

  std::span<const Scene> scenes_;
  ModesOptions options_, wide_;
  double accuracy_;
  SequenceStart start_;
  Reference reference_;
  Components components_;     // of the common chain's ln f
  Eigen::MatrixXd pilot_at_;  // pilots x components
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
