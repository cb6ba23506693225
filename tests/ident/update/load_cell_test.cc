// Tensions read by a load cell whose scale and zero are wrong, the same in every state.
#include "ident/update/model_update.h"
#include "model/linear/modal_analysis.h"
#include "model/scene/parameters.h"
#include "tests/ident/update/fit_data.h"
#include "tests/scenes.h"
#include "tests/test.h"

namespace rigfit::ident::load_cell_test {

constexpr double kScale = 1.03, kZero = -1.5;  // N

std::vector<UpdateState> states(double EI, double std, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::vector<UpdateState> all;
  for (const double reading : {25.0, 100.0, 200.0, 300.0}) {
    const auto truth = model::testing::paper_cable(kScale * reading + kZero, EI, 12);
    UpdateState state{.name = std::to_string(static_cast<int>(reading)) + " N",
                      .scene = model::testing::paper_cable(reading, EI, 12),
                      .measured = testing::modes_of(truth, model::ModePlane::in, 6, std, &random)};
    all.push_back(std::move(state));
  }
  return all;
}

// 95 % intervals of three unknowns over 20 campaigns: within three binomial deviations (8.4 %).
TEST(LoadCell, ScaleAndZeroCommonToAllStatesAreFound) {
  constexpr std::array truth{0.6, kScale, kZero};
  int covered = 0, total = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    UpdateOptions options = testing::plain_options();
    const auto result = update_model(
        states(0.6, 1e-3, seed), {{"cable.EI"}, {"load_cell.scale"}, {"load_cell.zero"}}, options);
    ASSERT_EQ(result.status, UpdateStatus::converged) << result.message;
    for (std::size_t k = 0; k < truth.size(); ++k) {
      const auto& found = result.parameters[k];
      EXPECT_GT(found.std, 0);
      covered += std::abs(found.value - truth[k]) <= result.coverage_factor * found.std;
      ++total;
    }
    // Known well enough to be of use: 0.1 % of a frequency is 0.2 % of a tension.
    EXPECT_LT(result.parameters[1].std, 2e-3);
    EXPECT_LT(result.parameters[2].std, 0.2);
  }
  EXPECT_GE(covered, 0.866 * total);
}

// Readings taken for true rule the model out, and a free zero that starts at zero has a scale.
TEST(LoadCell, ReadingsTakenForTrueAreRuledOut) {
  UpdateOptions options = testing::plain_options();
  const auto wrong = update_model(states(0.6, 1e-3, 1), {{"cable.EI"}}, options);
  EXPECT_LT(wrong.fit.p_value, 1e-6);
  const auto right = update_model(states(0.6, 1e-3, 1),
                                  {{"cable.EI"}, {"load_cell.scale"}, {"load_cell.zero"}}, options);
  EXPECT_GT(right.fit.p_value, 1e-3);
}

}  // namespace rigfit::ident::load_cell_test
