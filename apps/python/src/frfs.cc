// FRFs as Python holds them.
#include <pybind11/complex.h>
#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <complex>
#include <iterator>
#include <memory>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "apps/python/src/call.h"
#include "signal/spectra/frf_set.h"

namespace rigfit::python {
namespace {

using Eigen::Index;
using SharedFrfs = std::shared_ptr<signal::FrfSet>;

/// A view of what `owner` keeps.
template <typename T>
py::array view(const py::object& owner, const T* data, std::vector<py::ssize_t> shape,
               std::vector<py::ssize_t> strides) {
  py::array array(py::dtype::of<T>(), std::move(shape), std::move(strides), data, owner);
  array.attr("setflags")(py::arg("write") = false);
  return array;
}

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

py::list names_of(const std::vector<signal::MeasuredPoint>& points) {
  py::list names;
  for (const auto& point : points) names.append(point.name);
  return names;
}

/// FRFs of another program: H lines x responses x inputs, SI per N.
SharedFrfs frfs_of_arrays(const py::array_t<double, py::array::c_style>& frequency_hz,
                          const py::array_t<std::complex<double>, py::array::c_style>& H,
                          const py::object& coherence, const py::dict& options) {
  auto frfs = std::make_shared<signal::FrfSet>();
  frfs->frequency_hz = Eigen::Map<const Eigen::VectorXd>(frequency_hz.data(), frequency_hz.size());
  const Index lines = H.shape(0), columns = H.shape(1) * H.shape(2);
  using RowMajor =
      Eigen::Matrix<std::complex<double>, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  frfs->H = Eigen::Map<const RowMajor>(H.data(), lines, columns);
  if (!coherence.is_none()) {
    const auto given = coherence.cast<py::array_t<double, py::array::c_style>>();
    using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
    frfs->coherence = Eigen::Map<const Rows>(given.data(), lines, columns);
  }
  const auto responses = options["responses"].cast<std::vector<std::string>>();
  const auto inputs = options["inputs"].cast<std::vector<std::string>>();
  const auto points = [](const std::vector<std::string>& names) {
    std::vector<signal::MeasuredPoint> list;
    list.reserve(names.size());
    for (const auto& name : names) list.push_back({name, static_cast<int>(list.size()) + 1, 0});
    return list;
  };
  frfs->responses = points(responses);
  frfs->inputs = points(inputs);
  const auto form = options["form"].cast<std::string>();
  frfs->form = form == "receptance"    ? signal::FrfForm::receptance
               : form == "mobility"    ? signal::FrfForm::mobility
               : form == "accelerance" ? signal::FrfForm::accelerance
                                       : signal::FrfForm::unknown;
  frfs->unit = unit_of(frfs->form);
  frfs->averages = options["averages"].cast<int>();
  frfs->exponential_decay_rate_1_s = options["exponential_window"].cast<double>();
  return frfs;
}

}  // namespace

void bind_frfs(py::module_& module) {
  py::class_<signal::FrfSet, SharedFrfs>(module, "FrfSet",
                                         "FRFs at hand, of `frfs_of_arrays` or a result; their "
                                         "arrays cannot be written to.")
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
  module.def("frfs_of_arrays", &frfs_of_arrays);
}

}  // namespace rigfit::python
