#include "ident/campaign/single_tests/tension_campaign.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "ident/campaign/single_tests/rate_uncertainty.h"
#include "ident/statistics/in_parallel.h"
#include "ident/statistics/probability_text.h"
#include "signal/recording/recording_error.h"

namespace rigfit::ident {
namespace {

/// What is said of the tones of a channel.
void add_tones(const signal::SpectralPeaks& found, std::size_t index, const std::string& file,
               const std::string& channel, TensionCampaignResult& campaign) {
  const std::string where = file + ": " + channel;
  std::string left_out, possible;
  for (const auto& tone : found.tones) {
    campaign.tones.push_back({index, file, channel, tone});
    left_out += fmt::format("{}{:.5g}", left_out.empty() ? "" : ", ", tone.frequency_hz);
    if (tone.reach_hz > 0) left_out += fmt::format(" (it wanders: +-{:.2g})", tone.reach_hz);
  }
  for (const auto& peak : found.peaks) {
    if (!peak.undecided) continue;
    possible += fmt::format("{}{:.5g}", possible.empty() ? "" : ", ", peak.frequency_hz.value);
  }
  auto& findings = campaign.result.findings;
  if (!left_out.empty()) {
    findings.push_back(
        {"steady_tone",
         fmt::format("Check for mains hum or a machine at {} Hz: the amplitude is constant, "
                     "unlike that of a resonance driven by noise; left out",
                     left_out),
         where, false});
  }
  if (!possible.empty()) {
    findings.push_back(
        {"possible_tone",
         fmt::format("Record longer, or give --band: this record cannot tell whether {} Hz is a "
                     "steady tone or a mode of little damping; taken as a mode",
                     possible),
         where, false});
  }
}

void add_peaks(const TensionInputs& inputs, std::size_t index, TensionCampaignResult& campaign) {
  const auto& [name, recording] = inputs.recordings[index];
  signal::SpectralPeakOptions options;
  if (inputs.band_high_hz > 0) {
    options.low_hz = inputs.band_low_hz;
    options.high_hz = inputs.band_high_hz;
  }
  options.max_peaks = inputs.max_peaks;
  std::vector<const signal::Channel*> channels;
  for (const auto& asked : inputs.channels) {
    try {
      channels.push_back(&recording.channel(asked));
    } catch (const signal::RecordingError& error) {
      campaign.result.findings.push_back({"channel", error.what(), name, true});
    }
  }
  if (inputs.channels.empty()) {
    for (const auto& one : recording.channels) channels.push_back(&one);
  }
  for (const auto* one : channels) {
    const auto& channel = *one;
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
      campaign.peaks.push_back({index, name, channel.name, peak});
    }
    std::string differ;
    for (const auto& peak : found.peaks) {
      if (peak.between_parts_hz == 0) continue;
      differ += fmt::format("{}{:.5g} Hz (std {:.2g} Hz)", differ.empty() ? "" : ", ",
                            peak.frequency_hz.value, peak.between_parts_hz);
    }
    if (!differ.empty()) {
      campaign.result.findings.push_back(
          {"groups_differ",
           "Look for wind, traffic or temperature, or take a calmer stretch: from part to part of "
           "the record the frequency changes by more than its uncertainty, which the intervals "
           "allow for: " +
               differ,
           name + ": " + channel.name, false});
    }
    add_tones(found, index, name, channel.name, campaign);
    if (found.peaks.empty()) {
      campaign.result.findings.push_back(
          {"no_peaks", found.reason, name + ": " + channel.name, false});
    }
  }
}

/// The cable's mass carries the uncertainty of the rate; the budget parts them again.
void part_tension_budget(const signal::Estimate& mass, double rate_relative_std,
                         TensionResult& result) {
  const auto part = [&](std::vector<UpdateBudgetTerm>& budget) {
    for (auto& term : budget) {
      if (term.source != "mass per length") continue;
      const auto [own, rate] = parts_of_mass(term.std, mass, rate_relative_std);
      term.std = own;
      budget.push_back({std::string(kRateSource), rate});
      break;
    }
    std::erase_if(budget, [](const auto& term) { return term.std == 0; });
  };
  part(result.budget);
  for (auto& candidate : result.candidates) part(candidate.budget);
}

}  // namespace

