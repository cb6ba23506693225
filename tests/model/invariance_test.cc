// Results must not depend on the way a rig is written down: the units of length and time, a
// member's direction, left and right, the compass, the order of things. Each rewriting must leave
// every FRF from a load to a sensor as it is, and with it equilibrium, modes and damping.
//
// Tolerance: equilibria balance to about 1e-10 of the largest force, which changes stiffnesses by
// as much; a resonance of damping ratio 0.01 multiplies that by 1 / (2 x 0.01). 1e-7 of an FRF's
// largest value leaves a factor of twenty.
#include "model/frfs/frf_synthesis.h"
#include "model/response/response.h"
#include "tests/scenes.h"
#include "tests/test.h"

namespace rigfit::model::invariance_test {

constexpr double kTolerance = 1e-7;

Load at(std::string name, Place place, const Eigen::Vector3d& direction) {
  return testing::impact(std::move(place), direction.normalized(), 0.5, 0.004, std::move(name));
}

/// An inclined cable with a mass on it, held by springs at one end, rigidly at the other.
Scene inclined_cable() {
  Scene scene = testing::paper_cable(80, 0.6, 12);
  scene.nodes[1].position << 2.0, 0.7, 0.4;
  scene.nodes[0].support.kind = Support::Kind::elastic;
  scene.nodes[0].support.translational << 2e5, 3e5, 2e5;  // alike in every horizontal direction
  scene.nodes[0].support.rotational << 20, 30, 20;
  scene.nodes[1].support.kind = Support::Kind::clamped;
  Member& cable = scene.members[0];
  cable.masses = {{0.3, 0.02}};
  cable.joint = {Member::Joint::pinned, Member::Joint::rigid};
  cable.damping = {50, 2e-3, 1e-4};
  scene.loads = {at("low", {"", "cable", 0.2}, {0.3, -1, 0.2}),
                 at("high", {"", "cable", 0.7}, {0.1, 0.5, 1})};
  return scene;
}

/// The paper's rig with cables of unequal length and tension that pull the beam aside.
Scene lopsided_rig() {
  Scene scene = testing::cable_beam_rig(200, 0.6, 8);
  scene.members[0].EI = {2.1, 2.1};
  scene.nodes[3].position << 1.0, 0.7, 0.1;
  scene.members[2].tension = 190;
  for (auto& member : scene.members) member.damping_ratio = 0.01;
  scene.loads = {at("beam", {"", scene.members[0].name, 0.8}, {1, 0, 0.3}),
                 at("cable", {"", "left cable", 0.25}, {0, -1, 0.5}),
                 at("tip", {"tip", "", 0}, {0.2, 0.1, 1})};
  return scene;
}

/// A tapered pole with a cable from its top to the ground.
Scene stayed_pole() {
  Scene scene = testing::vertical_beam(4, 3e3, 5, 8);
  scene.members[0].EA = 1e8;
  scene.members[0].taper = 0.6;
  scene.nodes.push_back(testing::node("ground", {3, 0, 1}, Support::Kind::pinned));
  scene.nodes[1].mass = 0.5;
  Member stay = testing::paper_cable(150, 0.6, 8).members[0];
  stay.nodes = {"ground", scene.members[0].nodes[1]};
  stay.assembled = Member::Assembled::straight;
  scene.members.push_back(stay);
  for (auto& member : scene.members) member.damping_ratio = 0.01;
  scene.loads = {at("pole", {"", scene.members[0].name, 0.5}, {1, 0, 0.4}),
                 at("stay", {"", "cable", 0.4}, {0, 1, 1})};
  return scene;
}

/// A displacement sensor at the place and in the direction of every load.
Scene with_sensors(Scene scene) {
  scene.sensors.clear();
  for (const auto& load : scene.loads) {
    scene.sensors.push_back(
        {load.name, load.place, load.direction, Sensor::Quantity::displacement});
  }
  return scene;
}

struct Rig {
  const char* name;
  Scene (*scene)();
  double highest_hz;
};

class Invariance : public ::testing::TestWithParam<Rig> {
 protected:
  void SetUp() override {
    scene_ = with_sensors(GetParam().scene());
    lines_ = Eigen::VectorXd::LinSpaced(60, 0.02, 1) * GetParam().highest_hz;
    expected_ = frfs(scene_, lines_);
    // A test of nothing but quasi-static lines would prove little.
    double largest = 0;
    for (const auto& H : expected_) largest = std::max(largest, H.cwiseAbs().maxCoeff());
    ASSERT_GT(largest, 3 * expected_.front().cwiseAbs().maxCoeff());
  }

  static std::vector<Eigen::MatrixXcd> frfs(const Scene& scene, const Eigen::VectorXd& lines) {
    const auto result = synthesize_frfs(scene, lines);
    EXPECT_EQ(result.equilibrium.status, EquilibriumStatus::converged) << result.equilibrium.reason;
    return result.H;
  }

