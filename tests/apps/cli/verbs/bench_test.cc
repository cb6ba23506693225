#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "apps/bench/bench_study.h"
#include "tests/apps/run_program.h"

namespace rigfit::apps::bench_test {
namespace {
using Json = nlohmann::json;

/// One quick run of everything, shared.
class BenchRun : public ::testing::Test {
 protected:
  static void SetUpTestSuite() { json_ = document_of("bench --quick"); }
  void SetUp() override { ASSERT_TRUE(json_.is_object()); }

  static std::vector<Json> rows_of(const std::string& task, const std::string& study = "") {
    std::vector<Json> out;
    for (const auto& row : json_["rows"]) {
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

  static inline Json json_;
};

TEST_F(BenchRun, EveryTaskHasAFrontAndADefault) {
  std::map<std::string, int> front, defaults;
  std::set<std::string> tasks;
  for (const auto& row : json_["rows"]) {
    const std::string study = row["task"].get<std::string>() + "/" + row.value("study", "");
    tasks.insert(row["task"].get<std::string>());
    const double error = error_of(row);
    EXPECT_TRUE(std::isfinite(error) && error >= 0 && error <= 1) << row;
    EXPECT_GT(row["wall_s"].get<double>(), 0) << row;
    EXPECT_GE(row["reference_error"].get<double>(), 0);
    front[study] += row["on_front"].get<bool>();
    defaults[study] += row["default"].get<bool>();
  }
  EXPECT_EQ(tasks, (std::set<std::string>{"nonlinear-response"}));
  for (const auto& [study, count] : front) EXPECT_GE(count, 1) << study;
  for (const auto& [study, count] : defaults) EXPECT_EQ(count, 1) << study;
  // No row of the front is beaten in both.
  for (const auto& a : json_["rows"]) {
    for (const auto& b : json_["rows"]) {
      if (a["task"] != b["task"] || a.value("study", "") != b.value("study", "")) continue;
      if (!a["on_front"].get<bool>()) continue;
      EXPECT_FALSE(b["wall_s"].get<double>() < 0.85 * a["wall_s"].get<double>() &&
                   error_of(b) < 0.85 * error_of(a) &&
                   error_of(a) > a["reference_error"].get<double>())
          << a << b;
    }
  }
}

TEST_F(BenchRun, DefaultsKeepWhatTheyPromise) {
  // Frequencies to 1e-4 (the accuracy asked) turn the phase of what moves below 150 Hz by
  // 2 pi 150 0.1 1e-4 = 1e-2 at the end.
  EXPECT_LT(error_of(default_of("nonlinear-response", "steps")), 1e-2);
}

TEST_F(BenchRun, SchemesGoTheSameWay) {
  bool stiff = false;
  for (const auto& row : rows_of("nonlinear-response", "steps")) {
    if (row["method"] == "stiff (SUNDIALS IDA)") {
      stiff = true;
      EXPECT_LT(error_of(row), 1e-2);
    }
    if (row["method"] == "explicit") {
      EXPECT_LT(error_of(row), 1e-4) << row;
    }
  }
  EXPECT_TRUE(stiff);
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
  add("theirs", 5, 1e-4, false, false);
  add("fails", 1, 1, false, false);
  const Plot plot = bench_plot(study);
  EXPECT_TRUE(plot.log_x && plot.log_y);
  ASSERT_EQ(plot.series.size(), 4U);
  EXPECT_EQ(plot.series[0].name, "own");
  EXPECT_EQ(plot.series[0].x, (std::vector<double>{0.01, 0.02}));
  EXPECT_EQ(plot.series[0].y, (std::vector<double>{1e-3, 1e-5}));
  EXPECT_EQ(plot.series[2].name, "Pareto-optimal");
  EXPECT_EQ(plot.series[2].x.size(), 2U);
  EXPECT_EQ(plot.series[3].name, "default");
  EXPECT_EQ(plot.series[3].x, std::vector<double>{0.02});
  study.rows.resize(0);
  EXPECT_TRUE(bench_plot(study).series.empty());
}

}  // namespace
}  // namespace rigfit::apps::bench_test
