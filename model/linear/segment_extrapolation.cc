#include "model/linear/segment_extrapolation.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>

#include "model/linear/segment_choice.h"

namespace rigfit::model {
namespace {

constexpr std::array<int, 16> kSequence{2,  3,  4,  6,  8,   12,  16,  24,
                                        32, 48, 64, 96, 128, 192, 256, 384};
constexpr int kMostSegments = 2000;                 // segments a member
constexpr std::size_t kSmallest = 2, kLargest = 4;  // windows: chains that a value is of
// The first number of segments is twice m: m by the phase of the highest wave (rad), by the layers
// of bending in a member, and at least.
constexpr double kPhaseShare = 0.42, kLayerShare = 0.25, kMostForLayers = 24;
constexpr int kFirstFewest = 3;
constexpr double kAtNode = 1e-6;  // of a segment
constexpr int kFinestPlace = 25;  // masses' positions: multiples of 1 / this
constexpr int kBeside = 2;        // modes followed above those asked for
constexpr double kMargin = 0.02;  // a band's edges are moved out by while modes are followed

/// Neville's value at h = 0 of the points first..last in powers of h^2.
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

/// What is left after the change `last` when errors go with h^p: p from the change before.
double left_over(double before, double last, double ratio_before, double ratio_last) {
  const double size = std::abs(last);
  if (last == 0) return 0;
  const double fall = before / last;
  if (!(fall > 1)) return size;  // no power law: all of it may be missing
  const auto predicted = [&](double p) {
    return std::pow(ratio_last, p) * (std::pow(ratio_before, p) - 1) /
           (std::pow(ratio_last, p) - 1);
  };
  double low = 1, high = 16;
  if (predicted(low) >= fall) return size / (ratio_last - 1);
  for (int i = 0; i < 40; ++i) {
    const double middle = 0.5 * (low + high);
    (predicted(middle) < fall ? low : high) = middle;
  }
  return size / (std::pow(ratio_last, low) - 1);
}

/// Two chains' value; its error is of first order in h, and not smooth: what the last chains, from
/// twice the segments' length on, changed.
SequenceLimit irregular_limit(const std::vector<double>& h, const std::vector<double>& f) {
  const std::size_t last = f.size() - 1;
  const auto value = [&](std::size_t k) { return neville(h, f, k - 1, k); };
  SequenceLimit out;
  out.value = out.limit = value(last);
  for (std::size_t k = last; k > 1 && k + 2 > last; --k) {
    out.error += std::abs(value(k) - value(k - 1));
  }
  if (last < 3) out.error *= 2;
  return out;
}

/// A mode followed through the chains.
struct Track {
  int motion = 0;
  int mode = 0;  // in the finest chain's motion
  std::vector<double> h, hz;
  double value = 0;  // last extrapolated value, Hz; 0: none yet
};

/// Where the chains of a sequence have nodes in common: displacements of a motion's modes there,
/// columns of unit length (zero where nothing but twist moves).
Eigen::MatrixXd common_shapes(const ChainModes& modes, const MotionModes& motion,
                              const std::vector<int>& common) {
  const Chain& chain = *modes.chain;
  const auto& numbering = motion.assembly->numbering();
  std::vector<int> rows;
  for (std::size_t m = 0; m < chain.members.size(); ++m) {
    const ChainMember& member = chain.members[m];
    const int stride = member.segments / common[m];
    for (int i = 0; i <= common[m]; ++i) {
      const int node = member.nodes[static_cast<std::size_t>(i) * static_cast<std::size_t>(stride)];
      for (int axis = 0; axis < 3; ++axis) rows.push_back(numbering.displacement(axis, node));
    }
  }
  Eigen::MatrixXd out =
      Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(rows.size()), motion.omega2.size());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (rows[i] >= 0) out.row(static_cast<Eigen::Index>(i)) = motion.shapes.row(rows[i]);
  }
  for (Eigen::Index k = 0; k < out.cols(); ++k) {
    const double size = out.col(k).norm();
    if (size > 0) out.col(k) /= size;
  }
  return out;
}

/// The new chain's mode of each of the old chain's: by shape, then by order and frequency; -1:
/// none.
std::vector<int> followers(const Eigen::MatrixXd& before, const Eigen::MatrixXd& after,
                           const Eigen::VectorXd& omega2_before,
                           const Eigen::VectorXd& omega2_after) {
  Eigen::MatrixXd overlap = (before.transpose() * after).cwiseAbs2();
  std::vector<int> next(static_cast<std::size_t>(overlap.rows()), -1);
  std::vector<bool> taken(static_cast<std::size_t>(overlap.cols()), false);
  for (Eigen::Index round = 0; round < std::min(overlap.rows(), overlap.cols()); ++round) {
    Eigen::Index i = 0, j = 0;
    if (overlap.maxCoeff(&i, &j) < 0.5) break;
    next[static_cast<std::size_t>(i)] = static_cast<int>(j);
    taken[static_cast<std::size_t>(j)] = true;
    overlap.row(i).setZero();
    overlap.col(j).setZero();
  }
  // Equal frequencies share their shapes in any mixture; twist alone has none here.
  std::size_t j = 0;
  for (std::size_t i = 0; i < next.size(); ++i) {
    if (next[i] >= 0) continue;
    while (j < taken.size() && taken[j]) ++j;
    if (j == taken.size()) break;
    const double ratio =
        omega2_after[static_cast<Eigen::Index>(j)] / omega2_before[static_cast<Eigen::Index>(i)];
    if (std::abs(ratio - 1) > 0.2) continue;
    next[i] = static_cast<int>(j);
    taken[j] = true;
  }
  return next;
}

