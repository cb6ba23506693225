// Python's bending, axial, tension: what the verbs of these names do with recordings.
#include <pybind11/stl.h>

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "apps/cli/verbs/calls.h"
#include "apps/python/src/call.h"
#include "apps/python/src/module.h"
#include "apps/python/src/recording_object.h"

namespace rigfit::python {
namespace {

using SharedSources = std::shared_ptr<std::vector<Source>>;

SharedSources shared_sources(const py::list& given) {
  return std::make_shared<std::vector<Source>>(sources_of(given));
}

std::vector<std::string> names_of(const std::vector<Source>& sources) {
  std::vector<std::string> names;
  for (const Source& source : sources) names.push_back(source.name());
  return names;
}

std::vector<signal::Recording> load_all(const std::vector<Source>& sources, double sample_rate_hz,
                                        apps::VerbContext& context) {
  signal::ReadOptions reading;
  reading.sample_rate_hz = sample_rate_hz;
  std::vector<signal::Recording> recordings;
  recordings.reserve(sources.size());
  for (const Source& source : sources) recordings.push_back(source.load(context, reading));
  return recordings;
}

signal::Recording bending_recording(const Source& source, apps::VerbContext& context) {
  if (!source.recording) return apps::load_bending_file(source.path, context);
  signal::Recording recording = source.recording->recording;
  apps::drop_time_notes(recording);
  warn_of_notes(recording, context);
  return recording;
}

py::tuple bending(const py::list& given, const py::dict& options_given) {
  const Options options(options_given);
  const auto sources = shared_sources(given);
  apps::BendingCommand command;
  command.files = names_of(*sources);
  options.take("span", command.span);
  options.take("span_std", command.span_std);
  options.take("tension", command.columns.tension);
  options.take("load", command.columns.load);
  options.take("deflection", command.columns.deflection);
  command.columns.remedy = "name it with `{}`";
  ident::BendingTestOptions& test = command.campaign.test;
  options.take("load_calibration", test.load_calibration_std);
  options.take("deflection_calibration", test.deflection_calibration_std);
  options.take("tension_calibration", test.tension_calibration_std);
  options.take("tension_zero_std", test.tension_zero_std_N);
  options.take("strand", command.strand);
  options.take("ends", command.ends);
  options.take("rectangle", command.rectangle);
  options.take("diameter", command.diameter);
  options.take("second_moment", command.second_moment);
  options.take("section_std", command.section_std);
  options.take("relative_std", command.campaign.assumed_relative_std);
  options.take("EA", command.EA);
  options.take("mass_per_length", command.mass_per_length);
  return run_verb("bending", options, [sources, command](apps::VerbContext& context) {
    apps::BendingCommand filled = command;
    for (const Source& source : *sources) {
      apps::add_bending_source(bending_recording(source, context), filled, context);
    }
    return apps::bending_result(std::move(filled), context);
  });
}

py::tuple axial(const py::list& given, const py::dict& options_given) {
  const Options options(options_given);
  const auto sources = shared_sources(given);
  apps::AxialCommand command;
  command.files = names_of(*sources);
  options.take("mass", command.mass);
  options.take("length", command.lengths);
  options.take("channel", command.channel);
  options.take("mass_per_length", command.mass_per_length);
  options.take("mass_std", command.mass_std);
  options.take("length_std", command.length_std);
  options.take("mass_per_length_std", command.mass_per_length_std);
  options.take("adapter_stiffness", command.adapter);
  options.take("adapter_stiffness_std", command.adapter_std);
  options.take("adapter_bar", command.adapter_bar);
  options.take("compliance_std", command.compliance_std);
  options.take("frame_stiffness", command.frame);
  options.take("frame_stiffness_std", command.frame_std);
  options.take("catalogue_EA", command.catalogue);
  options.take("band", command.band);
  options.take("sample_rate", command.sample_rate_hz);
  options.take("draws", command.draws);
  return run_verb("axial", options, [sources, command](apps::VerbContext& context) {
    auto recordings = load_all(*sources, command.sample_rate_hz, context);
    return apps::axial_result(command, std::move(recordings), context);
  });
}

py::tuple tension(const py::list& given, const py::dict& options_given) {
  const Options options(options_given);
  const auto sources = shared_sources(given);
  apps::TensionCommand command;
  command.files = names_of(*sources);
  options.take("channel", command.channels);
  options.take("frequencies", command.frequencies);
  options.take("band", command.band);
  options.take("measured", command.measured);
  options.take("column", command.column);
  options.take("plane", command.plane);
  options.take("length", command.length);
  options.take("mass_per_length", command.mass);
  options.take("mass_of", command.mass_of);
  options.take("EI", command.EI);
  options.take("EA", command.EA);
  options.take("ends", command.ends);
  options.take("frequency_std", command.frequency_std);
  options.take("inclination", command.inclination);
  options.take("sample_rate", command.sample_rate_hz);
  options.take("missed", command.missed);
  options.take("false_mode", command.false_mode);
  options.take("max_peaks", command.max_peaks);
  return run_verb("tension", options, [sources, command](apps::VerbContext& context) {
    const auto recordings = load_all(*sources, command.sample_rate_hz, context);
    return apps::tension_result(command, recordings, context);
  });
}

py::tuple tension_table(const py::dict& options_given) {
  const Options options(options_given);
  apps::TensionTableCommand command;
  options.take("table", command.table);
  options.take("out", command.out);
  options.take("missed", command.missed);
  options.take("false_mode", command.false_mode);
  return run_verb("tension", options, [command](apps::VerbContext& context) {
    return apps::tension_table_result(command, context);
  });
}

}  // namespace

void bind_laboratory(py::module_& module) {
  module.def("bending", &bending);
  module.def("axial", &axial);
  module.def("tension", &tension);
  module.def("tension_table", &tension_table);
}

}  // namespace rigfit::python
