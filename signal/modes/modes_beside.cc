#include "signal/modes/modes_beside.h"

#include <algorithm>
#include <complex>
#include <vector>

#include "signal/modes/mode_search.h"
#include "signal/numerics/numbers.h"

namespace rigfit::signal {
namespace {

using Complex = std::complex<double>;
using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::VectorXcd;

/// Poles beside the band are looked for this far beyond its end and back into it, in band widths.
constexpr double kBeyond = 0.25, kWithin = 0.125;
constexpr Index kFewestLines = 16;

/// Modes of the lines from `low_hz` to `high_hz`.
VectorXcd poles_between(const FrfSet& frfs, double low_hz, double high_hz,
                        const ModalOptions& options) {
  std::vector<Note> none;
  const ModalBand part = select_band(frfs, low_hz, high_hz, none);
  const FrfNoise noise = first_noise(part);
  if (!noise.column.cwiseInverse().any()) return {};
  ModalOptions once = options;
  once.searches = 1;
  const LscfResult diagram =
      stabilise(part, part.lines.H, noise, options.lscf, 0, part.frequency_hz.size());
  const FoundModes found =
      search_modes(part, cluster_poles(diagram, part.spacing_hz, options.clusters), noise, once);
  if (found.exhausted || !found.covariance.full_rank) return {};
  return found.fit.poles;
}

/// The part of `column` outside of the orthonormal `columns`, over its size; added where it counts.
void add_column(VectorXcd column, MatrixXcd& columns) {
  constexpr double kPart = 1e-3;
  column.normalize();
  for (int twice = 0; twice < 2; ++twice) column -= columns * (columns.adjoint() * column).eval();
  const double part = column.norm();
  if (part < kPart) return;
  columns.conservativeResize(Eigen::NoChange, columns.cols() + 1);
  columns.rightCols(1) = column / part;
}

}  // namespace

VectorXcd poles_beside(const FrfSet& frfs, const ModalBand& band, const ModalOptions& options) {
  const auto& f = frfs.frequency_hz;
  const double low = band.frequency_hz[0], high = band.frequency_hz[band.frequency_hz.size() - 1];
  const double width = high - low;
  std::vector<Complex> poles;
  const auto lines_within = [&](double from, double to) {
    return (f.array() > 0 && f.array() > from && f.array() < to).count();
  };
  const auto add = [&](const VectorXcd& found, double from, double to) {
    for (const Complex pole : found) {
      const double at = pole.imag() / kTwoPi;
      if (at > from && at < to) poles.push_back(pole);
    }
  };
  const double above = high + kBeyond * width, below = std::max(0.0, low - kBeyond * width);
  if (lines_within(high, above) >= kFewestLines) {
    add(poles_between(frfs, high - kWithin * width, above, options), high, above);
  }
  if (lines_within(below, low) >= kFewestLines) {
    add(poles_between(frfs, below, low + kWithin * width, options), below, low);
  }
  return Eigen::Map<const VectorXcd>(poles.data(), static_cast<Index>(poles.size()));
}

void set_background(const Eigen::Ref<const MatrixXcd>& background, ModalBand& band) {
  FrfLines& lines = band.lines;
  lines.background = background;
  if (band.beside.size() == 0) return;
  const VectorXcd scale = lines.s.array().pow(lines.power);
  MatrixXcd columns(lines.s.size(), 0);
  add_column(lines.s.array().pow(lines.power - 2), columns);
  add_column(scale, columns);
  const Index residuals = columns.cols();
  columns.conservativeResize(Eigen::NoChange, residuals + background.cols());
  columns.rightCols(background.cols()) = background;
  const Index known = columns.cols();
  for (const Complex pole : band.beside) {
    add_column(scale.array() / (lines.s.array() - pole), columns);
    add_column(scale.array() / (lines.s.array() - std::conj(pole)), columns);
  }
  const Index added = columns.cols() - known;
  lines.background.conservativeResize(Eigen::NoChange, background.cols() + added);
  lines.background.rightCols(added) = columns.rightCols(added);
}

}  // namespace rigfit::signal
