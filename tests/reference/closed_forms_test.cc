#include "tests/reference/closed_forms.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <stdexcept>

#include "tests/reference/bracketed_root.h"
#include "tests/reference/dense_eigen.h"

namespace rigfit::model::closed_forms_test {
namespace {

using std::numbers::pi;

// A second algorithm for every beam: Rayleigh-Ritz in Hermite cubic elements (the consistent
// mass), which converges as h^4 from above. 160 elements: (beta h)^4/720 below 1e-8 for the first
// four modes; the tolerance of 2e-7 leaves room for the conditioning of K (n^4 times epsilon).
struct Ends {
  bool deflection_0, slope_0, deflection_1, slope_1;  // held?
};
std::vector<double> finite_element_frequencies(const UniformBeam& beam, Ends ends, double tip_mass,
                                               double gravity, int count) {
  const int n = 160;
  const double h = beam.length_m / n, m = beam.mass_per_length_kg_m;
  Eigen::MatrixXd K = Eigen::MatrixXd::Zero(2 * n + 2, 2 * n + 2), M = K;
  for (int e = 0; e < n; ++e) {
    // Standing on x = 0: compression from the weight above, linear along the element (its
    // mean here: midpoint errors are h^2 of the weight's share and vanish in the comparison below).
    const double above = beam.length_m - (e + 0.5) * h;
    const double T = beam.tension_N - gravity * (m * above + tip_mass);
    Eigen::Matrix4d k, g, c;
    k << 12, 6 * h, -12, 6 * h, 6 * h, 4 * h * h, -6 * h, 2 * h * h, -12, -6 * h, 12, -6 * h, 6 * h,
        2 * h * h, -6 * h, 4 * h * h;
    g << 36, 3 * h, -36, 3 * h, 3 * h, 4 * h * h, -3 * h, -h * h, -36, -3 * h, 36, -3 * h, 3 * h,
        -h * h, -3 * h, 4 * h * h;
    c << 156, 22 * h, 54, -13 * h, 22 * h, 4 * h * h, 13 * h, -3 * h * h, 54, 13 * h, 156, -22 * h,
        -13 * h, -3 * h * h, -22 * h, 4 * h * h;
    K.block<4, 4>(2 * e, 2 * e) += beam.EI_Nm2 / (h * h * h) * k + T / (30 * h) * g;
    M.block<4, 4>(2 * e, 2 * e) += m * h / 420 * c;
  }
  M(2 * n, 2 * n) += tip_mass;
  std::vector<int> keep;
  for (int i = 0; i < 2 * n + 2; ++i) {
    const bool held = (i == 0 && ends.deflection_0) || (i == 1 && ends.slope_0) ||
                      (i == 2 * n && ends.deflection_1) || (i == 2 * n + 1 && ends.slope_1);
    if (!held) keep.push_back(i);
  }
  const Eigen::MatrixXd Kf = K(keep, keep), Mf = M(keep, keep);
  // Inverted (M x = mu K x): the low frequencies are then the large eigenvalues, found accurately.
  const Eigen::VectorXd mu = testing::symmetric_eigenvalues(Mf, Kf);
  std::vector<double> result;
  for (int i = 0; i < count; ++i) {
    result.push_back(1 / std::sqrt(mu[Kf.rows() - 1 - i]) / (2 * pi));
  }
  return result;
}

void expect_relative(const std::vector<double>& a, const std::vector<double>& b, double tolerance) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) EXPECT_NEAR(a[i] / b[i], 1, tolerance) << "mode " << i;
}

const UniformBeam kCable{
    .length_m = 2.4, .mass_per_length_kg_m = 0.16667, .EI_Nm2 = 0.5972, .tension_N = 200};
const UniformBeam kBeam{
    .length_m = 0.75, .mass_per_length_kg_m = 0.295, .EI_Nm2 = 2.1, .tension_N = 0};

TEST(BracketedRoot, FindsSimpleAndFlatRoots) {
  EXPECT_NEAR(bracketed_root([](double x) { return std::cos(x); }, 0, 3), pi / 2, 1e-15);
  EXPECT_NEAR(bracketed_root([](double x) { return std::pow(x - 1, 3); }, 0, 5), 1, 1e-5);
  EXPECT_EQ(bracketed_root([](double x) { return x; }, 0, 5), 0);
  // A step: no better than the last bit, but never lost.
  EXPECT_NEAR(bracketed_root([](double x) { return x < 0.3 ? -1.0 : 1e9; }, -1, 1), 0.3, 1e-15);
}

TEST(ClosedForms, PinnedBeamAgreesWithFiniteElements) {
  expect_relative(pinned_beam_frequencies(kCable, 4),
                  finite_element_frequencies(kCable, {true, false, true, false}, 0, 0, 4), 2e-7);
  UniformBeam string = kCable;
  string.EI_Nm2 = 0;
  EXPECT_NEAR(pinned_beam_frequencies(string, 1)[0], std::sqrt(200 / 0.16667) / 4.8, 1e-12);
}

