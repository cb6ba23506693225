// Model choice: weights of models by their evidence, against numerical integration.
#include "ident/update/model_candidates.h"

#include "model/linear/modal_analysis.h"
#include "tests/ident/update/fit_data.h"
#include "tests/test.h"

namespace rigfit::ident::model_candidates_test {

// A hanger of 1 m between two supports, stress-free, 12 segments.
model::Scene hanger(const std::string& support, double EI) {
  using Kind = model::Support::Kind;
  auto scene = model::testing::vertical_beam(1, EI, 0.3, 12);
  scene.gravity.setZero();
  scene.members[0].name = "rod";
  scene.members[0].EI[1] = 200;
  for (auto& node : scene.nodes) {
    node.support.kind = support == "pinned" ? Kind::pinned : Kind::clamped;
  }
  return scene;
}

std::vector<MeasuredMode> measured(const model::Scene& truth, double std, std::uint64_t seed,
                                   std::size_t count) {
  std::mt19937_64 random(seed);
  auto modes = testing::modes_of(truth, model::ModePlane::in, count, std, &random);
  for (auto& mode : modes) mode.frequency_hz.std = std * mode.frequency_hz.value;
  return modes;
}

// ln of the integral over ln EI of prior and likelihood of these modes in order, the model's error
// tau integrated too; the priors as update_alternatives.h has them, about `centre`.
double log_evidence(const std::string& support, const std::vector<MeasuredMode>& modes,
                    double centre) {
  constexpr int kPoints = 4001;
  const double width = std::log(10.0), reach = 1.0;
  const auto exact = measured(hanger(support, 1), 0, 1, modes.size());  // f ~ sqrt(EI), stress-free
  double sum = 0, most = -1e300;
  std::vector<double> logs;
  for (int i = 0; i < kPoints; ++i) {
    const double q = std::log(centre) + reach * (2.0 * i / (kPoints - 1) - 1);
    const double prior =
        -0.5 * std::pow((q - std::log(centre)) / width, 2) - std::log(width * std::sqrt(2 * kPi));
    for (int t = 0; t <= 10; ++t) {
      const double tau = t == 0 ? 0 : 1e-4 * std::pow(10, (t - 1) / 3.0);
      double log = prior + std::log(t == 0 ? 0.5 : 0.05);
      for (std::size_t m = 0; m < modes.size(); ++m) {
        const auto& f = modes[m].frequency_hz;
        const double all = std::hypot(f.std / f.value, tau);
        const double e = std::log(exact[m].frequency_hz.value / f.value) + 0.5 * q;
        log += -0.5 * std::pow(e / all, 2) - std::log(all * std::sqrt(2 * kPi));
      }
      logs.push_back(log);
      most = std::max(most, log);
    }
  }
  for (const double log : logs) sum += std::exp(log - most);
  return most + std::log(sum * 2 * reach / (kPoints - 1));
}

// Two modes of 10 %: the ratio of their frequencies is 4 with pinned ends and 2.76 with clamped
// ones, 2.6 standard deviations apart.
TEST(ModelCandidates, WeightsAreThoseOfNumericalIntegration) {
  for (const char* truth : {"pinned", "clamped"}) {
    const auto modes = measured(hanger(truth, 2), 0.1, 3, 2);
    UpdateOptions options;
    options.segment_uncertainty = false;  // the data have the model's segments
    std::vector<ModelCandidate> candidates;
    for (const char* support : {"pinned", "clamped"}) {
      candidates.push_back({support, {{"rod", hanger(support, 2), modes}}, {{"rod.EI_z"}}});
    }
    const auto found = compare_candidates(candidates, options);
    ASSERT_EQ(found.candidates.size(), 2U);
    EXPECT_EQ(found.candidates[found.heaviest].name, truth);
    EXPECT_NEAR(found.candidates[0].weight + found.candidates[1].weight, 1, 1e-12);
    int compared = 0;
    for (const auto& one : found.candidates) {
      double sum = 0;
      for (const auto& answer : one.result.alternatives) {
        sum += std::exp(answer.log_evidence - one.result.log_evidence);
        const auto& pairs = answer.pairs;
        if (pairs.size() != 2 || pairs[0].order != 0 || pairs[1].order != 1) continue;
        // ln f is linear in ln EI, and its answer does not depend on tau: Laplace is exact.
        const double integral =
            answer.log_evidence - answer.log_detected - answer.log_false - answer.log_missed;
        EXPECT_NEAR(integral, log_evidence(one.name, modes, answer.parameters[0].value), 0.02)
            << one.name << " for " << truth;
        ++compared;
      }
      EXPECT_NEAR(sum, 1, 0.01);  // answers below 0.001 are not listed
    }
    EXPECT_GE(compared, 1);
  }
}

TEST(ModelCandidates, AParameterMoreMustEarnItsPlace) {
  const auto modes = measured(hanger("clamped", 2), 0.002, 5, 4);
  const UpdateState state{"rod", hanger("clamped", 2), modes};
  const auto found = compare_candidates(
      {{"EI", {state}, {{"rod.EI_z"}}}, {"EI, taper", {state}, {{"rod.EI_z"}, {"rod.taper"}}}},
      {.segment_uncertainty = false});
  EXPECT_GT(found.candidates[0].weight, found.candidates[1].weight);
  ASSERT_EQ(found.averaged.size(), 1U);
  EXPECT_TRUE(holds(found.averaged[0], 2));
}

}  // namespace rigfit::ident::model_candidates_test
