#include "signal/modes/mode_search.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <functional>
#include <limits>
#include <utility>

#include "signal/numerics/numbers.h"

namespace rigfit::signal {
namespace {

using Complex = std::complex<double>;
using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::VectorXcd;
using Eigen::VectorXd;

struct Candidate {
  Complex pole;  ///< window removed
  double presence = 0;
  std::ptrdiff_t cluster = -1;  ///< cluster in the whole band's diagram; -1: found later
};

class ModeSearch {
 public:
  ModeSearch(const ModalBand& of, const ModalOptions& with, FrfNoise noise)
      : band_of_(of), options_of_(with), noise_(std::move(noise)) {
    const double frfs = static_cast<double>(of.lines.H.cols());
    penalty_ = (2 * frfs + 2) * std::log(2 * static_cast<double>(of.frequency_hz.size()) * frfs);
  }

  /// `first`: the clusters are the diagram's, whose fate is told.
  void add(const std::vector<PoleCluster>& clusters, bool first = false) {
    for (const PoleCluster& cluster : clusters) {
      const auto index = first ? static_cast<std::ptrdiff_t>(&cluster - clusters.data()) : -1;
      candidates_.push_back({cluster.pole_rad_s + band().window, cluster.presence, index});
    }
    std::sort(candidates_.begin(), candidates_.end(),
              [](const auto& a, const auto& b) { return a.pole.imag() < b.pole.imag(); });
  }

  /// Refines, weighs anew by what the fit leaves, and drops what does not stand out, until all do.
  /// Candidates that are no modes never settle down, so poles are refined to the end only
  /// afterwards.
  void settle() {
    ModalRefineOptions rough = options().refine;
    rough.max_iterations = std::min(rough.max_iterations, 6);
    bool settled = false;
    for (;;) {
      const ModalRefineOptions& refine_options = settled ? options().refine : rough;
      refine(refine_options);
      if (exhausted()) return;
      if (fit_.end == RefineEnd::rank_deficient && drop_one_of_the_nearest()) continue;
      model_ = fitted_frfs(band().lines, fit_);
      update_noise();
      if (settled) {
        refine(refine_options);
        if (exhausted()) return;
        if (fit_.end == RefineEnd::rank_deficient && drop_one_of_the_nearest()) continue;
        model_ = fitted_frfs(band().lines, fit_);
      }
      covariance_ = modal_significance(band().lines, noise_, fit_, model_);
      if (!covariance_.full_rank) {
        if (drop_one_of_the_nearest()) continue;
        return;
      }
      if (drop_implausible() || drop_weak()) continue;
      if (settled) return;
      settled = true;
    }
  }

  const MatrixXcd& model() const { return model_; }
  void update_noise() {
    noise_ = noise_from_residuals(model_, band().lines.H - model_, fit_.leverage,
                                  band().lines.inputs, band().correlation_lines);
    noise_.lead = band().lead;
  }
  /// The model without modes that leave more of the FRFs around them than they explain: such a pole
  /// stands between two modes.
  MatrixXcd without_wrong_modes() const {
    std::vector<Index> right;
    for (Index r = 0; r < fit_.poles.size(); ++r) {
      const auto [low, count] = lines_around(r);
      const auto left = band().lines.H.middleRows(low, count) - model_.middleRows(low, count);
      if (count > 0 &&
          left.squaredNorm() < 0.25 * band().lines.H.middleRows(low, count).squaredNorm()) {
        right.push_back(r);
      }
    }
    if (static_cast<Index>(right.size()) == fit_.poles.size()) return model();
    ModalRefineResult part = fit_;
    part.poles = fit_.poles(right);
    part.residues = fit_.residues(right, Eigen::all);
    return fitted_frfs(band().lines, part);
  }
  /// Misfit under a given noise, with the price of the modes: comparable between searches.
  double cost_with(const FrfNoise& noise) const {
    const MatrixXcd& H = band().lines.H;
    double sum = 0, count = 0;
    for (Index c = 0; c < H.cols(); ++c) {
      if (!std::isfinite(noise.column[c])) continue;
      const auto left = H.col(c) - model_.col(c);
      sum += (left.array().abs2() / noise.line.array()).sum() / noise.column[c];
      count += 2 * static_cast<double>(H.rows());
    }
    return count * std::log(std::max(sum, 1e-300)) + penalty_ * static_cast<double>(size());
  }
  std::size_t size() const { return candidates_.size(); }
  const std::vector<Candidate>& candidates() const { return candidates_; }
  const std::vector<DroppedCluster>& dropped() const { return dropped_; }
  const ModalRefineResult& fit() const { return fit_; }
  const ModalCovariance& covariance() const { return covariance_; }
  const FrfNoise& noise() const { return noise_; }
  double penalty() const { return penalty_; }
  int iterations() const { return iterations_; }
  /// The work of a search that is compared with this one.
  void charge(const ModeSearch& other) { work_ = other.work_; }
  bool exhausted() const { return work_ > options().max_work; }

