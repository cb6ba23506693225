// rigfit modal --ambient: modes from motion under unknown forces, one or several set-ups.
#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <vector>

#include "apps/campaign_file/recording_description.h"
#include "apps/cli/plots/plot_option.h"
#include "apps/cli/verbs/impact_command.h"
#include "apps/describe/digits.h"
#include "apps/report/figures/figures.h"
#include "apps/results/modal_json.h"
#include "signal/ambient/ambient_modes.h"
#include "signal/writers/write_uff.h"

namespace rigfit::apps {
namespace {

void check_ambient_options(const ModalCommand& command) {
  const auto& impact = command.impact;
  if (!impact.hammer.force.empty())
    throw UsageError("--ambient is for motion without a measured force");
  for (const auto& name : command.of_hits) {
    if (name != "--response" && name != "--sample-rate") {
      throw UsageError(name + " is for hits; --ambient has none");
    }
  }
  if (!command.synthesis.empty()) throw UsageError("--synthesis needs FRFs; --ambient has none");
}

/// Set-ups that have a reference, or an error that names the channels that would serve.
signal::AmbientResult analysed(const ModalCommand& command, VerbContext& context) {
  signal::AmbientOptions options;
  options.channels = command.impact.hammer.responses;
  if (!command.impact.band.empty()) {
    options.low_hz = command.impact.band[0], options.high_hz = command.impact.band[1];
  }
  options.max_damping_ratio = command.max_damping;
  // The usual order of FRFs is not that of half spectra.
  if (command.order != ModalCommand().order) options.max_order = command.order;
  options.threads = context.threads;
  std::vector<signal::AmbientResult> setups;
  for (const auto& file : command.files) {
    // One recording is held at a time: a day of many channels fills the memory. A reference that
    // it lacks is refused below, with the channels that would serve.
    const signal::Recording recording =
        load_recording(file, context, command.impact.sample_rate_hz);
    options.references.clear();
    for (const auto& name : command.references) {
      const bool there = std::any_of(recording.channels.begin(), recording.channels.end(),
                                     [&](const auto& channel) { return channel.name == name; });
      if (there || command.files.size() == 1) options.references.push_back(name);
    }
    setups.push_back(signal::ambient_modes(recording, options));
    for (auto& note : setups.back().notes) {
      if (command.files.size() > 1)
        note.where = file + (note.where.empty() ? "" : ", ") + note.where;
    }
  }
  return signal::merge_setups(setups, command.references);
}

Json ambient_mode_json(const signal::AmbientMode& one) {
  Json json = mode_json(one.mode);
  json["frequency_hz"]["low"] = json_number(one.frequency_95.low);
  json["frequency_hz"]["high"] = json_number(one.frequency_95.high);
  json["damping_ratio"]["low"] = json_number(one.damping_95.low);
  json["damping_ratio"]["high"] = json_number(one.damping_95.high);
  json["degrees_of_freedom"] = json_number(one.degrees);
  json["decay_times"] = json_number(one.decay_times);
  json["doubt_code"] = one.code.empty() ? Json(nullptr) : Json(one.code);
  return json;
}

void print(std::ostream& out, const signal::AmbientResult& result, bool all) {
  std::size_t others = 0;
  out << fmt::format("{:>4} {:>12} {:>10} {:>11} {:>10} {:>6} {:>6}\n", "mode", "f, Hz", "+-",
                     "damping, %", "+-", "MPC", "T/tau");
  for (std::size_t r = 0; r < result.modes.size(); ++r) {
    const auto& one = result.modes[r];
    const auto &f = one.mode.frequency_hz, &zeta = one.mode.damping_ratio;
    if (one.mode.doubtful && !all) {
      ++others;
      continue;
    }
    out << fmt::format("{:>4} {:>12} {:>10} {:>11} {:>10} {:>6.3f} {:>6.0f}  {}\n", r + 1,
                       value_digits(f.value, f.std), std_digits(f.std),
                       value_digits(100 * zeta.value, 100 * zeta.std), std_digits(100 * zeta.std),
                       one.mode.modal_phase_collinearity, one.decay_times,
                       one.mode.doubtful ? "uncertain: " + one.mode.doubt : "");
  }
  if (others > 0) out << fmt::format("and {} uncertain: --all lists them\n", others);
  for (const auto& tone : result.tones) {
    out << fmt::format("tone at {:.6g} Hz taken out, amplitude {:.3g}\n", tone.frequency_hz,
                       tone.amplitude);
  }
  out << fmt::format("{:.4g} to {:.4g} Hz, {:.0f} s, correlations to {:.3g} s\n", result.low_hz,
                     result.high_hz, result.duration_s, result.lag_s);
}

/// Singular values of the spectral matrix with the modes, stabilisation diagram.
void draw(PlotSheet& sheet, const signal::AmbientResult& found) {
  signal::ModalResult poles;
  poles.stabilisation = found.stabilisation;
  Plot plot{"ambient-spectrum",
            "Singular values of the spectral matrix",
            "Motion of all channels together, each over its standard deviation. A mode is a peak "
            "of the first singular value; where the second rises with it, two modes are close. "
            "Lines: modes, broken where they are uncertain.",
            "frequency, Hz",
            "singular value",
            false,
            true};
  plot.link = plot.id;
  for (const auto& one : found.modes) {
    const double f = one.mode.frequency_hz.value;
    plot.marks.push_back({f, fmt::format("{:.4g}", f), Origin::modelled, one.mode.doubtful});
    if (!one.mode.doubtful) poles.model.modes.push_back(one.mode);
  }
  for (Eigen::Index k = 0; k < std::min<Eigen::Index>(3, found.singular_values.cols()); ++k) {
    PlotSeries series{fmt::format("singular value {}", k + 1), Origin::measured,
                      static_cast<int>(k)};
    for (Eigen::Index i = 0; i < found.spectrum_hz.size(); ++i) {
      series.add(found.spectrum_hz[i], found.singular_values(i, k));
    }
    plot.series.push_back(std::move(series));
  }
  sheet.add(std::move(plot));
  if (poles.stabilisation.poles.empty()) return;
  Plot diagram = stabilisation_plot("ambient-stabilisation", poles, Origin::measured);
  diagram.link = "ambient-spectrum";
  sheet.add(std::move(diagram));
}

}  // namespace

Json ambient_result(const ModalCommand& command, VerbContext& context) {
  check_ambient_options(command);
  const signal::AmbientResult found = analysed(command, context);
  for (const auto& note : found.notes) {
    if (note.code == "no_modes") {
      context.refuse(note.code, note.message, note.where);
    } else {
      context.warn(note.code, note.message, note.where);
    }
  }
  Json result{{"modes", Json::array()}, {"responses", Json::array()}, {"tones", Json::array()}};
  for (const auto& one : found.modes) result["modes"].push_back(ambient_mode_json(one));
  for (const auto& name : found.channels) {
    result["responses"].push_back({{"name", name}, {"node", 0}, {"direction", 0}});
  }
  for (const auto& tone : found.tones) {
    result["tones"].push_back({{"frequency_hz", tone.frequency_hz}, {"amplitude", tone.amplitude}});
  }
  result["input_points"] = Json::array();
  result["ambient"] = true;
  result["amplitudes"] = false;  // shapes have no scale
  result["band_hz"] = {found.low_hz, found.high_hz};
  result["lag_s"] = found.lag_s;
  print(context.out, found, command.all);
  if (context.plots) draw(*context.plots, found);
  if (!command.out.empty()) {
    signal::ModalModel sure;  // UFF has no place for doubts
    for (const auto& one : found.modes) {
      if (!one.mode.doubtful) sure.modes.push_back(one.mode);
    }
    for (const auto& name : found.channels) sure.responses.push_back({name, 0, 0});
    context.write(command.out, signal::uff_text(sure));
    result["out"] = command.out;
    context.out << "modes (UFF 55): " << command.out << '\n';
  }
  return result;
}

}  // namespace rigfit::apps
