// Python's inspect, resample, decay, frf, modal: what the verbs of these names do with recordings
// and FRFs.
#include "apps/python/src/module.h"

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

#include "apps/cli/verbs/calls.h"
#include "apps/python/src/borrowed_samples.h"
#include "apps/python/src/call.h"
#include "apps/python/src/recording_object.h"
#include "signal/readers/read_frfs.h"
#include "signal/spectra/frf_set.h"

namespace rigfit::python {
namespace {

using Eigen::Index;
using SharedFrfs = std::shared_ptr<signal::FrfSet>;

// Vectors of recordings that borrow grow by moving.
static_assert(std::is_nothrow_move_constructible_v<signal::Recording>);

/// A hammer test whose samples are those of the recordings given.
struct BorrowedRun {
  std::vector<std::shared_ptr<const RecordingObject>> recordings;
  apps::ImpactRun run;

  BorrowedRun() = default;
  BorrowedRun(const BorrowedRun&) = delete;
  BorrowedRun& operator=(const BorrowedRun&) = delete;
  ~BorrowedRun() {
    for (auto& place : run.places) {
      for (auto& recording : place.recordings) give_back(recording);
    }
  }

  void add(const std::string& struck, const RecordingObject& recording) {
    auto place = std::find_if(run.places.begin(), run.places.end(),
                              [&](const auto& known) { return known.name == struck; });
    if (place == run.places.end()) {
      run.places.emplace_back();
      place = std::prev(run.places.end());
      place->name = struck;
    }
    place->recordings.emplace_back();  // grown before anything is borrowed
    place->recordings.back() = borrowed(recording.recording);
  }
};

/// Files are read, recordings at hand borrowed; then the test is analysed.
void analyse(const std::vector<Source>& sources, const apps::ImpactCommand& command,
             apps::VerbContext& context, BorrowedRun& run) {
  signal::ReadOptions reading;
  reading.sample_rate_hz = command.sample_rate_hz;
  for (std::size_t i = 0; i < sources.size(); ++i) {
    std::shared_ptr<const RecordingObject> recording = sources[i].recording;
    if (!recording) {
      auto read = std::make_shared<RecordingObject>();
      read->recording = sources[i].load(context, reading);
      recording = std::move(read);
    } else {
      warn_of_notes(recording->recording, context);
    }
    run.add(command.struck.empty() ? "" : command.struck[i], *recording);
    run.recordings.push_back(std::move(recording));
  }
  apps::run_impact_test(context, command, run.run);
}

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

py::object frfs_or_none(const SharedFrfs& frfs) {
  if (!frfs || frfs->frequency_hz.size() == 0) return py::none();
  return py::cast(frfs);
}

py::tuple frf(const py::list& given, const py::dict& options) {
  struct State {
    std::vector<Source> sources;
    apps::FrfCommand command;
    SharedFrfs frfs = std::make_shared<signal::FrfSet>();
  };
  auto state = std::make_shared<State>();
  state->command = command_of<apps::FrfCommand>(options);
  state->sources = sources_of(given);
  const py::tuple answer = run_verb("frf", options, [state](apps::VerbContext& context) {
    BorrowedRun run;
    analyse(state->sources, state->command.impact, context, run);
    Json result = apps::frf_result(run.run, state->command, context);
    *state->frfs = std::move(run.run.test.frfs);
    return result;
  });
  return py::make_tuple(answer[0], answer[1], answer[2], frfs_or_none(state->frfs));
}

/// Modes of FRFs at hand, of files of FRFs, or (with a force channel) of recordings of hits.
py::tuple modal(const py::object& frfs, const py::list& given, const py::dict& options) {
  struct State {
    std::vector<Source> sources;
    apps::ModalCommand command;
    SharedFrfs frfs;
  };
  auto state = std::make_shared<State>();
  state->command = command_of<apps::ModalCommand>(options);
  state->sources = sources_of(given);
  const bool at_hand = !frfs.is_none();
  if (at_hand) state->frfs = frfs.cast<SharedFrfs>();
  const py::tuple answer = run_verb("modal", options, [state, at_hand](apps::VerbContext& context) {
    apps::MeasuredFrfs measured;
    if (state->command.ambient) {
      for (const Source& source : state->sources) state->command.files.push_back(source.name());
      return apps::ambient_result(state->command, context);
    }
    if (!state->command.impact.force.empty()) {
      BorrowedRun run;
      analyse(state->sources, state->command.impact, context, run);
      measured = apps::measured_frfs(run.run);
    } else if (at_hand) {
      measured = apps::measured_frfs(*state->frfs, state->command, context);
    } else {
      for (const Source& source : state->sources) state->command.files.push_back(source.name());
      measured = apps::measured_frfs(state->command, context);
    }
    Json result{{"modes", Json::array()}};
    if (measured.frfs.frequency_hz.size() > 0) {
      result = apps::modal_result(measured, state->command, context);
    } else {
      result["hits"] = measured.hits;
      result["force_window"] = measured.force_window;
    }
    state->frfs = std::make_shared<signal::FrfSet>(std::move(measured.frfs));
    return result;
  });
  return py::make_tuple(answer[0], answer[1], answer[2], frfs_or_none(state->frfs));
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

SharedFrfs read_frfs(const std::string& path) {
  auto state = std::make_shared<signal::FrfSet>();
  run_unlocked([state, path] { *state = signal::read_frfs({path}, {}); });
  return state;
}

py::tuple inspect(const py::list& given, const py::dict& options) {
  auto sources = std::make_shared<std::vector<Source>>(sources_of(given));
  const double rate = command_of<apps::InspectCommand>(options).sample_rate_hz;
  return run_verb("inspect", options, [sources, rate](apps::VerbContext& context) {
    Json result;
    result["recordings"] = Json::array();
    signal::ReadOptions reading;
    reading.sample_rate_hz = rate;
    for (const Source& source : *sources) {
      result["recordings"].push_back(source.recording
                                         ? apps::inspect_result(source.load(context), context)
                                         : apps::inspect_file(source.name(), rate, context));
    }
    return result;
  });
}

/// document, exit code, Recording
py::tuple resample(const py::list& given, const py::dict& options) {
  auto sources = std::make_shared<std::vector<Source>>(sources_of(given));
  auto command = command_of<apps::ResampleCommand>(options);
  command.file = sources->at(0).name();
  auto even = std::make_shared<RecordingObject>();
  const py::tuple answer =
      run_verb("resample", options, [sources, command, even](apps::VerbContext& context) {
        signal::ReadOptions reading;
        reading.sample_rate_hz = command.sample_rate_hz;
        signal::ResampleResult result;
        Json json =
            apps::resample_result(sources->at(0).load(context, reading), command, context, result);
        even->recording = std::move(result.recording);
        return json;
      });
  return py::make_tuple(answer[0], answer[1], answer[2], even);
}

py::tuple decay(const py::list& given, const py::dict& options) {
  auto sources = std::make_shared<std::vector<Source>>(sources_of(given));
  auto command = command_of<apps::DecayCommand>(options);
  command.file = sources->at(0).name();
  return run_verb("decay", options, [sources, command](apps::VerbContext& context) {
    signal::ReadOptions reading;
    reading.sample_rate_hz = command.sample_rate_hz;
    return apps::decay_result(sources->at(0).load(context, reading), command, context);
  });
}

}  // namespace

void bind_signal(py::module_& module) {
  py::class_<signal::FrfSet, SharedFrfs>(module, "FrfSet",
                                         "FRFs at hand, of `frfs_of_arrays` or `read_frfs`; their "
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
  module.def("inspect", &inspect);
  module.def("decay", &decay);
  module.def("resample", &resample);
  module.def("frf", &frf);
  module.def("modal", &modal);
  module.def("frfs_of_arrays", &frfs_of_arrays);
  module.def("read_frfs", &read_frfs);
}

}  // namespace rigfit::python
