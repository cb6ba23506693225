// Bending tests that do not share the estimator's assumptions (simulated_bending.h): how often the
// 95 % interval of EI holds the truth, how often the test is refused, and what is warned of. Prints
// Markdown tables, last that of EI(T) from tests at four tensions (simulated_curve.h); the first
// argument is the number of seeds a row (100), the second a part of the rows' names ("EI(T)": only
// the last).
#include <fmt/format.h>

#include <cmath>
#include <cstdlib>
#include <map>
#include <string>
#include <vector>

#include "ident/bending/bending_analysis.h"
#include "tests/ident/bending/simulated_bending.h"
#include "tests/ident/bending/simulated_curve.h"

namespace {

using namespace rigfit::ident;
using simulated::Bending;
using simulated::Friction;

struct Row {
  std::string name;
  Bending test;
  double span_error_m = 0;
};

std::vector<Row> rows_of_tables() {
  std::vector<Row> rows;
  for (int n : {3, 4, 5, 6, 8, 10, 15, 20, 30}) {
    for (double noise : {0.002, 0.007}) {
      Row row{fmt::format("table, {} points one way, {:g} % noise", n, 100 * noise), {}};
      row.test.rows = n, row.test.strokes = 1;
      row.test.load_noise = row.test.deflection_noise = noise;
      rows.push_back(row);
    }
  }
  for (int n : {5, 9, 13, 21}) {
    for (double friction : {0.0, 0.05}) {
      Row row{fmt::format("table, {} points up and down, {:g} N Dahl friction", n, friction), {}};
      row.test.rows = n, row.test.strokes = 2, row.test.load_noise = 0.004;
      row.test.friction = Friction::dahl, row.test.friction_N = friction;
      rows.push_back(row);
    }
  }
  for (int n : {3, 5, 10}) {
    Row row{fmt::format("table, {} points, read to 0.01 mm", n), {}};
    row.test.rows = n, row.test.strokes = 1, row.test.travel_m = 0.97e-3;
    row.test.deflection_resolution_m = 1e-5;
    row.test.deflection_noise = 0.002;
    rows.push_back(row);
    row.name = fmt::format("table, {} points, exact", n);
    row.test.deflection_resolution_m = row.test.deflection_noise = 0;
    rows.push_back(row);
  }
  for (int n : {6, 10, 20}) {
    Row row{fmt::format("table, {} points, one deflection spike", n), {}};
    row.test.rows = n, row.test.strokes = 1, row.test.load_noise = 0.004;
    row.test.deflection_spikes = 1;
    rows.push_back(row);
    row.name = fmt::format("table, {} points, toe of 20 %", n);
    row.test.deflection_spikes = 0, row.test.toe = 0.2;
    rows.push_back(row);
    row.name = fmt::format("table, {} points, slope rises by 60 %", n);
    row.test.toe = 0, row.test.curvature = 0.6;
    rows.push_back(row);
    row.name = fmt::format("table, {} points, slope rises by 60 %, toe", n);
    row.test.toe = 0.2;
    rows.push_back(row);
  }
  return rows;
}

std::vector<Row> rows_of_records() {
  std::vector<Row> rows;
  const std::vector<std::pair<const char*, Friction>> laws{
      {"none", Friction::none},          {"bilinear", Friction::bilinear},
      {"Dahl 1/2", Friction::dahl_half}, {"Dahl 1", Friction::dahl},
      {"Dahl 2", Friction::dahl_two},    {"Bouc-Wen", Friction::bouc_wen}};
  for (const auto& [name, law] : laws) {
    for (int n : {50, 200, 2000}) {
      Row row{fmt::format("record, {} rows, friction {}", n, name), {}};
      row.test.rows = n, row.test.friction = law, row.test.friction_N = 0.05;
      row.test.load_noise = row.test.deflection_noise = 0.001;
      rows.push_back(row);
    }
    if (law == Friction::none) continue;
    Row row{fmt::format("record, 400 rows, {}, 0.1 N over 0.4 of 1 mm", name), {}};
    row.test.rows = 400, row.test.friction = law, row.test.friction_N = 0.1;
    row.test.friction_travel_m = 4e-4;
    row.test.load_noise = row.test.deflection_noise = 0.001;
    rows.push_back(row);
  }
  for (int n : {60, 400}) {
    Row row{fmt::format("record, {} rows, one deflection spike", n), {}};
    row.test.rows = n, row.test.load_noise = row.test.deflection_noise = 0.001;
    row.test.deflection_spikes = 1;
    rows.push_back(row);
    row.name = fmt::format("record, {} rows, three spikes each", n);
    row.test.deflection_spikes = row.test.load_spikes = 3;
    rows.push_back(row);
    row.name = fmt::format("record, {} rows, drift 2 % of load", n);
    row.test.deflection_spikes = row.test.load_spikes = 0, row.test.drift = 0.02;
    rows.push_back(row);
    row.name = fmt::format("record, {} rows, read to 0.01 mm and 0.1 N", n);
    row.test.drift = 0, row.test.deflection_resolution_m = 1e-5;
    row.test.load_resolution_N = 0.1;
    rows.push_back(row);
    row.name = fmt::format("record, {} rows, toe of 20 %", n);
    row.test.deflection_resolution_m = row.test.load_resolution_N = 0, row.test.toe = 0.2;
    rows.push_back(row);
    row.name = fmt::format("record, {} rows, slope rises by 60 %", n);
    row.test.toe = 0, row.test.curvature = 0.6;
    rows.push_back(row);
  }
  for (double clamp : {1000.0, 200.0, 50.0}) {
    Row row{fmt::format("record, clamps of {:g} N m/rad", clamp), {}};
    row.test.load_noise = row.test.deflection_noise = 0.001, row.test.clamp_Nm_rad = clamp;
    rows.push_back(row);
  }
  Row row{"record, span off by 2 mm", {}, 0.002};
  row.test.load_noise = row.test.deflection_noise = 0.001;
  rows.push_back(row);
  return rows;
}

void print(const Row& row, int seeds) {
  int held = 0, kept = 0;
  double bias = 0, width = 0;
  std::map<std::string, int> said;
  for (int k = 0; k < seeds; ++k) {
    std::mt19937_64 random(1000 * static_cast<std::uint64_t>(k) + 7);
    Bending test = row.test;
    test.EI_Nm2 = 0.5;
    const auto record = simulated::record(test, random);
    BendingTestOptions options;
    options.span_m = {test.span_m + row.span_error_m, 0};
    const auto result = analyse_bending_test(record, options);
    for (const auto& finding : result.findings) ++said[finding.code];
    if (result.refused) continue;
    ++kept;
    const auto& EI = result.stiffness;
    held += EI.low <= test.EI_Nm2 && test.EI_Nm2 <= EI.high;
    bias += EI.EI_Nm2.value / test.EI_Nm2 - 1;
    width += EI.EI_Nm2.std / EI.EI_Nm2.value;
  }
  std::string words;
  for (const auto& [code, count] : said) {
    words += fmt::format("{}{} {}", words.empty() ? "" : ", ", code, count);
  }
  fmt::print("| {:<52} | {:>3} | {:>5} | {:>7} | {:>6} | {} |\n", row.name, seeds - kept,
             kept > 0 ? fmt::format("{:.0f}", 100.0 * held / kept) : "",
             kept > 0 ? fmt::format("{:+.2f}", 100 * bias / kept) : "",
             kept > 0 ? fmt::format("{:.2f}", 100 * width / kept) : "", words);
}

void print_curves(int seeds) {
  fmt::print(
      "\n| EI(T) of four tests | tension, N | test's interval % | curve's % | bias % | std % |\n"
      "|---|---|---|---|---|---|\n");
  for (const bool of_the_moment : {false, true}) {
    const auto coverage = simulated::curve_coverage(of_the_moment, seeds);
    for (std::size_t i = 0; i < simulated::kCurveTensions.size(); ++i) {
      fmt::print("| EI of the tension {} | {:g} | {:.0f} | {:.0f} | {:+.2f} | {:.2f} |\n",
                 of_the_moment ? "of the moment" : "at rest", simulated::kCurveTensions[i],
                 100.0 * coverage.tests_held[i] / coverage.curves,
                 100.0 * coverage.held[i] / coverage.curves, 100 * coverage.bias[i],
                 100 * coverage.relative_std[i]);
    }
  }
}

}  // namespace

int main(int argc, char** argv) {
  const int seeds = argc > 1 ? std::max(2, std::atoi(argv[1])) : 100;
  const std::string part = argc > 2 ? argv[2] : "";
  fmt::print("{} seeds a row\n\n", seeds);
  fmt::print("| {:<52} | ref | cov % | bias % | std % | said |\n|---|---|---|---|---|---|\n",
             "test");
  for (const auto& rows : {rows_of_tables(), rows_of_records()}) {
    for (const auto& row : rows) {
      if (row.name.find(part) != std::string::npos) print(row, seeds);
    }
  }
  if (std::string("EI(T)").find(part) != std::string::npos) print_curves(seeds);
  return 0;
}
