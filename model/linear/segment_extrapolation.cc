#include "model/linear/segment_extrapolation.h"

#include <numeric>

namespace rigfit::model {
namespace {

constexpr std::array<int, 15> kSequence{2, 3, 4, 6, 8, 12, 16, 24, 32, 48, 64, 96, 128, 192, 256};
constexpr std::size_t kSmallest = 2, kLargest = 4;  // windows: chains that a value is of
constexpr int kForShapes = 16;       // the finest chain's factor where its shapes are asked for
constexpr double kRounding = 1e-11;  // relative, of eigenvalues

/// Displacements of a motion's modes at `samples` evenly spaced places of each member, columns of
/// unit length (zero where nothing but twist moves).
MatrixXd sampled_shapes(const ChainModes& modes, const MotionModes& motion,
                        const std::vector<int>& samples) {
  const Chain& chain = *modes.chain;
  const auto& numbering = motion.assembly->numbering();
  MatrixXd out = MatrixXd::Zero(3 * std::accumulate(samples.begin(), samples.end(), Index{0}),
                                motion.omega2.size());
  Index row = 0;
  for (std::size_t m = 0; m < chain.members.size(); ++m) {
    const ChainMember& member = chain.members[m];
    std::size_t i = 0;
    for (int k = 0; k < samples[m]; ++k) {
      const double place = (k + 0.5) / samples[m];
      while (member.places[i + 1] < place) ++i;
      const double f = (place - member.places[i]) / (member.places[i + 1] - member.places[i]);
      for (int axis = 0; axis < 3; ++axis, ++row) {
        const int a = numbering.displacement(axis, member.nodes[i]);
        const int b = numbering.displacement(axis, member.nodes[i + 1]);
        if (a >= 0) out.row(row) += (1 - f) * motion.shapes.row(a);
        if (b >= 0) out.row(row) += f * motion.shapes.row(b);
      }
    }
  }
  for (Index k = 0; k < out.cols(); ++k) {
    const double size = out.col(k).norm();
    if (size > 0) out.col(k) /= size;
  }
  return out;
}

/// The mode of `after` that each of `before` is, columns as of `sampled_shapes`: by shape, then by
/// order and frequency (squares in (rad/s)^2); -1: none.
std::vector<int> following_modes(const MatrixXd& before, const MatrixXd& after,
                                 const VectorXd& omega2_before, const VectorXd& omega2_after) {
  MatrixXd overlap = (before.transpose() * after).cwiseAbs2();
  std::vector<int> next(static_cast<std::size_t>(overlap.rows()), -1);
  std::vector<bool> taken(static_cast<std::size_t>(overlap.cols()), false);
  for (Index round = 0; round < std::min(overlap.rows(), overlap.cols()); ++round) {
    Index i = 0, j = 0;
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
    const double ratio = omega2_after[static_cast<Index>(j)] / omega2_before[static_cast<Index>(i)];
    if (std::abs(ratio - 1) > 0.2) continue;
    next[i] = static_cast<int>(j);
    taken[j] = true;
  }
  return next;
}

/// A mode followed through the chains.
struct Track {
  int motion = 0;
  int mode = 0;  // in the finest chain's motion
  std::vector<double> h, hz;
};

class Extrapolation {
 public:
  Extrapolation(const Scene& scene, const ModesOptions& options, const SequenceStart& start)
      : scene_(scene), options_(options), start_(start) {}

  /// The chain of `factor` times the first numbers; false: no equilibrium.
  bool add(int factor) {
    chain_ = find_chain_modes(scene_, options_, start_.chain(factor, options_));
    if (chain_.equilibrium.status != EquilibriumStatus::converged ||
        (chains_ > 0 && chain_.motions.size() != shapes_.size())) {
      return false;
    }
    ++chains_;
    follow(1.0 / factor);
    return true;
  }

  /// Takes the modes asked for by the window that errs least, and keeps them where they are the
  /// best so far; false: the estimate is above `accuracy` or not certain, or the chains are too
  /// few.
  bool meets(double accuracy) {
    const std::vector<Track*> asked = asked_tracks();
    std::size_t shortest = chains_;
    for (const Track* track : asked) shortest = std::min(shortest, track->hz.size());
    if (shortest < kSmallest + 2) return false;
    std::vector<SequenceLimit> best;
    double least = 0;
    bool sure = false;
    for (std::size_t window = kSmallest; window <= kLargest && window + 2 <= shortest; ++window) {
      std::vector<SequenceLimit> found;
      found.reserve(asked.size());
      double worst = 0;
      bool certain = true;
      for (const Track* track : asked) {
        found.push_back(sequence_limit(track->h, track->hz, window));
        const double error = found.back().error / found.back().value;
        if (error < worst) continue;
        worst = error;
        certain = found.back().certain || error <= kRounding;
      }
      if (!best.empty() && (sure > certain || (sure == certain && worst >= least))) continue;
      best = std::move(found);
      least = worst;
      sure = certain;
    }
    if (sure || !out_.known || least < out_.relative_error) take_over(asked, best, least);
    return sure && least <= accuracy;
  }

