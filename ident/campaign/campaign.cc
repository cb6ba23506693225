#include "ident/campaign/campaign.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "ident/statistics/in_parallel.h"
#include "model/scene/parameters.h"
#include "signal/recording/recording_error.h"

namespace rigfit::ident {
namespace {

using Tasks = std::vector<std::function<void()>>;

void run_all(const Tasks& tasks, int threads) {
  in_parallel(tasks.size(), threads, [&](std::size_t i) { tasks[i](); });
}

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
    if (!std::isfinite(row.measured_hz) || row.origin != origin) continue;
    MeasuredMode mode;
    const double by_rate = state.clock_relative_std * row.measured_hz;
    const double own = std::sqrt(std::max(0.0, row.std_hz * row.std_hz - by_rate * by_rate));
    mode.frequency_hz = {row.measured_hz, by_rate > 0 && own > 0 ? own : row.std_hz};
    mode.damping_ratio = {row.damping, row.damping_std};
    mode.plane = test.setup.plane;
    mode.shape = row.shape;
    state.measured.push_back(std::move(mode));
  }
  return state;
}

CampaignFitOutcome run_fit(const FitInputs& fit, const CampaignResult& so_far) {
  CampaignFitOutcome result;
  std::vector<StateUse> uses;
  for (const std::size_t t : fit.tests) {
    const auto& test = so_far.inputs.modal.at(t);
    for (const auto& modal : so_far.modal[t].model) {
      UpdateState state = fit_state(test, modal);
      if (state.measured.empty()) continue;
      const int index = static_cast<int>(result.states.size());
      uses.push_back({index, &*test.scene, modal.tension_N});
      result.states.push_back({t, &modal});
      result.task.states.push_back(std::move(state));
    }
  }
  result.task.free = fit.free;
  result.task.options = fit.options;
  result.task.hold_out = fit.hold_out;
  for (auto& input : known_inputs(so_far.known, uses)) {
    result.task.options.inputs.push_back(std::move(input));
  }
  if (result.states.empty()) return result;
  result.outcome = fit_campaign(result.task);
  return result;
}

/// `scene` with what a fit found of the state at that tension, else with what its states share;
/// false: the fit has found nothing.
bool apply_fit(const CampaignFitOutcome& fit, std::optional<double> tension_N,
               model::Scene& scene) {
  const auto& result = fit.outcome.result;
  if (fit.states.empty() || result.status != UpdateStatus::converged) return false;
  std::size_t from = 0;
  bool own = false;
  for (std::size_t s = 0; s < fit.states.size(); ++s) {
    if (fit.states[s].modal->tension_N == tension_N) from = s, own = true;
  }
  for (const auto& parameter : fit.task.free) {
    if (!own && parameter.per_state) continue;
    const auto& targets = parameter.targets;
    for (const auto& name : targets.empty() ? std::vector{parameter.name} : targets) {
      model::set_parameter(scene, name, model::parameter(result.scenes[from], name));
    }
  }
  return true;
}

/// The scene as given and as fitted, with the load and the sensor alone; empty: it lacks one.
std::vector<ModelVersion> versions(const DecayInputs& test, const std::string& channel,
                                   std::optional<double> tension_N, const CampaignResult& so_far) {
  model::Scene scene = scene_at(*test.scene, so_far.known, tension_N).scene;
  const auto other = test.sensors.find(channel);
  const std::string& sensor = other == test.sensors.end() ? channel : other->second;
  std::erase_if(scene.sensors, [&](const auto& one) { return one.name != sensor; });
  std::erase_if(scene.loads, [&](const auto& load) { return load.name != test.load; });
  if (scene.sensors.empty() || scene.loads.empty()) return {};
  std::vector<ModelVersion> all{{"as given", scene}};
  for (const std::size_t f : test.fits) {
    model::Scene fitted = scene;
    if (apply_fit(so_far.fits.at(f), tension_N, fitted)) {
      all.push_back({so_far.inputs.fits[f].title, std::move(fitted)});
    }
  }
  return all;
}

