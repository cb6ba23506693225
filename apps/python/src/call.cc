// The module rigfit._core: what the package's Python files call. Its functions take arguments that
// these have checked.
#include "apps/python/src/call.h"

#include <glog/logging.h>
#include <pybind11/eigen.h>
#include <pybind11/stl.h>

#include <atomic>
#include <chrono>
#include <exception>
#include <future>
#include <new>
#include <sstream>
#include <thread>

#include "apps/campaign_file/recordings.h"
#include "apps/cli/plots/plot_option.h"
#include "apps/cli/progress.h"
#include "apps/cli/verb.h"
#include "document/document_error.h"
#include "signal/recording/recording.h"

namespace rigfit::python {
namespace {

std::atomic<int> abandoned{0};

[[noreturn]] void raise(const char* kind, const std::string& message, const py::dict& fields) {
  const py::object type = py::module_::import("rigfit.errors").attr(kind);
  const py::object error = type(message, **fields);
  PyErr_SetObject(type.ptr(), error.ptr());
  throw py::error_already_set();
}

[[noreturn]] void raise_as_python(const std::exception_ptr& thrown) {
  using namespace py::literals;
  try {
    std::rethrow_exception(thrown);
  } catch (py::error_already_set&) {
    throw;
  } catch (const std::bad_alloc&) {
    PyErr_NoMemory();
    throw py::error_already_set();
  } catch (const std::exception& error) {
    constexpr const char* kKinds[] = {"",           "InternalError", "UsageError",
                                      "InputError", "Refused",       "NotConverged"};
    py::dict fields;
    const auto place = [&](const auto& input) {
      const auto& where = input.where();
      fields = py::dict("file"_a = where.file, "line"_a = where.line, "column"_a = where.column,
                        "problem"_a = input.problem(), "remedy"_a = input.remedy());
    };
    if (const auto* recording = dynamic_cast<const signal::RecordingError*>(&error)) {
      place(*recording);
      fields["channel"] = recording->where().channel, fields["value"] = recording->where().value;
    } else if (const auto* document = dynamic_cast<const document::DocumentError*>(&error)) {
      place(*document);
      fields["key"] = document->where().key;
    } else if (const auto* refused = dynamic_cast<const apps::Refused*>(&error)) {
      fields["code"] = refused->code;
    }
    raise(kKinds[static_cast<int>(apps::exit_code_of(error))], error.what(), fields);
  }
}

/// "mass_per_length" of "--mass-per-length".
std::string key_of(const std::string& option) {
  std::string key = option.starts_with("--") ? option.substr(2) : option;
  std::replace(key.begin(), key.end(), '-', '_');
  return key;
}

/// Values by such names into these options.
void take(describe::Options options, const py::dict& given) {
  using namespace py::literals;
  // The signature says what a call needs: files that come back as arrays are not written.
  for (auto& option : options) option.is_required = false;
  const auto text = py::module_::import("json").attr("dumps")(given).cast<std::string>();
  const Json values = Json::parse(text);
  Json named = Json::object();
  for (const auto& option : options) {
    if (const auto key = key_of(option.name); values.contains(key))
      named[option.name] = values[key];
  }
  const auto misfit = [&] {
    try {
      return describe::fill(options, named);
    } catch (...) {
      raise_as_python(std::current_exception());
    }
  }();
  if (misfit) {
    const std::string key = key_of(misfit->name);
    raise("ArgumentError", key + ": " + misfit->problem,
          py::dict("argument"_a = key, "problem"_a = misfit->problem));
  }
}

/// Work on a thread of its own. It may own objects of Python: destroyed with the lock held.
struct Job {
  std::function<void()> work;
  std::promise<void> done;
  std::atomic<bool> stop{false};
};

}  // namespace

py::object to_python(const Json& value) {
  const std::string text = value.dump(-1, ' ', false, Json::error_handler_t::replace);
  return py::module_::import("json").attr("loads")(text);
}

void run_unlocked(std::function<void()> work) {
  auto job = std::make_shared<Job>();
  job->work = std::move(work);
  std::future<void> done = job->done.get_future();
  // Whoever comes second, the end of the work or an interruption, knows of the other.
  auto parted = std::make_shared<std::atomic<bool>>(false);
  std::thread worker([job, parted]() mutable {
    apps::Progress::stops_by(&job->stop);
    try {
      job->work();
      job->done.set_value();
    } catch (...) {
      job->done.set_exception(std::current_exception());
    }
    if (!parted->exchange(true)) return;  // the caller joins, then releases the job
    {
      const py::gil_scoped_acquire locked;
      job.reset();
    }
    --abandoned;
  });
  for (bool ready = false; !ready;) {
    {
      const py::gil_scoped_release unlocked;
      ready = done.wait_for(std::chrono::milliseconds(50)) == std::future_status::ready;
    }
    if (ready || PyErr_CheckSignals() == 0) continue;
    ++abandoned;
    job->stop = true;
    if (parted->exchange(true)) {
      --abandoned;  // it has just ended
      worker.join();
    } else {
      worker.detach();
    }
    throw py::error_already_set();
  }
  worker.join();
  try {
    done.get();
  } catch (...) {
    raise_as_python(std::current_exception());
  }
}

py::tuple run_work(const std::string& name, const py::dict& given,
                   std::function<Json(apps::VerbContext&)> work) {
  struct State {
    std::ostringstream out;
    apps::VerbContext context{out};
    Json document;
    apps::SharedOptions shared;
  };
  auto state = std::make_shared<State>();
  auto& context = state->context;
  take(state->shared.options(context, true, true), given);
  context.quiet = true;  // no progress: what is printed is kept all the same
  context.silent = true;
  context.command = {"rigfit", name, "(from Python)"};
  run_unlocked([state, name, work = std::move(work)] {
    prepare_plots(state->context, state->shared.plot);
    const Json result = work(state->context);
    write_plots(state->context, state->shared.plot, name);
    state->document = state->context.document(name, result);
  });
  return py::make_tuple(to_python(state->document), static_cast<int>(context.exit_code),
                        state->out.str());
}

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
  state->verb = apps::verb_named(apps::all_verbs(), verb);
  // A file's name, or the key of an object that stands in its place.
  const auto name_of = [&](const py::handle& one) -> py::object {
    const std::string key =
        "<" + std::to_string(state->objects.recordings.size() + state->objects.scenes.size()) + ">";
    if (py::isinstance<signal::Recording>(one)) {
      state->objects.recordings[key] = one.cast<std::shared_ptr<signal::Recording>>();
    } else if (py::isinstance<model::Scene>(one)) {
      state->objects.scenes[key] = one.cast<std::shared_ptr<model::Scene>>();
    } else {
      return py::reinterpret_borrow<py::object>(one);
    }
    return py::str(key);
  };
  py::dict values = given.attr("copy")();
  const std::string key = key_of(state->verb.options.front().name);
  if (py::isinstance<signal::FrfSet>(inputs)) {
    state->objects.frfs = inputs.cast<std::shared_ptr<signal::FrfSet>>();
    values[key.c_str()] = "<FRFs>";
  } else if (py::isinstance<py::list>(inputs)) {
    py::list names;
    for (const py::handle one : inputs) names.append(name_of(one));
    values[key.c_str()] = names;
  } else if (!inputs.is_none()) {
    values[key.c_str()] = name_of(inputs);
  }
  take(state->verb.options, values);
  const py::tuple answer = run_work(verb, given, [state](apps::VerbContext& context) {
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

/// What the Python layer makes arguments, checks and docstrings of: each option of a verb.
py::list described_options(const std::string& verb) {
  using namespace py::literals;
  std::ostringstream none;
  apps::VerbContext context(none);
  apps::SharedOptions shared;
  const apps::Verbs verbs = apps::all_verbs();
  describe::Options options;
  const auto add = [&](const describe::Options& more) {
    options.insert(options.end(), more.begin(), more.end());
  };
  if (verb == "read") add(apps::options_of(context.reading));
  for (const auto& one : verbs) {
    if (one.name == verb) add(one.options), add(shared.options(context, one.reads, one.draws));
  }
  if (options.empty()) add(shared.options(context, false, false));
  py::list list;
  for (const auto& o : options) {
    list.append(py::dict("name"_a = o.name, "kind"_a = describe::name_of(o.kind),
                         "text"_a = o.text(), "lowest"_a = o.lowest, "highest"_a = o.highest,
                         "words"_a = o.words, "numbers"_a = o.numbers, "required"_a = o.is_required,
                         "written"_a = o.is_written, "default"_a = o.default_text()));
  }
  return list;
}

/// The JSON schema of a verb's result.
py::object result_schema(const std::string& verb) {
  return to_python(apps::verb_named(apps::all_verbs(), verb).schema());
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
  module.def("abandoned_calls", [] { return rigfit::python::abandoned.load(); });
  rigfit::python::bind_objects(module);
}
