#include "tests/bench/hard_cases/bar_chain.h"

#include <algorithm>
#include <cmath>

#include "tests/reference/dense_eigen.h"

namespace rigfit::hard_cases {
namespace {

using model::CatenaryState;
using model::ElasticCatenary;

/// Frequencies (Hz) of n bars; `components` 2: in the plane, 1: out of it.
std::vector<double> frequencies_of_bars(const ElasticCatenary& cable, const CatenaryState& state,
                                        double mass, int count, int n, int components) {
  const double l = state.unstretched_length_m / n;
  const Eigen::Index size = components * (n - 1);
  Eigen::MatrixXd K = Eigen::MatrixXd::Zero(size, size), M = K;
  for (int i = 0; i < n; ++i) {
    const Eigen::Vector2d e = model::catenary_point(cable, state, (i + 1) * l) -
                              model::catenary_point(cable, state, i * l);
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
  const Eigen::VectorXd omega2 = model::testing::symmetric_eigenvalues(K, M);
  std::vector<double> out;
  for (int i = 0; i < count; ++i) out.push_back(std::sqrt(omega2[i]) / (2 * M_PI));
  return out;
}

/// From n, 2 n and 3 n bars.
std::vector<double> extrapolated(const ElasticCatenary& cable, const CatenaryState& state,
                                 double mass, int count, int n, int components) {
  const auto a = frequencies_of_bars(cable, state, mass, count, n, components),
             b = frequencies_of_bars(cable, state, mass, count, 2 * n, components),
             c = frequencies_of_bars(cable, state, mass, count, 3 * n, components);
  std::vector<double> out;
  for (std::size_t i = 0; i < a.size(); ++i) {
    out.push_back(a[i] / 24 - b[i] * 16 / 15 + c[i] * 81 / 40);
  }
  return out;
}

}  // namespace

BarFrequencies bar_frequencies(const ElasticCatenary& cable, const CatenaryState& state,
                               double mass_per_length_kg_m, int count) {
  BarFrequencies out;
  for (const int components : {2, 1}) {
    const auto coarse = extrapolated(cable, state, mass_per_length_kg_m, count, 20, components);
    const auto fine = extrapolated(cable, state, mass_per_length_kg_m, count, 30, components);
    for (std::size_t i = 0; i < fine.size(); ++i) {
      out.error = std::max(out.error, std::abs(coarse[i] / fine[i] - 1));
    }
    (components == 2 ? out.in_hz : out.out_hz) = fine;
  }
  return out;
}

}  // namespace rigfit::hard_cases
