// The module rigfit._core: what the package's Python files call. Its functions take arguments that
// these have checked.
#include <glog/logging.h>
#include <pybind11/pybind11.h>

#include "apps/python/src/call.h"
#include "apps/python/src/module.h"
#include "apps/python/src/recording_object.h"

PYBIND11_MODULE(_core, module) {
  // Ceres logs why it gave up even when told to be silent: how a fit ended is in its result.
  FLAGS_minloglevel = google::FATAL;
  module.attr("version") = RIGFIT_VERSION;
  module.def("options", &rigfit::python::described_options);
  module.def("abandoned_calls", &rigfit::python::abandoned_calls);
  rigfit::python::bind_recordings(module);
  rigfit::python::bind_signal(module);
  rigfit::python::bind_laboratory(module);
  rigfit::python::bind_model(module);
}
