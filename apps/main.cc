// rigfit: one program, one verb a task. Parses the command line, runs the verb, writes its
// document.
#include <fmt/format.h>
#include <glog/logging.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <map>
#include <optional>
#include <string_view>
#include <system_error>
#include <thread>

#include "apps/cli/command_line.h"
#include "apps/cli/common_options.h"
#include "apps/cli/exit_code.h"
#include "apps/cli/json_document.h"
#include "apps/cli/plots/plot_option.h"
#include "apps/cli/progress.h"
#include "apps/cli/terminal.h"
#include "apps/cli/usage.h"
#include "apps/cli/verb.h"
#include "signal/recording/recording_error.h"

namespace rigfit::apps {
namespace {

/// Refuses two outputs that are one file. Devices and pipes may take several.
void check_outputs(const std::vector<std::string>& arguments) {
  std::map<std::filesystem::path, std::string> taken;
  for (std::size_t k = 0; k < arguments.size(); ++k) {
    for (const std::string name : {"--json", "--out", "--csv", "--plot"}) {
      const std::string& text = arguments[k];
      std::string file;
      if (text.starts_with(name + "=")) file = text.substr(name.size() + 1);
      if (text == name && k + 1 < arguments.size()) file = arguments[k + 1];
      std::error_code none;
      const auto kind = std::filesystem::status(file, none).type();
      const bool fresh = kind == std::filesystem::file_type::not_found;
      if (file.empty() || file == "-" || !(fresh || kind == std::filesystem::file_type::regular)) {
        continue;
      }
      const auto path = std::filesystem::weakly_canonical(std::filesystem::absolute(file), none);
      if (const auto [at, is_new] = taken.emplace(path, name); !is_new) {
        throw UsageError(at->second + " and " + name + " name one file, " + file +
                         "; give each its own");
      }
    }
  }
}

/// Standard input, which "-" names among the files, as a file; removed with the object.
class StandardInput {
 public:
  StandardInput() = default;
  ~StandardInput() {
    std::error_code ignored;
    if (!folder_.empty()) std::filesystem::remove_all(folder_, ignored);
  }
  StandardInput(const StandardInput&) = delete;
  StandardInput& operator=(const StandardInput&) = delete;

  /// Puts the file in place of "-", where this is no option's value.
  void replace(std::vector<std::string>& arguments) {
    for (std::size_t k = 0; k < arguments.size(); ++k) {
      if (arguments[k] != "-" || (k > 0 && arguments[k - 1].starts_with("--"))) continue;
      if (!folder_.empty()) throw UsageError("standard input (-) can be read once only");
      std::string name = (std::filesystem::temp_directory_path() / "rigfit-XXXXXX").string();
      if (::mkdtemp(name.data()) == nullptr)
        throw std::runtime_error("cannot make a folder in " + name);
      folder_ = name;
      struct stat input {};
      if (::fstat(STDIN_FILENO, &input) == 0 && S_ISCHR(input.st_mode) && !::isatty(STDIN_FILENO) &&
          std::cin.peek() != std::char_traits<char>::eof()) {
        throw signal::RecordingError({.file = "standard input"}, "is a device without an end",
                                     "give a file or a pipe");
      }
      const auto file = folder_ / "standard-input";
      std::ofstream out(file, std::ios::binary);
      if (std::cin.peek() != std::char_traits<char>::eof()) out << std::cin.rdbuf();
      if (!out.flush()) throw std::runtime_error("cannot write " + file.string());
      arguments[k] = file.string();
    }
  }

 private:
  std::filesystem::path folder_;
};

int run(int argc, char** argv) {
  Verbs verbs = all_verbs();
  CommonOptions common;
  PlotCommand plots;
  ReadingOptions reading;
  for (auto& verb : verbs) {
    const auto add = [&](const describe::Options& more) {
      verb.options.insert(verb.options.end(), more.begin(), more.end());
    };
    if (verb.reads) add(options_of(reading));
    add(options_of(common));
    if (verb.draws) add(options_of(plots));
  }

  std::vector<std::string> arguments(argv + 1, argv + argc);
  if (arguments.empty()) {
    std::cerr << program_help(verbs, text_width());
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
    std::cout << verb_help(verb, text_width());
    return 0;
  }
  StandardInput standard_input;
  standard_input.replace(arguments);
  parse_options(verb, arguments);

  check_outputs(arguments);
  std::ostream sink(nullptr);  // discards
  ResultBuffer result_buffer(std::cout.rdbuf());
  std::ostream results(&result_buffer);
  VerbContext context(common.quiet || common.json == "-" ? sink : results);
  context.quiet = common.quiet;
  context.verbose = common.verbose;
  context.threads = common.threads;
  context.seed = common.seed;
  context.reading = read_options(reading);
  context.command.assign(argv, argv + argc);

  prepare_plots(context, plots);
  std::optional<ProgressClock> clock(std::in_place, verb.name, context.quiet);
  Json result = Json::object();
  try {
    result = verb.run(context);
  } catch (const Refused& error) {
    context.refuse(error.code(), error.what());
  } catch (const NotConverged& error) {
    context.fail(error.what());
  }
  write_plots(context, plots, verb.name);
  clock.reset();
  const Json document = json_document(context, verb.name, std::move(result));
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
    std::cerr << rigfit::apps::on_terminal(rigfit::apps::TerminalColour::red, "error:") << ' '
              << error.what() << '\n';
    return static_cast<int>(rigfit::apps::exit_code_of(error));
  }
}
