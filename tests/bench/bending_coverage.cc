// Virtual bending tests with wire friction of several laws: how often the 95 % interval of EI holds
// the truth, bias in per cent and in standard uncertainties. Prints a Markdown table; the first
// argument is the number of campaigns (200).
#include <fmt/format.h>

#include <cmath>
#include <cstdlib>
#include <string>
#include <tuple>
#include <vector>

#include "ident/bending/bending_test.h"
#include "ident/virtual_rig/virtual_bending.h"
#include "ident/virtual_rig/virtual_laboratory.h"

namespace {

using namespace rigfit;

struct Scenario {
  std::string name;
  double tension_N, EI_Nm2, span_m, peak_load_N, friction_N, travel_m, exponent;
};

void row(const Scenario& scenario, int campaigns) {
  static std::uint64_t number = 17;
  ++number;
  int covered = 0, refused = 0;
  double bias = 0, relative_bias = 0, relative_std = 0;
  for (int k = 0; k < campaigns; ++k) {
    auto random = ident::random_stream(static_cast<std::uint64_t>(k), number);
    std::normal_distribution<double> normal;
    const ident::VirtualInstruments instruments;
    ident::VirtualBendingTest test;
    test.EI_Nm2 = scenario.EI_Nm2;
    test.tension_N = scenario.tension_N;
    test.peak_load_N = scenario.peak_load_N;
    test.friction_load_N = scenario.friction_N;
    test.friction_travel_m = scenario.travel_m;
    test.friction_exponent = scenario.exponent;
    test.tension_cell = instruments.tension_cell;
    test.load_cell = instruments.load_cell;
    test.lvdt = instruments.lvdt;
    ident::BendingTestOptions options;
    options.span_m = {scenario.span_m, 5e-4};
    options.tension_zero_std_N = instruments.tension_cell.offset_std;
    test.span_m = scenario.span_m + options.span_m.std * normal(random);
    const auto record = ident::virtual_bending_record(test, random);
    const auto result = ident::analyse_bending_test(
        {record.channel("tension").samples, record.channel("load").samples,
         record.channel("deflection").samples},
        options);
    if (result.refused) {
      ++refused;
      continue;
    }
    const auto& EI = result.stiffness;
    covered += EI.low <= scenario.EI_Nm2 && scenario.EI_Nm2 <= EI.high;
    bias += (EI.EI_Nm2.value - scenario.EI_Nm2) / EI.EI_Nm2.std;
    relative_bias += EI.EI_Nm2.value / scenario.EI_Nm2 - 1;
    relative_std += EI.EI_Nm2.std / EI.EI_Nm2.value;
  }
  const int kept = campaigns - refused;
  if (kept == 0) {
    fmt::print("| {:<46} | {:>6} | all refused |\n", scenario.name, refused);
    return;
  }
  fmt::print("| {:<46} | {:>6} | {:>8.1f} | {:>+7.2f} | {:>6.2f} | {:>+7.2f} |\n", scenario.name,
             refused, 100.0 * covered / kept, 100 * relative_bias / kept, 100 * relative_std / kept,
             bias / kept);
}

}  // namespace

int main(int argc, char** argv) {
  const int campaigns = argc > 1 ? std::max(2, std::atoi(argv[1])) : 200;
  fmt::print("{} virtual bending tests a row\n\n", campaigns);
  fmt::print(
      "| test                                           | refused | covered % | bias % |  std % | "
      "bias / std |\n|---|---|---|---|---|---|\n");
  for (const double T : {25.0, 100.0, 200.0, 300.0}) {
    const double EI = 0.08 + 0.042 * std::sqrt(T);
    for (const auto& [what, friction, travel, exponent] :
         std::vector<std::tuple<const char*, double, double, double>>{
             {"no friction", 0, 5e-5, 1},
             {"0.02 N over 0.05 mm", 0.02, 5e-5, 1},
             {"0.1 N over 0.2 mm", 0.1, 2e-4, 1},
             {"0.1 N, bilinear", 0.1, 2e-4, 0},
             {"0.05 N, long tail", 0.05, 1e-4, 1.5}}) {
      row({fmt::format("{:g} N, 0.5 m, 4 N, {}", T, what), T, EI, 0.5, 4, friction, travel,
           exponent},
          campaigns);
    }
  }
  return 0;
}
