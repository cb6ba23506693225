// rigfit tension: tension of a cable, hanger or stay from its natural frequencies.
#include <fmt/format.h>

#include <cmath>
#include <memory>
#include <optional>

#include "apps/campaign_file/measured_modes.h"
#include "apps/campaign_file/recording_description.h"
#include "apps/cli/json_document.h"
#include "apps/cli/number_checks.h"
#include "apps/cli/verb_figures.h"
#include "apps/cli/verbs/all.h"
#include "apps/cli/verbs/calls.h"
#include "ident/tension/cable_tension.h"
#include "signal/spectra/spectral_peaks.h"

namespace rigfit::apps {
namespace {

constexpr const char* kExample =
    "Examples:\n"
    "  rigfit tension --frequencies 7.36 14.59 22.15 29.9 --frequency-std 0.01 --length 2.4 "
    "--mass-per-length 0.16667\n"
    "  rigfit tension ambient.csv --channel acc --band 0.5 20 --length 98.3,0.05 --mass-per-length "
    "62.1,0.5 --EA 1.6e9";

/// "V" or "V,STD".
signal::Estimate value_and_std(const std::string& text, const std::string& option) {
  signal::Estimate estimate{0, 0};
  try {
    std::size_t used = 0;
    estimate.value = std::stod(text, &used);
    if (used < text.size() && text[used] == ',') {
      const std::string rest = text.substr(used + 1);
      estimate.std = std::stod(rest, &used);
      if (used == rest.size() && std::isfinite(estimate.value) && estimate.std >= 0 &&
          std::isfinite(estimate.std)) {
        return estimate;
      }
    } else if (used == text.size() && std::isfinite(estimate.value)) {
      return estimate;
    }
  } catch (const std::exception&) {
  }
  throw UsageError(fmt::format("{}: write a value or VALUE,STD, not \"{}\"", option, text));
}

std::optional<model::ModePlane> plane_of(const TensionCommand& command) {
  if (command.plane == "in") return model::ModePlane::in;
  if (command.plane == "out") return model::ModePlane::out;
  return std::nullopt;
}

/// Peaks of the spectra of recordings as measured modes.
void add_peaks(const TensionCommand& command, const std::vector<signal::Recording>& recordings,
               VerbContext& context, std::vector<ident::MeasuredMode>& modes, Json& spectra) {
  for (std::size_t f = 0; f < recordings.size(); ++f) {
    const auto& file = command.files[f];
    const auto& recording = recordings[f];
    for (const auto& channel : recording.channels) {
      if (!command.channels.empty() && std::find(command.channels.begin(), command.channels.end(),
                                                 channel.name) == command.channels.end()) {
        continue;
      }
      signal::SpectralPeakOptions options;
      if (!command.band.empty())
        options.low_hz = command.band[0], options.high_hz = command.band[1];
      options.max_peaks = command.max_peaks;
      const auto found = signal::spectral_peaks(channel.samples, recording.sample_rate_hz, options);
      for (const auto& peak : found.peaks) {
        ident::MeasuredMode mode;
        mode.frequency_hz = peak.frequency_hz;
        mode.damping_ratio = {std::nan(""), std::nan("")};
        mode.plane = plane_of(command);
        modes.push_back(std::move(mode));
        spectra.push_back(
            {{"file", file},
             {"channel", channel.name},
             {"frequency_hz", json_estimate(peak.frequency_hz.value, peak.frequency_hz.std)},
             {"half_power_bandwidth_hz", json_number(peak.bandwidth_hz)},
             {"signal_to_noise", json_number(peak.signal_to_noise)}});
      }
      if (found.peaks.empty()) context.warn("no_peaks", found.reason, file + ": " + channel.name);
    }
  }
}

std::vector<ident::MeasuredMode> measured_modes(const TensionCommand& command,
                                                const std::vector<signal::Recording>& recordings,
                                                VerbContext& context, Json& spectra) {
  std::vector<ident::MeasuredMode> modes;
  add_peaks(command, recordings, context, modes, spectra);
  if (!command.measured.empty()) {
    context.input(command.measured);
    for (auto& row : read_measured_modes(command.measured, command.column, plane_of(command), {})) {
      modes.push_back(std::move(row.mode));
    }
  }
  for (const double frequency : command.frequencies) {
    ident::MeasuredMode mode;
    mode.frequency_hz = {frequency,
                         command.frequency_std > 0 ? command.frequency_std : std::nan("")};
    mode.damping_ratio = {std::nan(""), std::nan("")};
    mode.plane = plane_of(command);
    modes.push_back(std::move(mode));
  }
  // Damping says nothing about the tension.
  for (auto& mode : modes) mode.damping_ratio = {std::nan(""), std::nan("")};
  return ident::merged_modes(modes);
}

Json interval_json(const signal::Estimate& estimate, double low, double high) {
  Json json = json_estimate(estimate.value, estimate.std);
  json["low"] = json_number(low);
  json["high"] = json_number(high);
  return json;
}

Json modes_json(const std::vector<ident::TensionMode>& modes) {
  Json list = Json::array();
  for (const auto& mode : modes) {
    list.push_back({{"order", mode.order > 0 ? Json(mode.order) : Json(nullptr)},
                    {"plane", mode.order > 0 ? Json(model::name_of(mode.plane)) : Json(nullptr)},
                    {"measured_hz", mode.measured_hz},
                    {"measured_std_hz", json_number(mode.measured_std_hz)},
                    {"model_hz", json_number(mode.model_hz)},
                    {"relative_error", json_number(mode.relative_error)}});
  }
  return list;
}

Json candidate_json(const ident::TensionCandidate& one) {
  Json json{{"ends", ident::name_of(one.ends)}, {"solved", one.solved}, {"weight", one.weight}};
  if (!one.message.empty()) json["message"] = one.message;
  if (!one.solved) return json;
  json["tension_N"] = interval_json(one.tension_N, one.low, one.high);
  json["EI_Nm2"] = json_estimate(one.EI_Nm2.value, one.EI_Nm2.std);
  if (one.ends == ident::CableEnds::springs) {
    json["spring_Nm_rad"] = json_estimate(one.spring_Nm_rad.value, one.spring_Nm_rad.std);
  }
  json["chi2"] = json_number(one.fit.chi2);
  json["degrees_of_freedom"] = one.fit.degrees_of_freedom;
  json["p_value"] = json_number(one.fit.p_value);
  json["model_std"] = one.fit.model_std;
  json["missed_modes"] = one.missed;
  json["modes"] = modes_json(one.modes);
  return json;
}

Json json_of(const ident::TensionResult& result) {
  const auto& best = result.candidates.front();
  Json json{{"tension_N", interval_json(result.tension_N, result.low, result.high)},
            {"tension_start_N", json_number(result.start_N)},
            {"tension_end_N", json_number(result.end_N)},
            {"EI_Nm2", json_estimate(result.EI_Nm2.value, result.EI_Nm2.std)},
            {"ends", ident::name_of(best.ends)},
            {"sag_m", json_number(result.sag_m)},
            {"irvine_parameter", json_number(result.irvine_parameter)},
            {"bending_parameter", json_number(result.bending_parameter)},
            {"decided", result.decided}};
  json["candidates"] = Json::array();
  for (const auto& one : result.candidates) json["candidates"].push_back(candidate_json(one));
  json["modes"] = modes_json(best.modes);
  json["formulas"] = {{"string_N", json_number(result.formulas.string_N)},
                      {"pinned_beam_N", json_number(result.formulas.pinned_beam_N)},
                      {"clamped_beam_N", json_number(result.formulas.clamped_beam_N)},
                      {"zui_N", json_number(result.formulas.zui_N)}};
  json["budget"] = Json::array();
  for (const auto& term : result.budget) {
    json["budget"].push_back({{"source", term.source}, {"std_N", json_number(term.std)}});
  }
  return json;
}

void print(std::ostream& out, const ident::TensionResult& result) {
  const auto& best = result.candidates.front();
  out << fmt::format(
      "tension {:.6g} N at mid-span, std {:.2g} N, 95 % interval {:.6g} to {:.6g} N\n",
      result.tension_N.value, result.tension_N.std, result.low, result.high);
  out << fmt::format("        {:.6g} N at the first end, {:.6g} N at the second; sag {:.3g} m\n",
                     result.start_N, result.end_N, result.sag_m);
  out << fmt::format("EI      {:.4g} N m2, std {:.2g}\n\n", result.EI_Nm2.value, result.EI_Nm2.std);
  out << fmt::format("{:<10} {:>8} {:>14} {:>10} {:>10} {:>5} {:>8}\n", "ends", "weight",
                     "tension, N", "std", "chi2", "dof", "p");
  for (const auto& one : result.candidates) {
    if (!one.solved) {
      out << fmt::format("{:<10} {}\n", ident::name_of(one.ends), one.message);
      continue;
    }
    out << fmt::format("{:<10} {:>8.3f} {:>14.6g} {:>10.2g} {:>10.3g} {:>5.3g} {:>8.2g}\n",
                       ident::name_of(one.ends), one.weight, one.tension_N.value, one.tension_N.std,
                       one.fit.chi2, one.fit.degrees_of_freedom, one.fit.p_value);
  }
  out << fmt::format("\n{:>5} {:>6} {:>13} {:>13} {:>10}\n", "order", "plane", "measured, Hz",
                     "model, Hz", "error");
  for (const auto& mode : best.modes) {
    if (mode.order == 0) {
      out << fmt::format("{:>5} {:>6} {:>13.6g} {:>13}\n", "-", "-", mode.measured_hz, "none");
      continue;
    }
    out << fmt::format("{:>5} {:>6} {:>13.6g} {:>13.6g} {:>8.3f} %\n", mode.order,
                       model::name_of(mode.plane), mode.measured_hz, mode.model_hz,
                       100 * mode.relative_error);
  }
  out << fmt::format(
      "\nFormulas from the lowest mode: string {:.6g} N, pinned beam {:.6g} N, clamped beam {:.6g} "
      "N, "
      "Zui {:.6g} N\n",
      result.formulas.string_N, result.formulas.pinned_beam_N, result.formulas.clamped_beam_N,
      result.formulas.zui_N);
}

ident::CableDescription description_of(const TensionCommand& command) {
  ident::CableDescription cable;
  cable.length_m = value_and_std(command.length, "--length");
  cable.mass_per_length = value_and_std(command.mass, "--mass-per-length");
  if (!command.EI.empty()) cable.EI_Nm2 = value_and_std(command.EI, "--EI");
  if (!command.EA.empty()) cable.EA_N = value_and_std(command.EA, "--EA");
  if (command.mass_of == "installed") cable.mass_reference = ident::MassReference::installed;
  if (command.mass_of == "unstretched") cable.mass_reference = ident::MassReference::unstretched;
  cable.inclination_deg = command.inclination;
  return cable;
}

void warn_of(const ident::TensionResult& result, const ident::CableDescription& cable,
             VerbContext& context) {
  const auto& best = result.candidates.front();
  if (best.fit.ruled_out()) {
    context.warn(
        "model_ruled_out",
        fmt::format(
            "chi-square {:.3g} for {:.3g} degrees of freedom (p = {:.2g}): the frequencies do not "
            "agree with the best model within their uncertainties",
            best.fit.chi2, best.fit.degrees_of_freedom, best.fit.p_value));
  }
  if (result.EA_assumed) {
    context.warn(
        "EA_assumed",
        "no --EA: a strain of 0.001 is taken, within a factor of 2 or so; it matters where "
        "the sag does");
  }
  if (result.EI_assumed) {
    context.warn(
        "EI_assumed",
        "no --EI, and fewer than three frequencies cannot tell it: L sqrt(T / EI) anywhere in "
        "2 to 2000 is part of the interval");
  }
  if (result.mass_reference_matters) {
    context.warn("mass_reference_unknown",
                 "whether the mass per length is that of the installed or of the "
                 "unstretched cable matters here: say --mass-of");
  }
  if (cable.length_m.std == 0 || cable.mass_per_length.std == 0) {
    context.warn("exact_inputs",
                 "length or mass per length is taken as exact: write VALUE,STD to count its "
                 "uncertainty (1 % of length is 2 % of tension)");
  }
}

Json run(const TensionCommand& command, VerbContext& context) {
  signal::ReadOptions read;
  read.sample_rate_hz = command.sample_rate_hz;
  std::vector<signal::Recording> recordings;
  for (const auto& file : command.files) recordings.push_back(load_recording(file, context, read));
  return tension_result(command, recordings, context);
}

}  // namespace

Json tension_result(const TensionCommand& command, const std::vector<signal::Recording>& recordings,
                    VerbContext& context) {
  if (!command.band.empty() && !(command.band[0] >= 0 && command.band[1] > command.band[0])) {
    throw UsageError("--band needs two rising frequencies in Hz");
  }
  const auto cable = description_of(command);
  Json spectra = Json::array();
  const auto modes = measured_modes(command, recordings, context, spectra);
  if (modes.empty() && command.files.empty()) {
    throw UsageError("give recordings, --measured or --frequencies");
  }
  if (modes.empty())
    throw Refused("no peak stands out of the noise: nothing to find a tension from");
  ident::TensionOptions options;
  if (command.ends == "pinned") options.ends = {ident::CableEnds::pinned};
  if (command.ends == "clamped") options.ends = {ident::CableEnds::clamped};
  if (command.ends == "springs") options.ends = {ident::CableEnds::springs};
  options.missed = command.missed;
  options.false_mode = command.false_mode;
  ident::TensionResult result;
  try {
    result = ident::identify_tension(cable, modes, options);
  } catch (const std::invalid_argument& error) {
    throw UsageError(error.what());
  }
  if (!result.solved) throw Refused(result.message);
  warn_of(result, cable, context);
  if (!result.decided) {
    context.refuse("not_decided",
                   "the frequencies do not decide which modes they are: no order has 90 % of the "
                   "weight; a further "
                   "frequency, --EI or --ends can");
  }
  print(context.out, result);
  if (context.plots) draw_tension(*context.plots, result);
  Json json = json_of(result);
  if (!spectra.empty()) json["peaks"] = std::move(spectra);
  return json;
}

void add_tension(CLI::App& program, Verbs& verbs) {
  const auto c = std::make_shared<TensionCommand>();
  CLI::App* app =
      program.add_subcommand("tension", "Tension of a cable, hanger or stay from its frequencies");
  app->footer(kExample);
  app->add_option("files", c->files, "Recordings of the cable's motion: peaks of their spectra")
      ->type_name("FILE");
  app->add_option("--channel", c->channels, "Channels to use (default: all)")->type_name("C");
  app->add_option("--band", c->band, "Where peaks are looked for, Hz")
      ->expected(2)
      ->type_name("LO HI");
  app->add_option("--max-peaks", c->max_peaks, "Peaks a channel at most")
      ->check(CLI::Range(1, 200))
      ->capture_default_str();
  app->add_option("--sample-rate", c->sample_rate_hz, "Where a file gives none, Hz")
      ->check(positive_number());
  app->add_option("--measured", c->measured, "Table of measured frequencies, or modes as UFF 55")
      ->type_name("F");
  app->add_option("--column", c->column, "Of the frequencies in the table")->type_name("NAME");
  app->add_option("--frequencies", c->frequencies, "Measured frequencies, Hz")
      ->check(positive_number())
      ->type_name("HZ");
  app->add_option("--frequency-std", c->frequency_std, "Standard uncertainty of --frequencies, Hz")
      ->check(positive_number());
  app->add_option("--plane", c->plane, "The motion that was measured")
      ->check(CLI::IsMember({"in", "out", "any"}))
      ->capture_default_str();
  app->add_option("--length", c->length, "Between the ends, along the chord, m")
      ->required()
      ->type_name("V[,STD]");
  app->add_option("--mass-per-length", c->mass, "kg/m")->required()->type_name("V[,STD]");
  app->add_option("--mass-of", c->mass_of, "What the mass per length is of")
      ->check(CLI::IsMember({"installed", "unstretched"}));
  app->add_option("--EI", c->EI, "Flexural rigidity, N m2 (default: fitted)")->type_name("V[,STD]");
  app->add_option("--EA", c->EA, "Axial rigidity, N")->type_name("V[,STD]");
  app->add_option("--inclination", c->inclination,
                  "Of the chord, degrees: 0 horizontal, 90 a hanger")
      ->check(number_within(-90, 90))
      ->capture_default_str();
  app->add_option("--ends", c->ends, "Kinds of ends")
      ->check(CLI::IsMember({"compare", "pinned", "clamped", "springs"}))
      ->capture_default_str();
  app->add_option("--missed", c->missed, "Probability that a mode in the band was missed")
      ->check(number_within(0.001, 0.9))
      ->capture_default_str();
  app->add_option("--false", c->false_mode,
                  "Probability that a measured mode is none of the cable's")
      ->check(number_within(0.001, 0.9))
      ->capture_default_str();
  verbs.push_back({app, [c](VerbContext& context) { return run(*c, context); }, true});
}

}  // namespace rigfit::apps