class Extrapolation {
 public:
  Extrapolation(const Scene& scene, const ModesOptions& options, const SequenceStart& start)
      : scene_(scene),
        options_(options),
        wide_(options),
        first_(start.first),
        regular_(start.regular) {
    if (wide_.band_hz) {
      wide_.band_hz->first *= 1 - kMargin;
      wide_.band_hz->second *= 1 + kMargin;
    } else {
      wide_.count += kBeside;
    }
  }

  /// The chain of `factor` times the first numbers; false: no equilibrium.
  bool add(int factor) {
    segments_ = first_;
    for (int& n : segments_) n *= factor;
    chain_ = find_modes(scene_, wide_, segments_);
    if (chain_.equilibrium.status != EquilibriumStatus::converged ||
        (chains_ > 0 && chain_.motions.size() != shapes_.size())) {
      return false;
    }
    ++chains_;
    follow(1.0 / factor);
    return true;
  }

  /// Takes the modes asked for by the window that errs least, and keeps them where they are the
  /// best so far; false: the estimate is above `accuracy`, or the chains are too few.
  bool meets(double accuracy) {
    std::vector<Track*> asked = asked_tracks();
    std::size_t shortest = chains_;
    for (const Track* track : asked) shortest = std::min(shortest, track->hz.size());
    if (shortest <= kSmallest) return false;
    double error = std::numeric_limits<double>::infinity();
    std::vector<SequenceLimit> best;
    const std::size_t largest = regular_ ? kLargest : kSmallest;
    for (std::size_t window = kSmallest; window <= largest && window < shortest; ++window) {
      std::vector<SequenceLimit> found;
      double worst = 0;
      for (const Track* track : asked) {
        found.push_back(regular_ ? sequence_limit(track->h, track->hz, window)
                                 : irregular_limit(track->h, track->hz));
        worst = std::max(worst, found.back().error / found.back().value);
      }
      if (worst < error) error = worst, best = std::move(found);
    }
    // The values of the chains before, by what this chain says of them.
    double change = 0;
    bool followed = last_error_ >= 0;
    for (std::size_t i = 0; i < asked.size(); ++i) {
      followed = followed && asked[i]->value > 0;
      change = std::max(change, std::abs(asked[i]->value / best[i].value - 1));
    }
    const double judged = regular_ ? change + error : last_error_;
    last_error_ = error;
    if (followed && (!out_.known || judged < out_.relative_error)) {
      keep();
      out_.known = true;
      out_.relative_error = judged;
      for (std::size_t i = 0; i < asked.size(); ++i) {
        out_.modes.order.push_back({asked[i]->motion, asked[i]->mode});
        out_.frequency_hz.push_back(asked[i]->value);
        out_.limit_hz.push_back(best[i].value);
      }
    }
    for (std::size_t i = 0; i < asked.size(); ++i) asked[i]->value = best[i].value;
    return out_.known && out_.relative_error <= accuracy;
  }

  ExtrapolatedModes take() {
    if (out_.segments.empty()) keep();
    return std::move(out_);
  }

 private:
  /// The last chain and its numbers of segments into the result, without modes asked for.
  void keep() {
    out_ = {};
    out_.modes = std::move(chain_);
    out_.modes.order.clear();
    out_.segments = segments_;
  }

