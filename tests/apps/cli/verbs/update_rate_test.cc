// Decays whose files state their step with few digits: one clock, whatever number of files.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "model/scene/read_scene.h"
#include "tests/apps/run_program.h"
#include "tests/scenes.h"

namespace rigfit::apps::update_rate_test {
namespace {

using Json = nlohmann::json;

// A taut string of 2.4 m: f = sqrt(T / m) / 4.8 m.
std::string string_scene() {
  auto scene = model::testing::paper_cable(200, 1e-4);
  scene.gravity.setZero();
  scene.members[0].mass_per_length = 0.16;
  return model::scene_text(scene);
}

// A decay of 4 s at 256 Hz, step printed as 0.00391 s: known to 5e-6 / 0.00391 / sqrt(3).
constexpr double kRelative = 5e-6 / 0.00391 / 1.7320508075688772;

std::string decay_file(double frequency_hz) {
  std::string text =
      "LabVIEW Measurement\t\nWriter_Version\t2\nSeparator\tTab\nDecimal_Separator\t.\n"
      "***End_of_Header***\t\n\nChannels\t1\nY_Unit_Label\tm/s^2\nX_Dimension\tTime\nX0\t0\n"
      "Delta_X\t0.00391\n***End_of_Header***\t\nX_Value\ttip\n";
  unsigned state = 12345;
  for (int i = 0; i < 1024; ++i) {
    const double t = i / 256.0;
    state = state * 1664525u + 1013904223u;
    const double noise = 1e-3 * (state / 4294967296.0 - 0.5);
    char row[40];
    std::snprintf(row, sizeof row, "\t%.6f\n",
                  std::exp(-0.5 * t) * std::cos(2 * M_PI * frequency_hz * t) + noise);
    text += row;
  }
  return text;
}

TEST(UpdateVerb, ARoundedSampleRateIsOneSourceOfAllDecays) {
  const TemporaryFolder folder;
  const auto scene = folder.write("scene.toml", string_scene());
  const auto a = folder.write("a.lvm", decay_file(std::sqrt(100 / 0.16) / 4.8));
  const auto b = folder.write("b.lvm", decay_file(std::sqrt(200 / 0.16) / 4.8));
  const auto fit = [&](const std::string& data) {
    double part = 0;
    const Json json =
        document_of("update {} --free cable.mass_per_length --starts 1 --out {} " + data,
                    {scene, folder.at("new.toml")});
    for (const auto& term : json["parameters"][0]["budget"]) {
      if (term["source"] == "sample rate") part = term["std"];
    }
    return part;
  };
  const double one = fit("--decay " + b + " --tension 200");
  const double two = fit("--decay " + a + " " + b + " --tension 100 200");
  EXPECT_NEAR(one, 2 * kRelative * 0.16, 0.02 * one);
  EXPECT_NEAR(two, one, 0.02 * one);
}

}  // namespace
}  // namespace rigfit::apps::update_rate_test
