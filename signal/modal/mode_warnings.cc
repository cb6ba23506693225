#include "signal/modal/mode_hits.h"

#include <fmt/ranges.h>

#include <string>

#include "signal/modal/band_background.h"
#include "signal/poles/pole_clusters.h"
#include "signal/recording/add_note.h"

namespace rigfit::signal {

namespace {

/// Share of a mode's amplitude left at the end of the records from which it may be a tone. Only
/// hits of ours are known to have records of 1 / line spacing: lines of stepped or periodic sines
/// lie as far apart as one likes, though 60 half bandwidths (90 %) show no mode.
double steady(const ModalBand& band) { return band.lead > 0 ? 0.5 : 0.9; }

}  // namespace

double misfit_inflation(const FrfNoise& noise, const Ref<const MatrixXcd>& misfit) {
  std::vector<Index> alive;
  for (Index c = 0; c < misfit.cols(); ++c) {
    if (std::isfinite(noise.column[c])) alive.push_back(c);
  }
  const Index lines = misfit.rows(), lags = std::clamp<Index>(lines / 5, 1, 8);
  if (lines < 2 || alive.empty()) return 1;
  const MatrixXcd over = noise.line.cwiseSqrt().cwiseInverse().asDiagonal() *
                         misfit(Eigen::all, alive) *
                         noise.column(alive).cwiseSqrt().cwiseInverse().asDiagonal();
  double more = 0;
  for (Index d = 1; d <= lags; ++d) {
    const auto first = over.topRows(lines - d), second = over.bottomRows(lines - d);
    const double power = 0.5 * (first.squaredNorm() + second.squaredNorm());
    if (!(power > 0)) return 1;
    const double excess = first.conjugate().cwiseProduct(second).sum().real() / power -
                          line_correlation(noise, d).real();
    more += 2 * (1 - static_cast<double>(d) / (static_cast<double>(lags) + 1)) * excess;
  }
  return 1 + std::max(0.0, more);
}

double misfit_beyond_noise(const ModalBand& band, const FrfNoise& noise, const IdentifiedMode& mode,
                           const Ref<const MatrixXcd>& misfit) {
  const auto [first, count] = lines_around(band, mode.pole_rad_s, 2.5);
  if (count < 2) return 0;
  const auto left = misfit.middleRows(first, count);
  const double around = band.lines.H.middleRows(first, count).squaredNorm();
  const double power = left.squaredNorm();
  if (!(around > 0) || !(power > 0)) return 0;
  const auto values = static_cast<double>(left.size());
  const double known = line_correlation(noise, 1).real();
  if (known > 0.9) return 0;      // a window as short as this makes all misfit alike
  double beyond = 0, chance = 0;  // of `power`
  if (band.H_std.size() > 0) {
    const double expected = 2 * band.H_std.middleRows(first, count).squaredNorm();
    beyond = power - expected;
    chance = expected / std::sqrt(values) * std::sqrt((1 + known * known) / (1 - known * known));
  } else {
    const double pairs = values * static_cast<double>(count - 1) / static_cast<double>(count);
    const double product =
        (left.topRows(count - 1).conjugate().cwiseProduct(left.bottomRows(count - 1)))
            .sum()
            .real() *
        values / pairs;
    beyond = (product - known * power) / (1 - known);
    chance = power / std::sqrt(2 * pairs) / (1 - known);
  }
  return beyond > 4 * chance ? std::sqrt(beyond / around) : 0;
}

void judge_modes(ModalResult& result, const ModalBand& band, const Ref<const MatrixXcd>& misfit,
                 const Ref<const MatrixXcd>& of_one_shape_each) {
  ModalModel& model = result.model;
  const FrfNoise& noise = result.noise;
  for (std::size_t r = 0; r < model.modes.size(); ++r) {
    IdentifiedMode& mode = model.modes[r];
    std::vector<std::string> doubts;
    const auto doubt = [&](bool holds, const std::string& why) {
      if (holds) doubts.push_back(why);
    };
    const bool global = mode.refinement == "global";
    const double measured = band.window - mode.pole_rad_s.real(), half = measured / kTwoPi;
    const double f = mode.frequency_hz.value, scatter = mode.between_points_std_hz;
    doubt(!mode.doubt.empty(), mode.doubt);
    doubt(
        mode.damping_dominated_by_window,
        fmt::format(
            "the window gives {:.0f} % of the measured decay rate: damping refused, frequency kept",
            100 * band.window / measured));
    const double damping =
        mode.damping_ratio.std / std::max(std::abs(mode.damping_ratio.value), 1e-300);
    doubt(!mode.damping_dominated_by_window && !(damping < 0.25),
          fmt::format("damping known to {:.0f} % only", 100 * std::min(10.0, damping)));
    // 5 % of variance: residues less than some 4 times what the test of presence asks for.
    doubt(mode.significance < 4,
          fmt::format("weak: {:.1f} times the least that is told from noise", mode.significance));
    // A line narrower than the record can show: as likely a steady tone as a mode.
    const double left = left_at_the_end(band, mode.pole_rad_s - band.window);
    doubt(left > steady(band),
          fmt::format("{:.0f} % of it are left at the end of the records: a steady tone such as "
                      "mains hum, or a mode that needs longer records",
                      100 * left));
    for (const IdentifiedMode& other : model.modes) {
      const bool tone = left_at_the_end(band, other.pole_rad_s - band.window) > steady(band);
      const double distance = std::abs(other.pole_rad_s.imag() - mode.pole_rad_s.imag());
      doubt(tone && left <= steady(band) && distance < 4 * measured,
            fmt::format("a steady tone at {:.4g} Hz lies within its resonance: it is no noise, "
                        "error bars do not allow for it",
                        other.frequency_hz.value));
    }
    // Structures, hits and sensors are not linear to better than some percent of a strong
    // resonance.
    const double peak =
        prominence(band, mode.pole_rad_s, mode.shape.norm() * mode.participation.norm(), 1);
    doubt(
        peak < 0.1,
        fmt::format("its peak is {:.2g} % of the FRFs around it, less than 10 %: what a non-linear "
                    "structure or differing hits add to a stronger mode looks like this",
                    100 * peak));
    doubt(f - half < result.low_hz || f + half > result.high_hz,
          "its resonance is cut by the end of the band");
    doubt(scatter > 4 * half,
          fmt::format("its frequency differs between points by {:.2g} Hz rms, {:.1f} half "
                      "bandwidths: the points do not show one and the same rig",
                      scatter, scatter / half));
    const double beyond = misfit_beyond_noise(band, noise, mode, misfit);
    const double unexplained = global ? beyond : mode.reconstruction_error;
    doubt(unexplained > 0.3, fmt::format("{:.0f} % of the FRFs around it are not explained by it{}",
                                         100 * unexplained, global ? ", nor by noise" : ""));
    // Standard deviations are of first order in the noise. Noise that goes with the FRF and is the
    // same for all of them weighs single lines of the peak by chance; beyond a tenth of the peak,
    // all its lines together, that is no small change.
    Index nearest = 0;
    (band.frequency_hz.array() - mode.pole_rad_s.imag() / kTwoPi).abs().minCoeff(&nearest);
    const double shared = std::sqrt(2 * noise.line[nearest] * noise.common.maxCoeff());
    const double lines = std::max(1.0, 2 * half / band.spacing_hz);
    doubt(global && shared > 0.1 * std::sqrt(lines),
          fmt::format("noise that all FRFs share, as that on the force, has {:.0f} % of them at "
                      "each of the {:.1f} lines of its resonance: error bars do not allow for so "
                      "much; use a force window",
                      100 * shared, lines));
    // Noise of the residues alone lowers the collinearity by about its share of the power.
    const double part = mode.shape_std.squaredNorm() / mode.shape.squaredNorm();
    doubt(mode.shape.size() >= 3 && mode.modal_phase_collinearity < 0.8 - 2 * part,
          fmt::format("complex shape: phase collinearity {:.2f}", mode.modal_phase_collinearity));
    for (const std::size_t other : {r - 1, r + 1}) {  // r - 1 wraps below 0 and is left out
      if (other >= model.modes.size()) continue;
      const double likeness = result.auto_mac(static_cast<Index>(r), static_cast<Index>(other));
      const Complex beside = model.modes[other].pole_rad_s;
      const double others = band.window - beside.real();
      const double distance = apart(mode.pole_rad_s, beside, band.window);
      // Where shapes do not tell: a cubic spring adds poles that decay 3, 5, ... times as fast.
      const bool shapes = mode.shape.size() >= 3;
      doubt(shapes ? likeness > 0.9 && distance < 2 : measured > 2 * others && distance < 1,
            fmt::format("{} the mode at {:.4g} Hz{}, resonances overlap: one mode that changed "
                        "between hits, or a non-linear one, looks like this",
                        shapes ? "same shape as" : "more than twice as wide as",
                        model.modes[other].frequency_hz.value,
                        shapes ? fmt::format(" (MAC {:.2f})", likeness) : ""));
    }
    mode.doubtful = !doubts.empty();
    mode.doubt = fmt::format("{}", fmt::join(doubts, "; "));
    const double of_one_shape =
        band.lines.inputs > 1 ? misfit_beyond_noise(band, noise, mode, of_one_shape_each) : 0;
    // As prominent as a mode has to be.
    if (const double more = of_one_shape > 0.1 ? of_one_shape : beyond; more > 0) {
      add_note(model.notes, "systematic_misfit", fmt::format("{:.4g} Hz", f),
               "Measure longer records and more points, or look for a change between hits: {:.2g} "
               "% of the FRFs around the mode are neither its own nor noise, as where a second "
               "mode lies within its resonance; error bars do not allow for it",
               100 * more);
    }
    // Records that end before the mode has decayed scale its residue by 1 - exp(-decay * length),
    // whose phase the record does not tell; poles stay right.
    if (left > 0.01) {
      const bool sine = band.lead == 0 && left > 0.5;
      add_note(model.notes, sine ? "steady_tone" : "decay_cut_off", fmt::format("{:.4g} Hz", f),
               "{:.1f} % of the amplitude are left at the end of {}: residues are uncertain by "
               "that, poles are not{}",
               100 * left, sine ? "records of 1 / line spacing" : "the records",
               sine ? "; a steady tone such as mains hum looks like this too. FRFs of stepped or "
                      "periodic sine are right as they are"
                    : "");
    }
  }
}

}  // namespace rigfit::signal
