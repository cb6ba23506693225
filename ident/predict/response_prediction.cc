#include "ident/predict/response_prediction.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <random>
#include <utility>

namespace rigfit::ident {
namespace {

constexpr int kFewestDraws = 40;  // the 2.5 % quantile then lies inside of the draws

double quantile_of_sorted(const std::vector<double>& values, double probability) {
  const double at = probability * static_cast<double>(values.size() - 1);
  const auto k = static_cast<std::size_t>(at);
  const double next = values[std::min(k + 1, values.size() - 1)];
  return values[k] + (at - static_cast<double>(k)) * (next - values[k]);
}

}  // namespace

ResponsePrediction predict_response(const model::Scene& scene, const FittedParameters& fitted,
                                    const ResponsePredictionOptions& options) {
  ResponsePrediction prediction;
  prediction.response = model::simulate_response(
      scene_with(scene, fitted, prediction.used, prediction.not_used), options.response);
  if (!prediction.response.completed) return prediction;
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(fitted.covariance);
  const Eigen::MatrixXd directions =
      eigen.eigenvectors() * eigen.eigenvalues().cwiseMax(0).cwiseSqrt().asDiagonal();
  auto wanted = options.response;
  wanted.solver = prediction.response.solver;
  std::mt19937_64 random(options.seed);
  std::normal_distribution<double> normal;
  std::vector<Eigen::MatrixXd> drawn;
  drawn.reserve(static_cast<std::size_t>(options.samples));
  std::vector<std::string> used, not_used;
  for (int s = 0; s < options.samples; ++s) {
    Eigen::VectorXd unit(directions.cols());
    for (auto& value : unit) value = normal(random);
    const Eigen::VectorXd change = directions * unit;
    auto moved = fitted;
    for (std::size_t i = 0; i < moved.parameters.size(); ++i) {
      double& value = moved.parameters[i].value;
      const double by = change[static_cast<Eigen::Index>(i)];
      value = value > 0 ? value * std::exp(by / value) : value + by;
    }
    auto one = model::simulate_response(scene_with(scene, moved, used, not_used), wanted);
    if (one.completed && one.samples.rows() == prediction.response.samples.rows() &&
        one.samples.allFinite()) {
      drawn.push_back(std::move(one.samples));
    }
  }
  prediction.samples = static_cast<int>(drawn.size());
  if (prediction.samples < kFewestDraws) return prediction;
  const auto& at_fit = prediction.response.samples;
  prediction.low.resizeLike(at_fit);
  prediction.high.resizeLike(at_fit);
  std::vector<double> values(drawn.size());
  for (Eigen::Index column = 0; column < at_fit.cols(); ++column) {
    for (Eigen::Index row = 0; row < at_fit.rows(); ++row) {
      std::transform(drawn.begin(), drawn.end(), values.begin(),
                     [&](const auto& matrix) { return matrix(row, column); });
      std::sort(values.begin(), values.end());
      prediction.low(row, column) = quantile_of_sorted(values, 0.025);
      prediction.high(row, column) = quantile_of_sorted(values, 0.975);
    }
  }
  return prediction;
}

}  // namespace rigfit::ident
