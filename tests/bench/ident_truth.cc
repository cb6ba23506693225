// Coverage and bias of EI from bending tests, of EA and damping from hanging-mass tests and of
// updated parameters over 200 virtual campaigns: the long form of what the unit tests check in
// short. Prints a table. bending_coverage and axial_coverage go through more kinds of tests.
//   ident_truth            the table
//   ident_truth starts testdata/virtual_laboratory     its rig, starts off by up to a factor of 10
#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <random>
#include <string_view>

#include "ident/axial/axial_identification.h"
#include "ident/bending/bending_analysis.h"
#include "ident/update/assignment/update_alternatives.h"
#include "ident/update/model_update.h"
#include "ident/update/update_checks.h"
#include "ident/virtual_rig/virtual_axial.h"
#include "ident/virtual_rig/virtual_bending.h"
#include "model/scene/read_scene.h"
#include "signal/decay/decay.h"
#include "tests/ident/update/laboratory_rig.h"

namespace {

using namespace rigfit;

constexpr int kCampaigns = 200;

struct Score {
  int covered = 0, total = 0;
  double bias = 0;  // sum of errors over their standard uncertainty
  void add(double value, double truth, double std, double low, double high) {
    covered += low <= truth && truth <= high;
    bias += (value - truth) / std;
    ++total;
  }
  void print(const std::string& name) const {
    fmt::print("| {:<28} | {:>4} | {:>8.1f} % | {:>+12.3f} |\n", name, total,
               100.0 * covered / total, bias / total);
  }
};

void bending() {
  for (const double tension : {25.0, 100.0, 200.0, 300.0}) {
    Score score;
    for (std::uint64_t seed = 0; seed < kCampaigns; ++seed) {
      ident::VirtualBendingTest test;
      test.EI_Nm2 = 0.5;
      test.tension_N = tension;
      test.span_m = 0.5;
      test.friction_load_N = 0.1;
      test.friction_travel_m = 2e-4;
      test.load_cell.noise_std = 0.01;
      test.load_cell.offset_std = 0.05;
      test.lvdt.noise_std = 1e-6;
      test.lvdt.offset_std = 1e-4;
      test.tension_cell.noise_std = 0.1;
      auto random = ident::random_stream(seed, static_cast<std::uint64_t>(tension));
      const auto record = ident::virtual_bending_record(test, random);
      ident::BendingTestOptions options;
      options.span_m = {0.5, 0};
      const auto result = ident::analyse_bending_test(
          {record.channel("tension").samples, record.channel("load").samples,
           record.channel("deflection").samples},
          options);
      if (result.refused) continue;
      score.add(result.stiffness.EI_Nm2.value, 0.5, result.stiffness.EI_Nm2.std,
                result.stiffness.low, result.stiffness.high);
    }
    score.print(fmt::format("bending, EI at {:g} N", tension));
  }
}

// Three lengths, five taps each; mass, cable's mass and lengths drawn from their uncertainties.
void axial() {
  constexpr double kEA = 221780, kZeta = 0.017;
  Score EA, zeta;
  for (std::uint64_t seed = 0; seed < kCampaigns; ++seed) {
    ident::Random random = ident::random_stream(seed, 91);
    std::normal_distribution<double> normal;
    ident::AxialSetup setup;
    setup.mass_kg = {2.2, 0.005};
    setup.mass_per_length_kg_m = {0.16667, 0.001};
    setup.length_std_m = 0.002;
    ident::VirtualAxialTest test;
    test.EA_N = kEA, test.damping_ratio = kZeta;
    test.hung_mass_kg = 2.2 + setup.mass_kg.std * normal(random);
    test.mass_per_length_kg_m = 0.16667 + setup.mass_per_length_kg_m.std * normal(random);
    test.after_s = 1, test.before_s = 0.2;
    test.load_cell.noise_std = 1, test.load_cell.offset_std = 1;
    std::vector<ident::AxialDecay> decays;
    for (const double length : {0.7, 1.0, 1.3}) {
      test.length_m = length + 0.002 * normal(random);
      for (int tap = 0; tap < 5; ++tap) {
        const auto record = ident::virtual_axial_record(test, random);
        const auto r = signal::estimate_decay(record.channels[0].samples, record.sample_rate_hz);
        if (!r.refusal.empty()) continue;
        decays.push_back({"tap", length, r.modes[0].damped_frequency_hz, r.modes[0].damping_ratio});
      }
    }
    const auto r = ident::identify_axial(decays, setup);
    EA.add(r.EA_N.value, kEA, r.EA_N.std, r.EA_low_N, r.EA_high_N);
    zeta.add(r.damping_ratio.value, kZeta, r.damping_ratio.std, r.damping_low, r.damping_high);
  }
  EA.print("axial, EA");
  zeta.print("axial, damping ratio");
}

// `segments`: 0: left to the program.
model::Scene cable(double tension, double EI, int segments = 0) {
  auto scene = model::parse_scene(R"(
[[node]]
name = "left"
position = [0.0, 0.0, 0.0]
support = "pinned"
[[node]]
name = "right"
position = [2.4, 0.0, 0.0]
support = "pinned"
[[member]]
name = "cable"
kind = "cable"
nodes = ["left", "right"]
segments = 30
mass_per_length = 0.16667
EA = 221780.0
EI = 0.6
tension = 200.0
)",
                                  "cable.toml");
  scene.members[0].segments = segments;
  model::set_parameter(scene, "cable.tension", tension);
  model::set_parameter(scene, "cable.EI", EI);
  return scene;
}

