// Input and result of FRF averaging (frf.h): the blocks, the options, the averaged FRFs.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

namespace rigfit::signal {

enum class FrfEstimator { h1, h2, hv };
[[nodiscard]] const char* name_of(FrfEstimator estimator);

/// One hit: views into recordings, all beginning at the same instant. A view shorter than the block
/// is continued by zeros (after its offset is subtracted).
struct FrfBlock {
  std::span<const double> force;
  std::vector<std::span<const double>> responses;
  double force_offset = 0;              ///< subtracted
  std::vector<double> response_offset;  ///< subtracted; empty: zeros
  Eigen::Index force_first = 0;         ///< samples of force kept as they are: from this ...
  Eigen::Index force_last = -1;         ///< ... to the one before this; -1: all of it
  Eigen::Index force_taper = 0;         ///< samples of fading on either side, zero beyond
  /// Samples of the block that are not noise of the force: the pulse with what may ring around it.
  Eigen::Index pulse_first = 0, pulse_last = -1;  ///< -1: not known, nor is the noise
  std::vector<double> response_noise_std;         ///< std of each response's noise; empty: unknown
};

struct FrfOptions {
  FrfEstimator estimator = FrfEstimator::h1;
  double sample_rate_hz = 0;
  Eigen::Index block_samples = 0;
  /// Rate a of the window exp(-a t) on force and response; 0: none.
  double exponential_decay_rate_1_s = 0;
  /// The residual noise power is averaged over this many lines on either side before it becomes an
  /// error bar: noise spectra are smooth, and an error bar from few hits alone scatters by
  /// 1 / (2 sqrt(n - 1)). Under an exponential window neighbouring lines share their noise; the
  /// width grows by the window's noise bandwidth, so as to hold as many independent lines. Where
  /// the average over two lines on either side exceeds the wide one beyond chance (0.1 %), as when
  /// modes still ring from the previous hit, the narrow average is used. Where the noise before the
  /// hit is known, the part that enters through the force (it peaks where |H| does) gives the shape
  /// that is scaled. 0: no averaging over lines.
  Eigen::Index error_smoothing_lines = 10;
  bool subtract_force_noise = true;  ///< from Gxx in H1
  Eigen::Index by_hit_lines = 0;     ///< lines in `FrfEstimate::by_hit`; 0: not filled
  bool leave_one_out = false;        ///< fill `FrfEstimate::incoherence_without`
  /// Lines used by leave-one-out: where the force spectrum is within this of its maximum.
  double leave_one_out_range_db = 20;
  int threads = 1;  ///< work over responses in parallel; the result is the same
};

struct FrfEstimate {
  Eigen::VectorXd frequency_hz;
  Eigen::MatrixXcd H;                      ///< lines x responses
  Eigen::MatrixXd H_std;                   ///< std of real and imaginary part, each; empty: unknown
  Eigen::MatrixXd coherence;               ///< empty for one hit (it would be 1)
  Eigen::VectorXd force_power;             ///< mean |X|^2 per hit, unscaled, by line
  std::vector<Eigen::MatrixXcd> by_hit;    ///< H of each hit by itself, first lines x responses
  Eigen::VectorXd force_noise;             ///< its part that is noise, by line; empty: unknown
  bool std_from_noise_before_hit = false;  ///< one hit: H_std is from noise_std of the block
  /// Part of the response power (all responses, each relative to its own) not explained by the
  /// force, per degree of freedom, in the lines of `leave_one_out_range_db`.
  double incoherence = 0;
  Eigen::VectorXd incoherence_without;  ///< `incoherence` without hit i
};

}  // namespace rigfit::signal
