// The module rigfit._core: what the package's Python files call. Its functions take arguments that
// these have checked.
#include <glog/logging.h>
#include <pybind11/eigen.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include "apps/campaign_file/recordings.h"
#include "apps/python/src/call.h"

namespace rigfit::python {
namespace {

/// Runs the verb of that name: its document {rigfit, command, inputs, warnings, ...}, its exit
/// code, what the program prints, and a dict of results that no document carries (`frfs`,
/// `recording`, `samples`, `covariance`, `scenes`). `given`: what the Python layer has checked, by
/// names of options with _ for -; `inputs`, where not None, is the option that stands first, by its
/// place. Recordings, scenes and FRFs stand where the program takes files.
py::tuple run(const std::string& verb, const py::dict& given, const py::object& inputs) {
  struct State {
    apps::Verb verb;
    apps::AtHand objects;
  };
  auto state = std::make_shared<State>();
  for (auto& one : apps::all_verbs()) {
    if (one.name == verb) state->verb = std::move(one);
  }
  // A file's name, or the key of an object that stands in its place.
  const auto name_of = [&](const py::handle& one) -> py::object {
    const std::string key =
        "<" + std::to_string(state->objects.recordings.size() + state->objects.scenes.size()) + ">";
    if (py::isinstance<signal::Recording>(one)) {
      state->objects.recordings[key] = one.cast<std::shared_ptr<signal::Recording>>();
      return py::str(key);
    }
    if (py::isinstance<model::Scene>(one)) {
      state->objects.scenes[key] = one.cast<std::shared_ptr<model::Scene>>();
      return py::str(key);
    }
    return py::reinterpret_borrow<py::object>(one);
  };
  py::dict values;
  for (const auto& [key, value] : given) values[key] = value;
  const std::string key = key_of(state->verb.options.front().name);
  if (py::isinstance<signal::FrfSet>(inputs)) {
    state->objects.frfs = inputs.cast<std::shared_ptr<signal::FrfSet>>();
    values[key.c_str()] = "<FRFs>";
  } else if (!inputs.is_none()) {
    if (py::isinstance<py::list>(inputs)) {
      py::list names;
      for (const py::handle one : inputs) names.append(name_of(one));
      values[key.c_str()] = names;
    } else {
      values[key.c_str()] = name_of(inputs);
    }
  }
  take(state->verb.options, values);
  const py::tuple answer = run_work(verb.c_str(), given, [state](apps::VerbContext& context) {
    context.at_hand = &state->objects;
    return state->verb.run(context);
  });
  auto& objects = state->objects;
  py::dict more;
  if (verb == "frf" || verb == "modal") {
    const bool any = objects.frfs && objects.frfs->frequency_hz.size() > 0;
    more["frfs"] = any ? py::cast(objects.frfs) : py::object(py::none());
  }
  if (objects.resampled) more["recording"] = py::cast(objects.resampled);
  if (objects.samples.size() > 0) more["samples"] = py::cast(std::move(objects.samples));
  if (verb == "update") {
    more["covariance"] = py::cast(std::move(objects.covariance));
    py::list scenes;
    for (const auto& scene : objects.fitted_scenes) {
      scenes.append(std::make_shared<model::Scene>(scene));
    }
    more["scenes"] = std::move(scenes);
  }
  return py::make_tuple(answer[0], answer[1], answer[2], more);
}

}  // namespace
}  // namespace rigfit::python

PYBIND11_MODULE(_core, module) {
  // Ceres logs why it gave up even when told to be silent: how a fit ended is in its result.
  FLAGS_minloglevel = google::FATAL;
  module.attr("version") = RIGFIT_VERSION;
  module.def("run", &rigfit::python::run);
  module.def("options", &rigfit::python::described_options);
  module.def("schema", &rigfit::python::result_schema);
  module.def("abandoned_calls", &rigfit::python::abandoned_calls);
  rigfit::python::bind_objects(module);
}
