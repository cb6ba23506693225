#include "signal/modes/mode_search.h"

namespace rigfit::signal {
namespace {

struct Candidate {
  Complex pole;  ///< window removed
  double presence = 0;
};

class ModeSearch {
 public:
  ModeSearch(const ModalBand& band, const ModalOptions& options, const FrfNoise& noise)
      : band_(band), options_(options) {
    found.noise = noise;
    const double frfs = static_cast<double>(band.lines.H.cols());
    found.penalty =
        (2 * frfs + 2) * std::log(2 * static_cast<double>(band.frequency_hz.size()) * frfs);
  }

  void add(const std::vector<PoleCluster>& clusters) {
    for (const PoleCluster& cluster : clusters) {
      candidates.push_back({cluster.pole_rad_s + band_.window, cluster.presence});
    }
    std::ranges::sort(candidates, {}, [](const Candidate& c) { return c.pole.imag(); });
  }

  /// Refines, weighs anew by what the fit leaves, and drops what does not stand out, until all do.
  /// Candidates that are no modes never settle down, so poles are refined to the end only
  /// afterwards.
  void settle() {
    ModalRefineOptions rough = options_.refine;
    rough.max_iterations = std::min(rough.max_iterations, 6);
    for (bool settled = false;;) {
      const ModalRefineOptions& refine_options = settled ? options_.refine : rough;
      bool determined = refine(refine_options);
      if (determined) update_noise();
      if (determined && settled) determined = refine(refine_options);
      if (exhausted()) return;
      if (determined) {
        found.covariance = modal_covariance(band_.lines, found.noise, found.fit, true);
      }
      found.covariance.full_rank = determined && found.covariance.full_rank;
      if (!found.covariance.full_rank) return;
      if (drop_implausible() || drop_weak()) continue;
      if (settled) return;
      settled = true;
    }
  }

  /// Misfit under a given noise, with the price of the modes: comparable between searches.
  double cost_with(const FrfNoise& noise) const {
    const MatrixXcd& H = band_.lines.H;
    double sum = 0, count = 0;
    for (Index c = 0; c < H.cols(); ++c) {
      if (!std::isfinite(noise.column[c])) continue;
      const auto left = H.col(c) - found.model.col(c);
      sum += (left.array().abs2() / noise.line.array()).sum() / noise.column[c];
      count += 2 * static_cast<double>(H.rows());
    }
    return count * std::log(std::max(sum, 1e-300)) +
           found.penalty * static_cast<double>(candidates.size());
  }
  bool exhausted() const { return work > options_.max_work; }

  std::vector<Candidate> candidates;
  FoundModes found;
  double work = 0;

 private:
  /// Whether the lines determine the poles within the work allowed.
  bool refine(ModalRefineOptions refine_options) {
    VectorXcd start(static_cast<Index>(candidates.size()));
    for (std::size_t r = 0; r < candidates.size(); ++r) {
      start[static_cast<Index>(r)] = candidates[r].pole;
    }
    // Gram matrices and products with the FRFs of each step, and as much for noise and covariance.
    const double columns = 2 * static_cast<double>(candidates.size()) + 4 +
                           2 * static_cast<double>(band_.lines.background.cols());
    const double step = 4 * static_cast<double>(band_.frequency_hz.size()) * columns *
                        (columns + static_cast<double>(band_.lines.H.cols()));
    // What goes beyond the work allowed is given up: no step after the one that does.
    const double affordable = std::max(0.0, (options_.max_work - work) / step - 3);
    if (affordable < refine_options.max_iterations) {
      refine_options.max_iterations = static_cast<int>(affordable) + 1;
    }
    found.fit = refine_modes(band_.lines, found.noise, start, refine_options);
    found.iterations += found.fit.iterations;
    work += (found.fit.iterations + 3.0) * step;
    for (std::size_t r = 0; r < candidates.size(); ++r) {
      candidates[r].pole = found.fit.poles[static_cast<Index>(r)];
    }
    if (exhausted() || found.fit.end == StepsEnd::rank_deficient) return false;
    found.model = fitted_frfs(band_.lines, found.fit);
    return true;
  }

  void update_noise() {
    found.noise = noise_from_residuals(found.model, band_.lines.H - found.model, found.fit.leverage,
                                       band_.lines.inputs, band_.correlation_lines);
    found.noise.lead = band_.lead;
  }