TEST(ClosedForms, ClampedBeamAgreesWithFiniteElementsAndTextbook) {
  expect_relative(clamped_beam_frequencies(kCable, 4),
                  finite_element_frequencies(kCable, {true, true, true, true}, 0, 0, 4), 2e-7);
  // Without tension: cos z cosh z = 1, z = 4.73004074, 7.85320462, 10.99560784 (Blevins).
  const auto f = clamped_beam_frequencies(kBeam, 3);
  const double z[] = {4.73004074, 7.85320462, 10.99560784};
  for (int i = 0; i < 3; ++i) {
    const double expected = z[i] * z[i] / (0.75 * 0.75) * std::sqrt(2.1 / 0.295) / (2 * pi);
    EXPECT_NEAR(f[static_cast<std::size_t>(i)] / expected, 1, 4e-9);  // digits printed
  }
}

TEST(ClosedForms, ClampedBeamTendsToStringWithoutOverflow) {
  // f = f_string (1 + 2 e + O(e^2)), e = sqrt(EI/T)/L: the end correction of a stiff string.
  UniformBeam cable = kCable;
  for (double EI : {1e-6, 1e-10, 1e-18}) {
    cable.EI_Nm2 = EI;
    const double e = std::sqrt(EI / cable.tension_N) / cable.length_m;
    UniformBeam string = cable;
    string.EI_Nm2 = 0;
    const auto f = clamped_beam_frequencies(cable, 3), f0 = pinned_beam_frequencies(string, 3);
    for (std::size_t n = 0; n < 3; ++n) {
      const double k = (n + 1.0) * pi;
      EXPECT_NEAR(f[n] / f0[n], 1 + 2 * e, (4 + k * k) * e * e + 4e-15);
    }
  }
}

TEST(ClosedForms, CantileverAgreesWithFiniteElements) {
  for (double tip : {0.0, 0.02, 0.5, 20.0}) {
    expect_relative(cantilever_frequencies(kBeam, tip, 4),
                    finite_element_frequencies(kBeam, {true, true, false, false}, tip, 0, 4), 2e-7);
  }
  // Rayleigh's limit of a heavy tip: omega^2 = 3 EI / (L^3 (M + 33/140 m L)), error O((m L/M)^2).
  const double M = 1e5, f = cantilever_frequencies(kBeam, M, 1)[0];
  const double expected =
      std::sqrt(3 * 2.1 / (std::pow(0.75, 3) * (M + 33.0 / 140 * 0.295 * 0.75))) / (2 * pi);
  EXPECT_NEAR(f / expected, 1, 1e-10);
}

TEST(ClosedForms, StandingCantilever) {
  // No gravity: the other closed form, by another algorithm.
  for (double tip : {0.0, 0.02, 0.5}) {
    expect_relative(standing_cantilever_frequencies(kBeam, tip, 0, 4),
                    cantilever_frequencies(kBeam, tip, 4), 1e-10);
  }
  // With gravity, finite elements with piecewise constant axial force: its error is
  // gamma (h/L)^2/12 of the weight's small share, below 2e-6 here.
  for (double gravity : {9.80665, -9.80665}) {
    expect_relative(standing_cantilever_frequencies(kBeam, 0.02, gravity, 4),
                    finite_element_frequencies(kBeam, {true, true, false, false}, 0.02, gravity, 4),
                    2e-6);
  }
  // Greenhill: buckles at m g L^3/EI = 7.8373.
  UniformBeam column = kBeam;
  const double g = 9.80665;
  column.EI_Nm2 = column.mass_per_length_kg_m * g * std::pow(column.length_m, 3) / 7.8373;
  const double critical = column.EI_Nm2;
  column.EI_Nm2 = critical * 1.0001;
  const double slow = standing_cantilever_frequencies(column, 0, g, 1)[0];
  EXPECT_LT(slow, 0.02 * cantilever_frequencies(column, 0, 1)[0]);
  column.EI_Nm2 = critical * 0.9999;
  EXPECT_THROW((void)standing_cantilever_frequencies(column, 0, g, 1), std::invalid_argument);
}

