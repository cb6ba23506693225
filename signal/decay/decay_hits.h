// Further impacts within a record: where a decay ends because the next one starts.
//
// The complex amplitude of a mode, z(t), changes smoothly along a decay, along a beat and under
// friction; an impact steps it. With means over L cycles z_-2, z_-1 before and z_1, z_2 behind t,
// both sides are extrapolated to t by a straight line,
//   J(t) = (3 z_1 - z_2) / 2 - (3 z_-1 - z_-2) / 2,
// which for z = exp(-a t) is of third order in a L. Where |J| stands out, the damped sinusoids of
// a ten cycles before and behind are fitted apart and together. It is an impact when two fits
// explain more than one (Fisher's test) and the amplitudes of both, taken to t, differ by more than
// a twentieth of the record's largest, a loss that leaves the phase as it is (friction) aside.
// Missing samples are left out of these fits: a gap is no impact.
#pragma once

#include <Eigen/Core>
#include <complex>
#include <vector>

namespace rigfit::signal {

/// Mean of y exp(-i w j), twice, over any samples: a running sum.
class RunningAmplitude {
 public:
  RunningAmplitude(const Eigen::Ref<const Eigen::VectorXd>& y, double w);
  /// Complex amplitude over samples [from, to); those outside of the record count as zero.
  [[nodiscard]] std::complex<double> over(Eigen::Index from, Eigen::Index to) const;
  /// The largest over `length` samples that begin a quarter of it apart.
  [[nodiscard]] double largest(Eigen::Index length) const;

 private:
  Eigen::VectorXcd sums_;
};

/// Samples over which an amplitude is averaged: a cycle, and near half the sample rate, where the
/// negative frequency comes close, a cycle of the beat with it.
[[nodiscard]] Eigen::Index averaging_cycle(double w);

/// Samples at which further impacts start, in time. `y`: NaN where missing; `w`: of the modes
/// looked at, rad per sample, the strongest first.
[[nodiscard]] std::vector<Eigen::Index> further_hits(const Eigen::Ref<const Eigen::VectorXd>& y,
                                                     const std::vector<double>& w);

}  // namespace rigfit::signal
