// The rig of the virtual laboratory at two tensions, starts off by up to a factor of 10 in four
// parameters: how often is another answer found than the truth's? Prints a table.
//   ident_truth testdata/virtual_laboratory
#include <fmt/format.h>

#include <Eigen/LU>
#include <chrono>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "ident/update/assignment/update_alternatives.h"
#include "ident/update/model_update.h"
#include "model/scene/parameters.h"
#include "tests/ident/update/laboratory_rig.h"

namespace {

using namespace rigfit;

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
      bool right = !answers.empty() && answers.front().error < 5e-3;
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
  if (argc < 2) {
    fmt::print("ident_truth testdata/virtual_laboratory\n");
    return 2;
  }
  starts(argv[1]);
}