  std::vector<Track*> asked_tracks() {
    std::vector<Track*> asked;
    std::vector<double> rough;
    for (const Track& track : tracks_) {
      const std::size_t n = track.hz.size();
      rough.push_back(neville(track.h, track.hz, n - std::min<std::size_t>(n, 3), n - 1));
    }
    std::vector<std::size_t> order(tracks_.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t a, std::size_t b) { return rough[a] < rough[b]; });
    for (const std::size_t i : order) {
      if (options_.band_hz) {
        if (rough[i] < options_.band_hz->first || rough[i] > options_.band_hz->second) continue;
      } else if (asked.size() == static_cast<std::size_t>(options_.count)) {
        break;
      }
      asked.push_back(&tracks_[i]);
    }
    return asked;
  }

  void follow(double h) {
    std::vector<Track> tracks;
    std::vector<Eigen::MatrixXd> shapes;
    std::vector<Eigen::VectorXd> omega2;
    for (std::size_t k = 0; k < chain_.motions.size(); ++k) {
      const MotionModes& motion = chain_.motions[k];
      shapes.push_back(common_shapes(chain_, motion, first_));
      omega2.push_back(motion.omega2);
      std::vector<Track> now(static_cast<std::size_t>(motion.omega2.size()));
      if (k < shapes_.size()) {
        const std::vector<int> next = followers(shapes_[k], shapes[k], omega2_[k], omega2[k]);
        for (const Track& track : tracks_) {
          if (track.motion != static_cast<int>(k)) continue;
          const int to = next[static_cast<std::size_t>(track.mode)];
          if (to >= 0) now[static_cast<std::size_t>(to)] = track;
        }
      }
      for (std::size_t i = 0; i < now.size(); ++i) {
        now[i].motion = static_cast<int>(k);
        now[i].mode = static_cast<int>(i);
        now[i].h.push_back(h);
        now[i].hz.push_back(std::sqrt(motion.omega2[static_cast<Eigen::Index>(i)]) / (2 * M_PI));
        tracks.push_back(std::move(now[i]));
      }
    }
    tracks_ = std::move(tracks);
    shapes_ = std::move(shapes);
    omega2_ = std::move(omega2);
  }

  const Scene& scene_;
  const ModesOptions& options_;
  ModesOptions wide_;
  std::vector<int> first_, segments_;  // segments: of the last chain
  bool regular_;
  std::size_t chains_ = 0;
  double last_error_ = -1;               // of the last chain's values, relative
  ChainModes chain_;                     // the last one, until it is kept
  std::vector<Track> tracks_;            // of the last chain, motion by motion
  std::vector<Eigen::MatrixXd> shapes_;  // likewise, at the common nodes
  std::vector<Eigen::VectorXd> omega2_;
  ExtrapolatedModes out_;
};

}  // namespace

SequenceLimit sequence_limit(const std::vector<double>& h, const std::vector<double>& f,
                             std::size_t window) {
  const std::size_t last = f.size() - 1;
  const auto of = [&](std::size_t points) { return neville(h, f, last + 1 - points, last); };
  SequenceLimit out;
  out.value = of(window);
  out.limit = of(window + 1);
  out.error = std::abs(out.value - out.limit);
  if (last > window) {
    const double earlier = neville(h, f, last - window, last - 1);
    const double before = earlier - neville(h, f, last - window - 1, last - 2);
    out.error = std::max(out.error, left_over(before, out.value - earlier,
                                              h[last - 2] / h[last - 1], h[last - 1] / h[last]));
  }
  return out;
}

SequenceStart sequence_start(const Scene& scene, const ChainModes& modes) {
  SequenceStart out;
  const Equilibrium rest = describe(*modes.chain, modes.equilibrium, scene);
  const std::vector<double> phases = wave_phases(scene, modes);
  for (std::size_t m = 0; m < scene.members.size(); ++m) {
    const Member& member = scene.members[m];
    const ChainMember& chained = modes.chain->members[m];
    const double tension = rest.members[m].tension_N;
    const double EI = std::max(member.EI[0], member.EI[1]);
    const double length = rest.members[m].unstretched_length_m;
    // Euler's least critical load, pi^2 EI / (2 L)^2: frequencies near it are differences of two
    // stiffnesses that converge each.
    const double critical = std::pow(0.5 * M_PI / length, 2) * std::min(member.EI[0], member.EI[1]);
    out.resolved = out.resolved && -tension <= critical;
    double wanted = kPhaseShare * phases[m];
    const bool bent =
        chained.end_joint[0] >= 0 || chained.end_joint[1] >= 0 || !member.masses.empty();
    if (bent && tension > 0 && EI > 0) {
      const double layers = length * std::sqrt(tension / EI);
      wanted = std::max(wanted, std::min(kLayerShare * layers, kMostForLayers));
      out.resolved = out.resolved && kLayerShare * layers <= kMostForLayers;
    }
    int first = std::max(kFirstFewest, static_cast<int>(std::ceil(wanted)));
    const auto off = [&](int n) {
      double worst = 0;
      for (const AttachedMass& mass : member.masses) {
        worst = std::max(worst, std::abs(mass.position * n - std::round(mass.position * n)));
      }
      return worst;
    };
    for (int n = first; off(first) > kAtNode && n <= std::max(2 * first, kFinestPlace); ++n) {
      if (off(n) <= kAtNode) first = n;
    }
    out.regular = out.regular && off(first) <= kAtNode;
    out.first.push_back(first);
  }
  return out;
}

ExtrapolatedModes extrapolate_modes(const Scene& scene, const ModesOptions& options,
                                    const SequenceStart& start, double accuracy) {
  SequenceStart from = start;
  for (int attempt = 0;; ++attempt) {
    Extrapolation extrapolation(scene, options, from);
    const int most = *std::max_element(from.first.begin(), from.first.end());
    bool stands = true;
    for (std::size_t level = 0; level < kSequence.size() && stands; ++level) {
      if (level > kSmallest + 1 && kSequence[level] * most > kMostSegments) break;
      stands = extrapolation.add(kSequence[level]);
      if (stands && extrapolation.meets(accuracy)) break;
    }
    // What stands only just may have buckled when cut coarsely.
    if (stands || attempt == 2) return extrapolation.take();
    for (int& n : from.first) n *= 4;
  }
}

}  // namespace rigfit::model
