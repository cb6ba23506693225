// Options and result of the identification of modes (modal_identification.h).
#pragma once

#include "signal/modes/modal_model.h"
#include "signal/poles/pole_clusters.h"
#include "signal/refinement/modal_refine.h"

namespace rigfit::signal {

struct ModalOptions {
  double low_hz = 0;   ///< band; lines at 0 Hz are never used
  double high_hz = 0;  ///< 0: to the last line
  LscfOptions lscf;
  PoleStepOptions refine;  ///< iterations and the step that ends them
  /// Smallest accepted peak of a mode, relative to the rms FRF within its half bandwidth, over all
  /// FRFs. Transducers and structures are linear to about this; in data with less noise, everything
  /// that the model leaves out would look like a mode.
  double min_prominence = 1e-3;
  /// Largest number of multiplications of the global search (some seconds); beyond it modes come
  /// from local fits.
  double max_work = 4e9;
  int searches = 3;  ///< largest number of searches of the residual for more modes; 0: none
};

struct ModalResult {
  ModalModel model;
  LscfResult stabilisation;  ///< window not removed
  FrfNoise noise;            ///< estimated from the fit's residual
  MatrixXd auto_mac;         ///< modes x modes
  StepsEnd end = StepsEnd::converged;
  int iterations = 0;
  Index lines_used = 0;
  double low_hz = 0, high_hz = 0;  ///< first and last line used
  /// Part of the fit besides modes and residuals (signal/modal/band_background.h), which truncated
  /// records and noise on the force cause. Lines used x FRFs, in the fitted form and window; empty:
  /// none.
  MatrixXcd background;
  VectorXd background_hz;  ///< its lines
  /// Rms misfit over the rms of the smoothed error bars H_std (1: the modes explain the FRFs within
  /// them); empty when the FRFs came without error bars.
  std::optional<double> misfit_over_error_bars;

  static constexpr auto fields() {
    using T = ModalResult;
    return std::tuple{describe::part(&T::model),
                      field("band_hz", describe::ends_of(&T::low_hz, &T::high_hz)),
                      field("lines", &T::lines_used),
                      field("misfit_over_error_bars", &T::misfit_over_error_bars),
                      field("auto_mac", &T::auto_mac),
                      field("stabilisation", &T::stabilisation)};
  }
};

/// FRFs of `model` in `form` at `frequency_hz` (lines at 0 Hz are dropped where the form divides by
/// zero), as measured under a window of `decay_rate_1_s`.
/// Throws std::invalid_argument when the model's form is unknown and `form` is another one.
[[nodiscard]] FrfSet synthesised(const ModalModel& model, const Ref<const VectorXd>& frequency_hz,
                                 FrfForm form, double decay_rate_1_s = 0);

/// FRFs of a whole fit, under the window of that fit. Its background (`ModalResult::background`) is
/// added from the first to the last line used, linearly interpolated, and is 0 at other lines.
[[nodiscard]] FrfSet synthesised(const ModalResult& fit, const Ref<const VectorXd>& frequency_hz,
                                 FrfForm form);

}  // namespace rigfit::signal
