// One call from Python into the libraries: arguments taken with the interpreter's lock, the work
// done without it, the answer and what went wrong given back with it.
//
// From the main thread the work runs on a thread of its own, so that Ctrl-C ends the call at once.
// Work that shows its progress (apps/cli/progress.h) stops then; other work goes on with what it
// owns until it is done or the interpreter ends.
#pragma once

#include <pybind11/pybind11.h>

#include <functional>
#include <memory>
#include <ostream>
#include <streambuf>
#include <string>

#include "apps/cli/verb.h"
#include "apps/cli/verb_context.h"

namespace rigfit::python {

namespace py = pybind11;
using apps::Json;

[[nodiscard]] py::object to_python(const Json& value);

/// Named arguments as the Python layer has checked them; None and what is not there keep the
/// default.
class Options {
 public:
  explicit Options(py::dict values) : values_(std::move(values)) {}

  template <typename T>
  void take(const char* name, T& field) const {
    if (!values_.contains(name)) return;
    const py::object value = values_[name];
    if (!value.is_none()) field = py::cast<T>(value);
  }
  [[nodiscard]] bool has(const char* name) const {
    return values_.contains(name) && !py::object(values_[name]).is_none();
  }

 private:
  py::dict values_;
};

/// What a call works in: a verb's context that is silent.
class CallContext {
 public:
  explicit CallContext(const Options& options);
  apps::VerbContext& verb() { return context_; }

 private:
  class Nothing : public std::streambuf {
    int overflow(int c) override { return c; }
  };
  Nothing nothing_;
  std::ostream out_;
  apps::VerbContext context_;
};

/// Runs `work` without the interpreter's lock and raises what it throws as a rigfit.Error. `work`
/// owns all that it uses; what it owns of Python is released with the lock held.
void run_unlocked(std::function<void()> work);

/// The verb's document and its exit code: {rigfit, command, inputs, warnings, ...}, int. `work` is
/// run unlocked.
[[nodiscard]] py::tuple run_verb(const char* name, const Options& options,
                                 std::function<Json(apps::VerbContext&)> work);

/// Calls that were interrupted and still work.
[[nodiscard]] int abandoned_calls();

}  // namespace rigfit::python
