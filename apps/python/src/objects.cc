// Recordings, FRFs and scenes as Python holds them.
#include <pybind11/complex.h>
#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <array>
#include <complex>
#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "apps/campaign_file/recordings.h"
#include "apps/cli/exit_code.h"
#include "apps/python/src/call.h"
#include "model/frfs/frf_synthesis.h"
#include "model/scene/parameters.h"
#include "model/scene/read_scene.h"
#include "model/scene/sensor_quantity.h"
#include "signal/recording/recording.h"
#include "signal/recording/units.h"
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
  py::list list;
  for (const auto& channel : recording->channels) {
    const auto& d = channel.direction;
    py::dict one;
    one["name"] = channel.name;
    one["unit"] = channel.unit;
    one["source_unit"] = channel.source_unit;
    one["quantity"] = signal::name_of(channel.quantity);
    one["direction"] = py::make_tuple(d[0], d[1], d[2]);
    one["missing_samples"] = channel.missing_samples;
    one["data"] = view<double>(py::cast(recording), channel.samples.data(),
                               {channel.samples.size()}, {sizeof(double)});
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

SharedScene parse_scene(const std::string& text, const std::string& name) {
  auto scene = std::make_shared<model::Scene>();
  run_unlocked([scene, text, name] { *scene = model::parse_scene(text, name); });
  return scene;
}

SharedScene read_scene(const std::string& path) {
  auto scene = std::make_shared<model::Scene>();
  run_unlocked([scene, path] { *scene = model::read_scene(path); });
  return scene;
}

SharedScene with_parameter(const model::Scene& scene, const std::string& name, double value) {
  auto changed = std::make_shared<model::Scene>(scene);
  run_unlocked([changed, name, value] { model::set_parameter(*changed, name, value); });
  return changed;
}

py::dict parameters_of(const model::Scene& scene) {
  py::dict values;
  for (const auto& name : model::parameter_names(scene)) {
    values[py::str(name)] = model::parameter(scene, name);
  }
  return values;
}

/// H: lines x sensors x loads.
py::tuple frf_of(const SharedScene& scene, const py::array_t<double, py::array::c_style>& lines,
                 const py::dict& options) {
  struct State {
    Eigen::VectorXd frequency_hz;
    model::ModesOptions modes;
    double decay_rate_1_s = 0;
    model::SynthesizedFrfs frfs;
  };
  auto state = std::make_shared<State>();
  state->frequency_hz = Eigen::Map<const Eigen::VectorXd>(lines.data(), lines.size());
  if (options.contains("segments")) state->modes.segments = options["segments"].cast<int>();
  if (options.contains("exponential_window")) {
    state->decay_rate_1_s = options["exponential_window"].cast<double>();
  }
  const py::tuple answer = run_work("frf_of", options, [scene, state](apps::VerbContext&) {
    state->frfs =
        model::synthesize_frfs(*scene, state->frequency_hz, state->modes, state->decay_rate_1_s);
    if (state->frfs.equilibrium.status != model::EquilibriumStatus::converged) {
      throw apps::NotConverged(scene->file + ": " + state->frfs.equilibrium.reason);
    }
    Json units = Json::array(), sensors = Json::array(), loads = Json::array();
    for (const auto& sensor : scene->sensors) {
      sensors.push_back(sensor.name);
      units.push_back("(" + std::string(model::described(sensor.quantity).unit) + ")/N");
    }
    for (const auto& load : scene->loads) loads.push_back(load.name);
    return Json{{"sensors", std::move(sensors)}, {"loads", std::move(loads)}, {"units", units}};
  });
  const auto sensors = static_cast<py::ssize_t>(scene->sensors.size());
  const auto loads = static_cast<py::ssize_t>(scene->loads.size());
  py::array_t<std::complex<double>> H({lines.size(), sensors, loads});
  auto values = H.mutable_unchecked<3>();
  for (py::ssize_t k = 0; k < lines.size(); ++k) {
    for (py::ssize_t s = 0; s < sensors; ++s) {
      for (py::ssize_t l = 0; l < loads; ++l) {
        values(k, s, l) = state->frfs.H[static_cast<std::size_t>(k)](s, l);
      }
    }
  }
  return py::make_tuple(answer[0], answer[1], answer[2], H);
}
}  // namespace

void bind_objects(py::module_& module) {
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
      .def_readonly("file", &model::Scene::file)
      .def_readonly("accuracy", &model::Scene::accuracy)
      .def("text", [](const model::Scene& scene) { return model::scene_text(scene); })
      .def("parameters", &parameters_of)
      .def("with_parameter", &with_parameter)
      .def("nodes", [](const model::Scene& scene) { return names_of(scene.nodes); })
      .def("members", [](const model::Scene& scene) { return names_of(scene.members); })
      .def("loads", [](const model::Scene& scene) { return names_of(scene.loads); })
      .def("sensors", [](const model::Scene& scene) { return names_of(scene.sensors); });
  module.def("parse_scene", &parse_scene);
  module.def("read_scene", &read_scene);
  module.def("frf_of", &frf_of);
}

}  // namespace rigfit::python