CableTestResult analyse_cable_test(const CableTest& test) {
  CableTestResult result;
  result.name = test.name;
  try {
    result.tension = identify_tension(test.cable, test.modes, test.options);
  } catch (const std::invalid_argument& error) {
    result.tension.message = error.what();
  }
  if (!result.tension.solved) {
    result.findings.push_back({"no_tension", result.tension.message, test.name, true});
    return result;
  }
  result.findings = tension_findings(result.tension, test.cable);
  for (auto& finding : result.findings) finding.where = test.name;
  return result;
}

std::vector<CableTestResult> analyse_cable_tests(const std::vector<CableTest>& tests, int threads) {
  std::vector<CableTestResult> results(tests.size());
  in_parallel(tests.size(), threads,
              [&](std::size_t i) { results[i] = analyse_cable_test(tests[i]); });
  return results;
}

std::vector<Finding> tension_findings(const TensionResult& result, const CableDescription& cable) {
  std::vector<Finding> findings;
  const auto warn = [&](const char* code, std::string message) {
    findings.push_back({code, std::move(message), "", false});
  };
  const auto& best = result.candidates.front();
  if (result.ruled_out) {
    findings.push_back(
        {"model_ruled_out",
         fmt::format("Check that this is one cable between two ends: its frequencies are {:.2g} % "
                     "off (rms), {:.2g} % at most, with the best of {} kinds of ends. State other "
                     "ends (--ends), orders (--order), masses or EI, or fit a scene (update)",
                     100 * best.rms_error, 100 * best.worst_error, result.candidates.size()),
         "", true});
  } else if (best.fit.ruled_out()) {
    warn("systematic_misfit",
         fmt::format("Enlarge the uncertainties of the frequencies, or name what the cable lacks "
                     "here (masses, ends): chi-square is {:.4g} for {:.3g} degrees of freedom "
                     "({}). The interval counts a model error of {:.2g} %",
                     best.fit.chi2, best.fit.degrees_of_freedom, p_text(best.fit.p_value),
                     100 * best.fit.model_std));
  }
  for (const auto& mode : best.modes) {
    if (mode.order > 0) continue;
    warn("unpaired",
         fmt::format("Check {:.5g} Hz: it is no mode of the cable in this answer. State "
                     "its order (--order) if it is one",
                     mode.measured_hz));
  }
  if (result.EA_assumed) {
    warn("EA_assumed",
         "Give EA: a strain of 0.001 is taken, within a factor of 2 or so; this matters where the "
         "cable sags");
  }
  if (result.EI_assumed) {
    warn(
        "EI_assumed",
        "Give EI, or three frequencies: fewer cannot tell it, so that the interval covers L sqrt(T "
        "/ EI) anywhere in 2 to 2000");
  }
  if (result.large_sag) {
    warn("deep_sag_not_corrected",
         "Check length and mass: the segment model has no equilibrium at the best tension, and the "
         "closed forms of a shallow cable are used uncorrected");
  }
  if (result.mass_reference_matters) {
    warn("assumed",
         "Say with mass_of whether the mass per length is that of the installed or of the "
         "unstretched cable: here the answers differ");
  }
  if (cable.length_m.std == 0 || cable.mass_per_length.std == 0) {
    warn("taken_as_exact",
         "Give the standard uncertainty of length and mass per length: without it they count as "
         "exact (1 % of length is 2 % of tension)");
  }
  if (!result.decided) {
    findings.push_back({"not_decided",
                        "Say which modes these are (--order), or give a further frequency, --EI or "
                        "--ends (--missed where modes were not excited): no order of the modes has "
                        "90 % of the weight",
                        "", true});
  }
  return findings;
}

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
    double rate_relative_std = 0;
    for (const auto& one : inputs.recordings) {
      rate_relative_std = std::max(rate_relative_std, one.recording.sample_rate_relative_std);
    }
    const auto mass = test.cable.mass_per_length;
    if (rate_relative_std > 0) {
      test.cable.mass_per_length = mass_with_rate(mass, rate_relative_std);
    }
    campaign.result = analyse_cable_test(test);
    if (rate_relative_std > 0) {
      part_tension_budget(mass, rate_relative_std, campaign.result.tension);
      const auto& first = campaign.modes.front().frequency_hz;
      if (auto said = rate_finding(rate_relative_std, first.value, first.std, inputs.test.name)) {
        campaign.result.findings.push_back(std::move(*said));
      }
    }
  }
  auto& findings = campaign.result.findings;
  findings.insert(findings.begin(), before.begin(), before.end());
  return campaign;
}

}  // namespace rigfit::ident
