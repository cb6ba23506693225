#include "model/scene/read_scene.h"
#include "tests/apps/apps_test.h"
#include "tests/scenes.h"

namespace rigfit::apps::respond_test {

const std::string kScenes = std::string(RIGFIT_TESTDATA) + "/scenes/";

TEST(Respond, ReleaseIsNonlinearAndItsEnergyBalanceCloses) {
  const TemporaryFolder folder;
  const std::string csv = folder.at("y.csv");
  const Document document =
      document_of("respond $/scenes/cable-release.toml --duration 0.5 --rate 2000 --out {}", {csv});
  EXPECT_EQ(document["command"], "respond");
  EXPECT_TRUE(document["nonlinear"].get<bool>());
  EXPECT_EQ(document["solver"], "explicit");
  EXPECT_NEAR(document["frequency_at_rest_hz"], 7.36, 0.01);
  EXPECT_NEAR(document["frequency_moving_hz"], 7.62, 0.03);
  EXPECT_LT(document["energy_drift"].get<double>(), 1e-4);
  EXPECT_GT(document["steps"].get<long>(), 1000);
  EXPECT_EQ(document["inputs"].size(), 1u);
  EXPECT_EQ(document["modelled"]["motion"], "plane");
  EXPECT_THAT(document["warnings"].dump(), Not(HasSubstr("motion_not_linear")));

  std::string header;
  const auto samples = columns(folder.read("y.csv"), &header);
  EXPECT_EQ(header, "Time (s),mid (m/s^2)");
  ASSERT_EQ(samples.size(), 2u);
  ASSERT_EQ(samples[0].size(), 1001u);
  EXPECT_NEAR(samples[0][1000], 0.5, 1e-12);
}

TEST(Respond, SaysWhatItLeftOutAndWhatThatCosts) {
  const TemporaryFolder folder;
  const auto respond = [&](const std::string& line) {
    return document_of("respond " + line + " --duration 0.2 --rate 2000 --out {}",
                       {folder.at("y.csv")});
  };
  const auto cost = [](const Document& document, const std::string& begin) {
    for (const Document& what : document["modelled"]["left_out"]) {
      if (what["what"].get<std::string>().rfind(begin, 0) == 0) {
        return what["relative_error"].get<double>();
      }
    }
    return -1.0;
  };
  // Forced to be linear, the release says that it is not, and by how much the response errs.
  const Document linear = respond("$/scenes/cable-release.toml --solver modal");
  EXPECT_TRUE(linear["nonlinear"].get<bool>());
  EXPECT_THAT(linear["warnings"].dump(),
              AllOf(HasSubstr("motion_not_linear"), HasSubstr("errs by about")));
  EXPECT_GT(cost(linear, "change of stiffness"), 0.01);
  // The linear answer has its energy balance too.
  EXPECT_LT(linear["energy_drift"].get<double>(), 1e-6);
  // Axial waves by need, in full, and slowed to one step a sample.
  const Document full = respond("$/scenes/cable-release.toml --axial on");
  const Document slowed = respond("$/scenes/cable-release.toml --axial off");
  EXPECT_EQ(cost(full, "axial"), -1);
  EXPECT_GT(cost(slowed, "axial"), 0);
  EXPECT_EQ(slowed["steps"], 400);
  EXPECT_GT(full["steps"].get<long>(), 2000);
  // Segments by the scene's accuracy.
  std::string text = "accuracy = 1e-3\n";
  std::ifstream file(kScenes + "cable-hit.toml");
  for (std::string line; std::getline(file, line);) {
    if (line.rfind("accuracy", 0) == 0) continue;
    text += (line == "segments = 30" ? "segments = \"auto\"" : line) + "\n";
  }
  const Document chosen = respond(folder.write("auto.toml", text));
  EXPECT_GE(chosen["modelled"]["segments"][0]["segments"].get<int>(), 8);
  EXPECT_LE(chosen["modelled"]["resolution_error"].get<double>(), 1e-3);
  EXPECT_EQ(cost(chosen, "bending within segments"),
            chosen["modelled"]["resolution_error"].get<double>());
}

TEST(Respond, RecordedForceFromAFile) {
  const TemporaryFolder folder;
  std::string force = "Time (s),Force (N)\n";
  for (int i = 0; i <= 100; ++i) {
    force += std::to_string(i * 0.001) + "," + std::to_string(i % 50 == 10 ? 0.2 : 0.0) + "\n";
  }
  folder.write("force.csv", force);
  const std::string hit = std::string(kCableScene) + R"(
[[load]]
kind = "record"
member = "cable"
position = 0.25
file = "force.csv"
[[sensor]]
name = "mid"
member = "cable"
position = 0.5
quantity = "displacement"
)";
  const std::string scene = folder.write("scene.toml", hit);
  const Document document =
      document_of("respond {} --duration 0.2 --rate 500 --out {}", {scene, folder.at("y.csv")});
  EXPECT_EQ(document["inputs"].size(), 2u);
  EXPECT_GT(document["sensors"][0]["rms"].get<double>(), 0);

