// rigfit axial: EA, damping ratio and damper of a cable from hanging-mass records.
#include <fmt/format.h>
#include <fmt/ostream.h>

#include <cmath>
#include <memory>

#include "apps/campaign_file/recording_description.h"
#include "apps/cli/exit_code.h"
#include "apps/cli/json_document.h"
#include "apps/cli/number_checks.h"
#include "apps/cli/verbs/all.h"
#include "ident/axial/axial_test.h"
#include "signal/decay/decay.h"
#include "signal/decay/decay_window.h"

namespace rigfit::apps {
namespace {

using Eigen::Index;

struct AxialCommand {
  std::vector<std::string> files;
  std::vector<double> lengths, band;
  std::string channel;
  double mass = 0, mass_std = 0, length_std = 0, mass_per_length = 0, mass_per_length_std = 0;
  double adapter = 0, adapter_std = 0, catalogue = 0, sample_rate_hz = 0;
  std::vector<double> adapter_bar;  // E Pa, A m2, l m
  int draws = ident::AxialOptions{}.draws;
};

constexpr const char* kAxialExample = R"(Example:
  rigfit axial a.csv b.csv c.csv --channel tension --mass 2.2 --mass-std 0.001 \
      --length 0.7 1.0 1.3 --length-std 0.001 --mass-per-length 0.16667
One length: for all files. As many lengths as files: one for each, in order. Otherwise the files are
taken in equal groups, one a length: six files with --length 0.7 1.0 are three of 0.7 m, then three
of 1.0 m. A file may hold several impulses; each is a sample.)";

struct RecordedSample {  // one decay of one file
  std::string file;
  double length_m = 0, start_s = 0;
  signal::DecayResult decay;
};

std::vector<double> length_of_each_file(const AxialCommand& c) {
  const std::size_t files = c.files.size(), lengths = c.lengths.size();
  if (lengths == 0 || lengths > files || files % lengths != 0) {
    throw UsageError(
        fmt::format("{} files and {} lengths: give one length, one for each file, or one for "
                    "each group of files of equal size",
                    files, lengths));
  }
  std::vector<double> each;
  for (std::size_t i = 0; i < files; ++i) each.push_back(c.lengths[i / (files / lengths)]);
  return each;
}

std::vector<RecordedSample> decays_of(const std::string& file, double length,
                                      const AxialCommand& command, VerbContext& context) {
  signal::ReadOptions reading;
  reading.sample_rate_hz = command.sample_rate_hz;
  const auto recording = load_recording(file, context, reading);
  const auto& channel = chosen_channel(recording, command.channel);
  const double rate = recording.sample_rate_hz;
  if (!(rate > 0)) throw UsageError(file + " gives no sample rate: say it with --sample-rate");
  std::vector<RecordedSample> samples;
  if (recording.time_s.size() > 0) {
    context.refuse("not_uniform", "samples are not evenly spaced in time", file);
    return samples;
  }
  signal::DecayOptions options;
  if (!command.band.empty()) {
    if (!(command.band[0] >= 0 && command.band[0] < command.band[1] &&
          command.band[0] < 0.5 * rate)) {
      throw UsageError("--band must rise and begin below half the sample rate");
    }
    options.band_low_hz = command.band[0], options.band_high_hz = command.band[1];
  }
  options.choose_window = false;
  for (const auto& w : signal::find_decays(channel.samples)) {
    RecordedSample s;
    s.file = file, s.length_m = length;
    s.decay =
        signal::estimate_decay(channel.samples.segment(w.start, w.end - w.start), rate, options);
    s.start_s = recording.start_time_s + static_cast<double>(w.start + s.decay.start) / rate;
    const std::string where = fmt::format("{}: {} at {:.4g} s", file, channel.name, s.start_s);
    if (!s.decay.refusal_code.empty()) {
      context.warn(s.decay.refusal_code, "left out: " + s.decay.refusal, where);
    }
    for (const auto& n : s.decay.notes) {
      // What is ordinary in this test goes into the samples, not on the screen.
      if (n.code != "start_chosen" && n.code != "coloured_residual" && n.code != "steady_tone") {
        context.warn(n.code, n.message, where);
      }
    }
    samples.push_back(std::move(s));
  }
  return samples;
}

Json json_of(const ident::AxialTestResult& r, const std::vector<RecordedSample>& all) {
  Json out;
  out["EA_N"] = json_estimate(r.EA_N.value, r.EA_N.std);
  out["EA_N"]["low"] = r.EA_low_N, out["EA_N"]["high"] = r.EA_high_N;
  out["damping_ratio"] = json_estimate(r.damping_ratio.value, r.damping_ratio.std);
  out["damping_ratio"]["low"] = r.damping_low, out["damping_ratio"]["high"] = r.damping_high;
  out["damping_Ns_m"] = json_estimate(r.damping_Ns_m.value, r.damping_Ns_m.std);
  out["damping_Ns_m"]["length_m"] = r.reference_length_m;
  out["coverage_factor_95"] = r.coverage_factor;
  Json samples = Json::array();
  std::size_t k = 0;
  for (const auto& s : all) {
    Json row{{"file", s.file}, {"length_m", s.length_m}, {"start_s", s.start_s}};
    if (!s.decay.refusal_code.empty()) {
      row["refused"] = s.decay.refusal_code;
      samples.push_back(std::move(row));
      continue;
    }
    const auto& mode = s.decay.modes.front();
    const auto& a = r.samples[k++];
    row["damped_frequency_hz"] =
        json_estimate(mode.damped_frequency_hz.value, mode.damped_frequency_hz.std);
    row["damping_ratio"] = json_estimate(mode.damping_ratio.value, mode.damping_ratio.std);
    row["r_squared"] = mode.r_squared;
    row["cycles"] = mode.cycles;
    row["stiffness_N_m"] = a.stiffness_N_m;
    row["cable_stiffness_N_m"] = a.cable_stiffness_N_m;
    row["EA_N"] = json_estimate(a.EA_N.value, a.EA_N.std);
    row["damping_Ns_m"] = a.damping_Ns_m;
    samples.push_back(std::move(row));
  }
  out["samples"] = std::move(samples);
  Json lengths = Json::array();
  for (const auto& l : r.lengths) {
    lengths.push_back({{"length_m", l.length_m},
                       {"records", l.records},
                       {"EA_N", json_estimate(l.EA_N.value, l.EA_N.std)},
                       {"damping_ratio", json_estimate(l.damping_ratio.value, l.damping_ratio.std)},
                       {"damping_Ns_m", l.damping_Ns_m}});
  }
  out["lengths"] = std::move(lengths);
  Json budget = Json::array();
  for (const auto& b : r.budget) {
    budget.push_back({{"source", b.source},
                      {"type", std::string(1, b.type)},
                      {"value", json_number(b.value)},
                      {"std", b.std},
                      {"unit", b.unit},
                      {"sensitivity_N_per_unit", b.sensitivity},
                      {"contribution_N", b.contribution_N},
                      {"share", b.share},
                      {"degrees_of_freedom",
                       b.degrees_of_freedom > 0 ? Json(b.degrees_of_freedom) : Json(nullptr)}});
  }
  out["budget"] = std::move(budget);
  out["between_lengths"] = {{"std_N", r.between_lengths_std_N},
                            {"cochran_Q", r.cochran_Q},
                            {"p_same_EA", r.homogeneity_p}};
  out["monte_carlo"] = {{"draws", r.draws},
                        {"EA_N", json_estimate(r.monte_carlo_EA_N.value, r.monte_carlo_EA_N.std)},
                        {"low", r.monte_carlo_low_N},
                        {"high", r.monte_carlo_high_N}};
  out["series_compliance_m_N"] =
      json_estimate(r.series_compliance_m_N.value, r.series_compliance_m_N.std);
  out["EA_without_series_N"] = json_number(r.EA_without_series_N);
  out["plausibility"] = {
      {"catalogue_EA_N", r.catalogue_EA_N > 0 ? Json(r.catalogue_EA_N) : Json(nullptr)},
      {"share", r.catalogue_EA_N > 0 ? Json(r.share_of_catalogue) : Json(nullptr)},
      {"sentence", r.plausibility}};
  return out;
}

void print(const ident::AxialTestResult& r, std::ostream& out) {
  fmt::print(out, "{:>9} {:>8} {:>12} {:>10} {:>11} {:>10} {:>12}\n", "length m", "records", "EA N",
             "std", "damping", "std", "damper Ns/m");
  for (const auto& l : r.lengths) {
    fmt::print(out, "{:>9.4g} {:>8} {:>12.6g} {:>10.3g} {:>11.5g} {:>10.2g} {:>12.4g}\n",
               l.length_m, l.records, l.EA_N.value, l.EA_N.std, l.damping_ratio.value,
               l.damping_ratio.std, l.damping_Ns_m);
  }
  fmt::print(out, "\nEA            {:.6g} N, std {:.3g} ({:.4g} to {:.4g} with 95 %)\n",
             r.EA_N.value, r.EA_N.std, r.EA_low_N, r.EA_high_N);
  fmt::print(out, "damping ratio {:.5g}, std {:.2g}\n", r.damping_ratio.value, r.damping_ratio.std);
  fmt::print(out, "damper        {:.5g} Ns/m, std {:.2g} (at {:.4g} m)\n", r.damping_Ns_m.value,
             r.damping_Ns_m.std, r.reference_length_m);
  if (r.lengths.size() > 1) {
    fmt::print(out, "between lengths: std {:.3g} N, the same EA with p = {:.2g}\n",
               r.between_lengths_std_N, r.homogeneity_p);
  }
  fmt::print(out, "\n{:<24} {:>12} {:>16} {:>8}\n", "uncertainty of EA from", "std",
             "contribution N", "share %");
  for (const auto& b : r.budget) {
    fmt::print(out, "{:<24} {:>12} {:>16.4g} {:>8.1f}\n", b.source,
               fmt::format("{:.3g} {}", b.std, b.unit), b.contribution_N, 100 * b.share);
  }
  if (r.draws > 0) {
    fmt::print(out, "Monte Carlo, {} draws: std {:.3g} N, {:.4g} to {:.4g} N with 95 %\n", r.draws,
               r.monte_carlo_EA_N.std, r.monte_carlo_low_N, r.monte_carlo_high_N);
  }
  if (!r.plausibility.empty()) fmt::print(out, "\n{}\n", r.plausibility);
}

Json run(const AxialCommand& command, VerbContext& context) {
  const auto lengths = length_of_each_file(command);
  ident::AxialSetup setup;
  setup.mass_kg = {command.mass, command.mass_std};
  setup.mass_per_length_kg_m = {command.mass_per_length, command.mass_per_length_std};
  setup.length_std_m = command.length_std;
  setup.adapter_stiffness_N_m = {command.adapter, command.adapter_std};
  if (!command.adapter_bar.empty()) {
    if (command.adapter > 0)
      throw UsageError("--adapter-stiffness and --adapter-bar say the same: give one");
    for (double v : command.adapter_bar) {
      if (!(v > 0)) throw UsageError("--adapter-bar takes modulus, area and length, all positive");
    }
    setup.adapter_stiffness_N_m.value =
        command.adapter_bar[0] * command.adapter_bar[1] / command.adapter_bar[2];
  }
  setup.catalogue_EA_N = command.catalogue;
  std::vector<RecordedSample> all;
  for (std::size_t i = 0; i < command.files.size(); ++i) {
    for (auto& s : decays_of(command.files[i], lengths[i], command, context))
      all.push_back(std::move(s));
  }
  std::vector<ident::AxialDecay> decays;
  for (const auto& s : all) {
    if (!s.decay.refusal_code.empty()) continue;
    const auto& mode = s.decay.modes.front();
    decays.push_back({fmt::format("{} at {:.4g} s", s.file, s.start_s), s.length_m,
                      mode.damped_frequency_hz, mode.damping_ratio});
  }
  if (decays.empty()) {
    context.refuse("no_decay", "none of the records holds a decay that can be used");
    return {{"samples", Json::array()}};
  }
  if (command.mass_per_length == 0) {
    context.warn("massless_cable",
                 "no --mass-per-length: a third of the cable's mass is missing from the "
                 "oscillating mass, and EA comes out low");
  }
  if (command.mass_std == 0 || command.length_std == 0) {
    context.warn("exact_inputs",
                 "mass or length taken as exact (no --mass-std or --length-std): the "
                 "uncertainty of EA leaves them out");
  }
  ident::AxialOptions options;
  options.draws = command.draws;
  options.seed = context.seed;
  ident::AxialTestResult r;
  try {
    r = ident::axial_test(decays, setup, options);
  } catch (const std::invalid_argument& error) {
    throw Refused(error.what());
  }
  for (const auto& n : r.notes) context.warn(n.code, n.message, n.where);
  print(r, context.out);
  return json_of(r, all);
}

}  // namespace