  ResolvedModes take() {
    if (!out_.modes.chain) keep();
    return std::move(out_);
  }

 private:
  void take_over(const std::vector<Track*>& asked, const std::vector<SequenceLimit>& found,
                 double error) {
    out_.known = true;
    out_.relative_error = error;
    out_.frequency_hz.clear();
    out_.limit_hz.clear();
    out_.modes.order.clear();
    for (std::size_t i = 0; i < asked.size(); ++i) {
      out_.modes.order.push_back({asked[i]->motion, asked[i]->mode});
      out_.frequency_hz.push_back(found[i].value);
      out_.limit_hz.push_back(found[i].limit);
    }
    keep();
  }

  /// The last chain into the result.
  void keep() {
    if (!chain_.chain) return;
    chain_.order = std::move(out_.modes.order);
    out_.modes = std::move(chain_);
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
      } else if (asked.size() == asked_count()) {
        break;
      }
      asked.push_back(&tracks_[i]);
    }
    return asked;
  }

  [[nodiscard]] std::size_t asked_count() const {
    const bool by_plane = options_.by_plane && shapes_.size() > 1;
    return by_plane ? tracks_.size() : static_cast<std::size_t>(options_.count);
  }

  void follow(double h) {
    std::vector<Track> tracks;
    std::vector<MatrixXd> shapes;
    std::vector<VectorXd> omega2;
    for (std::size_t k = 0; k < chain_.motions.size(); ++k) {
      const MotionModes& motion = chain_.motions[k];
      shapes.push_back(sampled_shapes(chain_, motion, start_.samples));
      omega2.push_back(motion.omega2);
      std::vector<Track> now(static_cast<std::size_t>(motion.omega2.size()));
      if (k < shapes_.size()) {
        const std::vector<int> next = following_modes(shapes_[k], shapes[k], omega2_[k], omega2[k]);
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
        now[i].hz.push_back(std::sqrt(motion.omega2[static_cast<Index>(i)]) / (2 * M_PI));
        tracks.push_back(std::move(now[i]));
      }
    }
    tracks_ = std::move(tracks);
    shapes_ = std::move(shapes);
    omega2_ = std::move(omega2);
  }

  const Scene& scene_;
  const ModesOptions& options_;
  const SequenceStart& start_;
  std::size_t chains_ = 0;
  ChainModes chain_;              // the last one, until it is kept
  std::vector<Track> tracks_;     // tracks in the last chain, motion by motion
  std::vector<MatrixXd> shapes_;  // likewise, at the samples
  std::vector<VectorXd> omega2_;
  ResolvedModes out_;
};

}  // namespace

SequenceLimit sequence_limit(const std::vector<double>& h, const std::vector<double>& f,
                             std::size_t window) {
  const std::size_t last = f.size() - 1;
  const auto of = [&](std::size_t points) { return neville(h, f, last + 1 - points, last); };
  SequenceLimit out;
  out.value = of(window);
  out.limit = of(window + 1);
  const double change = std::abs(out.value - out.limit);
  const double next = std::abs(out.limit - of(window + 2));
  out.certain = change > 0 && 3 * next <= change;
  out.error = change + 2 * next;
  return out;
}

ResolvedModes extrapolate_modes(const Scene& scene, const ModesOptions& options,
                                const SequenceStart& start, double accuracy) {
  Extrapolation extrapolation(scene, options, start);
  std::ptrdiff_t most = 0;  // segments of a member in the first chain
  for (const auto& places : start.chain(1, options).places) {
    most = std::max(most, std::ssize(places) - 1);
  }
  for (std::size_t level = 0; level < kSequence.size(); ++level) {
    if (level > kSmallest + 2 && kSequence[level] * most > kMostSegments) break;
    if (!extrapolation.add(kSequence[level])) break;
    if (!extrapolation.meets(accuracy)) continue;
    if (kSequence[level] >= kForShapes || !(options.shapes || options.damped)) break;
    if (!extrapolation.add(kForShapes) || extrapolation.meets(accuracy)) break;
    while (level + 1 < kSequence.size() && kSequence[level + 1] <= kForShapes) ++level;
  }
  return extrapolation.take();
}

ResolvedModes resolve_modes(const Scene& scene, const ModesOptions& options) {
  constexpr int kCoarse = 12;
  const bool open = std::all_of(scene.members.begin(), scene.members.end(), [&](const Member& m) {
    return options.segments.value_or(m.segments) <= 0;
  });
  const double accuracy = options.accuracy.value_or(scene.accuracy);
  if (open || options.accuracy) {
    const ChainModes coarse =
        find_modes(scene, options, std::vector<int>(scene.members.size(), kCoarse));
    const SequenceStart start =
        coarse.order.empty() ? SequenceStart{} : sequence_start(scene, coarse, accuracy);
    if (start.resolved && !coarse.order.empty()) {
      ResolvedModes limit = extrapolate_modes(scene, options, start, accuracy);
      limit.extrapolated = true;
      if (limit.known && limit.relative_error <= accuracy) return limit;
    }
  }
  return choose_segments(scene, options);
}

}  // namespace rigfit::model
