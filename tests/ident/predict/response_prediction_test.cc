#include "ident/predict/scene_prediction.h"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>
#include <string>

#include "model/linear/modal_analysis.h"

namespace rigfit::ident::response_prediction_test {
namespace {

/// A standing cantilever, struck at its tip.
model::Scene cantilever() {
  model::Scene scene;
  scene.nodes.resize(2);
  scene.nodes[0].name = "foot";
  scene.nodes[0].support.kind = model::Support::Kind::clamped;
  scene.nodes[1].name = "tip";
  scene.nodes[1].position = {0, 1, 0};
  model::Member beam;
  beam.name = "beam";
  beam.kind = model::Member::Kind::beam;
  beam.nodes = {"foot", "tip"};
  beam.mass_per_length = 0.5;
  beam.EA = 1e6;
  beam.EI = {10, 10};
  beam.GJ = 10;
  scene.members.push_back(beam);
  model::Load hit;
  hit.name = "hammer";
  hit.kind = model::Load::Kind::impact;
  hit.place.node = "tip";
  hit.direction = {1, 0, 0};
  hit.peak = 1;
  hit.duration = 0.005;
  scene.loads.push_back(hit);
  model::Sensor sensor;
  sensor.name = "tip";
  sensor.place.node = "tip";
  sensor.direction = {1, 0, 0};
  sensor.quantity = model::Sensor::Quantity::displacement;
  scene.sensors.push_back(sensor);
  return scene;
}

TEST(ResponsePrediction, TheIntervalHoldsAndOpensWithTime) {
  // EI known to 2 %, the truth one standard uncertainty off: at most some instants are outside, and
  // the interval widens as the phase runs away.
  const auto scene = cantilever();
  FittedParameters fitted;
  fitted.parameters = {{"beam.EI", 10}};
  fitted.covariance = Eigen::MatrixXd::Constant(1, 1, 0.04);
  ResponsePredictionOptions options;
  options.response.sampling.duration_s = 2;
  options.response.sampling.rate_hz = 200;
  options.response.segments = 10;
  options.samples = 60;
  const auto predicted = predict_response(scene, fitted, options);
  ASSERT_TRUE(predicted.response.completed) << predicted.response.reason;
  ASSERT_EQ(predicted.samples, 60);
  auto truth = scene;
  truth.members[0].EI = {10.2, 10.2};
  const auto measured = model::simulate_response(truth, options.response);
  ASSERT_TRUE(measured.completed);
  const auto n = measured.samples.rows();
  ASSERT_EQ(predicted.low.rows(), n);
  int outside = 0;
  for (Eigen::Index i = 0; i < n; ++i) {
    outside += measured.samples(i, 0) < predicted.low(i, 0) ||
               measured.samples(i, 0) > predicted.high(i, 0);
  }
  // One standard uncertainty is within the 2.5 % quantiles but where all draws cross.
  EXPECT_LT(outside, n / 10);
  const Eigen::ArrayXd width = predicted.high.col(0) - predicted.low.col(0);
  EXPECT_GT(width.tail(n / 4).mean(), 2 * width.head(n / 4).mean());
  EXPECT_LT(width.head(n / 4).mean(), measured.samples.col(0).cwiseAbs().maxCoeff());
}

TEST(ResponsePrediction, RefusesAFitOfOtherParameters) {
  FittedParameters fitted;
  fitted.parameters = {{"cable.EI", 1}};
  fitted.covariance = Eigen::MatrixXd::Constant(1, 1, 0.01);
  EXPECT_THROW((void)predict_response(cantilever(), fitted, {}), std::invalid_argument);
}

}  // namespace
}  // namespace rigfit::ident::response_prediction_test