void add_axial(CLI::App& program, Verbs& verbs) {
  auto c = std::make_shared<AxialCommand>();
  CLI::App* app = program.add_subcommand("axial", "EA and axial damping from hanging-mass records");
  app->footer(kAxialExample);
  app->add_option("files", c->files, "Recordings of the tension (or motion) after an impulse")
      ->required()
      ->type_name("FILE");
  app->add_option("--mass", c->mass, "Hung mass, adapter and clamp included, kg")
      ->required()
      ->check(positive_number())
      ->type_name("M");
  app->add_option("--length", c->lengths,
                  "Cable length, m: for all, each file, or each group of files")
      ->required()
      ->check(positive_number())
      ->type_name("L");
  app->add_option("--channel", c->channel, "Name or #number")->type_name("C");
  app->add_option("--mass-per-length", c->mass_per_length, "Of the cable, kg/m")
      ->check(not_negative_number());
  app->add_option("--mass-std", c->mass_std, "Standard uncertainty, kg")
      ->check(not_negative_number());
  app->add_option("--length-std", c->length_std, "Standard uncertainty of each length, m")
      ->check(not_negative_number());
  app->add_option("--mass-per-length-std", c->mass_per_length_std, "Standard uncertainty, kg/m")
      ->check(not_negative_number());
  app->add_option("--adapter-stiffness", c->adapter,
                  "In series with the cable, N/m (default: rigid)")
      ->check(not_negative_number());
  app->add_option("--adapter-stiffness-std", c->adapter_std, "Standard uncertainty, N/m")
      ->check(not_negative_number());
  app->add_option("--adapter-bar", c->adapter_bar,
                  "Adapter as a bar: modulus Pa, area m2, length m")
      ->expected(3)
      ->type_name("E A l");
  app->add_option("--catalogue-EA", c->catalogue,
                  "What EA should be, N (default: 80 GPa on the metal of the mass per length)")
      ->check(not_negative_number());
  app->add_option("--band", c->band, "Where the axial frequency is, Hz")
      ->expected(2)
      ->type_name("HZ");
  app->add_option("--sample-rate", c->sample_rate_hz, "Where a file gives none, Hz")
      ->check(positive_number());
  app->add_option("--draws", c->draws, "Monte Carlo draws, 0 for none")
      ->check(CLI::Range(0, 10000000))
      ->capture_default_str();
  verbs.push_back({app, [c](VerbContext& context) { return run(*c, context); }});
}

}  // namespace rigfit::apps