// Four tensions, six out-of-plane modes each, of a cable with 400 segments; free: EI and four
// tensions of one that leaves them to the program.
void update() {
  const double tensions[] = {100, 200, 300, 400};
  std::vector<std::vector<double>> truth;
  for (const double T : tensions) {
    std::vector<double> frequencies;
    model::ModesOptions options;
    options.count = 24;
    options.error_estimate = false;
    for (const auto& mode : model::analyse_modes(cable(T, 0.6, 400), options).modes) {
      if (mode.plane == model::ModePlane::out && frequencies.size() < 6) {
        frequencies.push_back(mode.frequency_hz);
      }
    }
    truth.push_back(frequencies);
  }
  std::vector<Score> scores(5);
  std::vector<double> times;
  ident::FreeParameter tension{"cable.tension"};
  tension.per_state = true;
  for (std::uint64_t seed = 0; seed < kCampaigns; ++seed) {
    std::mt19937_64 random(seed);
    std::normal_distribution<double> normal;
    std::vector<ident::UpdateState> states;
    for (std::size_t s = 0; s < 4; ++s) {
      ident::UpdateState state{
          fmt::format("{:g} N", tensions[s]), cable(1.1 * tensions[s], 0.8), {}};
      for (const double f : truth[s]) {
        ident::MeasuredMode mode;
        mode.frequency_hz = {f * (1 + 2e-3 * normal(random)), 2e-3 * f};
        mode.plane = model::ModePlane::out;
        state.measured.push_back(mode);
      }
      states.push_back(std::move(state));
    }
    ident::UpdateOptions options;
    options.starts = 1;
    const auto begin = std::chrono::steady_clock::now();
    const auto result = ident::update_model(states, {{"cable.EI"}, tension}, options);
    times.push_back(
        std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count());
    for (std::size_t p = 0; p < 5; ++p) {
      const auto& parameter = result.parameters[p];
      const double half = result.coverage_factor * parameter.std;
      scores[p].add(parameter.value, p == 0 ? 0.6 : tensions[p - 1], parameter.std,
                    parameter.value - half, parameter.value + half);
    }
  }
  for (std::size_t p = 0; p < 5; ++p) {
    scores[p].print(p == 0 ? "update, EI" : fmt::format("update, tension {:g} N", tensions[p - 1]));
  }
  {
    std::vector<ident::UpdateState> states;
    for (std::size_t s = 0; s < 4; ++s) {
      ident::UpdateState state{fmt::format("{:g} N", tensions[s]), cable(tensions[s], 0.6), {}};
      for (const double f : truth[s]) {
        ident::MeasuredMode mode;
        mode.frequency_hz = {f, 2e-3 * f};
        mode.plane = model::ModePlane::out;
        state.measured.push_back(mode);
      }
      states.push_back(std::move(state));
    }
    ident::UpdateOptions options;
    const auto begin = std::chrono::steady_clock::now();
    const auto solution = ident::update_model(states, {{"cable.EI"}, tension}, options);
    const auto middle = std::chrono::steady_clock::now();
    const auto study =
        ident::update_monte_carlo(solution, states, {{"cable.EI"}, tension}, options, 1000);
    const auto end = std::chrono::steady_clock::now();
    fmt::print(
        "\nupdate from four starts {:.3f} s; Monte Carlo of {} refits {:.1f} s, one thread\n",
        std::chrono::duration<double>(middle - begin).count(), study.samples,
        std::chrono::duration<double>(end - middle).count());
  }
  std::sort(times.begin(), times.end());
  fmt::print("\nupdate, 4 tensions x 6 modes, 5 free parameters, one start: median {:.3f} s\n",
             times[times.size() / 2]);
}

