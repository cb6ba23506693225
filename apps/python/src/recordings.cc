// Recordings as Python holds them.
#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <array>
#include <memory>
#include <string>
#include <utility>

#include "apps/campaign_file/recording_description.h"
#include "apps/cli/json_document.h"
#include "apps/python/src/call.h"
#include "signal/recording/recording.h"
#include "signal/recording/units.h"

namespace rigfit::python {
namespace {

using Shared = std::shared_ptr<signal::Recording>;

/// Samples are views that cannot be written to and keep the recording alive.
py::list channels_of(const Shared& recording) {
  py::list list;
  for (const auto& channel : recording->channels) {
    const auto& d = channel.direction;
    const py::array view(py::dtype::of<double>(), {channel.samples.size()}, {sizeof(double)},
                         channel.samples.data(), py::cast(recording));
    view.attr("setflags")(py::arg("write") = false);
    py::dict one;
    one["name"] = channel.name;
    one["unit"] = channel.unit;
    one["source_unit"] = channel.source_unit;
    one["quantity"] = signal::name_of(channel.quantity);
    one["direction"] = py::make_tuple(d[0], d[1], d[2]);
    one["missing_samples"] = channel.missing_samples;
    one["data"] = view;
    list.append(std::move(one));
  }
  return list;
}

py::list notes_of(const signal::Recording& recording) {
  Json list = Json::array();
  for (const auto& note : recording.notes) {
    list.push_back({{"code", note.code}, {"message", note.message}, {"where", note.where}});
  }
  return to_python(list);
}

/// A channel in its own unit: a copy of its numbers, in SI.
void add_channel(signal::Recording& recording, const py::dict& given) {
  const auto text = given["unit"].cast<std::string>();
  const auto unit = signal::parse_unit(text);
  signal::Channel channel;
  channel.name = given["name"].cast<std::string>();
  channel.source_unit = text;
  channel.missing_samples = given["missing"].cast<long>();
  if (given.contains("direction")) {
    channel.direction = given["direction"].cast<std::array<double, 3>>();
  }
  const auto array = given["data"].cast<py::array_t<double, py::array::c_style>>();
  channel.samples = Eigen::Map<const Eigen::VectorXd>(array.data(), array.size());
  if (unit) {
    channel.unit = unit->si;
    channel.quantity = unit->quantity;
    channel.si_per_source = unit->factor;
    channel.si_offset = unit->offset;
    channel.samples = channel.samples.array() * unit->factor + unit->offset;
  } else if (!text.empty()) {
    recording.notes.push_back(
        {"unknown_unit", "unit \"" + text + "\" is not known: its numbers are kept as they are",
         channel.name});
  }
  recording.channels.push_back(std::move(channel));
}

Shared from_channels(const py::list& channels, double fs, double start_s, const std::string& name) {
  auto recording = std::make_shared<signal::Recording>();
  recording->path = name;
  recording->format = "memory";
  recording->sample_rate_hz = fs;
  recording->start_time_s = start_s;
  for (const py::handle channel : channels) add_channel(*recording, channel.cast<py::dict>());
  return recording;
}

py::tuple read(const std::string& path, const py::dict& options) {
  auto recording = std::make_shared<signal::Recording>();
  const py::tuple answer = run_work("read", options, [recording, path](apps::VerbContext& context) {
    *recording = apps::load_recording(path, context);
    return Json::object();
  });
  return py::make_tuple(recording, answer[0]["warnings"]);
}

}  // namespace

void bind_recordings(py::module_& module) {
  py::class_<signal::Recording, Shared>(module, "Recording")
      .def_property_readonly("name", [](const signal::Recording& r) { return r.path.string(); })
      .def_readonly("format", &signal::Recording::format)
      .def_readonly("fs", &signal::Recording::sample_rate_hz)
      .def_readonly("start_time_s", &signal::Recording::start_time_s)
      .def_property_readonly("uniform",
                             [](const signal::Recording& r) { return r.time_s.size() == 0; })
      .def_property_readonly("time_s",
                             [](const signal::Recording& r) {
                               return py::array_t<double>(r.time_s.size(), r.time_s.data());
                             })
      .def("notes", &notes_of)
      .def("channels", &channels_of);
  module.def("read", &read);
  module.def("from_channels", &from_channels);
}

}  // namespace rigfit::python
