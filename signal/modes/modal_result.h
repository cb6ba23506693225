// What identification of modes is asked and what it gives (modal_identification.h).
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "signal/modes/modal_model.h"
#include "signal/poles/lscf.h"
#include "signal/poles/pole_clusters.h"
#include "signal/refinement/modal_noise.h"
#include "signal/refinement/modal_refine.h"
#include "signal/spectra/frf_set.h"

namespace rigfit::signal {

struct ModalOptions {
  double low_hz = 0;   ///< band; lines at 0 Hz are never used
  double high_hz = 0;  ///< 0: to the last line
  LscfOptions lscf;
  PoleClusterOptions clusters;
  ModalRefineOptions refine;
  /// A mode's own peak, over the rms FRF within its half bandwidth, all FRFs together, must exceed
  /// this. Transducers and structures are not linear to better than about this; in data with less
  /// noise than that, whatever the model leaves out would pass for a mode.
  double min_prominence = 1e-3;
  /// Multiplications that the global search may take, some seconds; beyond it modes come from local
  /// fits.
  double max_work = 4e9;
  int searches = 3;  ///< at most, of what is left for further modes; 0: the whole band only
};

/// A column of the stabilisation diagram that is no mode in the end, and the test it failed.
struct RejectedColumn {
  double frequency_hz = 0, damping_ratio = 0;  ///< as the diagram shows it, window removed
  double presence = 0;                         ///< share of the upper half of the orders, 0..1
  /// "presence", "band", "damping", "prominence", "significance", "twin"; of local fits: "points"
  /// (too few show it), "scatter" (they do not agree).
  std::string code;
  std::string reason;  ///< for a person, with the figure and the limit
};

struct ModalResult {
  ModalModel model;
  LscfResult stabilisation;              ///< window not removed
  std::vector<PoleCluster> clusters;     ///< clusters of that diagram, window not removed
  std::vector<RejectedColumn> rejected;  ///< columns of it without a mode, by rising frequency
  FrfNoise noise;                        ///< as estimated from what the fit leaves
  Eigen::MatrixXd auto_mac;              ///< modes x modes
  RefineEnd end = RefineEnd::converged;
  int iterations = 0;
  Eigen::Index lines_used = 0;
  double low_hz = 0, high_hz = 0;  ///< first and last line used
  /// What the fit has besides modes and residuals (smooth_background.h): what records that end
  /// early and noise on the force add. Lines used x FRFs, in the fitted form and window; empty:
  /// nothing.
  Eigen::MatrixXcd background;
  Eigen::VectorXd background_hz;  ///< its lines
  /// Rms of the misfit over what the smoothed error bars H_std expect (1: the modes explain the
  /// FRFs within them); empty when the FRFs came without error bars.
  std::optional<double> misfit_over_error_bars;
  /// Correlation (real part) of the misfit at neighbouring lines beyond that of noise under the
  /// window. Noise alone gives 0 within a few hundredths; a model that leaves something out, up
  /// to 1.
  double misfit_line_correlation = 0;
};

}  // namespace rigfit::signal