// Modes of 90 segments, a tenth of them missing, fitted with 30 from starts anywhere in a factor of
// 10 either way: how often the answer is another than the truth's, and how often it stands alone.
void starts(const std::string& laboratory) {
  fmt::print("| relative std of frequencies, damping | shapes | fits | lost | alone | s a fit |\n");
  fmt::print("|---|---|---|---|---|---|\n");
  struct Kind {
    double frequency, damping;
    bool shapes;
  };
  constexpr int kFits = 60;
  for (const auto& [frequency, damping, shapes] :
       {Kind{1e-4, 0.01, true}, Kind{1e-4, 0.01, false}, Kind{1e-3, 0.03, false}}) {
    std::mt19937_64 random(5);
    std::uniform_real_distribution<double> uniform(-1, 1);
    std::normal_distribution<double> normal;
    int lost = 0, alone = 0;
    const auto begin = std::chrono::steady_clock::now();
    for (int k = 0; k < kFits; ++k) {
      std::vector<ident::UpdateState> states;
      const auto parameters = ident::testing::laboratory_parameters();
      for (const double tension : {200.0, 300.0}) {
        const double set = tension * (1 + 0.01 * normal(random));
        ident::UpdateState state{
            fmt::format("{:g} N", tension),
            ident::testing::laboratory_rig(laboratory, "scenes", set, 30),
            ident::testing::laboratory_modes(laboratory, tension, 90, frequency, damping, random)};
        std::erase_if(state.measured, [&](auto& mode) {
          if (!shapes) mode.shape.resize(0);
          return uniform(random) > 0.8;
        });
        state.band_hz = {2.0, 60.0};
        states.push_back(std::move(state));
      }
      for (const auto& parameter : parameters) {
        if (parameter.per_state) continue;
        const double off = std::pow(10, uniform(random));
        const auto targets =
            parameter.targets.empty() ? std::vector{parameter.name} : parameter.targets;
        for (auto& state : states) {
          for (const auto& target : targets) {
            model::set_parameter(state.scene, target, off * model::parameter(state.scene, target));
          }
        }
      }
      ident::UpdateOptions options;
      options.model_relative_std = 1e-3;
      const ident::UpdateProblem problem(states, parameters, options);
      int fits = 0;
      std::string failure;
      const auto answers = ident::find_answers(problem, options, fits, failure);
      // The truth fits within noise and segments, 0.2 %; beyond 4 std lies 1 answer in 16,000.
      bool right = !answers.empty() && answers.front().errors.frequency < 5e-3;
      if (right) {
        const auto& best = answers.front();
        const double std = std::sqrt(best.hessian.inverse()(0, 0));
        right = std::abs(best.solution.q[0] - std::log(ident::testing::kLaboratoryEI)) < 4 * std;
      }
      lost += !right;
      alone += !right && !answers.empty() && answers.front().weight > 0.9;
    }
    const std::chrono::duration<double> time = std::chrono::steady_clock::now() - begin;
    fmt::print("| {:g}, {:g} | {} | {} | {} | {} | {:.2f} |\n", frequency, damping,
               shapes ? "yes" : "no", kFits, lost, alone, time.count() / kFits);
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc > 2 && std::string_view(argv[1]) == "starts") {
    starts(argv[2]);
    return 0;
  }
  fmt::print("| quantity                     |  n   | coverage   | bias / std   |\n");
  fmt::print("|------------------------------|------|------------|--------------|\n");
  bending();
  axial();
  update();
}
