// A very long record brought down to the band that its modes lie in.
//
// A line that lasts for 1e8 samples occupies next to nothing of the spectrum. Where everything that
// stands out of the noise lies in a narrow band, that band is cut out, moved down in frequency and
// sampled as slowly as it allows; the decay is then fitted there:
//   x_j = 2 Re sum_k H_k Y_k exp(2 pi i (k - k0) j / M)    real, at every `step`-th sample
// by FFT of overlapping blocks, so that memory does not grow with the record. H is the square
// root of a Nyquist filter with Meyer's smooth edges, |H(k)|^2 + |H(mirrored k)|^2 = 1: what folds
// at both ends of the band adds up to one, and white noise of variance s^2 stays white, s^2 / step.
// Poles, amplitudes and their Cramer-Rao bounds are then those of the whole record, as noise
// outside of the band holds nothing of the modes.
//
// What stands out is found in two ways over blocks of 65536 samples under Hann's window: lines of
// the mean spectrum above the median around them, and lines of any single block above what noise
// shows in the whole record once in a million records.
// Sources: Harris, Multirate Signal Processing (2004), ch. 3 and 4; Meyer, Wavelets and Operators
// (1992), section 2.7 (the edge).
#pragma once

#include <Eigen/Core>
#include <optional>

#include "signal/decay/decay_result.h"
#include "signal/sinusoids/decay_modes.h"

namespace rigfit::signal {

struct NarrowRecord {
  Eigen::VectorXd samples;       ///< less the straight line of the record
  Eigen::Index first = 0;        ///< sample of the record at which samples[0] is taken
  Eigen::Index step = 1;         ///< record's samples from one of `samples` to the next
  Eigen::Index shift_line = 0;   ///< frequencies are lowered by shift_line / length
  Eigen::Index length = 1;       ///< transform length, samples of the record
  double low = 0, high = 0;      ///< kept unchanged, cycles per sample of the record
  double offset = 0, slope = 0;  ///< line of the record: at its sample 0, and a sample

  /// What frequencies are lowered by, cycles per sample of `samples`.
  [[nodiscard]] double shift() const {
    return static_cast<double>(shift_line * step) / static_cast<double>(length);
  }
  [[nodiscard]] Eigen::Index record_sample(Eigen::Index sample) const {
    return first + sample * step;
  }
};

struct NarrowOptions {
  Eigen::Index least_samples = Eigen::Index{1} << 22;  ///< shorter records are left as they are
  Eigen::Index samples_left = Eigen::Index{1} << 20;   ///< at least
  Eigen::Index block = Eigen::Index{1} << 16;          ///< block of the spectra, samples
};

/// `y` in the band of what stands out of its noise within `band`. Nothing where the record is
/// short, has gaps or rails or next to no noise (100 dB), where nothing stands out, or where what
/// does takes more than a quarter of the samples.
[[nodiscard]] std::optional<NarrowRecord> narrow_record(const Eigen::Ref<const Eigen::VectorXd>& y,
                                                        const DecayBand& band,
                                                        const NarrowOptions& options = {});

/// The decay of the whole record, fitted to its band. Samples of the result are those of the
/// record, `noise_std` and the ratio of signal to noise those of white noise of the same density at
/// its rate; there is no residual. A note (`fitted_in_band`) says what was done.
[[nodiscard]] DecayResult estimate_narrow_decay(const NarrowRecord& record, double sample_rate_hz,
                                                const DecayOptions& options);

}  // namespace rigfit::signal
