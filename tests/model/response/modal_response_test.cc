#include "model/response/modal_response.h"

#include "tests/scenes.h"
#include "tests/test.h"

namespace rigfit::model::modal_response_test {

using Quantity = Sensor::Quantity;

Load impact(double peak, double duration, double start) {
  Load load = testing::impact({}, {0, -1, 0}, peak, duration);
  load.start = start;
  return load;
}

Load record() { return {.kind = Load::Kind::record}; }

// Classical Runge-Kutta on q'' = -2 zeta w q' - w^2 q + phi f(t), restarted at the corners of the
// force; with 400 steps a radian (more when heavily damped) its error is (1/400)^4/120 a radian,
// 1e-11 over these responses.
struct Oscillator {
  double omega, zeta, phi;
};
std::array<double, 2> integrate(const Oscillator& o, const LoadForce& force, double q0, double to) {
  std::array<double, 2> y{q0, 0};
  std::vector<double> corners = force.corners();
  corners.push_back(to);
  double t = 0;
  for (double corner : corners) {
    const double end = std::min(to, corner);
    if (end <= t) continue;
    const int steps = 10 + static_cast<int>(400 * o.omega * (1 + o.zeta) * (end - t));
    const double h = (end - t) / steps;
    const auto slope = [&](double at, std::array<double, 2> s) {
      return std::array{
          s[1], -2 * o.zeta * o.omega * s[1] - o.omega * o.omega * s[0] + o.phi * force.at(at)};
    };
    const auto moved = [](std::array<double, 2> s, double f, std::array<double, 2> d) {
      return std::array{s[0] + f * d[0], s[1] + f * d[1]};
    };
    for (int i = 0; i < steps; ++i) {
      const double at = t + i * h;
      const auto k1 = slope(at, y), k2 = slope(at + h / 2, moved(y, h / 2, k1));
      const auto k3 = slope(at + h / 2, moved(y, h / 2, k2)), k4 = slope(at + h, moved(y, h, k3));
      for (std::size_t c = 0; c < 2; ++c) y[c] += h / 6 * (k1[c] + 2 * k2[c] + 2 * k3[c] + k4[c]);
    }
    t = end;
  }
  return y;
}

PoleModel one_mode(const Oscillator& o, double q0, Index sensors) {
  return pole_model(Eigen::VectorXd::Constant(1, o.omega), Eigen::VectorXd::Constant(1, o.zeta),
                    Eigen::MatrixXd::Constant(1, 1, o.phi), Eigen::MatrixXd::Ones(sensors, 1),
                    Eigen::VectorXd::Constant(1, q0));
}

class ModalResponseDamping : public ::testing::TestWithParam<double> {};

TEST_P(ModalResponseDamping, AgreesWithRungeKuttaAndItsOwnEquation) {
  const Oscillator o{46, GetParam(), 0.7};
  // The pulse begins and ends between samples and is shorter than one.
  const LoadForce force{impact(100, 0.0021, 0.0333)};
  const double h = 0.005, q0 = 0.02;
  const PoleModel model = one_mode(o, q0, 3);
  const Eigen::MatrixXd y = modal_response(
      model, {Quantity::displacement, Quantity::velocity, Quantity::acceleration}, {force}, h, 60);
  for (int n = 0; n < 60; ++n) {
    const auto truth = integrate(o, force, q0, n * h);
    // Near zeta = 1 the two poles cancel: 1e-16 / 1.4e-4, and zeta itself is moved by 1e-8.
    const double tolerance = std::abs(o.zeta - 1) < 1e-6 ? 1e-8 : 2e-11;
    EXPECT_NEAR(y(n, 0), truth[0], tolerance) << n;
    EXPECT_NEAR(y(n, 1), truth[1], tolerance * o.omega) << n;
    EXPECT_NEAR(
        y(n, 2),
        o.phi * force.at(n * h) - 2 * o.zeta * o.omega * y(n, 1) - o.omega * o.omega * y(n, 0),
        tolerance * o.omega * o.omega)
        << n;
  }
}

INSTANTIATE_TEST_SUITE_P(FromFreeToHeavy, ModalResponseDamping,
                         ::testing::Values(0.0, 0.005, 0.7, 0.999, 1.0, 1.5, 30.0));

TEST(ModalResponse, PulseInResonanceIsExact) {
  // omega = pi / duration: sin(w t) drives its own frequency, q = (sin wt - wt cos wt)/(2 w^2).
  const double w = 50, D = kPi / w;
  const PoleModel model = one_mode({w, 0, 1}, 0, 1);
  const Eigen::MatrixXd y =
      modal_response(model, {Quantity::displacement}, {{impact(3, D, 0)}}, D / 7, 8);
  for (int n = 0; n < 8; ++n) {
    const double a = w * D / 7 * n;
    EXPECT_NEAR(y(n, 0), 3 * (std::sin(a) - a * std::cos(a)) / (2 * w * w), 1e-15);
  }
}

TEST(ModalResponse, RecordedForceIsExactBetweenItsSamples) {
  ForceHistory history{{0.01, 0.013, 0.02, 0.05}, {0, 5, -2, 0}};
  const LoadForce force{record(), &history};
  const Oscillator o{300, 0.02, 1};
  const PoleModel model = one_mode(o, 0, 1);
  const Eigen::MatrixXd y = modal_response(model, {Quantity::displacement}, {force}, 0.004, 30);
  for (int n = 0; n < 30; ++n) EXPECT_NEAR(y(n, 0), integrate(o, force, 0, 0.004 * n)[0], 1e-13);
}

TEST(ModalResponse, ManyModesAddUpAndLongResponsesStayExact) {
  const Index modes = 60;
  Eigen::VectorXd omega(modes), zeta = Eigen::VectorXd::Constant(modes, 1e-4);
  Eigen::MatrixXd load = Eigen::MatrixXd::Zero(modes, 1), sensor(1, modes);
  Eigen::VectorXd start(modes);
  for (Index r = 0; r < modes; ++r) {
    omega(r) = 46.0 * static_cast<double>(r + 1);
    start(r) = std::cos(1.3 * static_cast<double>(r)) / (1.0 + static_cast<double>(r * r));
    sensor(0, r) = std::sin(0.7 * static_cast<double>(r));
  }
  const PoleModel model = pole_model(omega, zeta, load, sensor, start);
  const Index rows = 20001;
  const double h = 0.0005;
  const Eigen::MatrixXd y =
      modal_response(model, {Quantity::displacement}, {{impact(0, 1, 0)}}, h, rows);
  for (Index n = 0; n < rows; n += 997) {
    double expected = 0;
    const double t = h * static_cast<double>(n);
    for (Index r = 0; r < modes; ++r) {
      const double wd = omega(r) * std::sqrt(1 - 1e-8), decay = std::exp(-1e-4 * omega(r) * t);
      expected += sensor(0, r) * start(r) * decay *
                  (std::cos(wd * t) + 1e-4 * omega(r) / wd * std::sin(wd * t));
    }
    // Phases of up to 2.8e4 rad are known to 4e-12, the recurrence rounds 4096 times.
    EXPECT_NEAR(y(n, 0), expected, 2e-11) << n;
  }
}

TEST(ForceHistory, LoadsOverTime) {
  const Load pulse = impact(10, 0.002, 0.5);
  const LoadForce force{pulse};
  EXPECT_EQ(force.at(0.4999), 0);
  EXPECT_NEAR(force.at(0.501), 10, 1e-12);
  EXPECT_EQ(force.at(0.503), 0);
  EXPECT_NEAR(force.end_s(), 0.502, 1e-15);
  const ForceHistory history{{1, 2, 4}, {0, 3, 1}};
  const Load recorded = record();
  const LoadForce sampled{recorded, &history};
  EXPECT_EQ(sampled.at(0.99), 0);
  EXPECT_NEAR(sampled.at(1.5), 1.5, 1e-15);
  EXPECT_NEAR(sampled.at(3), 2, 1e-15);
  EXPECT_EQ(sampled.at(4), 1);
  EXPECT_EQ(sampled.at(4.01), 0);
}

}  // namespace rigfit::model::modal_response_test
