// Coverage and bias of EI from bending tests and of updated parameters over 200 virtual campaigns:
// the long form of what the unit tests check in short. Prints a table.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <random>

#include "ident/bending_test.h"
#include "ident/model_update.h"
#include "ident/virtual_bending.h"
#include "model/read_scene.h"

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

model::Scene cable(double tension, double EI) {
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
  model::set_parameter(scene, "cable.tension", tension);
  model::set_parameter(scene, "cable.EI", EI);
  return scene;
}

// Four tensions, six out-of-plane modes each; free: EI and four tensions.
void update() {
  const double tensions[] = {100, 200, 300, 400};
  std::vector<std::vector<double>> truth;
  for (const double T : tensions) {
    std::vector<double> frequencies;
    model::ModesOptions options;
    options.count = 24;
    for (const auto& mode : model::analyse_modes(cable(T, 0.6), options).modes) {
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
  std::sort(times.begin(), times.end());
  fmt::print("\nupdate, 4 tensions x 6 modes, 5 free parameters, one start: median {:.3f} s\n",
             times[times.size() / 2]);
}

}  // namespace

int main() {
  fmt::print("| quantity                     |  n   | coverage   | bias / std   |\n");
  fmt::print("|------------------------------|------|------------|--------------|\n");
  bending();
  update();
}