 private:
  const ModalBand& band() const { return band_of_; }
  const ModalOptions& options() const { return options_of_; }

  void refine(ModalRefineOptions refine_options) {
    VectorXcd start(static_cast<Index>(candidates_.size()));
    for (std::size_t r = 0; r < candidates_.size(); ++r) {
      start[static_cast<Index>(r)] = candidates_[r].pole;
    }
    // Gram matrices and products with the FRFs of each step, and as much for noise and covariance.
    const double columns = 2 * static_cast<double>(candidates_.size()) + 4 +
                           2 * static_cast<double>(band().lines.background.cols());
    const double step = 4 * static_cast<double>(band().frequency_hz.size()) * columns *
                        (columns + static_cast<double>(band().lines.H.cols()));
    // What goes beyond the work allowed is given up: no step after the one that does.
    const double affordable = std::max(0.0, (options().max_work - work_) / step - 3);
    if (affordable < refine_options.max_iterations) {
      refine_options.max_iterations = static_cast<int>(affordable) + 1;
    }
    fit_ = refine_modes(band().lines, noise_, start, refine_options);
    iterations_ += fit_.iterations;
    work_ += (fit_.iterations + 3.0) * step;
    for (std::size_t r = 0; r < candidates_.size(); ++r) {
      candidates_[r].pole = fit_.poles[static_cast<Index>(r)];
    }
  }

  bool drop_one_of_the_nearest() {
    if (candidates_.size() < 2) return false;
    std::size_t worst = 0;
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t a = 0; a < candidates_.size(); ++a) {
      for (std::size_t b = a + 1; b < candidates_.size(); ++b) {
        const double apart = distance(a, b);
        if (apart < least) {
          least = apart;
          worst = candidates_[a].presence < candidates_[b].presence ? a : b;
        }
      }
    }
    note(candidates_[worst], "twin", [] {
      return std::string("the lines of the band cannot tell it from the mode beside it");
    });
    candidates_.erase(candidates_.begin() + static_cast<std::ptrdiff_t>(worst));
    return true;
  }

  template <class Reason>
  void note(const Candidate& candidate, const char* code, Reason reason) {
    if (candidate.cluster < 0) return;
    dropped_.push_back({static_cast<std::size_t>(candidate.cluster), code, reason()});
  }

  /// Lines within half a bandwidth of a mode, at least one line spacing: first and how many.
  std::pair<Index, Index> lines_around(Index r) const {
    const VectorXd& f = band().frequency_hz;
    const Complex raw = fit_.poles[r] - band().window;
    const double centre = raw.imag() / kTwoPi;
    const double half = std::max(-raw.real() / kTwoPi, band().spacing_hz);
    const auto low = std::lower_bound(f.begin(), f.end(), centre - half);
    const auto high = std::upper_bound(low, f.end(), centre + half);
    return {low - f.begin(), high - low};
  }

  /// Peak of a mode over the rms FRF around it.
  double prominence(Index r) const {
    const Complex raw = fit_.poles[r] - band().window;
    const auto [low, count] = lines_around(r);
    const double around = band().lines.H.middleRows(low, count).squaredNorm();
    if (count == 0 || around == 0) return 0;
    const double peak = fit_.residues.row(r).norm() / std::abs(raw.real()) *
                        std::pow(std::abs(raw), band().lines.power);
    return peak / std::sqrt(around / static_cast<double>(count));
  }

