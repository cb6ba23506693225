#include "ident/campaign/single_tests/axial_campaign.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <numbers>
#include <stdexcept>

#include "ident/axial/rod_stiffness.h"
#include "ident/campaign/single_tests/rate_uncertainty.h"
#include "ident/statistics/in_parallel.h"
#include "model/linear/modal_analysis.h"
#include "signal/decay/decay_window.h"
#include "signal/estimation/robust.h"
#include "signal/recording/recording_error.h"
#include "signal/sinusoids/decay_modes.h"

namespace rigfit::ident {
namespace {

// What one recording holds.
struct Found {
  std::vector<AxialFoundDecay> decays;
  std::vector<Finding> findings;
};

Found find(const AxialInputs& inputs, std::size_t index) {
  const auto& entry = inputs.recordings[index];
  const auto& recording = entry.recording;
  const double rate = recording.sample_rate_hz;
  Found found;
  const auto refuse = [&](const char* code, const char* why) {
    found.findings.push_back({code, why, entry.name, true});
  };
  if (recording.time_s.size() > 0 || !(rate > 0)) {
    refuse("not_uniform", recording.time_s.size() > 0 ? "its samples are not evenly spaced in time"
                                                      : "gives no sample rate; add sample_rate_hz");
    return found;
  }
  const signal::Channel* channel = nullptr;
  try {
    if (!inputs.channel.empty()) {
      channel = &recording.channel(inputs.channel);
    } else if (recording.channels.size() == 1) {
      channel = &recording.channels.front();
    } else {
      refuse("channel", "holds several channels; name one");
      return found;
    }
  } catch (const signal::RecordingError& error) {
    refuse("channel", error.what());
    return found;
  }
  signal::DecayOptions options;
  options.band_low_hz = inputs.band_low_hz, options.band_high_hz = inputs.band_high_hz;
  options.choose_window = false;
  const bool banded = inputs.band_low_hz > 0 || inputs.band_high_hz > 0;
  const signal::DecayBand band{
      inputs.band_low_hz / rate,
      inputs.band_high_hz > 0 ? std::min(inputs.band_high_hz / rate, 0.5) : 0.5, !banded};
  for (const auto& window : signal::find_decays(channel->samples, band)) {
    AxialFoundDecay d;
    d.recording = index, d.channel = channel->name, d.unit = channel->unit, d.rate_hz = rate;
    d.samples = channel->samples.segment(window.start, window.end - window.start);
    d.result = signal::estimate_decay(d.samples, rate, options);
    d.samples_start_s = recording.start_time_s + static_cast<double>(window.start) / rate;
    d.start_s = d.samples_start_s + static_cast<double>(d.result.start) / rate;
    const std::string where = fmt::format("{}: {} at {:.4g} s", entry.name, d.channel, d.start_s);
    if (!d.result.refusal_code.empty() || d.result.modes.empty()) {
      d.left_out = d.result.refusal_code.empty() ? "no_mode" : d.result.refusal_code;
      found.findings.push_back({d.left_out, "left out: " + d.result.refusal, where, false});
    }
    for (const auto& n : d.result.notes) {
      // What is ordinary in this test stays with the decay.
      if (n.code != "start_chosen" && n.code != "coloured_residual" && n.code != "steady_tone" &&
          n.code != "fitted_in_band") {
        found.findings.push_back({n.code, n.message, where, false});
      }
    }
    found.decays.push_back(std::move(d));
  }
  if (found.decays.empty()) refuse("no_decay", "holds no decay");
  return found;
}

struct ModeOfDecay {
  std::size_t decay = 0, mode = 0;
  double log_EA = 0, share = 0;  // of the energy of the decay's modes
};

// Beyond so many times the median standard uncertainty a record says less than a hundredth of it.
constexpr double kImprecise = 10;

// `decaying`: only modes that are seen to decay, which hum and ambient motion are not.
std::vector<ModeOfDecay> possible_modes(const AxialInputs& inputs,
                                        const std::vector<AxialFoundDecay>& decays, bool decaying) {
  std::vector<ModeOfDecay> all;
  const auto& setup = inputs.setup;
  for (std::size_t k = 0; k < decays.size(); ++k) {
    const auto& d = decays[k];
    if (!d.left_out.empty()) continue;
    const double length = inputs.recordings[d.recording].length_m;
    double energy = 0;
    for (const auto& mode : d.result.modes) energy += mode.energy;
    for (std::size_t m = 0; m < d.result.modes.size(); ++m) {
      const auto& mode = d.result.modes[m];
      const double omega = 2 * std::numbers::pi * mode.frequency_hz.value;
      const bool swings = model::kStandardGravity > 0.1 * omega * omega * length;
      if (swings && inputs.band_high_hz == 0 && inputs.band_low_hz == 0) continue;
      if (decaying && !(mode.damping_ratio.value > 2 * mode.damping_ratio.std)) continue;
      const auto rod = rod_stiffness(
          {omega * omega, setup.mass_kg.value, setup.mass_per_length_kg_m.value, length, 0});
      all.push_back({k, m, std::log(rod.cable_N_m * length), mode.energy / energy});
    }
  }
  return all;
}

// The strongest mode of every decay among those at the EA that most of the energy has.
void choose_modes(const AxialInputs& inputs, AxialCampaignResult& result) {
  auto all = possible_modes(inputs, result.decays, true);
  if (all.empty()) all = possible_modes(inputs, result.decays, false);
  constexpr double kSame = 0.5;  // of ln EA: 1.6 either way
  const auto score = [&](double log_EA, bool take) {
    std::vector<double> best(result.decays.size(), 0);
    for (const auto& one : all) {
      if (std::abs(one.log_EA - log_EA) > kSame || !(one.share > best[one.decay])) continue;
      best[one.decay] = one.share;
      if (take) result.decays[one.decay].mode = one.mode;
    }
    double sum = 0;
    for (double b : best) sum += b;
    return sum;
  };
  double most = 0, at = 0;
  for (const auto& one : all) {
    const double sum = score(one.log_EA, false);
    if (sum > most) most = sum, at = one.log_EA;
  }
  if (most > 0) score(at, true);
  const auto leave_out = [&](AxialFoundDecay& d, const char* code, std::string why) {
    d.left_out = code, d.mode.reset();
    result.findings.push_back(
        {d.left_out, std::move(why),
         fmt::format("{}: {} at {:.4g} s", inputs.recordings[d.recording].name, d.channel,
                     d.start_s),
         false});
  };
  std::vector<double> stds;
  for (auto& d : result.decays) {
    if (d.mode) stds.push_back(d.result.modes[*d.mode].damped_frequency_hz.std);
  }
  const double median = stds.empty() ? 0 : signal::median(stds);
  for (auto& d : result.decays) {
    if (!d.left_out.empty()) continue;
    if (!d.mode) {
      leave_out(d, "other_mode",
                fmt::format("left out: its strongest mode, {:.4g} Hz, is not the axial one of the "
                            "other records or does not decay; give a band",
                            d.result.modes.front().frequency_hz.value));
      continue;
    }
    const auto& f = d.result.modes[*d.mode].damped_frequency_hz;
    if (f.std > kImprecise * median) {
      leave_out(d, "imprecise_decay",
                fmt::format("left out: {:.4g} Hz is known to {:.2g} Hz, the other records to "
                            "{:.2g} Hz: all records of a length count the same",
                            f.value, f.std, median));
    }
  }
}

/// The hung mass carries the uncertainty of the rate; the budget parts them again.
void part_axial_budget(const signal::Estimate& mass, double rate_relative_std,
                       AxialCampaignResult& result) {
  auto& budget = result.test->budget;
  const auto row = std::find_if(budget.begin(), budget.end(),
                                [](const BudgetRow& one) { return one.source == "hung mass"; });
  if (row == budget.end()) return;
  const auto [own, rate] = parts_of_mass(row->contribution_N, mass, rate_relative_std);
  const double squares = own * own + rate * rate;
  BudgetRow of_rate = *row;
  of_rate.source = kRateSource;
  of_rate.unit = "1";
  of_rate.value = 1;
  of_rate.std = rate_relative_std;
  of_rate.sensitivity = 2 * mass.value * row->sensitivity;
  of_rate.contribution_N = rate;
  row->contribution_N = own;
  row->std = mass.std;
  if (squares > 0) {
    of_rate.share = row->share * rate * rate / squares;
    row->share -= of_rate.share;
  }
  budget.push_back(std::move(of_rate));
  std::stable_sort(budget.begin(), budget.end(),
                   [](const BudgetRow& a, const BudgetRow& b) { return a.share > b.share; });
}

}  // namespace

AxialCampaignResult axial_campaign(const AxialInputs& inputs) {
  AxialCampaignResult result;
  std::vector<Found> found(inputs.recordings.size());
  in_parallel(found.size(), inputs.threads, [&](std::size_t i) { found[i] = find(inputs, i); });
  for (auto& one : found) {
    std::move(one.decays.begin(), one.decays.end(), std::back_inserter(result.decays));
    std::move(one.findings.begin(), one.findings.end(), std::back_inserter(result.findings));
  }
  choose_modes(inputs, result);
  std::vector<AxialDecay> decays;
  double rate_relative_std = 0, longest_m = 0;
  for (const auto& d : result.decays) {
    if (!d.mode) continue;
    const auto& mode = d.result.modes[*d.mode];
    const auto& recording = inputs.recordings[d.recording];
    rate_relative_std = std::max(rate_relative_std, recording.recording.sample_rate_relative_std);
    longest_m = std::max(longest_m, recording.length_m);
    decays.push_back({fmt::format("{} at {:.4g} s", recording.name, d.start_s), recording.length_m,
                      mode.damped_frequency_hz, mode.damping_ratio});
  }
  if (decays.empty()) {
    result.findings.push_back(
        {"no_decay", "none of the records holds a decay that can be used", "", true});
    return result;
  }
  try {
    AxialSetup setup = inputs.setup;
    // The cable's own mass, a third of it, is scaled along with the hung one.
    const double moved = setup.mass_kg.value + setup.mass_per_length_kg_m.value * longest_m / 3;
    const double rate = rate_relative_std * moved / setup.mass_kg.value;
    if (rate > 0) setup.mass_kg = mass_with_rate(setup.mass_kg, rate);
    result.test = axial_test(decays, setup, inputs.options);
    if (rate > 0) {
      part_axial_budget(inputs.setup.mass_kg, rate, result);
      const auto& first = decays.front().damped_frequency_hz;
      if (auto said = rate_finding(rate_relative_std, first.value, first.std, "")) {
        result.findings.push_back(std::move(*said));
      }
    }
  } catch (const std::invalid_argument& error) {
    result.findings.push_back({"axial", error.what(), "", true});
    return result;
  }
  for (const auto& n : result.test->notes) {
    result.findings.push_back({n.code, n.message, n.where, false});
  }
  return result;
}

AxialKnowledge knowledge_of(const AxialTestResult& result) {
  auto EA = result.EA_N;
  // A bound without an upper end is no value for a scene.
  if (!std::isfinite(EA.std)) EA.value = EA.std = std::numeric_limits<double>::quiet_NaN();
  return {EA, result.damping_ratio};
}

void apply_axial(const AxialKnowledge& known, const std::vector<std::string>& EA_of,
                 const std::vector<std::string>& damping_of, model::Scene& scene, int state,
                 AxialUncertainty* uncertainty) {
  const auto apply = [&](const signal::Estimate& value, const std::vector<std::string>& names,
                         UncertainInput* input) {
    if (!std::isfinite(value.value)) return;
    for (const auto& name : names) {
      model::set_parameter(scene, name, value.value);
      if (input && value.std > 0) input->effects.push_back({state, name, value.std});
    }
  };
  apply(known.EA_N, EA_of, uncertainty ? &uncertainty->EA : nullptr);
  apply(known.damping_ratio, damping_of, uncertainty ? &uncertainty->damping : nullptr);
}

std::vector<AxialRecord> axial_records(const AxialInputs& inputs,
                                       const AxialCampaignResult& result) {
  std::vector<AxialRecord> records;
  std::size_t k = 0;
  for (const auto& decay : result.decays) {
    const bool used = decay.mode && result.test;
    records.push_back(
        {&inputs.recordings[decay.recording], &decay, used ? &result.test->samples[k++] : nullptr});
  }
  return records;
}

}  // namespace rigfit::ident
