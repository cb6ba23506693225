#include "signal/modes/modal_band.h"

#include "signal/estimation/robust.h"
#include "signal/recording/add_note.h"
#include "signal/refinement/modal_basis.h"

namespace rigfit::signal {

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
  FrfNoise noise = band.H_std.size() > 0
                       ? noise_from_std(H, band.H_std, band.lines.inputs, band.correlation_lines)
                       : noise_unknown(H, band.lines.inputs, band.correlation_lines);
  noise.lead = band.lead;
  return noise;
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

}  // namespace rigfit::signal
