// Which damped sinusoids a stretch of samples holds: the strongest first, then one more as long as
// the residual holds a peak that noise of its own colour would not show.
//
// A mode is taken when the energy that it explains exceeds what the best of all cells of the search
// (decay_search.h) takes out of noise with the chance `false_alarm`, when its pole is determined by
// the samples, and when it is not the company that another mode seeks for departing from an
// exponential.
#pragma once

#include <Eigen/Core>
#include <complex>
#include <optional>
#include <span>
#include <vector>

#include "signal/sinusoids/damped_sinusoids.h"
#include "signal/sinusoids/decay_search.h"

namespace rigfit::signal {

struct DecayBand {
  double low, high;  ///< undamped natural frequency, cycles per sample
  bool all;          ///< no limits
  [[nodiscard]] bool contains(std::complex<double> pole) const;
};

struct DecayModesOptions {
  int max_modes = 6;          ///< in the band, and as many beside it
  double false_alarm = 1e-4;  ///< chance that noise alone adds a mode
  bool relaxing = true;       ///< ask for an offset that decays
};

/// All modes that the samples support in the band and a quarter of its width beside it; nothing
/// when there is none. A background that decays, b exp(-r t), is taken as a mode is.
/// `start`: of the first mode, where it is known.
[[nodiscard]] std::optional<DampedSinusoidsFit> find_decay_modes(
    const DecaySamples& samples, const DecayBand& band, const DecayModesOptions& options,
    std::optional<std::complex<double>> start = std::nullopt);
/// The band that is fitted where `band` is asked for.
[[nodiscard]] DampedSinusoidsOptions fitted_band(const DecayBand& band);

/// Energy of mode `m` over the samples, sum of squares.
[[nodiscard]] double mode_energy(const DampedSinusoidsFit& fit, std::size_t m);
/// Sum of squares left when the complex amplitudes of these modes may also change with t^2 and t^3:
/// each as many parameters as one mode more.
[[nodiscard]] double departing_residual(const DampedSinusoidsFit& fit,
                                        std::span<const std::size_t> modes);
/// The mode of most energy in the band.
[[nodiscard]] std::size_t strongest_mode(const DampedSinusoidsFit& fit, const DecayBand& band);
/// Whether a pole may be that of an oscillation in so many samples: damping ratio under 0.9, 0.3
/// cycles and more, growing by e^2.9 at most.
[[nodiscard]] bool plausible_decay(std::complex<double> pole, Eigen::Index samples);
/// -Re p / |p|.
[[nodiscard]] double damping_ratio_of(std::complex<double> pole);

}  // namespace rigfit::signal
