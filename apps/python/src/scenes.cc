// Scenes as Python holds them, and their FRFs.
#include <pybind11/complex.h>
#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <complex>
#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "apps/cli/exit_code.h"
#include "apps/python/src/call.h"
#include "model/frfs/frf_synthesis.h"
#include "model/scene/parameters.h"
#include "model/scene/read_scene.h"
#include "model/scene/sensor_quantity.h"

namespace rigfit::python {
namespace {

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

template <typename Items>
py::list names_of(const Items& items) {
  py::list names;
  for (const auto& item : items) names.append(item.name);
  return names;
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

void bind_scenes(py::module_& module) {
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
