#include "signal/refinement/modal_noise.h"

#include "signal/spectra/fft.h"
#include "signal/spectra/line_means.h"

namespace rigfit::signal {
namespace {

/// Lines averaged for q: 400 squares, so that q scatters by 7 %, and at least 7 lines.
Index half_window(Index lines, Index columns) {
  const Index width = std::max<Index>(7, 200 / std::max<Index>(columns, 1) + 1);
  return std::min(width / 2, (lines - 1) / 2);
}

/// Smallest variance that rounding lets be told from zero, per FRF; infinite for a dead one.
VectorXd floor_of(const Ref<const MatrixXcd>& H) {
  return (H.colwise().squaredNorm().transpose() / static_cast<double>(H.rows()))
      .unaryExpr([](double power) {
        return power > 0 ? 1e-26 * power : std::numeric_limits<double>::infinity();
      });
}

/// What shows the noise of a set of FRFs.
struct Evidence {
  ArrayXXd squares;  ///< lines x FRFs, expected: the variance times `freedom`
  ArrayXXd power;    ///< |H|^2
  ArrayXd freedom;   ///< lines: share that no fit has used up
  VectorXd least;    ///< floor_of() the FRFs
};

/// h_i at each line: lines x inputs.
MatrixXd signal_to_noise(const FrfNoise& noise, const ArrayXXd& power) {
  MatrixXd h = MatrixXd::Zero(power.rows(), noise.inputs());
  for (Index c = 0; c < power.cols(); ++c) {
    if (std::isfinite(noise.column[c]))
      h.col(c % noise.inputs()) += (power.col(c) / noise.column[c]).matrix();
  }
  return h;
}

/// a_c + b_i |H|^2 of FRF c at each line.
ArrayXd variance_of(const FrfNoise& noise, const Evidence& of, Index c) {
  return noise.column[c] + noise.common[c % noise.inputs()] * of.power.col(c);
}

void update_lines(FrfNoise& noise, const Evidence& of) {
  ArrayXd ratio = ArrayXd::Zero(of.squares.rows());
  for (Index c = 0; c < of.squares.cols(); ++c)
    ratio += of.squares.col(c) / variance_of(noise, of, c);
  const Index half = half_window(of.squares.rows(), of.squares.cols());
  noise.line = mean_over_lines(ratio / static_cast<double>(of.squares.cols()), half) /
               mean_over_lines(of.freedom, half).max(1e-300);
  const double mean = noise.line.mean();
  if (!(mean > 0) || !std::isfinite(mean)) {
    noise.line.setOnes();
    return;
  }
  noise.line = (noise.line / mean).cwiseMax(1e-12);
  noise.column *= mean;
  noise.common *= mean;
}

/// a_c: what the common part leaves, each line weighted by its inverse variance.
void update_columns(FrfNoise& noise, const Evidence& of) {
  const ArrayXd q = (noise.line.array() * of.freedom).max(1e-300);
  for (Index c = 0; c < of.squares.cols(); ++c) {
    const double b = noise.common[c % noise.inputs()];
    const ArrayXd weight = of.freedom / variance_of(noise, of, c).square();
    const double total = (weight * (of.squares.col(c) / q - b * of.power.col(c))).sum();
    const double a = total / std::max(weight.sum(), 1e-300);
    // Shared noise may explain all of a line's scatter but never makes the FRF's own negative.
    if (std::isfinite(a)) noise.column[c] = std::max({a, of.least[c], 0.01 * noise.column[c]});
  }
}

/// All parts, where noise common to FRFs shows only in errors that go with |H| from line to line,
/// each FRF by itself: b power + a, by weighted least squares. The line factor comes last: given
/// the choice, it would take a resonance's share for itself.
void update_by_line(FrfNoise& noise, const Evidence& of) {
  for (int round = 0; round < 12; ++round) {
    update_columns(noise, of);
    VectorXd above = VectorXd::Zero(noise.inputs()), below = above;
    for (Index c = 0; c < of.squares.cols(); ++c) {
      if (!std::isfinite(noise.column[c])) continue;
      const ArrayXd power = of.power.col(c);
      const ArrayXd weight = of.freedom * power / variance_of(noise, of, c).square();
      const ArrayXd scaled = of.squares.col(c) / (noise.line.array() * of.freedom);
      above[c % noise.inputs()] += (weight * (scaled - noise.column[c])).sum();
      below[c % noise.inputs()] += (weight * power).sum();
    }
    noise.common = (below.array() > 0).select((above.array() / below.array()).max(0), 0);
    if (round >= 4) update_lines(noise, of);
  }
}

}  // namespace

FrfNoise noise_unknown(const Ref<const MatrixXcd>& H, Index inputs, double correlation_lines,
                       double lead) {
  return {VectorXd::Ones(H.rows()), floor_of(H) * 1e26, VectorXd::Zero(inputs), correlation_lines,
          lead};
}

FrfNoise noise_from_std(const Ref<const MatrixXcd>& H, const Ref<const MatrixXd>& H_std,
                        Index inputs, double correlation_lines, double lead) {
  const Evidence of{H_std.array().square(), H.array().abs2(), ArrayXd::Ones(H.rows()), floor_of(H)};
  FrfNoise noise = noise_unknown(H, inputs, correlation_lines, lead);
  noise.column = of.squares.colwise().mean().transpose().matrix().cwiseMax(of.least);
  update_by_line(noise, of);
  return noise;
}

FrfNoise noise_from_residuals(const Ref<const MatrixXcd>& model,
                              const Ref<const MatrixXcd>& residual,
                              const Ref<const VectorXd>& leverage, Index inputs,
                              double correlation_lines, double lead) {
  const Evidence of{0.5 * residual.array().abs2(), model.array().abs2(),
                    (1 - leverage.array()).max(0.02), floor_of(model)};
  FrfNoise noise = noise_unknown(model, inputs, correlation_lines, lead);
  noise.column =
      (of.squares.colwise().sum().transpose() / of.freedom.sum()).matrix().cwiseMax(of.least);
  if (model.cols() == inputs) {
    update_by_line(noise, of);
    return noise;
  }
  for (int round = 0; round < 6; ++round) {
    update_lines(noise, of);
    update_columns(noise, of);
    // The common factor seen by all FRFs of an input together: variance q (b + 1 / h).
    const MatrixXd h = signal_to_noise(noise, of.power);
    for (Index i = 0; i < inputs; ++i) {
      ArrayXcd factor = ArrayXcd::Zero(model.rows());
      Index alive = 0;
      for (Index c = i; c < model.cols(); c += inputs) {
        if (!std::isfinite(noise.column[c])) continue;
        ++alive;
        factor += model.col(c).array().conjugate() * residual.col(c).array() / noise.column[c];
      }
      if (alive < 2) continue;  // one FRF cannot tell its own noise from that of its force
      const ArrayXd own = h.col(i).array().max(1e-300).inverse();
      const ArrayXd square = 0.5 * (factor * own).abs2() / (noise.line.array() * of.freedom);
      const ArrayXd weight = of.freedom / (noise.common[i] + own).square();
      noise.common[i] = std::max(0.0, (weight * (square - own)).sum() / weight.sum());
    }
  }
  update_lines(noise, of);
  return noise;
}

VectorXd line_weight(const FrfNoise& noise, const Ref<const MatrixXcd>& H) {
  ArrayXd variance = ArrayXd::Ones(H.rows());
  if (noise.common.maxCoeff() > 0) {
    variance += (signal_to_noise(noise, H.array().abs2()) * noise.common).array();
  }
  return (variance * noise.line.array()).rsqrt().matrix();
}

Complex line_correlation(const FrfNoise& noise, Index d) {
  if (d == 0 || !(noise.correlation_lines > 0)) return d == 0 ? 1 : 0;
  const double lines = static_cast<double>(d);
  return std::polar(1.0, 2 * std::numbers::pi * noise.lead * lines) /
         Complex(1, std::numbers::pi * lines / noise.correlation_lines);
}

MatrixXd correlated(const FrfNoise& noise, const Ref<const MatrixXd>& stacked_columns) {
  if (!(noise.correlation_lines > 0)) return stacked_columns;
  // A sum over lines is a product over times: those of the spectrum with the window that rho is the
  // transform of. Lines from `lines` on, so that their conjugates below 0 Hz stay apart.
  const Index lines = stacked_columns.rows() / 2;
  RealFft fft(good_fft_length(6 * lines));
  fft.spectrum().setZero();
  for (Index d = 0; d < lines; ++d) fft.spectrum()[d] = line_correlation(noise, d);
  fft.inverse();
  const VectorXd window = static_cast<double>(fft.length()) * fft.time();
  MatrixXd result(stacked_columns.rows(), stacked_columns.cols());
  for (Index c = 0; c < stacked_columns.cols(); ++c) {
    fft.spectrum().setZero();
    fft.spectrum().segment(lines, lines).real() = stacked_columns.col(c).head(lines);
    fft.spectrum().segment(lines, lines).imag() = stacked_columns.col(c).tail(lines);
    fft.inverse();
    fft.time().array() *= window.array();
    fft.forward();
    result.col(c).head(lines) = fft.spectrum().segment(lines, lines).real();
    result.col(c).tail(lines) = fft.spectrum().segment(lines, lines).imag();
  }
  return result;
}

VectorXd inverse_variance_of(const FrfNoise& noise) {
  return noise.column.unaryExpr([](double v) { return std::isfinite(v) && v > 0 ? 1 / v : 0.0; });
}

}  // namespace rigfit::signal
