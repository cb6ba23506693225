// Recordings, FRFs and scenes as Python holds them.
#include <pybind11/complex.h>
#include <pybind11/eigen.h>
#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <array>

#include "apps/campaign_file/recordings.h"
#include "apps/python/src/call.h"
#include "model/frfs/frf_synthesis.h"
#include "model/scene/parameters.h"
#include "model/scene/read_scene.h"
#include "model/scene/sensor_quantity.h"
#include "signal/recording/recording.h"
#include "signal/recording/recording_time.h"
#include "signal/spectra/frf_set.h"

namespace rigfit::python {
namespace {

template <typename Items>
py::list names_of(const Items& items) {
  py::list names;
  for (const auto& item : items) names.append(item.name);
  return names;
}

/// A view of what `owner` keeps, which cannot be written to.
template <typename T>
py::array view(const py::object& owner, const T* data, std::vector<py::ssize_t> shape,
               std::vector<py::ssize_t> strides) {
  py::array array(py::dtype::of<T>(), std::move(shape), std::move(strides), data, owner);
  array.attr("setflags")(py::arg("write") = false);
  return array;
}

using Shared = std::shared_ptr<signal::Recording>;

/// Samples are views that keep the recording alive.
py::list channels_of(const Shared& recording) {
  using namespace py::literals;
  py::list list;
  for (const auto& channel : recording->channels) {
    list.append(py::dict("name"_a = channel.name, "unit"_a = channel.unit,
                         "source_unit"_a = channel.source_unit,
                         "quantity"_a = signal::name_of(channel.quantity),
                         "direction"_a = py::tuple(py::cast(channel.direction)),
                         "missing_samples"_a = channel.missing_samples,
                         "data"_a = view<double>(py::cast(recording), channel.samples.data(),
                                                 {channel.samples.size()}, {sizeof(double)})));
  }
  return list;
}

py::object notes_of(const signal::Recording& recording) {
  return to_python(describe::json_of(recording.notes));
}

/// A channel in its own unit: a copy of its numbers, in SI.
void add_channel(signal::Recording& recording, const py::dict& given) {
  signal::Channel channel;
  channel.name = given["name"].cast<std::string>();
  if (given.contains("direction")) {
    channel.direction = given["direction"].cast<std::array<double, 3>>();
  }
  signal::take_unit(given["unit"].cast<std::string>(), channel, recording.notes);
  signal::take_samples(given["data"].cast<Eigen::VectorXd>(), channel);
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

using Eigen::Index;
using SharedFrfs = std::shared_ptr<signal::FrfSet>;

/// lines x responses x inputs of a matrix with a column `response * inputs + input`.
template <typename T>
py::object layers(const SharedFrfs& frfs,
                  const Eigen::Matrix<T, Eigen::Dynamic, Eigen::Dynamic>& matrix) {
  if (matrix.size() == 0) return py::none();
  const auto lines = matrix.rows(), inputs = static_cast<Index>(frfs->inputs.size());
  const auto size = static_cast<py::ssize_t>(sizeof(T));
  return view<T>(py::cast(frfs), matrix.data(), {lines, matrix.cols() / inputs, inputs},
                 {size, size * lines * inputs, size * lines});
}

using SharedScene = std::shared_ptr<model::Scene>;

/// The scene that `make` gives, made without the interpreter's lock.
SharedScene made(std::function<model::Scene()> make) {
  auto scene = std::make_shared<model::Scene>();
  run_unlocked([scene, make = std::move(make)] { *scene = make(); });
  return scene;
}

SharedScene with_parameter(const model::Scene& scene, const std::string& name, double value) {
  return made([=, changed = scene]() mutable {
    model::set_parameter(changed, name, value);
    return changed;
  });
}

py::dict parameters_of(const model::Scene& scene) {
  py::dict values;
  for (const auto& name : model::parameter_names(scene)) {
    values[py::str(name)] = model::parameter(scene, name);
  }
  return values;
}

/// H: lines x sensors x loads.
py::tuple frf_of(const SharedScene& scene, const Eigen::VectorXd& lines, const py::dict& options) {
  auto frfs = std::make_shared<model::SynthesizedFrfs>();
  const py::tuple answer = run_work("frf_of", options, [scene, frfs, lines](apps::VerbContext&) {
    *frfs = model::synthesize_frfs(*scene, lines);
    if (frfs->equilibrium.status != model::EquilibriumStatus::converged) {
      throw apps::NotConverged(scene->file + ": " + frfs->equilibrium.reason);
    }
    const auto name = [](const auto& one) { return one.name; };
    const auto unit = [](const model::Sensor& sensor) {
      return "(" + std::string(model::described(sensor.quantity).unit) + ")/N";
    };
    return Json{{"sensors", describe::json_list(scene->sensors, name)},
                {"loads", describe::json_list(scene->loads, name)},
                {"units", describe::json_list(scene->sensors, unit)}};
  });
  return py::tuple(answer + py::make_tuple(py::module_::import("numpy").attr("array")(frfs->H)));
}

}  // namespace

void bind_objects(py::module_& module) {
  py::class_<signal::Recording, Shared>(module, "Recording")
      .def_property_readonly("name", [](const signal::Recording& r) { return r.path.string(); })
      .def_readonly("format", &signal::Recording::format)
      .def_readonly("fs", &signal::Recording::sample_rate_hz)
      .def_readonly("start_time_s", &signal::Recording::start_time_s)
      .def_property_readonly("time_s", [](const signal::Recording& r) { return r.time_s; })
      .def("notes", &notes_of)
      .def("channels", &channels_of);
  module.def("read", &read);
  module.def("from_channels", &from_channels);
  py::class_<signal::FrfSet, SharedFrfs>(module, "FrfSet",
                                         "FRFs of a result; their arrays cannot be written to.")
      .def_property_readonly(
          "frequency_hz",
          [](const SharedFrfs& f) {
            return view<double>(py::cast(f), f->frequency_hz.data(), {f->frequency_hz.size()},
                                {sizeof(double)});
          },
          "Lines, Hz.")
      .def_property_readonly(
          "H", [](const SharedFrfs& f) { return layers(f, f->H); },
          "lines x responses x inputs, SI per N, sign exp(+i 2 pi f t).")
      .def_property_readonly(
          "H_std", [](const SharedFrfs& f) { return layers(f, f->H_std); },
          "Standard deviation of the real and of the imaginary part, each; None: not known.")
      .def_property_readonly(
          "coherence", [](const SharedFrfs& f) { return layers(f, f->coherence); },
          "Layout of H; None: not known.")
      .def_property_readonly(
          "responses", [](const signal::FrfSet& f) { return names_of(f.responses); },
          "Names along the second axis of H.")
      .def_property_readonly(
          "inputs", [](const signal::FrfSet& f) { return names_of(f.inputs); },
          "Names along the third axis of H.")
      .def_property_readonly(
          "form", [](const signal::FrfSet& f) { return name_of(f.form); },
          "\"receptance\", \"mobility\", \"accelerance\" or \"unknown\".")
      .def_property_readonly(
          "unit", [](const signal::FrfSet& f) { return f.unit; }, "Of H.");
  py::class_<model::Scene, SharedScene>(module, "Scene")
      .def_readonly("title", &model::Scene::title)
      .def("text", [](const model::Scene& scene) { return model::scene_text(scene); })
      .def("parameters", &parameters_of)
      .def("with_parameter", &with_parameter)
      .def("nodes", [](const model::Scene& scene) { return names_of(scene.nodes); })
      .def("members", [](const model::Scene& scene) { return names_of(scene.members); })
      .def("loads", [](const model::Scene& scene) { return names_of(scene.loads); })
      .def("sensors", [](const model::Scene& scene) { return names_of(scene.sensors); });
  module.def("parse_scene", [](const std::string& text, const std::string& name) {
    return made([=] { return model::parse_scene(text, name); });
  });
  module.def("read_scene",
             [](const std::string& path) { return made([=] { return model::read_scene(path); }); });
  module.def("frf_of", &frf_of);
}

}  // namespace rigfit::python
