// rigfit axial: EA, damping ratio and damper of a cable from hanging-mass records.
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <memory>

#include "apps/campaign_file/recording_description.h"
#include "apps/cli/exit_code.h"
#include "apps/cli/plots/verb_figures.h"
#include "apps/cli/verbs/all.h"
#include "apps/results/axial_result.h"
#include "ident/campaign/single_tests/axial_campaign.h"

namespace rigfit::apps {
namespace {

struct AxialCommand {
  std::vector<std::string> files;
  std::vector<double> lengths, band;  ///< m: one, one a file, or one a group of files; Hz
  std::string channel;
  double mass = 0, mass_std = 0, mass_per_length = 0, mass_per_length_std = 0;
  double length_std = -1;  ///< negative: not given
  double adapter = 0, adapter_std = 0, catalogue = 0, sample_rate_hz = 0;
  double compliance_std = -1;  ///< negative: not given
  std::string frame;           ///< stiffness, N/m, or "rigid"; empty: not given
  double frame_std = 0;
  std::vector<double> adapter_bar;  ///< E Pa, A m2, l m
};

constexpr const char* kAxialExample = R"(Example:
  rigfit axial a.csv b.csv c.csv --channel tension --mass 2.2 --mass-std 0.001 \
      --length 0.7 1.0 1.3 --length-std 0.001 --mass-per-length 0.16667
One length: for all files. As many lengths as files: one for each, in order. Otherwise the files are
taken in equal groups, one a length: six files with --length 0.7 1.0 are three of 0.7 m, then three
of 1.0 m. A file may hold several impulses; each is a sample. From two lengths on, a compliance in
series (frame, adapter) is told from the slope of 1/k over length. One length cannot tell: it gives
the stiffness of the whole chain and EA from below, unless --frame-stiffness says what the frame has
(rigid is a statement too).)";

// What --frame-stiffness says, into the setup.
void state_frame(const AxialCommand& command, ident::AxialSetup& setup) {
  if (command.frame.empty()) return;
  setup.frame_stated = true;
  if (command.frame == "rigid") {
    if (command.frame_std > 0) {
      throw UsageError("--frame-stiffness rigid has no --frame-stiffness-std");
    }
    return;
  }
  double value = 0;
  const auto* end = command.frame.data() + command.frame.size();
  const auto [stop, error] = std::from_chars(command.frame.data(), end, value);
  if (error != std::errc() || stop != end || !std::isfinite(value) || !(value > 0)) {
    throw UsageError("--frame-stiffness: \"" + command.frame +
                     "\" is neither a positive number (N/m) nor rigid");
  }
  setup.frame_stiffness_N_m = {value, command.frame_std};
}

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

Json run(const AxialCommand& command, VerbContext& context) {
  const auto lengths = length_of_each_file(command);
  ident::AxialInputs inputs;
  auto& setup = inputs.setup;
  setup.mass_kg = {command.mass, command.mass_std};
  setup.mass_per_length_kg_m = {command.mass_per_length, command.mass_per_length_std};
  if (command.length_std >= 0) setup.length_std_m = command.length_std;
  setup.adapter_stiffness_N_m = {command.adapter, command.adapter_std};
  state_frame(command, setup);
  if (command.compliance_std >= 0) setup.series_compliance_std_m_N = command.compliance_std;
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
  inputs.channel = command.channel;
  inputs.threads = context.threads;
  double slowest = 0;
  for (std::size_t i = 0; i < command.files.size(); ++i) {
    signal::Recording recording = load_recording(command.files[i], context, command.sample_rate_hz);
    (void)chosen_channel(recording, command.channel);
    const std::string name = recording.path.string();
    const double rate = recording.sample_rate_hz;
    if (!(rate > 0)) {
      throw UsageError(name + " gives no sample rate: say it with --sample-rate");
    }
    slowest = i == 0 ? rate : std::min(slowest, rate);
    inputs.recordings.push_back({name, std::move(recording), lengths[i]});
  }
  if (!command.band.empty()) {
    if (!(command.band[0] >= 0 && command.band[0] < command.band[1] &&
          command.band[0] < 0.5 * slowest)) {
      throw UsageError("--band must rise and begin below half the sample rate");
    }
    inputs.band_low_hz = command.band[0], inputs.band_high_hz = command.band[1];
  }
  const auto result = ident::axial_campaign(inputs);
  context.tell(result.findings);
  if (context.plots) draw_axial(*context.plots, inputs, result);
  if (result.test) print_axial(context.out, *result.test);
  return axial_json(inputs, result);
}

describe::Options options_of(AxialCommand& c) {
  using describe::option;
  return {
      option("files", c.files, "Recordings of the tension (or motion) after an impulse")
          .required()
          .type("FILE"),
      option("--mass", c.mass, "Hung mass, adapter and clamp included", "kg")
          .required()
          .positive()
          .type("M"),
      option("--length", c.lengths, "Cable length, m: for all, each file, or each group of files")
          .required()
          .positive()
          .type("L"),
      option("--channel", c.channel, "Name or #number").type("C"),
      option("--mass-per-length", c.mass_per_length, "Of the cable", "kg/m").from_zero(),
      option("--mass-std", c.mass_std, "Standard uncertainty", "kg").from_zero(),
      option("--length-std", c.length_std,
             "Standard uncertainty of each length, m (not given: EA has no uncertainty)")
          .from_zero(),
      option("--mass-per-length-std", c.mass_per_length_std, "Standard uncertainty", "kg/m")
          .from_zero(),
      option("--adapter-stiffness", c.adapter, "In series with the cable, N/m (default: rigid)")
          .from_zero(),
      option("--adapter-stiffness-std", c.adapter_std, "Standard uncertainty", "N/m").from_zero(),
      option("--frame-stiffness", c.frame,
             "What gives way above the cable, N/m, or rigid (default: not known; one length then "
             "gives a lower bound of EA)")
          .type("K|rigid"),
      option("--frame-stiffness-std", c.frame_std, "Standard uncertainty", "N/m").from_zero(),
      option("--adapter-bar", c.adapter_bar, "Adapter as a bar: modulus Pa, area m2, length m")
          .count(3)
          .type("E A l"),
      option("--compliance-std", c.compliance_std,
             "Standard uncertainty of what else gives way in series, m/N; 0: known to be rigid "
             "(default: not known, told from several lengths)")
          .from_zero(),
      option("--catalogue-EA", c.catalogue,
             "What EA should be, N (default: 80 GPa on the metal of the mass per length)")
          .from_zero(),
      option("--band", c.band, "Where the axial frequency is", "Hz").count(2).type("HZ"),
      option("--sample-rate", c.sample_rate_hz, "Where a file gives none", "Hz").positive()};
}

}  // namespace

Verb axial_verb() {
  Verb verb = verb_of<AxialCommand>(
      "axial", "EA and axial damping from hanging-mass records", kAxialExample,
      [](const AxialCommand& c, VerbContext& context) { return run(c, context); });
  verb.draws = true;
  verb.reads = true;
  return verb;
}

}  // namespace rigfit::apps
