#include "signal/modal/band_background.h"

#include <iterator>

#include "signal/numerics/factorisations.h"

namespace rigfit::signal {
namespace {

/// Share of a column outside of those before, from which it counts.
constexpr double kPart = 1e-3;

/// Orthonormal columns s^(power - 2), s^power and, with `middle`, s^(power - 1).
MatrixXcd powers_of_s(const VectorXcd& s, int power, bool middle) {
  MatrixXcd columns(s.size(), middle ? 3 : 2);
  columns.col(0) = s.array().pow(power - 2);
  columns.col(1) = s.array().pow(power);
  if (middle) columns.col(2) = s.array().pow(power - 1);
  columns.colwise().normalize();
  return thin_qr(columns).Q;
}

/// What exp(-i w t), `first` <= t <= `last`, span outside of `known`.
MatrixXcd terms_between(const VectorXcd& s, const MatrixXcd& known, double first, double last) {
  const Index lines = s.size();
  if (!(last > first)) return MatrixXcd(lines, 0);
  const double low = s[0].imag(), high = s[lines - 1].imag();
  const double product = (last - first) * (high - low) / (kTwoPi);
  if (4 * (product + 4) > static_cast<double>(lines)) return MatrixXcd(lines, 0);
  // Delays closer than half of what the band resolves, so that any in between is spanned as well.
  const Index delays = 2 * static_cast<Index>(std::ceil(product)) + 9;
  MatrixXcd columns(lines, delays);
  for (Index j = 0; j < delays; ++j) {
    const double part = static_cast<double>(j) / static_cast<double>(delays - 1);
    const double t = first + (last - first) * part;
    columns.col(j) = (Complex(0, -t) * s.imag().array()).exp();
  }
  const double size = std::sqrt(static_cast<double>(lines * delays));
  columns -= (known * (known.adjoint() * columns)).eval();
  // Singular vectors above kPart by the Gram matrix: orthonormal to 1e-16 / kPart^2.
  const HermitianEigen gram = hermitian_eigen(columns.adjoint() * columns);
  const ArrayXd squares = gram.values;
  const Index terms = (squares > kPart * kPart * size * size).count();
  return columns * gram.vectors.rightCols(terms) *
         gram.values.tail(terms).cwiseSqrt().cwiseInverse().asDiagonal();
}

/// Poles beside the band are looked for this far beyond its end and as far back into it, in band
/// widths.
constexpr double kBeside = 0.25;
constexpr Index kLinesBeside = 16;

/// Modes of the lines from `low_hz` to `high_hz`.
VectorXcd poles_between(const FrfSet& frfs, double low_hz, double high_hz,
                        const ModalOptions& options) {
  std::vector<Note> none;
  ModalBand part = select_band(frfs, low_hz, high_hz, none);
  part.lines.background =
      smooth_background(part.lines.s, part.lines.power, frfs.force_noise_span_s);
  const FrfNoise noise = first_noise(part);
  if (!noise.column.cwiseInverse().any()) return {};
  ModalOptions once = options;
  once.searches = 1;
  const LscfResult diagram =
      stabilise(part, part.lines.H, noise, options.lscf, 0, part.frequency_hz.size());
  const FoundModes found = search_modes(part, cluster_poles(diagram, part.spacing_hz), noise, once);
  if (found.exhausted || !found.covariance.full_rank) return {};
  return found.fit.poles;
}

/// The residual terms and, outside of them, the orthonormal columns `more`.
MatrixXcd with_residuals(const FrfLines& lines, const MatrixXcd& more) {
  MatrixXcd columns(lines.s.size(), 2 + more.cols());
  columns << powers_of_s(lines.s, lines.power, false), more;
  return columns;
}

/// The part of `column` outside of the orthonormal `columns`, over its size; added where it counts.
void add_column(VectorXcd column, MatrixXcd& columns) {
  column.normalize();
  for (int twice = 0; twice < 2; ++twice) column -= columns * (columns.adjoint() * column).eval();
  const double part = column.norm();
  if (part < kPart) return;
  columns.conservativeResize(Eigen::NoChange, columns.cols() + 1);
  columns.rightCols(1) = column / part;
}

/// As in signal/impact: less does not show beside noise.
constexpr double kLeft = 1e-3, kTone = 0.9;
/// What depends on the place of the hit is smaller by its part of the record.
constexpr double kLeftWhereHitMatters = 1e-2;
/// Longest share of a record before the hit: analysers are set to some percent.
constexpr double kLongestLead = 0.125;
/// Iterations of a search, as counted by its work.
constexpr double kIterations = 40;
/// Standard deviations of noise that a misfit exceeds: for the functions of an unknown place, and
/// for the one in s, which costs little where it is not needed.
constexpr double kSure = 4, kLikely = 2;

/// Background terms, at most 60, with which so many iterations stay within `max_work`.
double affordable_terms(const ModalBand& band, Index poles, double max_work) {
  const auto frfs = static_cast<double>(band.lines.H.cols());
  const double product =
      max_work / (4 * kIterations * static_cast<double>(band.frequency_hz.size()));
  // x (x + FRFs) = product, x columns.
  const double columns = std::sqrt(product + 0.25 * frfs * frfs) - 0.5 * frfs;
  return std::clamp(0.5 * columns - static_cast<double>(poles) - 2, 0.0, 60.0);
}

}  // namespace

MatrixXcd smooth_background(const Ref<const VectorXcd>& s, int power, double span_s) {
  return terms_between(s, powers_of_s(s, power, false), -span_s, span_s);
}

MatrixXcd cut_off_background(const Ref<const VectorXcd>& s, int power, double before_s,
                             double after_s) {
  const MatrixXcd known = powers_of_s(s, power, true);
  const MatrixXcd smooth = terms_between(s, known, -before_s, after_s);
  MatrixXcd terms(s.size(), 1 + smooth.cols());
  terms.col(0) = known.col(2);
  terms.rightCols(smooth.cols()) = smooth;
  return terms;
}

VectorXcd poles_beside(const FrfSet& frfs, const ModalBand& band, const ModalOptions& options) {
  const ArrayXd f = frfs.frequency_hz.array();
  const double low = band.frequency_hz[0], high = band.frequency_hz[band.frequency_hz.size() - 1];
  const double reach = kBeside * (high - low), first = std::max(0.0, low - reach);
  std::vector<Complex> poles;
  for (const bool above : {false, true}) {
    const double from = above ? high : first, to = above ? high + reach : low;
    if ((f > 0 && f > from && f < to).count() < kLinesBeside) continue;
    const VectorXcd found = above ? poles_between(frfs, high - reach, to, options)
                                  : poles_between(frfs, from, low + reach, options);
    std::ranges::copy_if(found, std::back_inserter(poles), [&](Complex pole) {
      return pole.imag() > kTwoPi * from && pole.imag() < kTwoPi * to;
    });
  }
  return Map<const VectorXcd>(poles.data(), static_cast<Index>(poles.size()));
}

void set_background(const Ref<const MatrixXcd>& background, ModalBand& band) {
  FrfLines& lines = band.lines;
  const VectorXcd scale = lines.s.array().pow(lines.power);
  MatrixXcd columns = with_residuals(lines, background);
  for (const int next : {-4, 2, -6, 4})
    add_column(lines.s.array().pow(lines.power + next), columns);
  for (const Complex pole : band.beside) {
    add_column(scale.array() / (lines.s.array() - pole), columns);
    add_column(scale.array() / (lines.s.array() - std::conj(pole)), columns);
  }
  lines.background = columns.rightCols(columns.cols() - 2);
}

double left_at_the_end(const ModalBand& band, Complex raw) {
  return std::exp(raw.real() / band.spacing_hz);
}

bool misfit_shows(const Ref<const MatrixXcd>& background, const Ref<const MatrixXcd>& misfit,
                  const Ref<const VectorXd>& line, double deviations) {
  const double mean = background.rowwise().squaredNorm().dot(line);  // for noise of variance `line`
  double found = 0, frfs = 0;
  for (const auto& column : misfit.colwise()) {
    const double variance = (column.cwiseAbs2().array() / line.array()).mean();
    if (!(variance > 0)) continue;
    found += (background.adjoint() * column).squaredNorm() / variance;
    ++frfs;
  }
  return found >
         mean * (frfs + deviations * std::sqrt(frfs / static_cast<double>(background.cols())));
}

bool allow_for_cut_off(const FrfSet& frfs, const Ref<const VectorXcd>& poles,
                       const Ref<const MatrixXcd>& misfit, const FrfNoise& noise, double max_work,
                       ModalBand& band) {
  double most = 0;
  for (const Complex pole : poles) {
    // Two poles on one line are no tones: together they imitate a mode that is cut off.
    const bool alone = ((poles.array() - pole).abs() < kTwoPi * band.spacing_hz).count() == 1;
    const double left = left_at_the_end(band, pole - band.window);
    if (left < kTone || !alone) most = std::max(most, left);
  }
  if (!(most > kLeft)) return false;
  const double width = band.frequency_hz[band.frequency_hz.size() - 1] - band.frequency_hz[0];
  const double terms = affordable_terms(band, poles.size(), max_work);
  const double lead = frfs.pre_trigger_s, span = frfs.force_noise_span_s;
  const bool by_pole = lead * width > terms;
  const double before = by_pole    ? 0
                        : lead > 0 ? lead
                        : most < kLeftWhereHitMatters
                            ? 0
                            : std::min(kLongestLead / band.spacing_hz, terms / width);
  MatrixXcd background =
      cut_off_background(band.lines.s, band.lines.power, std::max(before, span), span);
  if (by_pole) {
    MatrixXcd columns = with_residuals(band.lines, background);
    for (const Complex pole : poles) {
      const double left = left_at_the_end(band, pole - band.window);
      if (left < kLeft || left > kTone) continue;
      for (const Complex p : {pole, std::conj(pole)}) {
        const ArrayXcd s = band.lines.s.array();
        const ArrayXcd turned = ((s - band.window) * lead).exp();
        add_column((turned - std::exp((p - band.window) * lead)) / (s - p), columns);
      }
    }
    background = columns.rightCols(columns.cols() - 2);
  }
  if (!(span > 0) && misfit.size() > 0 && !misfit_shows(background, misfit, noise.line, kSure)) {
    background = cut_off_background(band.lines.s, band.lines.power, 0, 0);
    if (!misfit_shows(background, misfit, noise.line, kLikely)) return false;
  }
  set_background(background, band);
  return true;
}

}  // namespace rigfit::signal
