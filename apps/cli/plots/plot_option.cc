#include "apps/cli/plots/plot_option.h"

#include <fmt/format.h>

#include <cmath>
#include <fstream>
#include <iterator>
#include <memory>
#include <stdexcept>

#include "apps/cli/output_file.h"
#include "apps/cli/plots/browser.h"
#include "apps/report/page/block_html.h"
#include "signal/readers/csv_fields.h"

namespace rigfit::apps {
namespace fs = std::filesystem;
namespace {

std::string kind_of(const std::string& file) {
  return signal::lower_case(fs::path(file).extension().string());
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
