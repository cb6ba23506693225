#include "ident/campaign/single_tests/axial_campaign.h"

#include <fmt/format.h>

#include <iterator>
#include <numeric>

#include "ident/statistics/in_parallel.h"
#include "model/linear/modal_analysis.h"
#include "signal/decay/decay.h"
#include "signal/estimation/robust.h"
#include "signal/recording/add_note.h"
#include "signal/recording/recording.h"

namespace rigfit::ident {
namespace {

/// A decay in messages.
std::string place_of(const AxialRecord& d) {
  return fmt::format("{}: {} at {:.4g} s", d.file, d.channel, d.start_s);
}

/// The decays of one recording.
AxialCampaignResult find(const AxialInputs& inputs, std::size_t index) {
  const std::optional<TestRecording> placed = placed_evenly(inputs.recordings[index]);
  const TestRecording& entry = placed ? *placed : inputs.recordings[index];
  const auto& recording = entry.recording;
  const double rate = recording.sample_rate_hz;
  AxialCampaignResult found;
  const auto refused = [&](Finding finding) {
    found.findings.push_back(std::move(finding));
    return std::move(found);
  };
  if (auto uneven = not_uniform(recording, entry.name)) return refused(std::move(*uneven));
  if (inputs.channel.empty() && recording.channels.size() > 1) {
    return refused({"channel", "holds several channels; name one", entry.name, true});
  }
  const signal::Channel* channel = nullptr;
  try {
    channel = &recording.channel(inputs.channel.empty() ? "#1" : inputs.channel);
  } catch (const signal::RecordingError& error) {
    return refused({"channel", error.what(), entry.name, true});
  }
  signal::DecayOptions options;
  options.band_low_hz = inputs.band_low_hz, options.band_high_hz = inputs.band_high_hz;
  options.choose_window = false;
  const bool banded = inputs.band_low_hz > 0 || inputs.band_high_hz > 0;
  const signal::DecayBand band{
      inputs.band_low_hz / rate,
      inputs.band_high_hz > 0 ? std::min(inputs.band_high_hz / rate, 0.5) : 0.5, !banded};
  for (const auto& window : signal::find_decays(channel->samples, band)) {
    AxialRecord d{estimated_decay(entry, *channel, window.start, window.end, options)};
    d.recording = index, d.length_m = entry.length_m;
    const std::string where = place_of(d);
    if (!d.result.refusal_code.empty() || d.result.modes.empty()) {
      d.left_out = d.result.refusal_code.empty() ? "no_mode" : d.result.refusal_code;
      found.findings.push_back({d.left_out, "left out: " + d.result.refusal, where});
    }
    auto notes = d.result.notes;
    std::erase_if(notes, [](const auto& n) {  // what is ordinary in this test stays with the decay
      return n.code == "start_chosen" || n.code == "steady_tone" || n.code == "fitted_in_band";
    });
    add_notes(notes, found.findings, where);
    found.decays.push_back(std::move(d));
  }
  if (found.decays.empty()) return refused({"no_decay", "holds no decay", entry.name, true});
  return found;
}

struct ModeOfDecay {
  std::size_t decay = 0, mode = 0;
  double log_EA = 0, share = 0;  // ln EA from the mode; its share of the decay's energy
};

std::vector<ModeOfDecay> possible_modes(const AxialInputs& inputs,
                                        const std::vector<AxialRecord>& decays) {
  std::vector<ModeOfDecay> all;
  const auto& setup = inputs.setup;
  for (std::size_t k = 0; k < decays.size(); ++k) {
    const auto& d = decays[k];
    if (!d.left_out.empty()) continue;
    double energy = 0;
    for (const auto& mode : d.result.modes) energy += mode.energy;
    for (std::size_t m = 0; m < d.result.modes.size(); ++m) {
      const auto& mode = d.result.modes[m];
      const double omega = kTwoPi * mode.frequency_hz.value;
      const bool swings = model::kStandardGravity > 0.1 * omega * omega * d.length_m;
      if (swings && inputs.band_high_hz == 0 && inputs.band_low_hz == 0) continue;
      const auto rod = rod_stiffness(
          {omega * omega, setup.mass_kg.value, setup.mass_per_length_kg_m.value, d.length_m, 0});
      all.push_back({k, m, std::log(rod.cable_N_m * d.length_m), mode.energy / energy});
    }
  }
  // Where the damping of some is known, what does not die away is hum.
  const auto steady = [&](const ModeOfDecay& one) {
    const auto& damping = decays[one.decay].result.modes[one.mode].damping_ratio;
    return !(damping.value > 2 * damping.std);
  };
  if (!std::ranges::all_of(all, steady)) std::erase_if(all, steady);
  return all;
}

// The strongest mode of every decay among those at the EA that most of the energy has.
void choose_modes(const AxialInputs& inputs, AxialCampaignResult& result) {
  const auto all = possible_modes(inputs, result.decays);
  constexpr double kSame = 0.5;  // in ln EA: a factor of 1.6 either way
  const auto score = [&](double log_EA, bool take) {
    std::vector<double> best(result.decays.size(), 0);
    for (const auto& one : all) {
      if (std::abs(one.log_EA - log_EA) > kSame || !(one.share > best[one.decay])) continue;
      best[one.decay] = one.share;
      if (take) result.decays[one.decay].mode = one.mode;
    }
    return std::accumulate(best.begin(), best.end(), 0.0);
  };
  double most = 0, at = 0;
  for (const auto& one : all) {
    const double sum = score(one.log_EA, false);
    if (sum > most) most = sum, at = one.log_EA;
  }
  if (most > 0) score(at, true);
  for (auto& d : result.decays) {
    if (!d.left_out.empty() || d.mode) continue;
    d.left_out = "other_mode";
    signal::add_note(result.findings, d.left_out, place_of(d),
                     "Give a band: the strongest mode, {:.4g} Hz, is not the axial one of the "
                     "other records; left out",
                     d.result.modes.front().frequency_hz.value);
  }
}

constexpr double kLongest = 100;  // m: in a hanging-mass test 0.1 m of cable, given in mm

// Mean tension of a channel of force over the weight that hangs on the cable; NaN: no force, or a
// cell that was set to zero under the mass. Such a cell swings by a share of the weight about a
// mean of next to nothing; what swings by a thousandth of it has another unit.
double share_of_weight(const signal::Channel& channel, double weight) {
  if (channel.unit != "N" && channel.quantity != signal::Quantity::force) return kNaN;
  const auto samples = signal::finite_values(channel.samples);
  const auto [low, high] = std::ranges::minmax(samples);
  const double swing = (high - low) / weight, share = std::abs(signal::median(samples)) / weight;
  return share < 0.05 && swing > 0.02 ? kNaN : share;
}

// Whether inputs contradict the recordings; each is refused before an EA is shown.
bool contradicts(const AxialInputs& inputs, AxialCampaignResult& result) {
  bool refused = false;
  const auto refuse = [&](const char* code, std::string message, const std::string& where) {
    result.findings.push_back({code, std::move(message), where, refused = true});
  };
  std::map<double, std::vector<const AxialRecord*>> by_length;
  std::vector<double> shares;
  for (const auto& d : result.decays) {
    if (!d.mode) continue;
    by_length[d.length_m].push_back(&d);
    const double weight =
        model::kStandardGravity *
        (inputs.setup.mass_kg.value + 0.5 * inputs.setup.mass_per_length_kg_m.value * d.length_m);
    const double share =
        share_of_weight(inputs.recordings[d.recording].recording.channel(d.channel), weight);
    if (std::isfinite(share)) shares.push_back(share);
  }
  const auto frequency = [](const AxialRecord* d) { return d->axial().damped_frequency_hz.value; };
  for (const auto& [length, records] : by_length) {
    const auto [lowest, highest] = std::ranges::minmax(records, {}, frequency);
    const double low = frequency(lowest), high = frequency(highest);
    if (length > kLongest) {
      refuse("length_suspected",
             fmt::format("Give lengths in m: {:.4g} m of cable is no hanging-mass test (as mm: "
                         "{:.4g} m); EA is proportional to the length",
                         length, 1e-3 * length),
             "");
    }
    // 5 % of frequency: 10 % of length, or of the mass.
    if (high > 1.05 * low) {
      refuse("lengths_mixed",
             fmt::format("Give each file its length (--length, one a file or a group of files): "
                         "at {:.4g} m one record swings at {:.4g} Hz, {} at {:.4g} Hz; as one "
                         "length EA would be off by up to {:.0f} %",
                         length, low, highest->file, high, 100 * (std::pow(high / low, 2) - 1)),
             lowest->file);
    }
  }
  const double share = shares.empty() ? 1 : signal::median(shares);
  // EA is off by as much as the share: within a tenth is what cells drift by, to a factor of 2 it
  // is warned of.
  if (std::abs(share - 1) < 0.1) return refused;
  signal::add_note(result.findings, "force_mismatch", "",
                   "Check the hung mass (kg) and the unit or sensitivity of the tension channel: "
                   "its mean is {:.3g} of the weight of {:.4g} kg; EA is proportional to the mass",
                   share, inputs.setup.mass_kg.value);
  result.findings.back().refused = !(share > 0.5 && share < 2);
  return refused || result.findings.back().refused;
}

}  // namespace

AxialCampaignResult axial_campaign(const AxialInputs& inputs) {
  AxialCampaignResult result;
  std::vector<AxialCampaignResult> found(inputs.recordings.size());
  in_parallel(found.size(), inputs.threads, [&](std::size_t i) { found[i] = find(inputs, i); });
  for (auto& one : found) {
    std::ranges::move(one.decays, std::back_inserter(result.decays));
    std::ranges::move(one.findings, std::back_inserter(result.findings));
  }
  choose_modes(inputs, result);
  std::vector<AxialDecay> decays;
  AxialSetup setup = inputs.setup;
  for (const auto& d : result.decays) {
    if (!d.mode) continue;
    setup.rate_relative_std = std::max(
        setup.rate_relative_std, inputs.recordings[d.recording].recording.sample_rate_relative_std);
    decays.push_back({fmt::format("{} at {:.4g} s", d.file, d.start_s), d.length_m,
                      d.axial().damped_frequency_hz, d.axial().damping_ratio});
  }
  if (decays.empty()) {
    result.findings.push_back(
        {"no_decay", "Repeat the taps, or give a band: no record holds a usable decay", "", true});
    return result;
  }
  if (contradicts(inputs, result)) return result;
  try {
    result.test = identify_axial(decays, setup);
  } catch (const std::invalid_argument& error) {
    result.findings.push_back({"axial", error.what(), "", true});
    return result;
  }
  std::size_t next = 0;
  for (auto& d : result.decays) {
    if (d.mode) d.sample = result.test->samples[next++];
  }
  tell_rate(setup.rate_relative_std, decays.front().damped_frequency_hz, "", result.findings);
  add_notes(result.test->notes, result.findings);
  return result;
}

}  // namespace rigfit::ident