  folder.write("force.csv", "Time (s),Acceleration (m/s^2),Voltage (V)\n0,1,2\n0.1,2,3\n");
  const ProgramRun wrong =
      run_line("respond {} --duration 0.2 --rate 500 --out {}", {scene, folder.at("y.csv")});
  EXPECT_EQ(wrong.exit_code, 3);
  EXPECT_THAT(wrong.err, HasSubstr("force"));
}

TEST(Respond, EverySolverGivesEveryQuantity) {
  // A touch that moves the cable by 0.06 mm, 1 % of its sag: linear to that.
  const TemporaryFolder folder;
  auto scene = model::testing::paper_cable(200, 0.5972, 12);
  scene.loads = {model::testing::impact({"", "cable", 0.25}, {0, -1, 0}, 0.05, 0.02)};
  using enum model::Sensor::Quantity;
  for (const auto& [name, quantity] : {std::pair{"displacement", displacement},
                                       {"velocity", velocity},
                                       {"acceleration", acceleration},
                                       {"force", force}}) {
    scene.sensors.push_back(model::testing::sensor("cable", 0.41, quantity));
    scene.sensors.back().name = name;
  }
  const std::string rig = folder.write("rig.toml", model::scene_text(scene));
  std::vector<std::vector<double>> first;
  for (const std::string solver : {"explicit", "modal", "stiff"}) {
    SCOPED_TRACE(solver);
    (void)document_of("respond {} --duration 0.1 --rate 1000 --out {} --solver " + solver,
                      {rig, folder.at("y.csv")});
    std::string header;
    const auto found = columns(folder.read("y.csv"), &header);
    EXPECT_EQ(header, "Time (s),displacement (m),velocity (m/s),acceleration (m/s^2),force (N)");
    ASSERT_EQ(found.size(), 5u);
    ASSERT_EQ(found[0].size(), 101u);
    if (first.empty()) first = found;
    for (std::size_t c = 1; c < 4; ++c) {
      double apart = 0, size = 0;
      for (std::size_t k = 0; k < found[c].size(); ++k) {
        apart += std::pow(found[c][k] - first[c][k], 2);
        size += std::pow(first[c][k], 2);
      }
      EXPECT_LT(std::sqrt(apart / size), solver == "modal" ? 0.01 : 3e-3) << c;
    }
    for (const double tension : found[4]) EXPECT_NEAR(tension, 200, 0.1);
  }
}

TEST(Bench, SchemesGoTheSameWayAndTheDefaultKeepsWhatItPromises) {
  const auto json = document_of("bench --quick");
  EXPECT_LT(json["reference_error"], 1e-3);
  int defaults = 0, stiff = 0;
  for (const auto& row : json["rows"]) {
    EXPECT_EQ(row["task"], "nonlinear-response");
    const double error = row["relative_error"];
    EXPECT_TRUE(std::isfinite(error) && error >= 0 && error <= 1) << row;
    EXPECT_GT(row["wall_s"], 0) << row;
    // Frequencies to 1e-4 (the accuracy asked) turn the phase of what moves below 150 Hz by
    // 2 pi 150 0.1 1e-4 = 1e-2 at the end.
    const bool is_default = row["default"], is_stiff = row["method"] == "stiff (SUNDIALS IDA)";
    if (is_default || is_stiff) {
      EXPECT_LT(error, 1e-2) << row;
    }
    if (row["method"] == "explicit") {
      EXPECT_LT(error, 1e-4) << row;
    }
    defaults += is_default, stiff += is_stiff;
  }
  EXPECT_EQ(defaults, 1);
  EXPECT_EQ(stiff, 1);
}

}  // namespace rigfit::apps::respond_test
