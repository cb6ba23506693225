// One call from Python into the libraries: arguments taken with the interpreter's lock, the work
// done without it, the answer and what went wrong given back with it.
//
// The work runs on a thread of its own, so that Ctrl-C in the main thread ends the call at once.
// Work that shows its progress (apps/cli/progress.h) stops then; other work goes on with what it
// owns until it is done or the interpreter ends.
#pragma once

#include <pybind11/pybind11.h>

#include "apps/cli/verb.h"

namespace rigfit::python {

namespace py = pybind11;
using apps::Json;

[[nodiscard]] py::object to_python(const Json& value);

/// Runs `work` without the interpreter's lock and raises what it throws as a rigfit.Error. `work`
/// owns all that it uses; what it owns of Python is released with the lock held.
void run_unlocked(std::function<void()> work);

/// A document {rigfit, command, inputs, warnings, ...} of that name with what `work` gives, the
/// exit code, and what is printed. `given` has the options of every verb and those of reading.
[[nodiscard]] py::tuple run_work(const std::string& name, const py::dict& given,
                                 std::function<Json(apps::VerbContext&)> work);

void bind_objects(py::module_& module);  ///< Recording, FrfSet, Scene and what makes them

}  // namespace rigfit::python