  /// All that left the band, became a background or are no larger than what no model explains.
  bool drop_implausible() {
    const VectorXd& f = band().frequency_hz;
    std::vector<Candidate> kept;
    for (std::size_t i = 0; i < candidates_.size(); ++i) {
      const auto r = static_cast<Index>(i);
      const Complex raw = fit_.poles[r] - band().window;
      const double damped = raw.imag() / kTwoPi, ratio = -raw.real() / std::abs(raw);
      const double most = options().lscf.max_damping_ratio, least = options().min_prominence;
      if (!(damped > f[0] && damped < f[f.size() - 1])) {
        note(candidates_[i], "band", [&] {
          return fmt::format(
              "the FRFs do not hold it there: fitted, it wanders to {:.4g} Hz, out of the band",
              damped);
        });
      } else if (!(ratio <= most)) {
        note(candidates_[i], "damping", [&] {
          return fmt::format(
              "fitted, it is damped by {:.0f} %, more than {:.0f} %: a background, "
              "not a resonance",
              100 * ratio, 100 * most);
        });
      } else if (const double peak = prominence(r); !(peak >= least)) {
        note(candidates_[i], "prominence", [&] {
          return fmt::format(
              "its peak is {:.1g} of the response around it, less than {:.1g}: too "
              "small for any sensor or model",
              peak, least);
        });
      } else {
        kept.push_back(candidates_[i]);
      }
    }
    if (kept.size() == candidates_.size()) return false;
    candidates_ = std::move(kept);
    return true;
  }

  /// Distance of two candidates in their bandwidths.
  double distance(std::size_t a, std::size_t b) const {
    return std::abs(candidates_[a].pole - candidates_[b].pole) /
           (std::abs(candidates_[a].pole.real() - band().window) +
            std::abs(candidates_[b].pole.real() - band().window));
  }

  /// The weakest first; of candidates whose resonances overlap only one at a time, since two that
  /// share one mode both look dispensable.
  bool drop_weak() {
    std::vector<std::size_t> weak;
    for (std::size_t r = 0; r < candidates_.size(); ++r) {
      if (covariance_.significance[static_cast<Index>(r)] < penalty_) weak.push_back(r);
    }
    std::sort(weak.begin(), weak.end(), [&](std::size_t a, std::size_t b) {
      return covariance_.significance[static_cast<Index>(a)] <
             covariance_.significance[static_cast<Index>(b)];
    });
    std::vector<std::size_t> drop;
    for (const std::size_t r : weak) {
      if (std::none_of(drop.begin(), drop.end(),
                       [&](std::size_t other) { return distance(r, other) < 3; })) {
        drop.push_back(r);
      }
    }
    std::sort(drop.rbegin(), drop.rend());
    for (const std::size_t r : drop) {
      note(candidates_[r], "significance", [&] {
        return fmt::format("its residues stand out of the noise by {:.2g} of what a mode must",
                           std::sqrt(covariance_.significance[static_cast<Index>(r)] / penalty_));
      });
      candidates_.erase(candidates_.begin() + static_cast<std::ptrdiff_t>(r));
    }
    return !drop.empty();
  }

  std::reference_wrapper<const ModalBand> band_of_;
  std::reference_wrapper<const ModalOptions> options_of_;
  FrfNoise noise_;
  double penalty_ = 0;
  std::vector<Candidate> candidates_;
  std::vector<DroppedCluster> dropped_;
  ModalRefineResult fit_;
  MatrixXcd model_;  ///< of `fit_`, once settled
  ModalCovariance covariance_;
  int iterations_ = 0;
  double work_ = 0;
};

}  // namespace

