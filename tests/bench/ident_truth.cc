// The rig of the virtual laboratory at two tensions, starts off by up to a factor of 10 in four
// parameters: how often is another answer found than the truth's, and how often does it stand
// alone?
#include <fmt/format.h>

#include <Eigen/LU>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "ident/update/assignment/update_alternatives.h"
#include "ident/update/model_update.h"
#include "model/scene/parameters.h"
#include "tests/bench/study.h"
#include "tests/ident/update/laboratory_rig.h"

namespace {

using namespace rigfit;

struct Kind {
  std::string name;
  double frequency, damping;  // relative standard deviations
  bool shapes;
};

// Modes of 90 segments, a tenth of them missing, fitted with 30 from starts anywhere in a factor of
// 10 either way.
void fit(const Kind& kind, std::uint64_t seed, study::Table& table) {
  const std::string laboratory = RIGFIT_TESTDATA "/virtual_laboratory";
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> uniform(-1, 1);
  std::normal_distribution<double> normal;
  std::vector<ident::UpdateState> states;
  const auto parameters = ident::testing::laboratory_parameters();
  for (const double tension : {200.0, 300.0}) {
    const double set = tension * (1 + 0.01 * normal(random));
    ident::UpdateState state{fmt::format("{:g} N", tension),
                             ident::testing::laboratory_rig(laboratory, "scenes", set, 30),
                             ident::testing::laboratory_modes(
                                 laboratory, tension, 90, kind.frequency, kind.damping, random)};
    std::erase_if(state.measured, [&](auto& mode) {
      if (!kind.shapes) mode.shape.resize(0);
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
  ident::UpdateOptions options{.model_relative_std = 1e-3};
  const auto [answers, seconds] = study::timed([&] {
    int fits = 0;
    std::string failure;
    return ident::find_answers(ident::UpdateProblem(states, parameters, options), options, fits,
                               failure);
  });
  // The truth fits within noise and segments, 0.2 %; beyond 4 std lies 1 answer in 16,000.
  bool right = !answers.empty() && answers.front().error < 5e-3;
  if (right) {
    const auto& best = answers.front();
    const double std = std::sqrt(best.hessian.inverse()(0, 0));
    right = std::abs(best.solution.q[0] - std::log(ident::testing::kLaboratoryEI)) < 4 * std;
  }
  table.add("lost", !right);
  table.add("wrong and alone", !right && !answers.empty() && answers.front().weight > 0.9);
  table.add("s a fit", seconds);
}

}  // namespace

int main(int argc, char** argv) {
  using enum study::Of;
  const Kind kinds[] = {{"f to 1e-4, damping to 1 %, shapes", 1e-4, 0.01, true},
                        {"f to 1e-4, damping to 1 %", 1e-4, 0.01, false},
                        {"f to 1e-3, damping to 3 %", 1e-3, 0.03, false}};
  study::run(study::arguments(argc, argv, 60),
             {"modes", {{"lost", sum}, {"wrong and alone", sum}, {"s a fit", mean}}}, kinds, fit);
}
