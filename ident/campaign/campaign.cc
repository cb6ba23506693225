#include "ident/campaign/campaign.h"

#include <chrono>
#include <iterator>

#include "ident/statistics/in_parallel.h"
#include "ident/update/model_update.h"
#include "model/scene/parameters.h"

namespace rigfit::ident {
namespace {

/// The measured modes of a state as a fit takes them: from its recordings where it has any. That
/// part of their standard uncertainty that comes from the sample rate is left to the clock that
/// states share.
UpdateState fit_state(const ModalInputs& test, const ModalState& modal) {
  UpdateState state;
  state.name = test.name + ", " + state_label(modal.tension_N);
  state.scene = modal.rig.scene;
  const Origin origin = modal.recorded ? modal.recorded->origin : Origin::published;
  if (modal.recorded) {
    state.clock_relative_std = modal.recorded->hammer.frfs.sample_rate_relative_std;
  }
  for (const auto& row : modal.rows) {
    if (!std::isfinite(row.frequency_hz.value) || row.origin != origin) continue;
    auto& [frequency, std] = state.measured.emplace_back(row).frequency_hz;
    const double by_rate = state.clock_relative_std * frequency;
    const double own = std::sqrt(std::max(0.0, std * std - by_rate * by_rate));
    if (by_rate > 0 && own > 0) std = own;
  }
  return state;
}

CampaignFitOutcome run_fit(const FitInputs& fit, const CampaignResult& so_far) {
  CampaignFitOutcome result;
  std::vector<StateUse> uses;
  for (const std::size_t t : fit.tests) {
    const auto& test = std::get<ModalInputs>(so_far.inputs.tests.at(t));
    for (const auto& modal : std::get<ModalOutcome>(so_far.tests[t]).model) {
      UpdateState state = fit_state(test, modal);
      if (state.measured.empty()) continue;
      uses.push_back({*test.scene, modal.tension_N});
      result.states.push_back(&modal);
      result.given.push_back(std::move(state));
    }
  }
  if (result.states.empty()) return result;
  UpdateOptions options = fit.options;
  std::ranges::move(known_inputs(so_far.known, uses), std::back_inserter(options.inputs));
  result.result = update_model(result.given, fit.free, options);
  return result;
}

/// `scene` with what a fit found of the state at that tension, else with what its states share;
/// false: the fit has found nothing.
bool apply_fit(const CampaignResult& so_far, std::size_t index, std::optional<double> tension_N,
               model::Scene& scene) {
  const auto& fit = so_far.fits.at(index);
  const auto& result = fit.result;
  if (fit.states.empty() || result.status != UpdateStatus::converged) return false;
  std::vector<std::optional<double>> tensions(fit.states.size());
  std::ranges::transform(fit.states, tensions.begin(),
                         [](const auto& state) { return state->tension_N; });
  const auto own = state_at(tensions, tension_N);
  for (const auto& parameter : so_far.inputs.fits[index].free) {
    if (!own && parameter.per_state) continue;
    for (const auto& name : parameter.all_targets()) {
      model::set_parameter(scene, name, model::parameter(result.scenes[own.value_or(0)], name));
    }
  }
  return true;
}

/// The scene as given and as fitted, with the load and the sensor alone; empty: it lacks one.
std::vector<ModelVersion> versions(const DecayInputs& test, const std::string& channel,
                                   std::optional<double> tension_N, const CampaignResult& so_far) {
  model::Scene scene = scene_at(*test.scene, so_far.known, tension_N);
  const auto other = test.sensors.find(channel);
  const std::string& sensor = other == test.sensors.end() ? channel : other->second;
  std::erase_if(scene.sensors, [&](const auto& one) { return one.name != sensor; });
  std::erase_if(scene.loads, [&](const auto& load) { return load.name != test.load; });
  if (scene.sensors.empty() || scene.loads.empty()) return {};
  std::vector<ModelVersion> all{{"as given", scene}};
  for (const std::size_t f : test.fits) {
    model::Scene fitted = scene;
    if (apply_fit(so_far, f, tension_N, fitted)) {
      all.push_back({so_far.inputs.fits[f].title, std::move(fitted)});
    }
  }
  return all;
}

DecayTest run_decays(const DecayInputs& test, const CampaignResult& so_far) {
  const int threads = so_far.inputs.threads;
  std::vector<DecayTest> each(test.recordings.size());
  in_parallel(each.size(), threads, [&](std::size_t r) {
    const TestRecording& one = test.recordings[r];
    each[r] = run_decay_test(one, test.options);
    for (auto& found : each[r].channels) {
      found.recording = r;
      if (found.result.modes.empty() || !test.scene) continue;
      found.answers = release_answers(
          found, test.options.decay, versions(test, found.channel, one.tension_N, so_far), threads);
    }
  });
  DecayTest all;
  for (auto& one : each) {
    std::ranges::move(one.channels, std::back_inserter(all.channels));
    std::ranges::move(one.findings, std::back_inserter(all.findings));
  }
  return all;
}

// What each test gives by itself.
TestResult analysed(const BendingCampaign& test) { return analyse_bending_campaign(test); }
TestResult analysed(const AxialInputs& test) { return axial_campaign(test); }
TestResult analysed(const TensionInputs& test) { return tension_campaign(test); }
TestResult analysed(ModalInputs& test) {
  return ModalOutcome{run_modal_test(std::exchange(test.recordings, {}), test.options), {}};
}
TestResult analysed(const DecayInputs&) { return DecayTest(); }  // after the fits

KnownValues known_values(const std::vector<TestResult>& tests) {
  KnownValues known;
  const AxialTestResult* axial = nullptr;
  for (const auto& one : tests) {
    const auto* bending = std::get_if<BendingCampaignResult>(&one);
    if (bending && known.EI.empty()) known.EI = bending->curve;
    const auto* hung = std::get_if<AxialCampaignResult>(&one);
    if (hung && hung->test && !axial) axial = &*hung->test;
  }
  if (!axial) return known;
  known.damping_ratio = axial->damping_ratio;
  // A bound without an upper end is no value for a scene.
  if (!std::isinf(axial->EA_N.std)) known.EA_N = axial->EA_N;
  return known;
}

}  // namespace

CampaignResult run_campaign(CampaignInputs inputs) {
  CampaignResult result;
  result.inputs = std::move(inputs);
  auto& in = result.inputs;
  result.tests.resize(in.tests.size());
  result.fits.resize(in.fits.size());
  result.test_s.resize(in.tests.size());
  result.fit_s.resize(in.fits.size());
  // `work` for each test or fit, one after the other where `threads` is 1.
  const auto each = [&](std::vector<double>& spent_s, const auto& work) {
    in_parallel(spent_s.size(), in.threads, [&](std::size_t i) {
      const auto begin = std::chrono::steady_clock::now();
      work(i);
      spent_s[i] += std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    });
  };
  each(result.test_s, [&](std::size_t i) {
    result.tests[i] = std::visit([](auto& test) { return analysed(test); }, in.tests[i]);
  });
  result.known = known_values(result.tests);
  each(result.test_s, [&](std::size_t i) {
    const auto* test = std::get_if<ModalInputs>(&in.tests[i]);
    if (!test || !test->scene) return;
    auto& outcome = std::get<ModalOutcome>(result.tests[i]);
    outcome.model = modal_states(*test, result.known, outcome.test.states);
  });
  each(result.fit_s, [&](std::size_t i) {
    result.fits[i] = run_fit(in.fits[i], result);
    in.advance();
  });
  each(result.test_s, [&](std::size_t i) {
    const auto* test = std::get_if<DecayInputs>(&in.tests[i]);
    if (test) result.tests[i] = run_decays(*test, result);
    in.advance();
  });
  return result;
}

}  // namespace rigfit::ident
