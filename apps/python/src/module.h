// Functions of the module by subject.
#pragma once

#include <pybind11/pybind11.h>

namespace rigfit::python {

/// inspect, decay, frf, modal, and the arrays of FRFs.
void bind_signal(pybind11::module_& module);
/// bending, axial, tension.
void bind_laboratory(pybind11::module_& module);
/// Scene, modes, frf_of, respond, update, predict, synthesize, report.
void bind_model(pybind11::module_& module);

}  // namespace rigfit::python
