// A second algorithm for a limp cable's small motions: straight two-node bars along the exact
// elastic catenary, with the catenary's own axial force, consistent mass and dense algebra. Nothing
// is shared with the segment model but the physics; the end points are not balanced by a Newton
// method, and there is no bending. Frequencies err by the square of the bars' length; chains with
// three numbers of bars remove that and the fourth power.
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "tests/reference/closed_forms.h"
#include "tests/reference/dense_eigen.h"

namespace rigfit::model {

/// Frequencies (Hz) of n bars; `components` 2: in the plane, 1: out of it.
inline std::vector<double> frequencies_of_bars(const ElasticCatenary& cable,
                                               const CatenaryState& state, double mass, int count,
                                               int n, int components) {
  const double l = state.unstretched_length_m / n;
  const Eigen::Index size = components * (n - 1);
  Eigen::MatrixXd K = Eigen::MatrixXd::Zero(size, size), M = K;
  for (int i = 0; i < n; ++i) {
    const Eigen::Vector2d e =
        catenary_point(cable, state, (i + 1) * l) - catenary_point(cable, state, i * l);
    const Eigen::Vector2d t = e.normalized();
    const double vertical = state.vertical_N - cable.weight_per_length_N_m * (i + 0.5) * l;
    const double force = std::hypot(state.tension_N, vertical);
    const double geometric = force / (l * (1 + force / cable.EA_N));
    Eigen::Matrix2d k = geometric * (Eigen::Matrix2d::Identity() - t * t.transpose()) +
                        cable.EA_N / l * t * t.transpose();
    if (components == 1) k(0, 0) = geometric;
    for (int a = 0; a < 2; ++a) {
      for (int b = 0; b < 2; ++b) {
        const Eigen::Index row = components * (i + a - 1), column = components * (i + b - 1);
        if (row < 0 || column < 0 || row >= size || column >= size) continue;
        const auto c = Eigen::Index(components);
        K.block(row, column, c, c) += (a == b ? 1 : -1) * k.topLeftCorner(c, c);
        M.block(row, column, c, c) +=
            mass * l * (a == b ? 1.0 / 3 : 1.0 / 6) * Eigen::MatrixXd::Identity(c, c);
      }
    }
  }
  const Eigen::VectorXd omega2 = testing::symmetric_eigenvalues(K, M);
  std::vector<double> out;
  for (int i = 0; i < count; ++i) out.push_back(std::sqrt(omega2[i]) / (2 * std::numbers::pi));
  return out;
}

struct BarFrequencies {
  std::vector<double> in_hz, out_hz;
  double error = 0;  ///< relative, the largest: the change from two thirds as many bars
};

inline BarFrequencies bar_frequencies(const ElasticCatenary& cable, const CatenaryState& state,
                                      double mass_per_length_kg_m, int count) {
  BarFrequencies out;
  for (const int components : {2, 1}) {
    const auto extrapolated = [&](int n) {  // from n, 2 n and 3 n bars
      std::vector<double> sum(static_cast<std::size_t>(count), 0.0);
      for (const auto& [times, weight] :
           {std::pair{1, 1.0 / 24}, {2, -16.0 / 15}, {3, 81.0 / 40}}) {
        const auto f =
            frequencies_of_bars(cable, state, mass_per_length_kg_m, count, times * n, components);
        for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += weight * f[i];
      }
      return sum;
    };
    const auto coarse = extrapolated(20), fine = extrapolated(30);
    for (std::size_t i = 0; i < fine.size(); ++i) {
      out.error = std::max(out.error, std::abs(coarse[i] / fine[i] - 1));
    }
    (components == 2 ? out.in_hz : out.out_hz) = fine;
  }
  return out;
}

}  // namespace rigfit::model