  /// `factor`: what the rewriting's units make of a metre per newton.
  void expect_same(const std::vector<Eigen::MatrixXcd>& found, double factor = 1) const {
    ASSERT_EQ(found.size(), expected_.size());
    Eigen::MatrixXd largest = Eigen::MatrixXd::Zero(expected_[0].rows(), expected_[0].cols());
    for (const auto& H : expected_) largest = largest.cwiseMax(H.cwiseAbs());
    for (std::size_t k = 0; k < found.size(); ++k) {
      const Eigen::MatrixXd error = (found[k] / factor - expected_[k]).cwiseAbs();
      ASSERT_TRUE((error.array() <= kTolerance * largest.array()).all())
          << lines_[k] << " Hz, error over largest\n"
          << error.cwiseQuotient(largest);
    }
  }

  Scene scene_;
  Eigen::VectorXd lines_;
  std::vector<Eigen::MatrixXcd> expected_;
};

// Millimetres and milliseconds in the place of metres and seconds: a newton is 1e-3 kg mm/ms^2.
TEST_P(Invariance, OfUnits) {
  constexpr double kLength = 1e3, kTime = 1e3, kForce = kLength / (kTime * kTime);
  Scene scene = scene_;
  scene.gravity *= kLength / (kTime * kTime);
  for (auto& node : scene.nodes) {
    node.position *= kLength;
    node.support.translational *= kForce / kLength;
    node.support.rotational *= kForce * kLength;
  }
  for (auto& member : scene.members) {
    member.mass_per_length /= kLength;
    member.EA *= kForce;
    for (auto& EI : member.EI) EI *= kForce * kLength * kLength;
    member.GJ *= kForce * kLength * kLength;
    member.polar_inertia *= kLength;
    if (member.tension) *member.tension *= kForce;
    member.damping.axial *= kForce * kTime;
    member.damping.bending *= kForce * kLength * kLength * kTime;
    member.damping.torsion *= kForce * kLength * kLength * kTime;
  }
  expect_same(frfs(scene, lines_ / kTime), kLength / kForce);
}

TEST_P(Invariance, OfTheDirectionOfMembers) {
  Scene scene = scene_;
  for (auto& member : scene.members) {
    std::swap(member.nodes[0], member.nodes[1]);
    std::swap(member.joint[0], member.joint[1]);
    for (auto& mass : member.masses) mass.position = 1 - mass.position;
    // Values are those at the first node.
    const double area = member.taper * member.taper;
    member.mass_per_length *= area;
    member.EA *= area;
    for (auto& EI : member.EI) EI *= area * area;
    member.GJ *= area * area;
    member.polar_inertia *= area * area;
    member.taper = 1 / member.taper;
  }
  for (auto& load : scene.loads) load.place.position = 1 - load.place.position;
  expect_same(frfs(with_sensors(scene), lines_));
}

TEST_P(Invariance, OfLeftAndRight) {
  for (const int axis : {0, 2}) {
    Scene scene = scene_;
    for (auto& node : scene.nodes) node.position[axis] *= -1;
    for (auto& load : scene.loads) load.direction[axis] *= -1;
    expect_same(frfs(with_sensors(scene), lines_));
  }
}

TEST_P(Invariance, OfTheCompass) {
  for (const double angle : {0.5, 2.0, kPi / 2}) {
    const Eigen::Matrix3d turn =
        Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitY()).toRotationMatrix();
    Scene scene = scene_;
    for (auto& node : scene.nodes) node.position = turn * node.position;
    for (auto& load : scene.loads) load.direction = turn * load.direction;
    expect_same(frfs(with_sensors(scene), lines_));
  }
}

TEST_P(Invariance, OfOrder) {
  Scene scene = scene_;
  std::reverse(scene.nodes.begin(), scene.nodes.end());
  std::reverse(scene.members.begin(), scene.members.end());
  std::reverse(scene.loads.begin(), scene.loads.end());
  auto found = frfs(with_sensors(scene), lines_);
  for (auto& H : found) H = H.reverse().eval();
  expect_same(found);
}

// Maxwell and Betti: what a force here does there, it does here from there.
TEST_P(Invariance, OfStruckAndMeasured) {
  auto found = expected_;
  for (auto& H : found) H.transposeInPlace();
  expect_same(found);
}

// What a load puts in is what moves, is stored or is dissipated: within the accuracy that the scene
// asks for, while it rings (backward differentiation, taken where nodes turn in space, damps).
TEST_P(Invariance, OfEnergy) {
  Scene scene = scene_;
  scene.loads.resize(1);
  ResponseOptions options{.sampling = {.duration_s = 0.1}};
  options.sampling.rate_hz = 1000;
  options.solver = ResponseSolver::explicit_motion;
  auto response = simulate_response(scene, options);
  if (response.impossible) {
    options.solver = ResponseSolver::stiff_motion;
    response = simulate_response(scene, options);
  }
  ASSERT_TRUE(response.completed) << response.reason;
  EXPECT_LT(std::abs(response.energy_drift), scene.accuracy) << name_of(response.solver);
  EXPECT_TRUE(response.samples.allFinite());
}

INSTANTIATE_TEST_SUITE_P(Rigs, Invariance,
                         ::testing::Values(Rig{"InclinedCable", inclined_cable, 25},
                                           Rig{"LopsidedRig", lopsided_rig, 60},
                                           Rig{"StayedPole", stayed_pole, 40}),
                         [](const auto& rig) { return std::string(rig.param.name); });

}  // namespace rigfit::model::invariance_test
