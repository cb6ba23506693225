#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "apps/bench/bench_plot.h"
#include "apps/bench/size_study.h"
#include "tests/apps/run_program.h"
#include "tests/reference/closed_forms.h"

namespace rigfit::apps::bench_test {
namespace {
using ::testing::HasSubstr;
using Json = nlohmann::json;

/// One quick run of everything, shared.
class BenchRun : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new TemporaryFolder;
    run_ = new ProgramRun(run_program(
        {"bench", "--quick", "--json", "-", "--out", (folder_->path() / "rows.csv").string()}));
    if (run_->exit_code == 0) json_ = new Json(parsed(run_->out));
  }
  static void TearDownTestSuite() {
    delete json_;
    delete run_;
    delete folder_;
    json_ = nullptr;
  }
  void SetUp() override { ASSERT_NE(json_, nullptr) << run_->err; }

  static std::vector<Json> rows_of(const std::string& task, const std::string& study = "") {
    std::vector<Json> out;
    for (const auto& row : (*json_)["rows"]) {
      if (row["task"] == task && row.value("study", "") == study) out.push_back(row);
    }
    return out;
  }
  static Json default_of(const std::string& task, const std::string& study = "") {
    for (const auto& row : rows_of(task, study)) {
      if (row["default"].get<bool>()) return row;
    }
    ADD_FAILURE() << "no default of " << task;
    return {};
  }
  static double error_of(const Json& row) { return row["relative_error"].get<double>(); }

  static TemporaryFolder* folder_;
  static ProgramRun* run_;
  static Json* json_;
};
TemporaryFolder* BenchRun::folder_ = nullptr;
ProgramRun* BenchRun::run_ = nullptr;
Json* BenchRun::json_ = nullptr;

TEST_F(BenchRun, EveryTaskHasAFrontAndADefaultThatIsOnItOrSaysWhyNot) {
  std::map<std::string, int> front, defaults;
  std::set<std::string> tasks;
  for (const auto& row : (*json_)["rows"]) {
    const std::string study = row["task"].get<std::string>() + "/" + row.value("study", "");
    tasks.insert(row["task"].get<std::string>());
    const double error = error_of(row);
    EXPECT_TRUE(std::isfinite(error) && error >= 0 && error <= 1) << row;
    EXPECT_GT(row["wall_s"].get<double>(), 0) << row;
    EXPECT_GE(row["reference_error"].get<double>(), 0);
    front[study] += row["on_front"].get<bool>();
    defaults[study] += row["default"].get<bool>();
    if (row["default"].get<bool>() && !row["on_front"].get<bool>()) {
      EXPECT_GT(row.value("note", "").size(), 40u) << row;
    }
  }
  EXPECT_EQ(tasks,
            (std::set<std::string>{"statics", "modes", "linear-response", "nonlinear-response",
                                   "frf-synthesis", "decay", "frf", "poles", "bending", "update"}));
  for (const auto& [study, count] : front) EXPECT_GE(count, 1) << study;
  for (const auto& [study, count] : defaults) EXPECT_EQ(count, 1) << study;
  // No row of the front is beaten in both.
  for (const auto& a : (*json_)["rows"]) {
    for (const auto& b : (*json_)["rows"]) {
      if (a["task"] != b["task"] || a.value("study", "") != b.value("study", "")) continue;
      if (!a["on_front"].get<bool>()) continue;
      EXPECT_FALSE(b["wall_s"].get<double>() < 0.85 * a["wall_s"].get<double>() &&
                   error_of(b) < 0.85 * error_of(a) &&
                   error_of(a) > a["reference_error"].get<double>())
          << a << b;
    }
  }
  const std::string csv = folder_->read("rows.csv");
  EXPECT_EQ(std::size_t(std::count(csv.begin(), csv.end(), '\n')), 1 + (*json_)["rows"].size());
}

TEST_F(BenchRun, ErrorsFallWithSegmentsByTheirOrder) {
  // Accurate inertia errs by more than h^2 in the first six modes of the cable, rigid rods by h^2:
  // from 30 to 60 segments by 4 (less than 3.5 would be a lower order).
  std::map<int, double> accurate, rods, statics;
  for (const auto& row : rows_of("modes")) {
    if (row["method"] == "accurate inertia, planes apart")
      accurate[row["segments"]] = error_of(row);
    if (row["method"] == "rigid rods (paper), planes apart") rods[row["segments"]] = error_of(row);
  }
  EXPECT_GT(rods[30] / rods[60], 3.5);
  EXPECT_LT(rods[30] / rods[60], 4.5);
  EXPECT_GT(accurate[30] / accurate[60], 3.5);
  EXPECT_LT(accurate[30], rods[30] / 5);
  for (const auto& row : rows_of("statics")) {
    if (row["method"] == "accurate joints, in the plane" && row["tolerance"] == 1e-9) {
      statics[row["segments"]] = error_of(row);
    }
  }
  EXPECT_GT(statics[30] / statics[60], 3.5);
  EXPECT_LT(statics[30], 1e-6);
  // Cut and unknowns make no difference but time.
  for (const auto& row : rows_of("modes")) {
    if (row["method"] == "accurate inertia, in space") {
      const int n = row["segments"];
      EXPECT_NEAR(error_of(row) / accurate[n], 1, 1e-3) << n;
    }
  }
}