  /// All that left the band, became a background or are no larger than what no model explains.
  bool drop_implausible() {
    const VectorXd& f = band_.frequency_hz;
    std::vector<Candidate> kept;
    for (std::size_t i = 0; i < candidates.size(); ++i) {
      const Complex pole = found.fit.poles[static_cast<Index>(i)], raw = pole - band_.window;
      const double damped = raw.imag() / kTwoPi, ratio = -raw.real() / std::abs(raw);
      const double residues = found.fit.residues.row(static_cast<Index>(i)).norm();
      if (damped > f[0] && damped < f[f.size() - 1] && ratio <= options_.lscf.max_damping_ratio &&
          prominence(band_, pole, residues, 0) >= options_.min_prominence) {
        kept.push_back(candidates[i]);
      }
    }
    if (kept.size() == candidates.size()) return false;
    candidates = std::move(kept);
    return true;
  }

  /// Distance of two candidates in their bandwidths.
  double distance(std::size_t a, std::size_t b) const {
    return apart(candidates[a].pole, candidates[b].pole, band_.window);
  }

  /// The weakest first; of candidates whose resonances overlap only one at a time, since two that
  /// share one mode both look dispensable.
  bool drop_weak() {
    const auto significance = [&](std::size_t r) {
      return found.covariance.significance[static_cast<Index>(r)];
    };
    std::vector<std::size_t> weak, drop;
    for (std::size_t r = 0; r < candidates.size(); ++r) {
      if (significance(r) < found.penalty) weak.push_back(r);
    }
    std::ranges::sort(weak, {}, significance);
    for (const std::size_t r : weak) {
      if (std::ranges::none_of(drop, [&](std::size_t q) { return distance(r, q) < 3; })) {
        drop.push_back(r);
      }
    }
    std::ranges::sort(drop, std::greater());
    for (const std::size_t r : drop)
      candidates.erase(candidates.begin() + static_cast<std::ptrdiff_t>(r));
    return !drop.empty();
  }

  const ModalBand& band_;
  const ModalOptions& options_;
};

}  // namespace

LscfResult stabilise(const ModalBand& band, const MatrixXcd& all, const FrfNoise& noise,
                     const LscfOptions& options, Index first, Index count) {
  const Index inputs = band.lines.inputs, responses = all.cols() / inputs;
  const VectorXd line = noise.line.segment(first, count).cwiseSqrt().cwiseInverse();
  const VectorXd column = noise.column.cwiseSqrt().cwiseInverse();
  std::vector<Index> order(static_cast<std::size_t>(all.cols()));  // responses by references
  for (Index c = 0; c < all.cols(); ++c) {
    order[static_cast<std::size_t>(c)] =
        inputs <= responses ? c : c % responses * inputs + c / responses;
  }
  return lscf(band.frequency_hz.segment(first, count),
              all.middleRows(first, count)(Eigen::all, order), std::min(inputs, responses), line,
              column(order) / column.maxCoeff(), options);
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
      const auto twin = std::ranges::find_if(found, [&](const PoleCluster& other) {
        return apart(other.pole_rad_s, cluster.pole_rad_s) < options.clusters.radius;
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
  search.add(clusters);
  search.settle();
  Index parts = 1;
  for (int pass = 0;
       pass < options.searches && !search.exhausted() && search.found.covariance.full_rank;
       ++pass) {
    parts *= 4;
    // Weighted by the noise as it was before the fit: lines of a missing mode look noisy
    // afterwards.
    const auto more = search_parts(band, band.lines.H - search.found.model, first, options, parts);
    if (more.empty()) continue;
    ModeSearch wider = search;
    wider.add(more);
    wider.settle();
    search.work = wider.work;
    if (search.exhausted()) break;
    if (wider.found.covariance.full_rank && wider.cost_with(first) < search.cost_with(first)) {
      search.candidates = std::move(wider.candidates), search.found = std::move(wider.found);
    }
  }
  search.found.exhausted = search.exhausted();
  if (search.found.fit.residues.cols() == 0) search.found.model.resize(0, 0);
  for (const Candidate& candidate : search.candidates) {
    search.found.presence.push_back(candidate.presence);
  }
  return std::move(search.found);
}

}  // namespace rigfit::signal
