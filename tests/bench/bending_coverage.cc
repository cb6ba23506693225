// Bending tests that do not share the estimator's assumptions (simulated_bending.h): how often the
// 95 % interval of EI holds the truth, how often the test is refused, and what is warned of. Then
// EI(T) from tests at four tensions (simulated_curve.h).
#include <fmt/format.h>

#include <cmath>
#include <string>
#include <vector>

#include "ident/bending/bending_analysis.h"
#include "tests/bench/study.h"
#include "tests/ident/bending/simulated_bending.h"
#include "tests/ident/bending/simulated_curve.h"

namespace {

using namespace rigfit;
using ident::simulated::Bending;
using ident::simulated::Friction;

struct Case {
  std::string name;
  Bending test;
  double span_error_m = 0;
};

std::vector<Case> cases() {
  std::vector<Case> all;
  const auto table = [&](int n, const std::string& name, auto change) {
    Case& one = all.emplace_back(fmt::format("table, {} points{}", n, name));
    one.test.rows = n, one.test.strokes = 1;
    change(one.test);
  };
  const auto record = [&](int n, const std::string& name, auto change) {
    Case& one = all.emplace_back(fmt::format("record, {} rows, {}", n, name));
    one.test.rows = n, one.test.load_noise = one.test.deflection_noise = 0.001;
    change(one.test);
  };
  for (int n : {3, 4, 5, 6, 8, 10, 15, 20, 30}) {
    for (double noise : {0.002, 0.007}) {
      table(n, fmt::format(" one way, {:g} % noise", 100 * noise),
            [&](Bending& b) { b.load_noise = b.deflection_noise = noise; });
    }
  }
  for (int n : {5, 9, 13, 21}) {
    for (double friction : {0.0, 0.05}) {
      table(n, fmt::format(" up and down, {:g} N Dahl friction", friction), [&](Bending& b) {
        b.strokes = 2, b.load_noise = 0.004;
        b.friction = Friction::dahl, b.friction_N = friction;
      });
    }
  }
  for (int n : {3, 5, 10}) {
    table(n, ", read to 0.01 mm", [](Bending& b) {
      b.travel_m = 0.97e-3, b.deflection_resolution_m = 1e-5, b.deflection_noise = 0.002;
    });
    table(n, ", exact", [](Bending& b) { b.travel_m = 0.97e-3; });
  }
  for (int n : {6, 10, 20}) {
    const auto noisy = [&](const char* name, auto change) {
      table(n, name, [&](Bending& b) { b.load_noise = 0.004, change(b); });
    };
    noisy(", one deflection spike", [](Bending& b) { b.deflection_spikes = 1; });
    noisy(", toe of 20 %", [](Bending& b) { b.toe = 0.2; });
    noisy(", slope rises by 60 %", [](Bending& b) { b.curvature = 0.6; });
    noisy(", slope rises by 60 %, toe", [](Bending& b) { b.curvature = 0.6, b.toe = 0.2; });
  }
  const std::vector<std::pair<const char*, Friction>> laws{
      {"none", Friction::none},          {"bilinear", Friction::bilinear},
      {"Dahl 1/2", Friction::dahl_half}, {"Dahl 1", Friction::dahl},
      {"Dahl 2", Friction::dahl_two},    {"Bouc-Wen", Friction::bouc_wen}};
  for (const auto& [name, friction] : laws) {
    const Friction law = friction;
    for (int n : {50, 200, 2000}) {
      record(n, fmt::format("friction {}", name),
             [&](Bending& b) { b.friction = law, b.friction_N = 0.05; });
    }
    if (law == Friction::none) continue;
    record(400, fmt::format("{}, 0.1 N over 0.4 of 1 mm", name),
           [&](Bending& b) { b.friction = law, b.friction_N = 0.1, b.friction_travel_m = 4e-4; });
  }
  for (int n : {60, 400}) {
    record(n, "one deflection spike", [](Bending& b) { b.deflection_spikes = 1; });
    record(n, "three spikes each", [](Bending& b) { b.deflection_spikes = b.load_spikes = 3; });
    record(n, "drift 2 % of load", [](Bending& b) { b.drift = 0.02; });
    record(n, "read to 0.01 mm and 0.1 N",
           [](Bending& b) { b.deflection_resolution_m = 1e-5, b.load_resolution_N = 0.1; });
    record(n, "toe of 20 %", [](Bending& b) { b.toe = 0.2; });
    record(n, "slope rises by 60 %", [](Bending& b) { b.curvature = 0.6; });
  }
  for (double clamp : {1000.0, 200.0, 50.0}) {
    record(200, fmt::format("clamps of {:g} N m/rad", clamp),
           [&](Bending& b) { b.clamp_Nm_rad = clamp; });
  }
  record(200, "span off by 2 mm", [](Bending&) {});
  all.back().span_error_m = 0.002;
  return all;
}

void analyse(const Case& one, std::uint64_t seed, study::Table& table) {
  std::mt19937_64 random(1000 * seed + 7);
  const auto record = ident::simulated::record(one.test, random);
  const auto result =
      ident::analyse_bending_test(record, {.span_m = {one.test.span_m + one.span_error_m, 0}});
  for (const auto& finding : result.findings) table.add("findings", finding.code);
  table.add("refused", result.refused);
  if (result.refused) return;
  const auto& EI = result.stiffness;
  table.add("held, %", study::held(EI, one.test.EI_Nm2));
  table.add("bias, %", 100 * (EI.EI_Nm2.value / one.test.EI_Nm2 - 1));
  table.add("std, %", 100 * EI.EI_Nm2.std / EI.EI_Nm2.value);
}

struct Curve {
  std::string name;
  bool of_the_moment;
  std::size_t tension;
};

void fit_curve(const Curve& curve, std::uint64_t seed, study::Table& table) {
  const auto one =
      ident::simulated::curve_coverage(curve.of_the_moment, 1, static_cast<int>(seed) + 1);
  if (one.curves == 0) return;
  table.add("test's interval held, %", one.tests_held[curve.tension]);
  table.add("curve's, %", one.held[curve.tension]);
  table.add("bias, %", 100 * one.bias[curve.tension]);
  table.add("std, %", 100 * one.relative_std[curve.tension]);
}

}  // namespace

int main(int argc, char** argv) {
  using enum study::Of;
  const auto arguments = study::arguments(argc, argv, 100, 0);
  study::run(arguments,
             {"test",
              {{"refused", sum},
               {"held, %"},
               {"bias, %", mean, "{:+.2f}"},
               {"std, %", mean, "{:.2f}"},
               {"findings", codes}}},
             cases(), analyse);
  std::vector<Curve> curves;
  for (const bool of_the_moment : {false, true}) {
    for (std::size_t i = 0; i < ident::simulated::kCurveTensions.size(); ++i) {
      curves.push_back({fmt::format("EI(T) of four tests, EI of the tension {}, at {:g} N",
                                    of_the_moment ? "of the moment" : "at rest",
                                    ident::simulated::kCurveTensions[i]),
                        of_the_moment, i});
    }
  }
  study::run(arguments,
             {"curve",
              {{"test's interval held, %"},
               {"curve's, %"},
               {"bias, %", mean, "{:+.2f}"},
               {"std, %", mean, "{:.2f}"}}},
             curves, fit_curve);
}
