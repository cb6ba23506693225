#include "apps/cli/plots/plot_option.h"

#include <unistd.h>

#include <cctype>
#include <cerrno>
#include <cstdlib>
#include <fstream>
#include <stdexcept>
#include <system_error>

#include "apps/report/page/block_html.h"
#include "signal/readers/csv_fields.h"

namespace rigfit::apps {
namespace fs = std::filesystem;
namespace {

std::string kind_of(const std::string& file) {
  return signal::lower_case(fs::path(file).extension().string());
}

/// The word as one types it in a shell: quoted where it holds more than letters, digits and a few
/// signs.
std::string shell_word(const std::string& word) {
  const bool plain = std::ranges::all_of(word, [](unsigned char c) {
    return std::isalnum(c) != 0 || std::string_view("-_./=,:+@%").find(c) != std::string::npos;
  });
  if (plain && !word.empty()) return word;
  std::string quoted = "'";
  for (const char c : word) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return quoted + "'";
}

/// A folder of its own for what a run needs for a moment, removed with everything in it.
std::shared_ptr<const fs::path> scratch_folder() {
  std::string name = (fs::temp_directory_path() / "rigfit-XXXXXX").string();
  if (!::mkdtemp(name.data())) {
    throw std::system_error(errno, std::generic_category(), "a temporary folder: " + name);
  }
  return {new fs::path(name), [](const fs::path* folder) {
            std::error_code none;
            fs::remove_all(*folder, none);
            delete folder;
          }};
}

/// The picture as PNG, twice as fine as the screen's pixels.
std::string png_of(const FiguresSvg& figures) {
  const auto folder = scratch_folder();
  const fs::path svg = *folder / "figures.svg", png = *folder / "figures.png";
  write_whole_file(svg, figures.svg);
  const bool made = run_chromium(find_chromium(),
                                 {"--force-device-scale-factor=2",
                                  fmt::format("--window-size={:.0f},{:.0f}",
                                              std::ceil(figures.width), std::ceil(figures.height)),
                                  "--screenshot=" + png.string()},
                                 svg);
  std::ifstream in(png, std::ios::binary);
  std::string content{std::istreambuf_iterator<char>(in), {}};
  if (!made || !content.starts_with("\x89PNG")) {
    throw std::runtime_error("Chromium failed to make a PNG of the figures; write .svg or .html");
  }
  return content;
}

}  // namespace

std::string find_chromium() {
  for (const char* name : {"chromium", "chromium-browser", "google-chrome", "google-chrome-stable",
                           "chrome", "microsoft-edge"}) {
    const std::string look = fmt::format("command -v {} >/dev/null 2>&1", name);
    if (std::system(look.c_str()) == 0) return name;
  }
  return {};
}

bool run_chromium(const std::string& chromium, const std::vector<std::string>& options,
                  const fs::path& page) {
  const auto profile = scratch_folder();
  std::string command = chromium +
                        " --headless --disable-gpu --no-first-run --disable-extensions"
                        " --hide-scrollbars " +
                        shell_word("--user-data-dir=" + profile->string());
  if (::geteuid() == 0) command += " --no-sandbox";  // it refuses to run as root else
  for (const auto& option : options) command += " " + shell_word(option);
  command += " " + shell_word("file://" + fs::absolute(page).string());
  return std::system((command + " </dev/null >/dev/null 2>&1").c_str()) == 0;
}

std::string repeat_command(const VerbContext& context) {
  std::string text = "rigfit";
  for (std::size_t i = 1; i < context.command.size(); ++i) {
    text += " " + shell_word(context.command[i]);
  }
  return text;
}

void prepare_plots(VerbContext& context, const std::string& file) {
  if (file.empty()) return;
  const std::string kind = kind_of(file);
  if (kind != ".html" && kind != ".svg" && kind != ".png") {
    throw UsageError(
        fmt::format("--plot: \"{}\" ends neither with .html nor with .svg or .png", file));
  }
  if (kind == ".png" && find_chromium().empty()) {
    throw UsageError(file + ": a PNG needs Chromium (Debian: chromium); write .svg or .html");
  }
  context.plots = std::make_shared<PlotSheet>();
}

void write_plots(VerbContext& context, const std::string& file, const std::string& verb) {
  if (!context.plots) return;
  auto& sheet = *context.plots;
  if (sheet.blocks.empty()) {
    context.warn("not_drawn", "there is no result to draw; no figure was written", file);
    return;
  }
  const std::string title = "rigfit " + verb;
  if (const std::string kind = kind_of(file); kind == ".html") {
    context.write(file, figures_page(title, repeat_command(context), sheet.blocks));
  } else {
    const auto figures = figures_svg(title, sheet.blocks);
    if (figures.height <= 0) {
      context.warn("not_drawn", "these results are drawn on a page only: write .html", file);
      return;
    }
    context.write(file, kind == ".png" ? png_of(figures) : figures.svg);
  }
  context.out << "figures: " << file << '\n';
}

}  // namespace rigfit::apps
