#include "signal/modes/mode_search.h"

#include "signal/estimation/robust.h"
#include "signal/recording/add_note.h"
#include "signal/refinement/modal_basis.h"

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
    for (bool settled = false;;) {
      PoleStepOptions steps = options_.refine;
      if (!settled) steps.max_iterations = std::min(steps.max_iterations, 6);
      bool determined = refine(steps);
      if (determined) {
        found.noise =
            noise_from_residuals(found.model, band_.lines.H - found.model, found.fit.leverage,
                                 band_.lines.inputs, band_.correlation_lines, band_.lead);
      }
      if (determined && settled) determined = refine(steps);
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
           penalty_ * static_cast<double>(candidates.size());
  }
  bool exhausted() const { return work > options_.max_work; }

  std::vector<Candidate> candidates;
  FoundModes found;
  double work = 0;

 private:
  /// Whether the lines determine the poles within the work allowed.
  bool refine(PoleStepOptions steps) {
    VectorXcd start(std::ssize(candidates));
    std::ranges::transform(candidates, start.begin(), &Candidate::pole);
    // Gram matrices and products with the FRFs of each step, and as much for noise and covariance.
    const double columns = 2 * static_cast<double>(candidates.size()) + 4 +
                           2 * static_cast<double>(band_.lines.background.cols());
    const double step = 4 * static_cast<double>(band_.frequency_hz.size()) * columns *
                        (columns + static_cast<double>(band_.lines.H.cols()));
    // What goes beyond the work allowed is given up: no step after the one that does.
    const double affordable = std::max(0.0, (options_.max_work - work) / step - 3);
    if (affordable < steps.max_iterations) steps.max_iterations = static_cast<int>(affordable) + 1;
    found.fit = refine_modes(band_.lines, found.noise, start, steps);
    found.iterations += found.fit.iterations;
    work += (found.fit.iterations + 3.0) * step;
    for (std::size_t r = 0; r < candidates.size(); ++r) {
      candidates[r].pole = found.fit.poles[static_cast<Index>(r)];
    }
    if (exhausted() || found.fit.end == StepsEnd::rank_deficient) return false;
    found.model = fitted_frfs(band_.lines, found.fit);
    return true;
  }

  Index place_of(const Candidate& one) const { return &one - candidates.data(); }

  /// All that left the band, became a background or are no larger than what no model explains.
  bool drop_implausible() {
    const VectorXd& f = band_.frequency_hz;
    return std::erase_if(candidates, [&](const Candidate& one) {
             const Complex raw = one.pole - band_.window;
             const double damped = raw.imag() / kTwoPi, ratio = -raw.real() / std::abs(raw);
             const double residues = found.fit.residues.row(place_of(one)).norm();
             return !(damped > f[0] && damped < f[f.size() - 1] &&
                      ratio <= options_.lscf.max_damping_ratio &&
                      prominence(band_, one.pole, residues, 0) >= options_.min_prominence);
           }) > 0;
  }

  /// The weakest first; of candidates whose resonances overlap only one at a time, since two that
  /// share one mode both look dispensable.
  bool drop_weak() {
    const auto significance = [&](const Candidate* one) {
      return found.covariance.significance[place_of(*one)];
    };
    std::vector<const Candidate*> weak, drop;
    for (const Candidate& one : candidates) {
      if (significance(&one) < penalty_) weak.push_back(&one);
    }
    std::ranges::sort(weak, {}, significance);
    for (const Candidate* one : weak) {
      if (std::ranges::none_of(drop, [&](const Candidate* other) {
            return apart(one->pole, other->pole, band_.window) < 3;
          })) {
        drop.push_back(one);
      }
    }
    std::erase_if(candidates, [&](const Candidate& one) {
      return std::ranges::find(drop, &one) != drop.end();
    });
    return !drop.empty();
  }

  const ModalBand& band_;
  const ModalOptions& options_;
  double penalty_ = least_significance(band_.lines.H);
};

}  // namespace

