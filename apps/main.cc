// rigfit: one program, one verb a task. Parses the command line, runs the verb, writes its
// document.
#include <glog/logging.h>
#include <malloc.h>
#include <unistd.h>

#include <csignal>
#include <exception>
#include <iostream>
#include <sstream>

#include "apps/cli/plots/plot_option.h"
#include "apps/cli/progress.h"
#include "apps/cli/verb.h"

namespace rigfit::apps {
namespace {

int run(int argc, char** argv) {
  Verbs verbs = all_verbs();
  std::ostringstream printed;
  VerbContext context(printed);
  SharedOptions shared;
  for (auto& verb : verbs) {
    const auto more = shared.options(context, verb.reads, verb.draws);
    verb.options.insert(verb.options.end(), more.begin(), more.end());
  }

  std::vector<std::string> arguments(argv + 1, argv + argc);
  if (arguments.empty()) {
    help(verbs, {}, std::cerr);
    return static_cast<int>(ExitCode::wrong_usage);
  }
  const auto asks = [](const std::string& text) { return text == "--help" || text == "-h"; };
  const std::string word = arguments.front();
  arguments.erase(arguments.begin());
  if (word == "--version") {
    std::cout << RIGFIT_VERSION << '\n';
    return 0;
  }
  if (word == "help" || asks(word)) {
    help(verbs, arguments, std::cout);
    return 0;
  }
  const Verb& verb = verb_named(verbs, word);
  if (std::any_of(arguments.begin(), arguments.end(), asks)) {
    help(verbs, {verb.name}, std::cout);
    return 0;
  }
  parse_options(verb, arguments);

  context.command.assign(argv, argv + argc);

  prepare_plots(context, shared.plot);
  std::optional<Progress> progress(std::in_place, verb.name, 1, context.quiet);
  Json result = Json::object();
  const auto print = [&] {
    progress.reset();
    if (!context.quiet && shared.json != "-") std::cout << printed.str();
    printed.str("");
  };
  try {
    result = verb.run(context);
  } catch (const Refused& error) {
    context.refuse(error.code, error.what());
  } catch (const NotConverged& error) {
    context.fail(error.what());
  } catch (...) {
    print();
    throw;
  }
  print();
  write_plots(context, shared.plot, verb.name);
  print();
  const Json document = context.document(verb.name, result);
  if (shared.json == "-") {
    std::cout << document.dump(2, ' ', false, Json::error_handler_t::replace) << '\n';
  } else if (!shared.json.empty()) {
    context.write(shared.json, document.dump(2, ' ', false, Json::error_handler_t::replace) + "\n");
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
  // Matrices come and go. Returned to the system each time, as is usual, their pages cost a sixth
  // of an update of the published rig (`perf record rigfit update`: asm_exc_page_fault and below).
  // 32 MiB is the most that glibc takes.
  mallopt(M_MMAP_THRESHOLD, 32 << 20);
  mallopt(M_TRIM_THRESHOLD, 256 << 20);
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
