#include "ident/campaign/tension_campaign.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

namespace rigfit::ident {
namespace {

void add_peaks(const TensionInputs& inputs, std::size_t index, TensionCampaignResult& campaign) {
  const auto& [name, recording] = inputs.recordings[index];
  signal::SpectralPeakOptions options;
  if (inputs.band_high_hz > 0) {
    options.low_hz = inputs.band_low_hz;
    options.high_hz = inputs.band_high_hz;
  }
  options.max_peaks = inputs.max_peaks;
  for (const auto& asked : inputs.channels) {
    const bool there = std::any_of(recording.channels.begin(), recording.channels.end(),
                                   [&asked](const auto& channel) { return channel.name == asked; });
    if (!there) {
      campaign.result.findings.push_back({"channel", "no channel \"" + asked + "\"", name, true});
    }
  }
  for (const auto& channel : recording.channels) {
    const auto& asked = inputs.channels;
    if (!asked.empty() && std::find(asked.begin(), asked.end(), channel.name) == asked.end()) {
      continue;
    }
    signal::SpectralPeaks found;
    try {
      found = signal::spectral_peaks(channel.samples, recording.sample_rate_hz, options);
    } catch (const std::invalid_argument& error) {
      found.reason = error.what();
    }
    for (const auto& peak : found.peaks) {
      MeasuredMode mode;
      mode.frequency_hz = peak.frequency_hz;
      mode.plane = inputs.plane;
      campaign.modes.push_back(std::move(mode));
      campaign.peaks.push_back({index, channel.name, peak});
    }
    if (found.peaks.empty()) {
      campaign.result.findings.push_back(
          {"no_peaks", found.reason, name + ": " + channel.name, false});
    }
  }
}

}  // namespace

TensionCampaignResult tension_campaign(const TensionInputs& inputs) {
  TensionCampaignResult campaign;
  for (std::size_t i = 0; i < inputs.recordings.size(); ++i) add_peaks(inputs, i, campaign);
  campaign.modes.insert(campaign.modes.end(), inputs.test.modes.begin(), inputs.test.modes.end());
  // Damping says nothing about the tension.
  for (auto& mode : campaign.modes) mode.damping_ratio = {std::nan(""), std::nan("")};
  campaign.modes = merged_modes(std::move(campaign.modes));
  auto before = std::move(campaign.result.findings);
  if (campaign.modes.empty()) {
    campaign.result.name = inputs.test.name;
    campaign.result.tension.message =
        "no peak stands out of the noise: nothing to find a tension from";
    campaign.result.findings = {
        {"no_tension", campaign.result.tension.message, inputs.test.name, true}};
  } else {
    auto test = inputs.test;
    test.modes = campaign.modes;
    campaign.result = analyse_cable_test(test);
  }
  auto& findings = campaign.result.findings;
  findings.insert(findings.begin(), before.begin(), before.end());
  return campaign;
}

}  // namespace rigfit::ident
