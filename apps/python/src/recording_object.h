// Recordings as Python holds them.
#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "apps/cli/verb_context.h"
#include "signal/readers/files/read_options.h"
#include "signal/recording/recording.h"

namespace rigfit::python {

namespace py = pybind11;

/// A recording that was read, or one whose samples are NumPy arrays. Never changed once made.
class RecordingObject {
 public:
  RecordingObject() = default;
  RecordingObject(const RecordingObject&) = delete;
  RecordingObject& operator=(const RecordingObject&) = delete;
  ~RecordingObject();

  signal::Recording recording;
  /// Keeps `array` (one dimension, contiguous, doubles) and uses its memory; copies what is not
  /// aligned.
  void set_samples(std::size_t channel, const py::array_t<double>& array);

 private:
  std::vector<bool> borrowed_;
  std::vector<py::object> owners_;
};

void bind_recordings(py::module_& module);

}  // namespace rigfit::python