LscfResult stabilise(const ModalBand& band, const MatrixXcd& all, const FrfNoise& noise,
                     const LscfOptions& options, Index first, Index count) {
  const Index inputs = band.lines.inputs, responses = all.cols() / inputs;
  const auto H = all.middleRows(first, count);
  const auto frequency_hz = band.frequency_hz.segment(first, count);
  const VectorXd line = noise.line.segment(first, count).cwiseSqrt().cwiseInverse();
  const VectorXd column = noise.column.cwiseSqrt().cwiseInverse();
  if (inputs <= responses) {
    return lscf(frequency_hz, H, inputs, line, column / column.maxCoeff(), options);
  }
  MatrixXcd turned(H.rows(), H.cols());
  VectorXd turned_column(H.cols());
  for (Index o = 0; o < responses; ++o) {
    for (Index i = 0; i < inputs; ++i) {
      turned.col(i * responses + o) = H.col(o * inputs + i);
      turned_column[i * responses + o] = column[o * inputs + i];
    }
  }
  return lscf(frequency_hz, turned, responses, line, turned_column / turned_column.maxCoeff(),
              options);
}

std::vector<PoleCluster> search_parts(const ModalBand& band, const MatrixXcd& left,
                                      const FrfNoise& noise, const ModalOptions& options,
                                      Index parts) {
  const Index lines = band.frequency_hz.size();
  // An order of a quarter of the lines leaves each polynomial well determined.
  const Index width = std::min(lines, std::max<Index>(lines / parts, 32));
  LscfOptions lscf_options = options.lscf;
  lscf_options.max_order = static_cast<int>(std::min<Index>(options.lscf.max_order / 2, width / 4));
  std::vector<PoleCluster> found;
  const Index steps = std::max<Index>(0, (2 * (lines - width) + width - 1) / width);
  for (Index i = 0; i <= steps; ++i) {
    const Index first = std::min(i * width / 2, lines - width);
    const LscfResult diagram = stabilise(band, left, noise, lscf_options, first, width);
    for (const PoleCluster& cluster : cluster_poles(diagram, band.spacing_hz, options.clusters)) {
      // The outer eighths belong to the neighbours; the ends of the band have none.
      const double f = cluster.pole_rad_s.imag() / kTwoPi;
      const double margin = static_cast<double>(width) / 8 * band.spacing_hz;
      if ((first > 0 && f < band.frequency_hz[first] + margin) ||
          (first + width < lines && f > band.frequency_hz[first + width - 1] - margin)) {
        continue;
      }
      const auto twin = std::find_if(found.begin(), found.end(), [&](const PoleCluster& other) {
        return std::abs(other.pole_rad_s - cluster.pole_rad_s) <
               options.clusters.radius *
                   (std::abs(other.pole_rad_s.real()) + std::abs(cluster.pole_rad_s.real()));
      });
      if (twin == found.end()) {
        found.push_back(cluster);
      } else if (cluster.scatter < twin->scatter) {
        *twin = cluster;
      }
    }
  }
  return found;
}

FoundModes search_modes(const ModalBand& band, const std::vector<PoleCluster>& clusters,
                        const FrfNoise& first, const ModalOptions& options) {
  ModeSearch search(band, options, first);
  search.add(clusters, true);
  search.settle();
  Index parts = 1;
  for (int pass = 0;
       pass < options.searches && !search.exhausted() && search.fit().residues.cols() > 0; ++pass) {
    parts *= 4;
    // Weighted by the noise as it was before the fit: lines of a missing mode look noisy
    // afterwards.
    const auto more =
        search_parts(band, band.lines.H - search.without_wrong_modes(), first, options, parts);
    if (more.empty()) continue;
    ModeSearch wider = search;
    wider.add(more);
    wider.settle();
    search.charge(wider);
    if (search.exhausted()) break;
    if (wider.cost_with(first) < search.cost_with(first)) search = std::move(wider);
  }
  FoundModes found;
  found.exhausted = search.exhausted();
  found.fit = search.fit();
  if (found.exhausted) return found;
  found.covariance = search.covariance();
  for (const Candidate& candidate : search.candidates())
    found.presence.push_back(candidate.presence);
  found.dropped = search.dropped();
  found.noise = search.noise();
  if (found.fit.residues.cols() > 0) found.model = search.model();
  found.penalty = search.penalty();
  found.iterations = search.iterations();
  return found;
}

}  // namespace rigfit::signal
