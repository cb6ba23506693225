#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "model/scene/read_scene.h"

namespace rigfit::model::scene_text_test {
namespace {

// Numbers are written in their shortest exact form, so every value must come back to the last bit.
TEST(SceneText, ReadsBackToTheSameScene) {
  Scene scene;
  scene.title = "a \"quoted\" title \\ with\ttabs, \xc3\xa4 and\nlines";
  scene.gravity = {0.1, -9.7, 1.0 / 3};
  scene.accuracy = 1e-6;
  SceneNode a, b, c;
  a.name = "a";
  a.support.kind = Support::Kind::clamped;
  b.name = "b \"2\"";
  b.position = {1.0 / 3, 2e-17, -1e6};
  b.mass = 0.02;
  c.name = "c";
  c.position = {2, 0, 0};
  c.support.kind = Support::Kind::elastic;
  c.support.translational = {1e5, std::numeric_limits<double>::infinity(), 0};
  c.support.rotational = {0, 1e-3, 7};
  scene.nodes = {a, b, c};
  Member cable;
  cable.name = "cable";
  cable.nodes = {"a", "b \"2\""};
  cable.segments = 30;
  cable.mass_per_length = 0.16667;
  cable.EA = 221780;
  cable.EI = {0.1 + 0.2, 0.1 + 0.2};
  cable.GJ = 0.1;
  cable.polar_inertia = 1e-9;
  cable.stretch = 1e-3;
  cable.assembled = Member::Assembled::straight;
  cable.joint = {Member::Joint::pinned, Member::Joint::rigid};
  cable.damping_ratio = 0.0;
  cable.masses = {{0.25, 0.003}, {1.0, 1e-3}};
  Member beam = cable;
  beam.name = "beam";
  beam.kind = Member::Kind::beam;
  beam.nodes = {"b \"2\"", "c"};
  beam.segments = 0;
  beam.stretch.reset();
  beam.EI = {2.1, 3.3};
  beam.taper = 0.7;
  beam.damping_ratio.reset();
  beam.damping = {1.5, 0.01, 1e-4};
  scene.members = {cable, beam};
  Load impact;
  impact.name = "hit";
  impact.place.member = "beam";
  impact.place.position = 0.8;
  impact.direction = Eigen::Vector3d(1, 2, 3).normalized();
  impact.peak = 80;
  impact.duration = 0.002;
  impact.start = 0.5;
  Load release;
  release.name = "drop";
  release.kind = Load::Kind::release;
  release.place.node = "b \"2\"";
  release.mass = 0.2;
  release.direction = scene.gravity.normalized();
  scene.loads = {impact, release};
  for (const auto quantity : {Sensor::Quantity::acceleration, Sensor::Quantity::velocity,
                              Sensor::Quantity::displacement, Sensor::Quantity::force}) {
    Sensor sensor;
    sensor.name = "s" + std::to_string(scene.sensors.size());
    sensor.place.member = "cable";
    sensor.place.position = 0.5;
    sensor.quantity = quantity;
    scene.sensors.push_back(sensor);
  }

  const Scene back = parse_scene(scene_text(scene), "");
  EXPECT_EQ(back.title, scene.title);
  EXPECT_EQ(back.gravity, scene.gravity);
  EXPECT_EQ(back.accuracy, scene.accuracy);
  ASSERT_EQ(back.nodes.size(), scene.nodes.size());
  for (std::size_t i = 0; i < scene.nodes.size(); ++i) {
    EXPECT_EQ(back.nodes[i].name, scene.nodes[i].name);
    EXPECT_EQ(back.nodes[i].position, scene.nodes[i].position);
    EXPECT_EQ(back.nodes[i].support.kind, scene.nodes[i].support.kind);
    EXPECT_EQ(back.nodes[i].support.translational, scene.nodes[i].support.translational);
    EXPECT_EQ(back.nodes[i].support.rotational, scene.nodes[i].support.rotational);
    EXPECT_EQ(back.nodes[i].mass, scene.nodes[i].mass);
  }
  ASSERT_EQ(back.members.size(), scene.members.size());
  for (std::size_t i = 0; i < scene.members.size(); ++i) {
    const Member &x = back.members[i], &y = scene.members[i];
    EXPECT_EQ(x.name, y.name);
    EXPECT_EQ(x.kind, y.kind);
    EXPECT_EQ(x.nodes, y.nodes);
    EXPECT_EQ(x.segments, y.segments);
    EXPECT_EQ(x.mass_per_length, y.mass_per_length);
    EXPECT_EQ(x.EA, y.EA);
    EXPECT_EQ(x.EI, y.EI);
    EXPECT_EQ(x.GJ, y.GJ);
    EXPECT_EQ(x.polar_inertia, y.polar_inertia);
    EXPECT_EQ(x.taper, y.taper);
    EXPECT_EQ(x.tension, y.tension);
    EXPECT_EQ(x.unstretched_length, y.unstretched_length);
    EXPECT_EQ(x.stretch, y.stretch);
    EXPECT_EQ(x.assembled, y.assembled);
    EXPECT_EQ(x.joint, y.joint);
    EXPECT_EQ(x.damping_ratio, y.damping_ratio);
    EXPECT_EQ(x.damping.axial, y.damping.axial);
    EXPECT_EQ(x.damping.bending, y.damping.bending);
    EXPECT_EQ(x.damping.torsion, y.damping.torsion);
    ASSERT_EQ(x.masses.size(), y.masses.size());
    for (std::size_t k = 0; k < x.masses.size(); ++k) {
      EXPECT_EQ(x.masses[k].position, y.masses[k].position);
      EXPECT_EQ(x.masses[k].mass, y.masses[k].mass);
    }
  }
  ASSERT_EQ(back.loads.size(), scene.loads.size());
  for (std::size_t i = 0; i < scene.loads.size(); ++i) {
    const Load &x = back.loads[i], &y = scene.loads[i];
    EXPECT_EQ(x.name, y.name);
    EXPECT_EQ(x.kind, y.kind);
    EXPECT_EQ(x.place.node, y.place.node);
    EXPECT_EQ(x.place.member, y.place.member);
    EXPECT_EQ(x.place.position, y.place.position);
    EXPECT_EQ(x.direction, y.direction);
    EXPECT_EQ(x.peak, y.peak);
    EXPECT_EQ(x.duration, y.duration);
    EXPECT_EQ(x.start, y.start);
    EXPECT_EQ(x.mass, y.mass);
  }
  ASSERT_EQ(back.sensors.size(), scene.sensors.size());
  for (std::size_t i = 0; i < scene.sensors.size(); ++i) {
    EXPECT_EQ(back.sensors[i].quantity, scene.sensors[i].quantity);
    EXPECT_EQ(back.sensors[i].direction, scene.sensors[i].direction);
  }
  EXPECT_EQ(scene_text(back), scene_text(scene));
}

}  // namespace
}  // namespace rigfit::model::scene_text_test