TEST(ClosedForms, IrvineLimitsAndCrossover) {
  SaggingCable cable{
      .span_m = 2.4, .mass_per_length_kg_m = 0.16667, .EA_N = 221780, .tension_N = 200};
  const double string = std::sqrt(200 / 0.16667) / 4.8;
  // The taut limit, the inextensible one (tan u = u: u = 4.49340946), and the crossover at 4 pi^2.
  cable.gravity_m_s2 = 0;
  EXPECT_NEAR(irvine_symmetric_frequencies(cable, 1)[0], string, 1e-12);
  cable.gravity_m_s2 = 9.80665;
  EXPECT_GT(irvine_symmetric_frequencies(cable, 1)[0], string);
  SaggingCable rigid = cable;
  rigid.EA_N = 1e15;
  EXPECT_NEAR(irvine_symmetric_frequencies(rigid, 1)[0] / (2 * 4.4934094579 / pi * string), 1,
              1e-6);  // lambda^2 = 4e8: relative distance of order 10/lambda^2
  SaggingCable crossing = cable;
  crossing.EA_N *= 4 * pi * pi / irvine_parameter(cable);
  EXPECT_NEAR(irvine_symmetric_frequencies(crossing, 1)[0] /
                  irvine_antisymmetric_frequencies(crossing, 1)[0],
              1, 1e-12);
  EXPECT_NEAR(irvine_out_of_plane_frequencies(cable, 3)[2], 3 * string, 1e-12);
  // Galerkin on sines, the second algorithm: K = (H (k pi/L)^2 L/2) + (EA/Le) (w'' int phi)^2.
  const int n = 200;
  Eigen::MatrixXd K = Eigen::MatrixXd::Zero(n, n);
  const double L = 2.4, H = 200, m = 0.16667, w = m * 9.80665;
  const double Le = L * (1 + std::pow(w * L / H, 2) / 8);
  for (int i = 0; i < n; ++i) {
    const double ki = (2 * i + 1) * pi / L;
    K(i, i) += H * ki * ki / m;
    for (int j = 0; j < n; ++j) {
      const double kj = (2 * j + 1) * pi / L;
      K(i, j) += cable.EA_N / Le * std::pow(w / H, 2) * (2 / ki) * (2 / kj) * 2 / (m * L);
    }
  }
  const Eigen::VectorXd values = testing::symmetric_eigenvalues(K);
  const auto f = irvine_symmetric_frequencies(cable, 3);
  // The truncated rest of the sum over 1/k^4 is of order 1/n^3.
  for (int i = 0; i < 3; ++i) {
    EXPECT_NEAR(std::sqrt(values(i)) / (2 * pi) / f[static_cast<std::size_t>(i)], 1, 1e-6);
  }
}

TEST(ClosedForms, CatenaryMeetsItsEnds) {
  for (double rise : {0.0, 1.5, -7.0}) {
    for (double tension : {0.5, 5.0, 200.0, 1e4}) {
      for (double EA : {2e3, 2e5, 2e7}) {
        const ElasticCatenary cable{
            .span_m = 2.4, .rise_m = rise, .weight_per_length_N_m = 1.634, .EA_N = EA};
        const CatenaryState state = catenary_of_tension(cable, tension);
        const Eigen::Vector2d end = catenary_point(cable, state, state.unstretched_length_m);
        EXPECT_NEAR(end.x(), 2.4, 1e-11) << rise << ' ' << tension << ' ' << EA;
        EXPECT_NEAR(end.y(), rise, 1e-10) << rise << ' ' << tension << ' ' << EA;
        const CatenaryState again = catenary_of_length(cable, state.unstretched_length_m);
        // Length to tension is as badly conditioned as the cable is stiff: EA/H.
        EXPECT_NEAR(again.tension_N / tension, 1, 1e-13 * (10 + EA / tension));
      }
    }
  }
}

TEST(ClosedForms, CatenaryIsInEquilibriumEverywhere) {
  // Along the profile: H y' = V(s) and the stretched length of ds is (1 + T/EA) ds; differences of
  // second order, h = 1e-5 L: error h^2 times third derivatives of order one.
  const ElasticCatenary cable{
      .span_m = 2.4, .rise_m = 0.7, .weight_per_length_N_m = 1.634, .EA_N = 300};
  const CatenaryState state = catenary_of_tension(cable, 3.0);
  double lowest = 0;
  for (int i = 1; i < 200; ++i) {
    const double s = state.unstretched_length_m * i / 200, h = 1e-5;
    const Eigen::Vector2d t =
        (catenary_point(cable, state, s + h) - catenary_point(cable, state, s - h)) / (2 * h);
    const double V = state.vertical_N - 1.634 * s;
    EXPECT_NEAR(t.y() / t.x(), -V / 3.0, 1e-8);
    EXPECT_NEAR(t.norm(), 1 + std::hypot(3.0, V) / 300, 1e-8);
    const Eigen::Vector2d p = catenary_point(cable, state, s);
    lowest = std::max(lowest, 0.7 * p.x() / 2.4 - p.y());
  }
  EXPECT_NEAR(state.sag_m, lowest, 1e-4 * lowest);  // 200 points: (1/200)^2 of the sag
  // Small sag: w L^2 / (8 H).
  const ElasticCatenary taut{
      .span_m = 2.4, .rise_m = 0, .weight_per_length_N_m = 1.634, .EA_N = 221780};
  EXPECT_NEAR(catenary_of_tension(taut, 200).sag_m, 1.634 * 2.4 * 2.4 / 1600, 1e-5);
}

TEST(ClosedForms, RefusesNonsense) {
  EXPECT_THROW((void)pinned_beam_frequencies({}, 1), std::invalid_argument);
  EXPECT_THROW((void)cantilever_frequencies(kCable, 0, 1), std::invalid_argument);
  EXPECT_THROW((void)cantilever_frequencies(kBeam, -1, 1), std::invalid_argument);
  EXPECT_THROW((void)irvine_parameter({}), std::invalid_argument);
  EXPECT_THROW((void)catenary_of_tension({}, 1), std::invalid_argument);
  EXPECT_THROW((void)standing_cantilever_frequencies(kBeam, 0, 0, 9), std::invalid_argument);
}

}  // namespace
}  // namespace rigfit::model::closed_forms_test
