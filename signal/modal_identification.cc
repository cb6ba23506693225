#include "signal/modal_identification.h"

#include <fmt/format.h>

#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <utility>

#include "signal/mac.h"
#include "signal/modal_basis.h"
#include "signal/modal_synthesis.h"
#include "signal/residues.h"

namespace rigfit::signal {
namespace {

using Complex = std::complex<double>;
using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Eigen::VectorXcd;
using Eigen::VectorXd;
constexpr double two_pi = 2 * std::numbers::pi;

struct Band {
  VectorXd frequency_hz;
  MatrixXd H_std;  ///< empty: not known or not usable
  FrfLines lines;
  double spacing_hz = 0;
  double window = 0;  ///< decay rate, 1/s
  double correlation_lines = 0;
};

Band select_band(const FrfSet& frfs, const ModalOptions& options, std::vector<Note>& notes) {
  const Index inputs = static_cast<Index>(frfs.inputs.size());
  const Index columns = static_cast<Index>(frfs.responses.size()) * inputs;
  if (columns == 0 || frfs.H.cols() != columns || frfs.H.rows() != frfs.frequency_hz.size()) {
    throw std::invalid_argument("identify_modes: no FRFs, or sizes that do not fit");
  }
  const double high = options.high_hz > 0 ? options.high_hz : frfs.frequency_hz.maxCoeff();
  std::vector<Index> rows;
  Index unusable = 0;
  for (Index k = 0; k < frfs.frequency_hz.size(); ++k) {
    const double f = frfs.frequency_hz[k];
    if (!(f > 0) || f < options.low_hz || f > high) continue;
    if (!rows.empty() && !(f > frfs.frequency_hz[rows.back()])) {
      throw std::invalid_argument("identify_modes: frequencies do not rise");
    }
    if (frfs.H.row(k).allFinite()) {
      rows.push_back(k);
    } else {
      ++unusable;
    }
  }
  if (unusable > 0) {
    notes.push_back({"lines_left_out",
                     fmt::format("{} lines with values that are not finite are left out", unusable),
                     ""});
  }
  if (rows.size() < 8) {
    throw std::invalid_argument(fmt::format(
        "identify_modes: {} usable lines in the band, at least 8 are needed", rows.size()));
  }
  Band band;
  const auto count = static_cast<Index>(rows.size());
  band.frequency_hz.resize(count);
  band.lines.H.resize(count, columns);
  band.H_std.resize(frfs.H_std.size() ? count : 0, frfs.H_std.size() ? columns : 0);
  for (Index i = 0; i < count; ++i) {
    const Index k = rows[static_cast<std::size_t>(i)];
    band.frequency_hz[i] = frfs.frequency_hz[k];
    band.lines.H.row(i) = frfs.H.row(k);
    if (band.H_std.size()) band.H_std.row(i) = frfs.H_std.row(k);
  }
  // A line without an error bar among others that have one cannot be weighed against them.
  if (band.H_std.size() && !(band.H_std.allFinite() && band.H_std.maxCoeff() > 0)) {
    band.H_std.resize(0, 0);
    notes.push_back({"error_bars_unusable",
                     "some error bars of the FRFs are missing: the noise is estimated from the fit",
                     ""});
  }
  band.window = frfs.exponential_decay_rate_1_s;
  VectorXd steps = band.frequency_hz.tail(count - 1) - band.frequency_hz.head(count - 1);
  std::nth_element(steps.begin(), steps.begin() + (count - 1) / 2, steps.end());
  band.spacing_hz = steps[(count - 1) / 2];
  band.correlation_lines = band.window / band.spacing_hz;
  band.lines.s = laplace_lines(band.frequency_hz, band.window);
  band.lines.power = power_of_s(frfs.form);
  band.lines.inputs = inputs;
  return band;
}

/// Poles of what `H` holds in `count` lines from `first` on, window not removed. The fewer of
/// responses and inputs serve as references.
LscfResult stabilise(const Band& band, const MatrixXcd& all, const FrfNoise& noise,
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

/// Clusters of what is left, from overlapping parts of the band, `parts` and a half of them wide.
std::vector<PoleCluster> search_parts(const Band& band, const MatrixXcd& left,
                                      const FrfNoise& noise, const ModalOptions& options,
                                      Index parts) {
  const Index lines = band.frequency_hz.size();
  // An order of a quarter of the lines leaves each polynomial well determined.
  const Index width = std::max<Index>(lines / parts, 32);
  LscfOptions lscf_options = options.lscf;
  lscf_options.max_order = static_cast<int>(std::min<Index>(options.lscf.max_order / 2, width / 4));
  std::vector<PoleCluster> found;
  const Index steps = std::max<Index>(0, (2 * (lines - width) + width - 1) / width);
  for (Index i = 0; i <= steps; ++i) {
    const Index first = std::min(i * width / 2, lines - width);
    const LscfResult diagram = stabilise(band, left, noise, lscf_options, first, width);
    for (const PoleCluster& cluster : cluster_poles(diagram, band.spacing_hz, options.clusters)) {
      // The outer eighths belong to the neighbours; the ends of the band have none.
      const double f = cluster.pole_rad_s.imag() / two_pi;
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

struct Candidate {
  Complex pole;  ///< window removed
  double presence = 0;
};

class ModeSearch {
 public:
  ModeSearch(const Band& of, const ModalOptions& with, FrfNoise noise)
      : band_of_(of), options_of_(with), noise_(std::move(noise)) {
    const double frfs = static_cast<double>(of.lines.H.cols());
    penalty_ = (2 * frfs + 2) * std::log(2 * static_cast<double>(of.frequency_hz.size()) * frfs);
  }

  void add(const std::vector<PoleCluster>& clusters) {
    for (const PoleCluster& cluster : clusters) {
      candidates_.push_back({cluster.pole_rad_s + band().window, cluster.presence});
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
      if (fit_.end == RefineEnd::rank_deficient && drop_one_of_the_nearest()) continue;
      update_noise();
      if (settled) {
        refine(refine_options);
        if (fit_.end == RefineEnd::rank_deficient && drop_one_of_the_nearest()) continue;
      }
      covariance_ = modal_covariance(band().lines, noise_, fit_);
      if (!covariance_.full_rank) {
        if (drop_one_of_the_nearest()) continue;
        return;
      }
      if (drop_implausible() || drop_weak()) continue;
      if (settled) return;
      settled = true;
    }
  }

  MatrixXcd model() const {
    return synthesise(band().lines.s, band().lines.power, fit_.poles, fit_.residues, fit_.lower,
                      fit_.upper);
  }
  void update_noise() {
    const MatrixXcd m = model();
    noise_ = noise_from_residuals(m, band().lines.H - m, fit_.leverage, band().lines.inputs,
                                  band().correlation_lines);
  }
  /// The model without modes that leave more of the FRFs around them than they explain: such a pole
  /// stands between two modes.
  MatrixXcd without_wrong_modes() const {
    const MatrixXcd left = band().lines.H - model();
    std::vector<Index> right;
    for (Index r = 0; r < fit_.poles.size(); ++r) {
      const auto [low, count] = lines_around(r);
      if (count > 0 && left.middleRows(low, count).squaredNorm() <
                           0.25 * band().lines.H.middleRows(low, count).squaredNorm()) {
        right.push_back(r);
      }
    }
    if (static_cast<Index>(right.size()) == fit_.poles.size()) return model();
    VectorXcd poles(static_cast<Index>(right.size()));
    MatrixXcd residues(poles.size(), fit_.residues.cols());
    for (Index i = 0; i < poles.size(); ++i) {
      poles[i] = fit_.poles[right[static_cast<std::size_t>(i)]];
      residues.row(i) = fit_.residues.row(right[static_cast<std::size_t>(i)]);
    }
    return synthesise(band().lines.s, band().lines.power, poles, residues, fit_.lower, fit_.upper);
  }
  /// Misfit under a given noise, with the price of the modes: comparable between searches.
  double cost_with(const FrfNoise& noise) const {
    const MatrixXcd left = band().lines.H - model();
    double sum = 0, count = 0;
    for (Index c = 0; c < left.cols(); ++c) {
      if (!std::isfinite(noise.column[c])) continue;
      sum += (left.col(c).array().abs2() / noise.line.array()).sum() / noise.column[c];
      count += 2 * static_cast<double>(left.rows());
    }
    return count * std::log(std::max(sum, 1e-300)) + penalty_ * static_cast<double>(size());
  }
  std::size_t size() const { return candidates_.size(); }
  const std::vector<Candidate>& candidates() const { return candidates_; }
  const ModalRefineResult& fit() const { return fit_; }
  const ModalCovariance& covariance() const { return covariance_; }
  const FrfNoise& noise() const { return noise_; }
  double penalty() const { return penalty_; }
  int iterations() const { return iterations_; }

 private:
  const Band& band() const { return band_of_; }
  const ModalOptions& options() const { return options_of_; }

  void refine(const ModalRefineOptions& refine_options) {
    VectorXcd start(static_cast<Index>(candidates_.size()));
    for (std::size_t r = 0; r < candidates_.size(); ++r) {
      start[static_cast<Index>(r)] = candidates_[r].pole;
    }
    fit_ = refine_modes(band().lines, noise_, start, refine_options);
    iterations_ += fit_.iterations;
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
    candidates_.erase(candidates_.begin() + static_cast<std::ptrdiff_t>(worst));
    return true;
  }

  /// Lines within half a bandwidth of a mode, at least one line spacing: first and how many.
  std::pair<Index, Index> lines_around(Index r) const {
    const VectorXd& f = band().frequency_hz;
    const Complex raw = fit_.poles[r] - band().window;
    const double centre = raw.imag() / two_pi;
    const double half = std::max(-raw.real() / two_pi, band().spacing_hz);
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
    std::vector<Candidate> kept;
    for (std::size_t i = 0; i < candidates_.size(); ++i) {
      const auto r = static_cast<Index>(i);
      const Complex raw = fit_.poles[r] - band().window;
      const double damped = raw.imag() / two_pi;
      if (damped > band().frequency_hz[0] &&
          damped < band().frequency_hz[band().frequency_hz.size() - 1] &&
          -raw.real() <= options().lscf.max_damping_ratio * std::abs(raw) &&
          prominence(r) >= options().min_prominence) {
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
      candidates_.erase(candidates_.begin() + static_cast<std::ptrdiff_t>(r));
    }
    return !drop.empty();
  }

  std::reference_wrapper<const Band> band_of_;
  std::reference_wrapper<const ModalOptions> options_of_;
  FrfNoise noise_;
  double penalty_ = 0;
  std::vector<Candidate> candidates_;
  ModalRefineResult fit_;
  ModalCovariance covariance_;
  int iterations_ = 0;
};

/// Frequency and damping ratio of a pole, and their derivatives with respect to its two parts.
void fill_frequency_and_damping(Complex pole, IdentifiedMode& mode, Eigen::Matrix2d& jacobian) {
  const double x = pole.real(), y = pole.imag(), w = std::abs(pole);
  mode.frequency_hz.value = w / two_pi;
  mode.damping_ratio.value = -x / w;
  jacobian << x / (w * two_pi), y / (w * two_pi), -y * y / (w * w * w), x * y / (w * w * w);
}

void fill_shape(const ModalRefineResult& fit, const ModalCovariance& covariance, Index r,
                Index inputs, IdentifiedMode& mode) {
  const Index responses = fit.residues.cols() / inputs;
  MatrixXcd residue(responses, inputs);
  for (Index c = 0; c < fit.residues.cols(); ++c) {
    residue(c / inputs, c % inputs) = fit.residues(r, c);
  }
  Index strongest = 0;
  if (inputs == 1) {
    mode.shape = residue.col(0);
    mode.participation = VectorXcd::Ones(1);
  } else {
    // The nearest matrix of rank one, with the strongest input's participation made 1.
    const Eigen::JacobiSVD<MatrixXcd> svd(residue, Eigen::ComputeThinU | Eigen::ComputeThinV);
    const VectorXcd v = svd.matrixV().col(0).conjugate();
    v.cwiseAbs().maxCoeff(&strongest);
    mode.participation = v / v[strongest];
    mode.shape = svd.matrixU().col(0) * (svd.singularValues()[0] * v[strongest]);
  }
  mode.shape_std.resize(responses, 2);
  for (Index o = 0; o < responses; ++o) {
    mode.shape_std(o, 0) = covariance.residue_std_re(r, o * inputs + strongest);
    mode.shape_std(o, 1) = covariance.residue_std_im(r, o * inputs + strongest);
  }
  mode.modal_phase_collinearity = modal_phase_collinearity(mode.shape);
}

/// Correlation of the weighted misfit at neighbouring lines, less what the noise model expects;
/// noted when it is beyond chance and large enough to matter for the error bars.
void check_misfit(ModalResult& result, const Band& band, const MatrixXcd& misfit) {
  const Index pairs = misfit.rows() - 1;
  Complex product = 0;
  double power = 0, frfs = 0;
  for (Index c = 0; c < misfit.cols(); ++c) {
    if (!std::isfinite(result.noise.column[c])) continue;
    const VectorXcd r = misfit.col(c).cwiseQuotient(result.noise.line.cwiseSqrt().cast<Complex>()) /
                        std::sqrt(result.noise.column[c]);
    product += r.head(pairs).dot(r.tail(pairs));
    power += 0.5 * (r.head(pairs).squaredNorm() + r.tail(pairs).squaredNorm());
    ++frfs;
  }
  if (!(power > 0)) return;
  const double window = band.correlation_lines;
  const double expected = window > 0 ? (1.0 / Complex(1, std::numbers::pi / window)).real() : 0;
  result.misfit_line_correlation = product.real() / power - expected;
  const double chance = 5 / std::sqrt(2 * frfs * static_cast<double>(pairs));
  if (std::abs(result.misfit_line_correlation) > std::max(chance, 0.2)) {
    result.model.notes.push_back(
        {"systematic_misfit",
         fmt::format(
             "the misfit is not like noise: neighbouring lines correlate by {:.2f} more than "
             "noise does. Something is left out (non-linearity, change between hits, modes "
             "outside the band); error bars of the modes are too small then",
             result.misfit_line_correlation),
         ""});
  }
}

/// Why a person should not rely on a mode, each reason with its figure.
void judge(ModalResult& result, const Band& band) {
  ModalModel& model = result.model;
  for (std::size_t r = 0; r < model.modes.size(); ++r) {
    IdentifiedMode& mode = model.modes[r];
    std::vector<std::string> doubts;
    const double decay = -mode.pole_rad_s.real(), measured = decay + band.window;
    if (mode.damping_dominated_by_window) {
      doubts.push_back(fmt::format(
          "the window gives {:.0f} % of the measured decay rate: damping refused, frequency kept",
          100 * band.window / measured));
    } else if (!(mode.damping_ratio.std < 0.25 * std::abs(mode.damping_ratio.value))) {
      doubts.push_back(fmt::format(
          "damping known to {:.0f} % only",
          100 * mode.damping_ratio.std / std::max(std::abs(mode.damping_ratio.value), 1e-300)));
    }
    // 5 % of variance: residues less than some 4 times what the test of presence asks for.
    if (mode.significance < 4) {
      doubts.push_back(
          fmt::format("weak: {:.1f} times the least that is told from noise", mode.significance));
    }
    const double f = mode.frequency_hz.value, half = measured / two_pi;
    if (f - half < result.low_hz || f + half > result.high_hz) {
      doubts.push_back("its resonance is cut by the end of the band");
    }
    if (mode.presence < 0.6) {
      doubts.push_back(
          fmt::format("present in {:.0f} % of the model orders only", 100 * mode.presence));
    }
    if (mode.shape.size() >= 3) {
      // Noise of the residues alone lowers the collinearity by about its share of the power.
      const double share = mode.shape_std.squaredNorm() / mode.shape.squaredNorm();
      if (mode.modal_phase_collinearity < 0.8 - 2 * share) {
        doubts.push_back(
            fmt::format("complex shape: phase collinearity {:.2f}", mode.modal_phase_collinearity));
      }
      for (const std::size_t other : {r - 1, r + 1}) {  // r - 1 wraps below 0 and is left out
        if (other >= model.modes.size()) continue;
        const double likeness = result.auto_mac(static_cast<Index>(r), static_cast<Index>(other));
        const double apart = std::abs(mode.pole_rad_s - model.modes[other].pole_rad_s) /
                             (measured + band.window - model.modes[other].pole_rad_s.real());
        if (likeness > 0.9 && apart < 2) {
          doubts.push_back(fmt::format(
              "same shape as the mode at {:.4g} Hz (MAC {:.2f}), resonances overlap: "
              "one mode that changed between hits, or a non-linear one, looks like this",
              model.modes[other].frequency_hz.value, likeness));
        }
      }
    }
    mode.doubtful = !doubts.empty();
    mode.doubt = fmt::format("{}", fmt::join(doubts, "; "));
    // Records that end before the mode has decayed scale its residue by 1 - exp(-decay * length),
    // whose phase the record does not tell; poles stay right.
    const double left = std::exp(-measured / band.spacing_hz);
    if (left > 0.01) {
      model.notes.push_back({"decay_cut_off",
                             fmt::format("{:.1f} % of the amplitude are left at the end of the "
                                         "records: residues are uncertain by that, poles are not",
                                         100 * left),
                             fmt::format("{:.4g} Hz", f)});
    }
  }
}

void export_modes(const FrfSet& frfs, const Band& band, const ModeSearch& search,
                  ModalResult& result) {
  const ModalRefineResult& fit = search.fit();
  const ModalCovariance& covariance = search.covariance();
  const Index inputs = band.lines.inputs;
  const auto responses = static_cast<Index>(frfs.responses.size());
  ModalModel& model = result.model;
  model.lower_residual.resize(responses, inputs);
  model.upper_residual.resize(responses, inputs);
  for (Index c = 0; c < fit.lower.size(); ++c) {
    model.lower_residual(c / inputs, c % inputs) = fit.lower[c];
    model.upper_residual(c / inputs, c % inputs) = fit.upper[c];
  }
  std::vector<Index> order(search.size());
  for (std::size_t r = 0; r < order.size(); ++r) order[r] = static_cast<Index>(r);
  std::sort(order.begin(), order.end(),
            [&](Index a, Index b) { return std::abs(fit.poles[a]) < std::abs(fit.poles[b]); });
  const auto size = static_cast<Index>(2 * order.size());
  MatrixXd jacobian = MatrixXd::Zero(size, size);
  for (std::size_t i = 0; i < order.size(); ++i) {
    const Index r = order[i], row = static_cast<Index>(2 * i);
    IdentifiedMode mode;
    mode.pole_rad_s = fit.poles[r];
    const Complex raw = fit.poles[r] - band.window;
    mode.damping_ratio_with_window = -raw.real() / std::abs(raw);
    mode.damping_dominated_by_window = band.window > -0.5 * raw.real();
    Eigen::Matrix2d local;
    fill_frequency_and_damping(mode.pole_rad_s, mode, local);
    jacobian.block<2, 2>(row, 2 * r) = local;
    fill_shape(fit, covariance, r, inputs, mode);
    mode.presence = search.candidates()[static_cast<std::size_t>(r)].presence;
    mode.significance = std::sqrt(covariance.significance[r] / search.penalty());
    model.modes.push_back(std::move(mode));
  }
  model.pole_covariance = jacobian * covariance.poles * jacobian.transpose();
  MatrixXcd shapes(responses, static_cast<Index>(order.size()));
  for (std::size_t i = 0; i < order.size(); ++i) {
    const auto row = static_cast<Index>(2 * i);
    model.modes[i].frequency_hz.std = std::sqrt(model.pole_covariance(row, row));
    model.modes[i].damping_ratio.std = std::sqrt(model.pole_covariance(row + 1, row + 1));
    shapes.col(static_cast<Index>(i)) = model.modes[i].shape;
  }
  result.auto_mac = auto_mac(shapes);
}

}  // namespace

ModalResult identify_modes(const FrfSet& frfs, const ModalOptions& options) {
  ModalResult result;
  ModalModel& model = result.model;
  model.responses = frfs.responses;
  model.inputs = frfs.inputs;
  model.fitted_form = frfs.form;
  model.exponential_decay_rate_1_s = frfs.exponential_decay_rate_1_s;
  const Band band = select_band(frfs, options, model.notes);
  const MatrixXcd& H = band.lines.H;
  const Index inputs = band.lines.inputs;
  result.lines_used = band.frequency_hz.size();
  result.low_hz = band.frequency_hz[0];
  result.high_hz = band.frequency_hz[result.lines_used - 1];
  if (frfs.form == FrfForm::unknown) {
    model.notes.push_back({"form_unknown",
                           "the FRFs do not say whether they are receptances, mobilities or "
                           "accelerances: the units of shapes and residuals are not known",
                           ""});
  }
  for (Index c = 0; c < H.cols(); ++c) {
    if (H.col(c).isZero(0)) {
      model.notes.push_back({"dead_frf", "this FRF is zero throughout and was left out",
                             frfs.responses[static_cast<std::size_t>(c / inputs)].name});
    }
  }
  const bool has_error_bars = band.H_std.size() > 0;
  const FrfNoise first = has_error_bars
                             ? noise_from_std(H, band.H_std, inputs, band.correlation_lines)
                             : noise_unknown(H, inputs, band.correlation_lines);
  if (!first.column.cwiseInverse().any()) {
    model.notes.push_back({"no_modes", "all FRFs are zero", ""});
    result.noise = first;
    model.pole_covariance.resize(0, 0);
    return result;
  }

  result.stabilisation = stabilise(band, H, first, options.lscf, 0, result.lines_used);
  result.clusters = cluster_poles(result.stabilisation, band.spacing_hz, options.clusters);
  ModeSearch search(band, options, first);
  search.add(result.clusters);
  search.settle();
  Index parts = 1;
  for (int pass = 0; pass < options.searches && search.fit().residues.cols() > 0; ++pass) {
    parts *= 4;
    // Weighted by the noise as it was before the fit: lines of a missing mode look noisy
    // afterwards.
    const auto more = search_parts(band, H - search.without_wrong_modes(), first, options, parts);
    if (more.empty()) continue;
    ModeSearch wider = search;
    wider.add(more);
    wider.settle();
    if (wider.cost_with(first) < search.cost_with(first)) search = std::move(wider);
  }

  result.end = search.fit().end;
  result.iterations = search.iterations();
  result.noise = search.noise();
  if (search.fit().residues.cols() == 0 || !search.covariance().full_rank) {
    result.end = RefineEnd::rank_deficient;
    model.lower_residual.setZero(static_cast<Index>(frfs.responses.size()), inputs);
    model.upper_residual = model.lower_residual;
    model.notes.push_back(
        {"rank_deficient", "the lines of the band do not determine any mode", ""});
    return result;
  }
  export_modes(frfs, band, search, result);
  if (model.modes.empty()) {
    model.notes.push_back(
        {"no_modes", "nothing in the band stands out of the noise as a resonance", ""});
  }
  measure_errors(model, frfs, result.low_hz, result.high_hz);
  if (has_error_bars) {
    const MatrixXcd m = search.model();
    double sum = 0;
    Index count = 0;
    for (Index c = 0; c < H.cols(); ++c) {
      if (!std::isfinite(first.column[c])) continue;
      sum += ((H.col(c) - m.col(c)).array().abs2() /
              (2 * first.line.array() *
               (first.column[c] + first.common[c % inputs] * m.col(c).array().abs2())))
                 .sum();
      count += H.rows();
    }
    result.misfit_over_error_bars = std::sqrt(sum / static_cast<double>(count));
  }
  check_misfit(result, band, H - search.model());
  judge(result, band);
  return result;
}

}  // namespace rigfit::signal
