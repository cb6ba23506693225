#include "apps/python/src/recording_object.h"

#include <pybind11/stl.h>

#include <array>
#include <cmath>
#include <utility>

#include "apps/campaign_file/recording_description.h"
#include "apps/cli/common_options.h"
#include "apps/cli/json_document.h"
#include "apps/python/src/borrowed_samples.h"
#include "apps/python/src/call.h"
#include "signal/recording/units.h"

namespace rigfit::python {
namespace {

using Shared = std::shared_ptr<RecordingObject>;

/// Samples of a channel as an array that cannot be written to and keeps the recording alive.
py::array samples_of(const Shared& object, std::size_t channel) {
  const Eigen::VectorXd& samples = object->recording.channels.at(channel).samples;
  py::array view(py::dtype::of<double>(), {samples.size()}, {sizeof(double)}, samples.data(),
                 py::cast(object));
  view.attr("setflags")(py::arg("write") = false);
  return view;
}

py::list channels_of(const Shared& object) {
  py::list list;
  for (std::size_t c = 0; c < object->recording.channels.size(); ++c) {
    const signal::Channel& channel = object->recording.channels[c];
    py::dict one;
    one["name"] = channel.name;
    one["unit"] = channel.unit;
    one["source_unit"] = channel.source_unit;
    one["quantity"] = signal::name_of(channel.quantity);
    one["direction"] =
        py::make_tuple(channel.direction[0], channel.direction[1], channel.direction[2]);
    one["missing_samples"] = channel.missing_samples;
    one["data"] = samples_of(object, c);
    list.append(std::move(one));
  }
  return list;
}

py::list notes_of(const RecordingObject& object) {
  py::list list;
  for (const signal::Note& note : object.recording.notes) {
    py::dict one;
    one["code"] = note.code;
    one["message"] = note.message;
    one["where"] = note.where;
    list.append(std::move(one));
  }
  return list;
}

/// A channel in its own unit: numbers in SI, which is a copy only where the unit asks for one.
void add_channel(RecordingObject& object, const py::dict& given) {
  const auto text = given["unit"].cast<std::string>();
  const auto unit = signal::parse_unit(text);
  signal::Channel channel;
  channel.name = given["name"].cast<std::string>();
  channel.source_unit = text;
  channel.missing_samples = given["missing"].cast<long>();
  if (given.contains("direction")) {
    channel.direction = given["direction"].cast<std::array<double, 3>>();
  }
  if (unit) {
    channel.unit = unit->si;
    channel.quantity = unit->quantity;
    channel.si_per_source = unit->factor;
    channel.si_offset = unit->offset;
  } else if (!text.empty()) {
    object.recording.notes.push_back(
        {"unknown_unit", "unit \"" + text + "\" is not known: its numbers are kept as they are",
         channel.name});
  }
  const auto array = given["data"].cast<py::array_t<double, py::array::c_style>>();
  object.recording.channels.push_back(std::move(channel));
  const std::size_t index = object.recording.channels.size() - 1;
  object.set_samples(index, array);
  if (unit && (unit->factor != 1 || unit->offset != 0)) {
    auto& samples = object.recording.channels[index].samples;
    const Eigen::VectorXd scaled = (samples.array() * unit->factor + unit->offset).matrix();
    object.set_samples(index, py::array_t<double>(scaled.size(), scaled.data()));
  }
}

/// How many samples are NaN, how many infinite.
py::tuple count_not_finite(const py::array_t<double, py::array::c_style>& samples) {
  const double* data = samples.data();
  const py::ssize_t count = samples.size();
  long missing = 0, infinite = 0;
  {
    const py::gil_scoped_release unlocked;
    for (py::ssize_t i = 0; i < count; ++i) {
      if (std::isfinite(data[i])) continue;
      ++(std::isnan(data[i]) ? missing : infinite);
    }
  }
  return py::make_tuple(missing, infinite);
}

Shared from_channels(const py::list& channels, double fs, double start_s, const std::string& name) {
  auto object = std::make_shared<RecordingObject>();
  object->recording.path = name;
  object->recording.format = "memory";
  object->recording.sample_rate_hz = fs;
  object->recording.start_time_s = start_s;
  for (const py::handle channel : channels) {
    add_channel(*object, channel.cast<py::dict>());
  }
  return object;
}

py::tuple read(const std::string& path, const py::dict& options) {
  struct State {
    explicit State(const py::dict& from) : context(from) {}
    CallContext context;
    Shared object = std::make_shared<RecordingObject>();
  };
  auto state = std::make_shared<State>(options);
  apps::ReadingOptions given;
  take(options_of(given), options);
  signal::ReadOptions reading = apps::read_options(given);
  if (options.contains("sample_rate")) {
    reading.sample_rate_hz = options["sample_rate"].cast<double>();
  }
  run_unlocked([state, path, reading] {
    state->object->recording = apps::load_recording(path, state->context.verb(), reading);
  });
  return py::make_tuple(state->object, to_python(apps::json_document(state->context.verb(), "read",
                                                                     Json::object())["warnings"]));
}

}  // namespace

RecordingObject::~RecordingObject() {
  for (std::size_t c = 0; c < borrowed_.size() && c < recording.channels.size(); ++c) {
    if (borrowed_[c]) give_back(recording.channels[c].samples);
  }
}

void RecordingObject::set_samples(std::size_t channel, const py::array_t<double>& array) {
  borrowed_.resize(recording.channels.size(), false);
  owners_.resize(recording.channels.size());
  Eigen::VectorXd& samples = recording.channels[channel].samples;
  if (borrowed_[channel]) give_back(samples);
  borrowed_[channel] = can_borrow(array.data());
  if (borrowed_[channel]) {
    borrow(samples, array.data(), array.size());
    owners_[channel] = array;
  } else {
    samples = Eigen::Map<const Eigen::VectorXd>(array.data(), array.size());
    owners_[channel] = py::object();
  }
}

void bind_recordings(py::module_& module) {
  py::class_<RecordingObject, Shared>(module, "Recording")
      .def_property_readonly("name",
                             [](const RecordingObject& r) { return r.recording.path.string(); })
      .def_property_readonly("format", [](const RecordingObject& r) { return r.recording.format; })
      .def_property_readonly("fs",
                             [](const RecordingObject& r) { return r.recording.sample_rate_hz; })
      .def_property_readonly("start_time_s",
                             [](const RecordingObject& r) { return r.recording.start_time_s; })
      .def_property_readonly(
          "uniform", [](const RecordingObject& r) { return r.recording.time_s.size() == 0; })
      .def_property_readonly("time_s",
                             [](const RecordingObject& r) {
                               return py::array_t<double>(r.recording.time_s.size(),
                                                          r.recording.time_s.data());
                             })
      .def("notes", &notes_of)
      .def("channels", &channels_of);
  module.def("read", &read);
  module.def("from_channels", &from_channels);
  module.def("count_not_finite", &count_not_finite);
}

}  // namespace rigfit::python
