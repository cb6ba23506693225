// Frequency response functions with their error bars: output of `frf`, input of `modal`.
//
// H(f) = response / force with exp(+i 2 pi f t) (passive poles lie in the upper half of the
// frequency plane: H of a lightly damped mode has negative imaginary receptance). One-sided lines.
//
// Error bars of FRFs that another analyser averaged come from their coherence:
//   std(Re H) = std(Im H) = |H| sqrt((1 - g2) / (2 (n - 1) g2)),   n averages
// (Bendat and Piersol, Random Data, 4th ed., sec. 9.2, with n - 1 in place of n as in frf.h).
// Coherence of few averages scatters from line to line: the noise power |H|^2 (1 - g2) / g2 is
// averaged over lines before it becomes an error bar.
#pragma once

#include "signal/recording/recording.h"

namespace rigfit::signal {

/// Those that are known by the power of s that they have over a receptance.
enum class FrfForm { receptance, mobility, accelerance, unknown };
[[nodiscard]] const char* name_of(FrfForm form);
/// "m/N", "(m/s)/N", "(m/s^2)/N", "" for unknown.
[[nodiscard]] const char* unit_of(FrfForm form);
/// Receptance of a displacement, mobility of a velocity, accelerance of an acceleration; and back.
[[nodiscard]] FrfForm form_of(Quantity response);
[[nodiscard]] Quantity response_of(FrfForm form);

/// Where and in which direction a signal was taken: UFF 58's node and direction, plus a name.
struct MeasuredPoint {
  std::string name;
  int node = 0;
  int direction = 0;  ///< UFF: +-1 x, +-2 y, +-3 z, 0 scalar

  bool operator==(const MeasuredPoint&) const = default;
  static constexpr auto fields() {
    using T = MeasuredPoint;
    return std::tuple{field("name", &T::name), field("node", &T::node),
                      field("direction", &T::direction)};
  }
};

struct FrfSet {
  VectorXd frequency_hz;                 ///< lines
  std::vector<MeasuredPoint> responses;  ///< No
  std::vector<MeasuredPoint> inputs;     ///< Ni
  /// lines x (No * Ni), column `response * Ni + input`; SI per N in the units of `form`.
  MatrixXcd H;
  /// Same layout: standard deviation of the real and of the imaginary part, each (random error of
  /// the average, not of one hit); empty: unknown.
  MatrixXd H_std;
  MatrixXd coherence;  ///< same layout; empty: unknown
  FrfForm form = FrfForm::unknown;
  std::string unit;  ///< such as "(m/s^2)/N"
  double exponential_decay_rate_1_s =
      0;  ///< window shared by force and response; adds to every pole
  /// Mean time from the beginning of the blocks to the hits' peaks; 0: unknown. With a window it
  /// determines how the noise of neighbouring lines correlates (modal_noise.h).
  double pre_trigger_s = 0;
  /// FRFs of the single hits in the average, layout as H, fewer lines; columns of inputs with fewer
  /// hits are NaN. They show what changes between hits (mode_hits.h). Empty: not kept.
  std::vector<MatrixXcd> by_hit;
  /// Integral of the force over each hit's pulse by input, then hit, in the order of `by_hit`: the
  /// force's unit times s, usually N s. They weight the hits (mode_hits.h). Empty: unknown.
  std::vector<std::vector<double>> hit_impulse;
  /// Noise on the force left by a force window, and responses cut off at the end of a block, add to
  /// H the transform of a signal that lies within this time of the hit, s, and so is smooth over
  /// lines. 0: there is neither.
  double force_noise_span_s = 0;
  /// Standard deviation of Re and of Im of the relative error that noise under a force window gives
  /// all FRFs of an input alike, mean over the band. It goes with the residues.
  double force_noise_std = 0;
  int averages = 0;
  double sample_rate_hz = 0;
  /// Relative standard uncertainty of the rate, common to all frequencies
  /// (Recording::sample_rate_relative_std).
  double sample_rate_relative_std = 0;
  std::vector<Note> notes;

  [[nodiscard]] Index column(Index response, Index input) const {
    return response * static_cast<Index>(inputs.size()) + input;
  }
};

/// Multiplies by s^k to get `form`, with s = i omega + exponential_decay_rate_1_s: under a shared
/// exponential window H is known on that line of the s plane. Where s^k is a division, the line at
/// 0 Hz is dropped, with a note. Throws std::invalid_argument when either form is unknown.
[[nodiscard]] FrfSet converted(const FrfSet& frfs, FrfForm form);

/// Multiplies one column by s^power.
void multiply_by_s(FrfSet& frfs, Index column, int power);

/// Fills `H_std` of a set that has a coherence and no error bars. `averages`: stated by a person,
/// 0: take the set's own. Notes, added to the set's: "assumed" (two are taken, which gives the
/// largest error bars), "coherence_unusable" (one average, values outside 0..1), "low_coherence"
/// (median in the band below 0.8). A set without a coherence or with error bars is left as it is.
void error_bars_from_coherence(FrfSet& frfs, int averages,
                               const std::optional<std::pair<double, double>>& band_hz);

}  // namespace rigfit::signal
