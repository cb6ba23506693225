// Which damped sinusoids a stretch of samples holds: the strongest first, then one more as long as
// the residual holds a peak that noise of its own colour would not show.
//
// A mode is taken when the energy that it explains exceeds what the best of all cells of the search
// (decay_search.h) takes out of noise with the chance `false_alarm`, when its pole is determined by
// the samples, and when it is not the company that another mode seeks for departing from an
// exponential. A mode that noise passes for where it is larger while the mode lasts
// (uneven_noise.h) is taken back at the end.
#pragma once

#include <Eigen/Core>
#include <complex>
#include <optional>
#include <span>
#include <vector>

#include "signal/sinusoids/damped_sinusoids.h"
#include "signal/sinusoids/decay_search.h"

namespace rigfit::signal {

struct DecaySamples {
  Eigen::VectorXd values;  ///< 0 where missing
  std::vector<Eigen::Index> missing;
};

/// Samples [start, end) of `y`, NaN where missing.
[[nodiscard]] DecaySamples decay_samples(const Eigen::Ref<const Eigen::VectorXd>& y,
                                         Eigen::Index start, Eigen::Index end);

struct DecayBand {
  double low, high;  ///< undamped natural frequency, cycles per sample
  bool all;          ///< no limits
  [[nodiscard]] bool contains(std::complex<double> pole) const;
};

struct DecayModesOptions {
  int max_modes = 6;          ///< in the band; as many outside it are fitted to keep them out
  double false_alarm = 1e-4;  ///< chance that noise alone adds a mode
};

/// All modes that the samples support; nothing when there is none. `peaks`: those of the samples
/// without their trend (decay_search.h), where they are known already.
[[nodiscard]] std::optional<DampedSinusoidsFit> find_decay_modes(
    const DecaySamples& samples, const DecayBand& band, const DecayModesOptions& options,
    const std::vector<DecayCandidate>& peaks = {});

/// What the energy that a mode explains must exceed, in variances of the noise, to be taken:
/// Fisher's test with four degrees at `false_alarm` over all cells of the search.
[[nodiscard]] double energy_needed(const DampedSinusoidsFit& fit, double false_alarm);
/// How far the sum of squares rises when mode `m` is left out and all other poles stay.
[[nodiscard]] double energy_explained(const DampedSinusoidsFit& fit, std::size_t m);

/// Energy of mode `m` over the samples, sum of squares.
[[nodiscard]] double mode_energy(const DampedSinusoidsFit& fit, std::size_t m);
/// Sum of squares left when the complex amplitudes of these modes may also change with t^2 and t^3:
/// each as many parameters as one mode more.
[[nodiscard]] double departing_residual(const DampedSinusoidsFit& fit,
                                        std::span<const Eigen::Index> missing,
                                        std::span<const std::size_t> modes);
/// The mode of most energy in the band.
[[nodiscard]] std::size_t strongest_mode(const DampedSinusoidsFit& fit, const DecayBand& band);
/// Whether a pole may be that of an oscillation in so many samples: damping ratio under 0.9, 0.3
/// cycles and more, growing by e^2.9 at most.
[[nodiscard]] bool plausible_decay(std::complex<double> pole, Eigen::Index samples);
/// -Re p / |p|.
[[nodiscard]] double damping_ratio_of(std::complex<double> pole);

}  // namespace rigfit::signal
