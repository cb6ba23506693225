#include "ident/campaign/single_tests/tension_campaign.h"

#include <fmt/ranges.h>

#include "ident/statistics/uncertainty.h"
#include "signal/ambient/ambient_modes.h"
#include "signal/recording/add_note.h"
#include "signal/recording/recording.h"

namespace rigfit::ident {
namespace {

/// The modes of a recording's channels together, of which the tension takes the frequencies: found
/// in bands of 16 times their lower end at most, since the orders of a diagram are spread over its
/// band. A recording of few decay times holds few of the groups whose scatter the std is of; it is
/// taken together with the std that a mode driven by white noise has at best, half / (2 pi sqrt(T
/// half)).
void add_recorded_modes(const TensionInputs& inputs, const TestRecording& recorded,
                        TensionCampaignResult& campaign) {
  constexpr double kFewestCycles = 20;  // cycles of the lowest mode, where no band is given
  // 16, of 4, 8 and 16, found most modes of short records; bands reach beyond their ends, so that a
  // mode at an end is not cut (else it is missed, or its std is 2.5 times as large).
  constexpr double kWidest = 16, kBeyond = 1.15;
  constexpr double kSteady = 0.1;  // decay times: 10 % in the whole recording is no decay to see
  const auto& name = recorded.name;
  const auto& recording = recorded.recording;
  auto& findings = campaign.findings;
  const bool given = inputs.band_high_hz > 0;
  const double low = given && inputs.band_low_hz > 0
                         ? inputs.band_low_hz
                         : kFewestCycles / std::max(recording.duration_s(), 1e-9);
  const double high = given ? inputs.band_high_hz : 0.4 * recording.sample_rate_hz;
  const double bands = std::max(1.0, std::ceil(std::log(high / low) / std::log(kWidest)));
  std::vector<double> tones;
  std::string refusal;
  const std::size_t before = campaign.peaks.size();
  for (double k = 0; k < bands; ++k) {
    const double from = low * std::pow(high / low, k / bands),
                 to = low * std::pow(high / low, (k + 1) / bands);
    signal::AmbientOptions options;
    options.channels = inputs.channels;
    options.low_hz = std::max(low, from / kBeyond);
    options.high_hz = std::min(high, to * kBeyond);
    signal::AmbientResult found;
    try {
      found = signal::ambient_modes(recording, options);
    } catch (const signal::RecordingError& error) {
      refusal = error.what();  // it names the file; another band may have modes
      continue;
    }
    const auto inside = [&](double hz) { return hz >= from && (hz < to || k + 1 == bands); };
    for (const auto& tone : found.tones) {
      if (inside(tone.frequency_hz)) tones.push_back(tone.frequency_hz);
    }
    for (const auto& mode : found.modes) {
      const auto& frequency = mode.mode.frequency_hz;
      if ((mode.mode.doubtful && mode.code != "too_short") || !inside(frequency.value)) continue;
      if (mode.decay_times < kSteady) continue;
      const double half = -mode.mode.pole_rad_s.real();
      const double least = half / (kTwoPi * std::sqrt(mode.decay_times));
      MeasuredMode measured;
      measured.frequency_hz = {frequency.value, std::hypot(frequency.std, least)};
      measured.plane = inputs.plane;
      campaign.peaks.push_back({name, measured.frequency_hz, mode.mode.damping_ratio.value});
      campaign.modes.push_back(std::move(measured));
    }
  }
  if (!tones.empty()) {
    signal::add_note(findings, "steady_tone", name,
                     "Check for mains hum or a machine at {:.5g} Hz: the amplitude is constant, "
                     "unlike that of a resonance driven by noise; left out",
                     fmt::join(tones, ", "));
  }
  const bool none = campaign.peaks.size() == before;
  if (!refusal.empty()) {
    findings.push_back({"no_modes", refusal, "", none});
  } else if (none) {
    findings.push_back({"no_modes", "no mode stands out of the noise", name});
  }
}

/// Warnings and refusals of a result, in words.
void add_findings(const TensionInputs& inputs, TensionCampaignResult& campaign) {
  const auto& cable = inputs.cable;
  const auto& result = campaign.tension;
  const auto tell = [&](const char* code, std::string message, bool refused = false) {
    campaign.findings.push_back({code, std::move(message), inputs.name, refused});
  };
  if (!result.solved) return tell("no_tension", result.message, true);
  const auto& best = result.candidates.front();
  if (result.ruled_out) {
    tell(
        "model_ruled_out",
        fmt::format("Check that this is one cable between two ends: its frequencies are {:.2g} % "
                    "off (rms), {:.2g} % at most, with the best of {} kinds of ends. State other "
                    "ends (--ends), orders (--order), masses or EI, or fit a scene (update)",
                    100 * best.fit.rms_error, 100 * best.fit.worst_error, result.candidates.size()),
        true);
  } else if (best.fit.ruled_out()) {
    tell("systematic_misfit",
         fmt::format("Enlarge the uncertainties of the frequencies, or name what the cable lacks "
                     "here (masses, ends): chi-square is {:.4g} for {:.3g} degrees of freedom "
                     "(probability {}). The interval counts a model error of {:.2g} %",
                     best.fit.chi2, best.fit.degrees_of_freedom, probability_text(best.fit.p_value),
                     100 * best.fit.model_std));
  }
  for (const auto& mode : best.modes) {
    if (mode.order > 0) continue;
    tell("unpaired",
         fmt::format("Check {:.5g} Hz: it is no mode of the cable in this answer. State "
                     "its order (--order) if it is one",
                     mode.measured_hz));
  }
  const bool exact = cable.length_m.std == 0 || cable.mass_per_length.std == 0;
  // Polyethylene fibres bear 3.5 GPa at 970 kg/m3; nylon breaks at a strain of 0.3.
  const double T = result.tension_N.value;
  const bool borne =
      T < 4e6 * cable.mass_per_length.value && !(cable.EA_N && T > 0.3 * cable.EA_N->value);
  for (const auto& [is, code, message] : {
           std::tuple{!cable.EA_N, "EA_assumed",
                      "Give EA: a strain of 0.001 is taken, within a factor of 2 or so; this "
                      "matters where the cable sags"},
           {!cable.EI_Nm2 && best.modes.size() < 3, "EI_assumed",
            "Give EI, or three frequencies: fewer cannot tell it, so that the interval covers L "
            "sqrt(T / EI) anywhere in 2 to 2000"},
           {!borne, "unit_suspected",
            "Check the units of length (m), mass per length (kg/m), EA (N) and frequencies (Hz): "
            "no "
            "cable of this mass and EA bears the tension"},
           {result.mass_reference_matters, "assumed",
            "Say with mass_of whether the mass per length is that of the installed or of the "
            "unstretched cable: here the answers differ"},
           {exact, "taken_as_exact",
            "Give the standard uncertainty of length and mass per length: without it they count as "
            "exact (1 % of length is 2 % of tension)"},
       }) {
    if (is) tell(code, message);
  }
  if (!result.decided) {
    tell("not_decided",
         "Say which modes these are (--order), or give a further frequency, --EI or --ends "
         "(--missed where modes were not excited): no order of the modes has 90 % of the weight",
         true);
  }
}

}  // namespace

TensionCampaignResult tension_campaign(const TensionInputs& inputs) {
  TensionCampaignResult campaign;
  for (const auto& recorded : inputs.recordings) add_recorded_modes(inputs, recorded, campaign);
  campaign.modes.insert(campaign.modes.end(), inputs.modes.begin(), inputs.modes.end());
  // Damping says nothing about the tension.
  for (auto& mode : campaign.modes) mode.damping_ratio = {std::nan(""), std::nan("")};
  campaign.modes = merged_modes(std::move(campaign.modes));
  auto cable = inputs.cable;
  for (const auto& one : inputs.recordings) {
    cable.rate_relative_std =
        std::max(cable.rate_relative_std, one.recording.sample_rate_relative_std);
  }
  if (campaign.modes.empty()) {
    campaign.tension.message = "no peak stands out of the noise: nothing to find a tension from";
  } else {
    try {
      campaign.tension = identify_tension(cable, campaign.modes, inputs.options);
    } catch (const std::invalid_argument& error) {
      campaign.tension.message = error.what();
    }
  }
  add_findings(inputs, campaign);
  if (campaign.modes.empty()) return campaign;
  tell_rate(cable.rate_relative_std, campaign.modes.front().frequency_hz, inputs.name,
            campaign.findings);
  return campaign;
}

}  // namespace rigfit::ident