void run_channel(const DecayInputs& test, const CampaignResult& so_far, int threads,
                 const std::string& channel, DecayOutcome& outcome) {
  const auto& [name, recording, tension_N] = test.recordings[outcome.recording];
  DecayTestOptions options = test.options;
  options.channels = {channel};
  outcome.found = std::move(run_decay_test(recording, options).channels.front());
  const auto& strongest = outcome.found.strongest;
  if (!strongest.refusal_code.empty() || strongest.modes.empty() || !test.scene) return;
  const auto scenes = versions(test, channel, tension_N, so_far);
  if (scenes.empty()) return;
  outcome.modelled = true;
  outcome.answers = release_answers(
      {outcome.found.samples, recording.sample_rate_hz, strongest.start, strongest.end},
      options.decay, scenes, threads);
}

DecaysOutcome run_decays(const DecayInputs& test, const CampaignResult& so_far) {
  DecaysOutcome result;
  std::vector<std::string> channels;
  for (std::size_t r = 0; r < test.recordings.size(); ++r) {
    const auto& [name, recording, tension_N] = test.recordings[r];
    if (auto refused = not_uniform(recording)) {
      refused->where = name;
      result.findings.push_back(std::move(*refused));
      continue;
    }
    std::vector<std::string> names = test.options.channels;
    if (names.empty()) {
      for (const auto& channel : recording.channels) names.push_back(channel.name);
    }
    for (const auto& channel : names) {
      try {
        (void)recording.channel(channel);
      } catch (const signal::RecordingError& error) {
        result.findings.push_back({"channel", error.what(), name, true});
        continue;
      }
      channels.push_back(channel);
      result.channels.push_back({r, {}, false, {}});
    }
  }
  const int threads = so_far.inputs.threads;
  in_parallel(channels.size(), threads, [&](std::size_t i) {
    run_channel(test, so_far, threads, channels[i], result.channels[i]);
  });
  return result;
}

}  // namespace

CampaignResult run_campaign(CampaignInputs inputs) {
  CampaignResult result;
  result.inputs = std::move(inputs);
  auto& in = result.inputs;
  result.bending.resize(in.bending.size());
  result.axial.resize(in.axial.size());
  result.tension.resize(in.tension.size());
  result.modal.resize(in.modal.size());
  result.fits.resize(in.fits.size());
  result.decays.resize(in.decays.size());
  Tasks tasks;
  // `work` for each of the inputs, one after the other where `threads` is 1.
  const auto stage = [&](const auto& all, const auto& work, bool done) {
    for (std::size_t i = 0; i < all.size(); ++i) {
      tasks.emplace_back([&in, work, done, i] {
        work(i);
        if (done && in.advance) in.advance();
      });
    }
  };
  const auto finish = [&] {
    run_all(tasks, in.threads);
    tasks.clear();
  };
  stage(
      in.bending, [&](auto i) { result.bending[i] = analyse_bending_campaign(in.bending[i]); },
      true);
  stage(
      in.axial, [&](auto i) { result.axial[i] = axial_campaign(in.axial[i]); }, true);
  stage(
      in.tension, [&](auto i) { result.tension[i] = tension_campaign(in.tension[i]); }, true);
  stage(
      in.modal,
      [&](auto i) {
        auto& test = in.modal[i];
        result.modal[i].test = run_modal_test(std::exchange(test.recordings, {}), test.options);
      },
      false);
  finish();
  for (const auto& one : result.bending) {
    if (result.known.EI.empty()) result.known.EI = one.curve;
  }
  for (const auto& one : result.axial) {
    if (!result.known.axial && one.test) result.known.axial = knowledge_of(*one.test);
  }
  stage(
      in.modal,
      [&](auto i) {
        const auto& test = in.modal[i];
        if (!test.scene) return;
        result.modal[i].model = modal_states(test.setup, *test.scene, result.known,
                                             result.modal[i].test.states, test.published);
      },
      true);
  finish();
  stage(
      in.fits, [&](auto i) { result.fits[i] = run_fit(in.fits[i], result); }, true);
  finish();
  stage(
      in.decays, [&](auto i) { result.decays[i] = run_decays(in.decays[i], result); }, true);
  finish();
  return result;
}

}  // namespace rigfit::ident