ModalBand select_band(const FrfSet& frfs, double low_hz, double high_hz, std::vector<Note>& notes) {
  const Index inputs = static_cast<Index>(frfs.inputs.size());
  const Index columns = static_cast<Index>(frfs.responses.size()) * inputs;
  const auto fits = [&](const auto& H) {
    return H.cols() == columns && H.rows() == frfs.frequency_hz.size();
  };
  if (columns == 0 || !fits(frfs.H) || (frfs.H_std.size() > 0 && !fits(frfs.H_std))) {
    throw std::invalid_argument("identify_modes: no FRFs, or sizes that do not fit");
  }
  const double high = high_hz > 0 ? high_hz : frfs.frequency_hz.maxCoeff();
  std::vector<Index> rows;
  for (Index k = 0; k < frfs.frequency_hz.size(); ++k) {
    const double f = frfs.frequency_hz[k];
    if (!(f > 0) || f < low_hz || f > high) continue;
    if (!rows.empty() && !(f > frfs.frequency_hz[rows.back()])) {
      throw std::invalid_argument("identify_modes: frequencies do not rise");
    }
    rows.push_back(k);
  }
  const auto unusable = std::erase_if(rows, [&](Index k) { return !frfs.H.row(k).allFinite(); });
  if (unusable > 0) {
    add_note(notes, "data_left_out", "", "{} lines with values that are not finite are left out",
             unusable);
  }
  if (rows.size() < 8) {
    throw std::invalid_argument(
        fmt::format("{} usable lines in the band, at least 8 are needed", rows.size()));
  }
  ModalBand band;
  const auto count = static_cast<Index>(rows.size());
  band.frequency_hz = frfs.frequency_hz(rows);
  band.lines.H = frfs.H(rows, Eigen::all);
  if (frfs.H_std.size() > 0) band.H_std = frfs.H_std(rows, Eigen::all);
  // A line without an error bar among others that have one cannot be weighed against them.
  if (band.H_std.size() && !(band.H_std.allFinite() && band.H_std.maxCoeff() > 0)) {
    band.H_std.resize(0, 0);
    add_note(notes, "error_bars_unusable", "",
             "some error bars of the FRFs are missing: the noise is estimated from the fit");
  }
  band.rows = std::move(rows);
  band.window = frfs.exponential_decay_rate_1_s;
  const VectorXd steps = band.frequency_hz.tail(count - 1) - band.frequency_hz.head(count - 1);
  band.spacing_hz = median({steps.begin(), steps.end()});
  band.correlation_lines = band.window / band.spacing_hz;
  band.lead = frfs.pre_trigger_s * band.spacing_hz;
  band.lines.s = laplace_lines(band.frequency_hz, band.window);
  band.lines.power = power_of_s(frfs.form);
  band.lines.inputs = inputs;
  return band;
}

FrfNoise first_noise(const ModalBand& band) {
  const MatrixXcd& H = band.lines.H;
  const Index inputs = band.lines.inputs;
  return band.H_std.size() > 0
             ? noise_from_std(H, band.H_std, inputs, band.correlation_lines, band.lead)
             : noise_unknown(H, inputs, band.correlation_lines, band.lead);
}

double least_significance(const Ref<const MatrixXcd>& H) {
  return (2 * static_cast<double>(H.cols()) + 2) * std::log(2 * static_cast<double>(H.size()));
}

std::pair<Index, Index> lines_around(const ModalBand& band, Complex pole, double least,
                                     double half_bandwidths) {
  const VectorXd& f = band.frequency_hz;
  const double centre = pole.imag() / kTwoPi;
  const double half =
      std::max(half_bandwidths * (band.window - pole.real()) / kTwoPi, least * band.spacing_hz);
  const auto low = std::lower_bound(f.begin(), f.end(), centre - half);
  const auto high = std::upper_bound(low, f.end(), centre + half);
  return {low - f.begin(), high - low};
}

double prominence(const ModalBand& band, Complex pole, double residues, double none) {
  const auto [first, count] = lines_around(band, pole);
  const double power = band.lines.H.middleRows(first, count).squaredNorm();
  if (!(power > 0)) return none;
  const Complex raw = pole - band.window;
  const double peak = residues / std::abs(raw.real()) * std::pow(std::abs(raw), band.lines.power);
  return peak / std::sqrt(power / static_cast<double>(count));
}

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
    for (const PoleCluster& cluster : cluster_poles(diagram, band.spacing_hz)) {
      // The outer eighths belong to the neighbours; the ends of the band have none.
      const double f = cluster.pole_rad_s.imag() / kTwoPi;
      const double margin = static_cast<double>(width) / 8 * band.spacing_hz;
      if ((first > 0 && f < band.frequency_hz[first] + margin) ||
          (first + width < lines && f > band.frequency_hz[first + width - 1] - margin)) {
        continue;
      }
      const auto twin = std::ranges::find_if(found, [&](const PoleCluster& other) {
        return apart(other.pole_rad_s, cluster.pole_rad_s) < kClusterRadius;
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
