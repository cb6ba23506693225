// rigfit: one program, one verb a task. Parses the command line, runs the verb, writes its
// document.
#include <fmt/format.h>
#include <glog/logging.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <csignal>
#include <exception>
#include <fstream>
#include <iostream>
#include <streambuf>
#include <thread>

#include "apps/cli/exit_code.h"
#include "apps/cli/json_document.h"
#include "apps/cli/plot_option.h"
#include "apps/cli/verb.h"

namespace rigfit::apps {
namespace {

struct CommonOptions {
  std::string json;
  bool quiet = false;
  int threads = std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
  std::uint64_t seed = 1;
};

void add_common(CLI::App& verb, CommonOptions& common) {
  verb.add_option("--json", common.json, "Write the result as JSON to F; '-' is standard output")
      ->type_name("F")
      ->group("Common");
  verb.add_flag("--quiet", common.quiet, "Say nothing but errors")->group("Common");
  verb.add_option("--threads", common.threads,
                  "Threads to use (all processors); the numbers do not depend on it")
      ->check(CLI::Range(1, 1024))
      ->group("Common");
  verb.add_option("--seed", common.seed, "Seed of every random number")
      ->capture_default_str()
      ->group("Common");
}

class NullBuffer : public std::streambuf {
  int overflow(int c) override { return c; }
};

int run(int argc, char** argv) {
  CLI::App program{
      "Test-rig recordings to identified parameters, a segment model and a report of model against "
      "test.",
      "rigfit"};
  program.set_version_flag("--version", RIGFIT_VERSION);
  program.require_subcommand(1);
  program.option_defaults()->always_capture_default(false);

  Verbs verbs;
  add_all_verbs(program, verbs);
  CommonOptions common;
  PlotCommand plots;
  for (auto& verb : verbs) {
    add_common(*verb.app, common);
    if (verb.draws) add_plot_option(*verb.app, plots);
  }

  try {
    program.parse(argc, argv);
  } catch (const CLI::CallForHelp& help) {
    return program.exit(help);
  } catch (const CLI::CallForVersion& version) {
    return program.exit(version);
  } catch (const CLI::ParseError& error) {
    program.exit(error);
    return static_cast<int>(ExitCode::wrong_usage);
  }

  const auto chosen =
      std::find_if(verbs.begin(), verbs.end(), [](const Verb& verb) { return verb.app->parsed(); });
  NullBuffer nothing;
  std::ostream sink(&nothing);
  VerbContext context(common.quiet || common.json == "-" ? sink : std::cout);
  context.quiet = common.quiet;
  context.threads = common.threads;
  context.seed = common.seed;
  context.command.assign(argv, argv + argc);

  prepare_plots(context, plots);
  Json result = chosen->run(context);
  write_plots(context, plots, chosen->app->get_name());
  const Json document = json_document(context, chosen->app->get_name(), std::move(result));
  if (common.json == "-") {
    std::cout << document.dump(2, ' ', false, Json::error_handler_t::replace) << '\n';
  } else if (!common.json.empty()) {
    context.write(common.json, document.dump(2, ' ', false, Json::error_handler_t::replace) + "\n");
  }
  if (!std::cout.flush()) {
    throw std::runtime_error("cannot write to standard output (a full disk, a closed pipe?)");
  }
  return static_cast<int>(context.exit_code);
}

/// Recordings are read through the memory map of their file: one that is cut short meanwhile, or
/// whose disk fails, ends here instead of in a crash.
extern "C" void input_vanished(int) {
  constexpr char kMessage[] =
      "error: an input was cut short while it was being read; run again when nothing writes to "
      "it\n";
  static_cast<void>(!::write(STDERR_FILENO, kMessage, sizeof kMessage - 1));
  ::_exit(static_cast<int>(ExitCode::bad_input));
}

}  // namespace
}  // namespace rigfit::apps

int main(int argc, char** argv) {
  using rigfit::apps::ExitCode;
  std::signal(SIGBUS, rigfit::apps::input_vanished);
  // Ceres logs why it gave up even when told to be silent: how a fit ended is in its result.
  FLAGS_minloglevel = google::FATAL;
  try {
    return rigfit::apps::run(argc, argv);
  } catch (const std::bad_alloc&) {
    std::cerr << "error: not enough memory\n";
    return static_cast<int>(ExitCode::fault);
  } catch (const std::exception& error) {
    std::cerr << "error: " << error.what() << '\n';
    return static_cast<int>(rigfit::apps::exit_code_of(error));
  }
}
