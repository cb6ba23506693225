// A campaign as a whole: what its tests find reaches the scene of the fits, with its uncertainty.
#include "ident/campaign/campaign.h"

#include "ident/update/model_update.h"
#include "model/linear/modal_analysis.h"
#include "model/scene/parameters.h"
#include "model/scene/read_scene.h"
#include "signal/readers/read_recording.h"
#include "tests/test.h"

namespace rigfit::ident {
namespace {

const std::string kData = RIGFIT_TESTDATA;

/// EI(T) = 0.2 + 0.002 T N m2, each point to `relative_std`.
BendingCampaign bending(double relative_std) {
  BendingSource source{.name = "bending"};
  for (const double tension_N : {25.0, 100.0, 200.0, 300.0}) {
    const double EI = 0.2 + 0.002 * tension_N;
    source.values.push_back({.tension_N = tension_N, .EI_Nm2 = EI, .std = relative_std * EI});
  }
  BendingCampaign campaign;
  campaign.sources.push_back(std::move(source));
  return campaign;
}

/// Frequencies of the cable at two tensions, to 1e-4, where EI is what the bending tests say.
CampaignInputs campaign(double relative_std) {
  CampaignInputs inputs;
  inputs.tests.push_back(bending(relative_std));
  ModalInputs test{.name = "cable", .plane = model::ModePlane::in};
  test.scene = SceneUse{.scene = model::read_scene(kData + "/jalali2021/scenes/cable.toml"),
                        .tension_of = {"cable.tension"},
                        .EI_of = {"cable.EI"}};
  for (const double tension_N : {100.0, 300.0}) {
    model::Scene scene = test.scene->scene;
    model::set_parameter(scene, "cable.tension", 1.01 * tension_N);
    model::set_parameter(scene, "cable.EI", 0.2 + 0.002 * tension_N);
    int found = 0;
    for (const auto& mode : model::analyse_modes(scene, {.count = 12}).modes) {
      if (mode.plane != model::ModePlane::in || ++found > 4) continue;
      test.published.push_back({tension_N, mode.frequency_hz, {}});
    }
  }
  inputs.tests.push_back(std::move(test));
  FitInputs fit{.title = "tension", .tests = {1}};
  fit.free.push_back({.name = "tension", .targets = {"cable.tension"}, .per_state = true});
  fit.options.model_relative_std = 1e-4;
  fit.options.assumed_relative_std = 1e-4;
  inputs.fits.push_back(std::move(fit));
  return inputs;
}

TEST(Campaign, StiffnessOfTheBendingTestsReachesTheFitWithItsUncertainty) {
  const auto result = run_campaign(campaign(0.05));
  EXPECT_NEAR(result.known.EI.at(300).EI_Nm2, 0.8, 1e-6);
  const auto& fit = result.fits.at(0);
  ASSERT_EQ(fit.states.size(), 2u);
  EXPECT_EQ(fit.given[0].name, "cable, 100 N");
  // The scene has the EI of each state, not that of its file.
  EXPECT_NEAR(model::parameter(fit.given[1].scene, "cable.EI"), 0.8, 1e-6);
  const auto& parameters = fit.result.parameters;
  ASSERT_EQ(parameters.size(), 2u);
  EXPECT_NEAR(parameters[0].value / 101, 1, 1e-3);
  EXPECT_NEAR(parameters[1].value / 303, 1, 1e-3);
  // Four modes to 1e-4 tell EI better than 5 %: its tests' part of the tension is small, not none.
  const auto& budget = parameters[1].budget;
  EXPECT_TRUE(std::any_of(budget.begin(), budget.end(), [&](const auto& term) {
    return term.source.find("EI") != std::string::npos && term.std > 0.05 * parameters[1].std;
  }));
  // Bending tests that are known better leave the tension less uncertain.
  const auto better = run_campaign(campaign(0.005));
  EXPECT_LT(better.fits.at(0).result.parameters.at(1).std, 0.8 * parameters[1].std);
}

TEST(Campaign, IsTheFitAndTheModelThatItsPartsGiveByThemselves) {
  auto inputs = campaign(0.05);
  inputs.threads = 2;
  const auto result = run_campaign(inputs);
  const auto& test = std::get<ModalInputs>(inputs.tests[1]);
  const auto states = modal_states(test, result.known, {});
  const auto& model = std::get<ModalOutcome>(result.tests[1]).model;
  ASSERT_EQ(model.size(), states.size());
  for (std::size_t s = 0; s < states.size(); ++s) {
    EXPECT_EQ(model[s].analysis.modes.at(3).frequency_hz,
              states[s].analysis.modes.at(3).frequency_hz);
  }
  const auto& fit = result.fits[0];
  auto options = inputs.fits[0].options;
  options.inputs = known_inputs(result.known, {{*test.scene, 100.}, {*test.scene, 300.}});
  const auto alone = update_model(fit.given, inputs.fits[0].free, options).parameters[0];
  EXPECT_EQ(alone.value, fit.result.parameters[0].value);
  EXPECT_EQ(alone.std, fit.result.parameters[0].std);
}

TEST(Campaign, RecordedStatesNearOneTensionKeepTheirOwnChannels) {
  const auto inputs = campaign(0.05);
  std::vector<ModalTestState> recorded(2);
  for (std::size_t s : {0u, 1u}) {
    recorded[s].tension_N = 99.8 + 0.2 * static_cast<double>(s);
    recorded[s].modal.emplace().model.modes.resize(1 + s);
  }
  const auto states = modal_states(std::get<ModalInputs>(inputs.tests[1]), {}, recorded);
  ASSERT_EQ(states.size(), 3u);  // and 300 N, published
  EXPECT_EQ(states[0].recorded, &recorded[0]);
  EXPECT_EQ(states[1].recorded, &recorded[1]);
  EXPECT_EQ(states[0].rows.size(), 1u);  // what was published at 100 N is the second's
  EXPECT_GT(states[1].rows.size(), 2u);
}

TEST(Campaign, DecaysAreThoseOfTheDecayTestAndAMissingChannelIsRefused) {
  DecayInputs decays;
  const std::string file = kData + "/virtual_laboratory/cable-in-plane/rig/T200N-release.uff";
  decays.recordings.push_back(
      {.name = "release", .recording = signal::read_recording(file), .tension_N = 200.0});
  decays.options.channels = {"accelerometer", "not there"};
  const auto result = run_campaign({.tests = {decays}});
  const auto& found = std::get<DecayTest>(result.tests.at(0));
  ASSERT_EQ(found.channels.size(), 1u);
  EXPECT_EQ(std::ranges::count(found.findings, true, &Finding::refused), 1);
  decays.options.channels.pop_back();
  const auto alone = run_decay_test(decays.recordings[0], decays.options);
  ASSERT_FALSE(alone.channels.at(0).result.modes.empty());
  EXPECT_EQ(found.channels[0].result.modes.at(0).damping_ratio.value,
            alone.channels[0].result.modes[0].damping_ratio.value);
}

TEST(Campaign, WithoutTestsHasNoResults) {
  const auto result = run_campaign({});
  EXPECT_TRUE(result.fits.empty());
  EXPECT_TRUE(result.known.EI.empty());
}

}  // namespace
}  // namespace rigfit::ident