TEST_F(BenchRun, CalculixStandsBesideTheModesWhereItIsInstalled) {
  for (const auto& study : (*json_)["studies"]) {
    if (study["task"] != "modes") continue;
    EXPECT_THAT(study["beside"].get<std::string>(), HasSubstr("CalculiX"));
  }
  std::map<int, double> errors;
  for (const auto& row : rows_of("modes")) {
    if (row["method"] == "CalculiX, elements a member") errors[row["segments"]] = error_of(row);
  }
  if (std::system("command -v ccx >/dev/null") != 0) GTEST_SKIP() << "no ccx";
  // Quadratic elements: from 5 to 20 of them by far more than the 16 of second order.
  ASSERT_TRUE(errors.contains(5) && errors.contains(20));
  EXPECT_GT(errors[5] / errors[20], 16);
}

TEST_F(BenchRun, DefaultsKeepWhatTheyPromise) {
  // "auto" keeps the scene's accuracy; its estimate is good to a tenth.
  EXPECT_LT(error_of(default_of("modes")), 1.1e-4);
  // The recurrence is exact: rounding of the phase, omega t eps, of modes to 1 kHz in 0.1 s.
  EXPECT_LT(error_of(default_of("linear-response", "steps")), 1e-10);
  // Frequencies to 1e-4 (the accuracy asked) turn the phase of what moves below 150 Hz by
  // 2 pi 150 0.1 1e-4 = 1e-2 at the end.
  EXPECT_LT(error_of(default_of("nonlinear-response", "steps")), 1e-2);
  // At a resonance a frequency off by 1e-4 changes the function by 1e-4 / zeta, zeta = 0.005.
  EXPECT_LT(error_of(default_of("frf-synthesis")), 2e-2);
  // Six records reach the Cramer-Rao bound: rms of six beyond 2.2 bounds in 1 of 1e5.
  const Json decay = default_of("decay");
  EXPECT_LT(error_of(decay), 2.2 * decay["bound"].get<double>());
  // Noise of 0.5 % of each channel, five hits: less than that over the whole band.
  EXPECT_LT(error_of(default_of("frf")), 5e-3);
  // 0.1 % noise on 20 x 1400 lines: std of a frequency about zeta 1e-3 / sqrt(lines in the band of
  // a mode times 20), some 1e-6; the search must not lose more than an order of that.
  EXPECT_LT(error_of(default_of("poles")), 1e-5);
  EXPECT_LT(error_of(default_of("bending")), 1e-13);
  // EI is a small part of a cable's stiffness: 30 segments cost it 3.5 %, which "auto" takes off.
  // What the 120 of the quick study's frequencies cost, a sixteenth of that, is left.
  EXPECT_LT(error_of(default_of("update")), 0.04 / 16);
}

TEST_F(BenchRun, RivalsGoTheSameWay) {
  // The paper's own solver and the explicit scheme integrate the same equations.
  bool adams = false;
  for (const auto& row : rows_of("nonlinear-response", "steps")) {
    if (row["method"] == "CVODE-Adams, fixed point (paper)") {
      adams = true;
      EXPECT_LT(error_of(row), 1e-3);
    }
    if (row["method"] == "explicit") {
      EXPECT_LT(error_of(row), 1e-4) << row;
    }
  }
  EXPECT_TRUE(adams);
  for (const auto& row : rows_of("bending")) {
    if (row["method"] != "bisection of the printed form") continue;
    // A bracket of `tolerance` about lambda is twice that in EI.
    EXPECT_LT(error_of(row), 2 * row["tolerance"].get<double>());
    EXPECT_GT(error_of(row), error_of(default_of("bending")));
  }
}

const char* const kCantilever = R"(
title = "cantilever"
gravity = 0.0
[[node]]
name = "base"
position = [0.0, 0.0, 0.0]
support = "clamped"
[[node]]
name = "tip"
position = [0.75, 0.0, 0.0]
[[member]]
name = "beam"
kind = "beam"
nodes = ["base", "tip"]
segments = 30
mass_per_length = 0.295
EA = 1e7
EI = [2.1, 8.4]
GJ = 2.0
)";

