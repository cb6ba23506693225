#include "apps/cli/plots/plot_option.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cmath>
#include <fstream>
#include <iterator>
#include <memory>
#include <stdexcept>

#include "apps/cli/output_file.h"
#include "apps/cli/plots/browser.h"
#include "apps/report/page/block_html.h"
#include "signal/readers/csv/csv_fields.h"

namespace rigfit::apps {
namespace fs = std::filesystem;
namespace {

std::string kind_of(const std::string& file) {
  return signal::lower_case(fs::path(file).extension().string());
}

std::string content_of(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// The picture as PNG, twice as fine as the screen's pixels.
std::string png_of(const FiguresSvg& figures) {
  const ScratchFolder folder;
  const fs::path svg = folder.path() / "figures.svg", png = folder.path() / "figures.png";
  write_whole_file(svg, figures.svg);
  bool made = false;
  if (const auto converter = find_program({"rsvg-convert"}); !converter.empty()) {
    made = run_silently(converter, {"--zoom=2", "--output=" + png.string(), svg.string()}) == 0;
  }
  if (const auto chromium = find_chromium(); !made && !chromium.empty()) {
    made = run_chromium(chromium,
                        {"--force-device-scale-factor=2",
                         fmt::format("--window-size={:.0f},{:.0f}", std::ceil(figures.width),
                                     std::ceil(figures.height)),
                         "--screenshot=" + png.string()},
                        svg);
  }
  std::string content = made ? content_of(png) : "";
  if (content.rfind("\x89PNG", 0) != 0) {
    throw std::runtime_error(
        "the program that turns figures into a PNG failed; write them as .svg or .html");
  }
  return content;
}

}  // namespace

std::string repeat_command(const VerbContext& context) {
  std::string text = "rigfit";
  for (std::size_t i = 1; i < context.command.size(); ++i) {
    std::string word = context.command[i];
    if (word.find_first_of(" \t'\"$&;()<>|*?[]\\") != std::string::npos) {
      std::string quoted = "'";
      for (const char c : word) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
      word = quoted + "'";
    }
    text += " " + word;
  }
  return text;
}

describe::Options options_of(PlotCommand& c) {
  return {option("--plot", c.file,
                 "Draw the result: an interactive page (.html) or a picture (.svg, .png)")
              .writes()
              .type("F.html|svg|png")};
}

void prepare_plots(VerbContext& context, const PlotCommand& command) {
  if (command.file.empty()) return;
  const std::string kind = kind_of(command.file);
  if (kind != ".html" && kind != ".svg" && kind != ".png") {
    throw UsageError(
        fmt::format("--plot: \"{}\" ends neither with .html nor with .svg or .png", command.file));
  }
  const fs::path file(command.file);
  const fs::path folder = file.has_parent_path() ? file.parent_path() : fs::path(".");
  std::error_code none;
  if (!fs::is_directory(folder, none)) {
    throw UsageError(command.file + ": there is no folder " + folder.string() +
                     " to write the figures to");
  }
  if (fs::is_directory(file, none) || ::access(folder.c_str(), W_OK) != 0) {
    throw UsageError(command.file + ": the figures cannot be written there");
  }
  if (kind == ".png" && find_program({"rsvg-convert"}).empty() && find_chromium().empty()) {
    throw UsageError(command.file +
                     ": a PNG needs rsvg-convert (Debian: librsvg2-bin) or Chromium, and neither "
                     "is here; write .svg or .html");
  }
  context.plots = std::make_shared<PlotSheet>();
}

void write_plots(VerbContext& context, const PlotCommand& command, const std::string& verb) {
  if (!context.plots) return;
  auto& sheet = *context.plots;
  if (sheet.blocks.empty()) {
    context.warn("not_drawn", "there is no result to draw; no figure was written", command.file);
    return;
  }
  const std::string title = "rigfit " + verb;
  const fs::path file = command.file;
  if (const std::string kind = kind_of(file.string()); kind == ".html") {
    context.write(file, figures_page(title, repeat_command(context), sheet.blocks));
  } else {
    const auto figures = figures_svg(title, sheet.blocks);
    if (figures.height <= 0) {
      context.warn("not_drawn", "these results are drawn on a page only: write .html",
                   command.file);
      return;
    }
    context.write(file, kind == ".png" ? png_of(figures) : figures.svg);
  }
  context.out << "figures: " << file.string() << '\n';
}

}  // namespace rigfit::apps
