// rigfit: one program, one verb a task. Parses the command line, runs the verb, writes its
// document.
#include <fmt/format.h>
#include <glog/logging.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <csignal>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <optional>
#include <streambuf>
#include <string_view>
#include <system_error>
#include <thread>

#include "apps/cli/exit_code.h"
#include "apps/cli/json_document.h"
#include "apps/cli/plots/plot_option.h"
#include "apps/cli/progress.h"
#include "apps/cli/terminal.h"
#include "apps/cli/usage.h"
#include "apps/cli/verb.h"
#include "signal/readers/recording_description.h"
#include "signal/recording/units.h"

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
  verb.add_flag("--quiet", common.quiet, "Print errors only")->group("Common");
  verb.add_option("--threads", common.threads,
                  "Threads to use (all processors); the numbers do not depend on it")
      ->check(CLI::Range(1, 1024))
      ->group("Common");
  verb.add_option("--seed", common.seed, "Seed of every random number")
      ->capture_default_str()
      ->group("Common");
}

/// Verbs whose files are recordings.
constexpr std::array<std::string_view, 9> kReaders = {
    "inspect", "decay", "frf", "modal", "bending", "axial", "tension", "resample", "new"};

/// What a person says of every file of a run, as in the TOML file beside it.
struct ReadingOptions {
  std::string format, decimal, separator, time_unit;
  std::vector<std::string> variables;
};

void add_reading(CLI::App& verb, ReadingOptions& reading) {
  verb.add_option("--format", reading.format, "Format of the files, where their content misleads")
      ->check(CLI::IsMember(signal::format_names()))
      ->group("Reading");
  verb.add_option("--decimal", reading.decimal, "Decimal sign of tables: point or comma")
      ->group("Reading");
  verb.add_option("--separator", reading.separator,
                  "Between columns of tables: comma, semicolon, tab or blank")
      ->group("Reading");
  verb.add_option("--time-unit", reading.time_unit, "Unit of the time column: s, ms, us, min")
      ->group("Reading");
  verb.add_option("--variable", reading.variables, "Arrays to take of .mat files")
      ->type_name("NAME")
      ->group("Reading");
}

signal::ReadOptions read_options(const ReadingOptions& given) {
  signal::ReadOptions options;
  options.format = given.format;
  options.variables = given.variables;
  const auto sign = [](const std::string& text, const char* option, std::string_view allowed) {
    if (text.empty()) return char{0};
    const char found = signal::sign_named(text);
    if (found == 0 || allowed.find(found) == std::string_view::npos) {
      throw UsageError(std::string(option) + " does not know \"" + text + "\"");
    }
    return found;
  };
  options.decimal = sign(given.decimal, "--decimal", ".,");
  options.separator = sign(given.separator, "--separator", ",;\t ");
  if (!given.time_unit.empty()) {
    const auto unit = signal::parse_unit(given.time_unit);
    if (!unit || unit->quantity != signal::Quantity::time) {
      throw UsageError("--time-unit: \"" + given.time_unit +
                       "\" is no unit of time (s, ms, us, min)");
    }
    options.time_unit_s = unit->factor;
  }
  return options;
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
    for (std::size_t k = 1; k < arguments.size(); ++k) {
      if (arguments[k] != "-" || arguments[k - 1].starts_with("--")) continue;
      if (!folder_.empty()) throw UsageError("standard input (-) can be read once only");
      std::string name = (std::filesystem::temp_directory_path() / "rigfit-XXXXXX").string();
      if (::mkdtemp(name.data()) == nullptr)
        throw std::runtime_error("cannot make a folder in " + name);
      folder_ = name;
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

  program.formatter(help_formatter());

  Verbs verbs;
  add_all_verbs(program, verbs);
  CommonOptions common;
  PlotCommand plots;
  ReadingOptions reading;
  for (auto& verb : verbs) {
    if (std::find(kReaders.begin(), kReaders.end(), verb.app->get_name()) != kReaders.end()) {
      add_reading(*verb.app, reading);
    }
    add_common(*verb.app, common);
    if (verb.draws) add_plot_option(*verb.app, plots);
  }

  std::vector<std::string> arguments(argv + 1, argv + argc);
  if (arguments.empty()) {
    static_cast<void>(help(program, verbs, {}, std::cerr));
    return static_cast<int>(ExitCode::wrong_usage);
  }
  if (arguments.front() == "help") {
    return help(program, verbs, {arguments.begin() + 1, arguments.end()}, std::cout);
  }
  StandardInput standard_input;
  standard_input.replace(arguments);

  try {
    std::vector<std::string> reversed(arguments.rbegin(), arguments.rend());
    program.parse(reversed);
  } catch (const CLI::CallForHelp& help) {
    return program.exit(help);
  } catch (const CLI::CallForVersion& version) {
    return program.exit(version);
  } catch (const CLI::ParseError& error) {
    throw UsageError(usage_error(verbs, arguments, error.what()));
  }

  const auto chosen =
      std::find_if(verbs.begin(), verbs.end(), [](const Verb& verb) { return verb.app->parsed(); });
  NullBuffer nothing;
  std::ostream sink(&nothing);
  ResultBuffer result_buffer(std::cout.rdbuf());
  std::ostream results(&result_buffer);
  VerbContext context(common.quiet || common.json == "-" ? sink : results);
  context.quiet = common.quiet;
  context.threads = common.threads;
  context.seed = common.seed;
  context.reading = read_options(reading);
  context.command.assign(argv, argv + argc);

  prepare_plots(context, plots);
  std::optional<ProgressClock> clock(std::in_place, chosen->app->get_name(), context.quiet);
  Json result = Json::object();
  try {
    result = chosen->run(context);
  } catch (const Refused& error) {
    context.refuse(error.code(), error.what());
  } catch (const NotConverged& error) {
    context.fail(error.what());
  }
  write_plots(context, plots, chosen->app->get_name());
  clock.reset();
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
    std::cerr << rigfit::apps::on_terminal(rigfit::apps::Colour::red, "error:") << ' '
              << error.what() << '\n';
    return static_cast<int>(rigfit::apps::exit_code_of(error));
  }
}