TEST(BenchVerb, ReferenceOfASceneIsTheClosedForm) {
  const TemporaryFolder folder;
  const auto run =
      run_program({"bench", folder.write("beam.toml", kCantilever), "--quick", "--json", "-"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const Json json = parsed(run.out);
  std::vector<double> truth;
  for (const double EI : {2.1, 8.4}) {
    for (const double f : model::cantilever_frequencies({0.75, 0.295, EI, 0}, 0, 6)) {
      truth.push_back(f);
    }
  }
  std::sort(truth.begin(), truth.end());
  bool compared = false;
  for (const auto& study : json["studies"]) {
    if (study["task"] != "modes") continue;
    const auto values = study["reference_values"].get<std::vector<double>>();
    ASSERT_EQ(values.size(), 6u);
    for (std::size_t i = 0; i < values.size(); ++i) {
      // Its own estimate, and the roots of a characteristic equation to 1e-12. The estimate is a
      // difference of two limits: thrice that covers what both share.
      EXPECT_NEAR(values[i] / truth[i], 1, 3 * study["reference_error"].get<double>() + 1e-9);
    }
    EXPECT_LT(study["reference_error"].get<double>(), 1e-6);
    compared = true;
  }
  EXPECT_TRUE(compared);
  // A horizontal beam without weight sags not, nothing loads it: those tasks are named and left.
  std::map<std::string, std::string> skipped;
  for (const auto& study : json["studies"]) {
    if (study.contains("skipped")) skipped[study["task"]] = study["skipped"];
  }
  EXPECT_EQ(skipped.size(), 4u);
  EXPECT_THAT(skipped["statics"], HasSubstr("sags"));
  EXPECT_THAT(skipped["linear-response"], HasSubstr("no load"));
  EXPECT_EQ(json["warnings"].size(), 4u);
  for (const auto& row : json["rows"]) EXPECT_EQ(row["task"], "modes");
}

// Methods in order of time, the front joined, the default marked; what failed is not drawn.
TEST(BenchPlot, TimeAgainstError) {
  BenchStudy study;
  study.task = "statics", study.study = "steps";
  const auto add = [&](const char* method, double time, double error, bool front, bool standard) {
    BenchRow row;
    row.method = method, row.wall_s = time, row.relative_error = error;
    row.on_front = front, row.is_default = standard;
    study.rows.push_back(row);
  };
  add("own", 0.02, 1e-5, true, true);
  add("own", 0.01, 1e-3, true, false);
  add("theirs (paper)", 5, 1e-4, false, false);
  add("fails", 1, 1, false, false);
  const Plot plot = bench_plot(study);
  EXPECT_TRUE(plot.log_x && plot.log_y);
  ASSERT_EQ(plot.series.size(), 4U);
  EXPECT_EQ(plot.series[0].name, "own");
  EXPECT_EQ(plot.series[0].x, (std::vector<double>{0.01, 0.02}));
  EXPECT_EQ(plot.series[0].y, (std::vector<double>{1e-3, 1e-5}));
  EXPECT_EQ(plot.series[1].origin, Origin::published_model);
  EXPECT_EQ(plot.series[2].name, "Pareto-optimal");
  EXPECT_EQ(plot.series[2].x.size(), 2U);
  EXPECT_EQ(plot.series[3].name, "default");
  EXPECT_EQ(plot.series[3].x, std::vector<double>{0.02});
  study.rows.resize(0);
  EXPECT_TRUE(bench_plot(study).series.empty());
}

TEST(BenchVerb, CostAgainstSize) {
  // A power law gives its exponent.
  EXPECT_NEAR(log_slope({1, 3, 10}, {2, 2 * std::pow(3, 1.5), 2 * std::pow(10, 1.5)}), 1.5, 1e-12);
  const auto run = run_program({"bench", "--size", "--quick", "--json", "-"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const Json json = parsed(run.out);
  std::map<std::string, std::vector<double>> sizes;
  for (const auto& row : json["rows"]) {
    EXPECT_GT(row["wall_s"].get<double>(), 0) << row;
    sizes[row["method"]].push_back(row["size"]);
  }
  std::set<std::string> tasks;
  for (const auto& study : json["studies"]) {
    const auto& of = sizes[study["method"]];
    ASSERT_FALSE(of.empty()) << study;
    EXPECT_TRUE(std::is_sorted(of.begin(), of.end()));
    EXPECT_EQ(study.contains("time_slope"), of.size() >= 3) << study;
    tasks.insert(study["task"].get<std::string>());
  }
  EXPECT_EQ(tasks, (std::set<std::string>{"channels", "files", "poles", "samples", "segments"}));
}

TEST(BenchVerb, BadInputsAndUsage) {
  const TemporaryFolder folder;
  EXPECT_EQ(run_program({"bench", "missing.toml"}).exit_code, 3);
  EXPECT_EQ(run_program({"bench", "--task", "weather"}).exit_code, 2);
  const std::string scene = folder.write("beam.toml", kCantilever);
  const auto wrong = run_program({"bench", scene, "--task", "decay"});
  EXPECT_EQ(wrong.exit_code, 2);
  EXPECT_THAT(wrong.err, HasSubstr("decay"));
  EXPECT_EQ(run_program({"bench", scene, "--size"}).exit_code, 2);
  EXPECT_EQ(run_program({"bench", "--size", "--task", "decay"}).exit_code, 2);
  EXPECT_EQ(run_program({"bench", "--task", "files"}).exit_code, 2);
  // Nothing of what was asked can be done.
  const auto nothing = run_program({"bench", scene, "--quick", "--task", "statics"});
  EXPECT_EQ(nothing.exit_code, 4);
  EXPECT_THAT(nothing.err, HasSubstr("sags"));
}

}  // namespace
}  // namespace rigfit::apps::bench_test
