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

py::tuple bending(const py::list& given, const py::dict& options) {
  const auto sources = shared_sources(given);
  auto command = command_of<apps::BendingCommand>(options);
  command.files = names_of(*sources);
  command.columns.remedy = "name it with `{}`";
  return run_verb("bending", options, [sources, command](apps::VerbContext& context) {
    apps::BendingCommand filled = command;
    for (const Source& source : *sources) {
      apps::add_bending_source(bending_recording(source, context), filled, context);
    }
    return apps::bending_result(std::move(filled), context);
  });
}

py::tuple axial(const py::list& given, const py::dict& options) {
  const auto sources = shared_sources(given);
  auto command = command_of<apps::AxialCommand>(options);
  command.files = names_of(*sources);
  return run_verb("axial", options, [sources, command](apps::VerbContext& context) {
    auto recordings = load_all(*sources, command.sample_rate_hz, context);
    return apps::axial_result(command, std::move(recordings), context);
  });
}

py::tuple tension(const py::list& given, const py::dict& options) {
  const auto sources = shared_sources(given);
  auto command = command_of<apps::TensionCommand>(options);
  command.files = names_of(*sources);
  return run_verb("tension", options, [sources, command](apps::VerbContext& context) {
    const auto recordings = load_all(*sources, command.sample_rate_hz, context);
    return apps::tension_result(command, recordings, context);
  });
}

py::tuple tension_table(const py::dict& options) {
  const auto command = command_of<apps::TensionCommand>(options);
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
