#include "apps/report/report_files.h"

#include <fmt/format.h>

#include <fstream>
#include <iterator>

#include "apps/cli/output_file.h"
#include "apps/cli/plots/browser.h"
#include "ident/statistics/in_parallel.h"

namespace rigfit::apps {
namespace fs = std::filesystem;
namespace {

/// Writes a file of the report unless it is there with that content.
void put(const fs::path& path, const std::string& content) {
  std::ifstream before(path, std::ios::binary);
  if (before && std::string(std::istreambuf_iterator<char>(before), {}) == content) return;
  write_whole_file(path, content);
}

/// Calls `use` with every Plot and every Picture that has data.
template <class Use>
void each_figure(std::span<const ReportPart> parts, Use use) {
  for (const auto& part : parts) {
    for (const auto& block : part.blocks) {
      if (const auto* plot = std::get_if<Plot>(&block)) use(*plot);
      if (const auto* picture = std::get_if<Picture>(&block)) {
        if (!picture->csv.empty()) use(*picture);
      }
      if (const auto* group = std::get_if<PlotGroup>(&block)) {
        for (const auto& tab : group->tabs) {
          for (const auto& one : tab.plots) use(one);
        }
      }
    }
  }
}

std::string csv_of(const Plot& plot) { return plot_csv(plot); }
std::string csv_of(const Picture& picture) { return picture.csv; }
std::string svg_of(const Plot& plot, const SvgOptions& options) { return svg_plot(plot, options); }
std::string svg_of(const Picture& picture, const SvgOptions&) { return picture.svg; }

void write_pdfs(const fs::path& folder, const ReportOptions& options, VerbContext& context) {
  const fs::path browser = find_chromium();
  if (browser.empty()) {
    context.refuse(
        "no_browser",
        "no Chromium, Chrome or Edge is on PATH: no PDF is written. Install one (Debian: apt "
        "install chromium), or open report.html in any browser and print it",
        folder.string());
    return;
  }
  std::vector<std::string> names{"report"};
  if (options.style == ReportStyle::client) names.emplace_back("appendix");
  for (const auto& name : names) {
    const fs::path part = folder / (name + ".part.pdf"), pdf = folder / (name + ".pdf");
    std::error_code error;
    if (run_chromium(browser,
                     {"--no-pdf-header-footer", "--generate-pdf-document-outline",
                      "--print-to-pdf=" + fs::absolute(part).string()},
                     fs::absolute(folder / (name + ".html")))) {
      fs::rename(part, pdf, error);
    }
    if (error || !fs::exists(pdf)) {
      fs::remove(part, error);
      context.refuse("not_printed", fmt::format("{} did not print {}.html", browser.string(), name),
                     name + ".pdf");
    }
  }
}

}  // namespace

void require_own_report(const fs::path& folder, const std::string& title) {
  std::ifstream file(folder / "report.json");
  if (!file) return;
  const Json before = Json::parse(file, nullptr, false);
  const std::string other =
      before.is_object() && before.value("command", Json()) == "report" && before.contains("title")
          ? before["title"].dump()
          : "a file of something else";
  if (other == Json(title).dump()) return;
  throw UsageError(
      fmt::format("{} holds {}, this campaign is {}: name another folder by --out, or "
                  "replace that report by --force",
                  (folder / "report.json").string(), other, Json(title).dump()));
}

Json figure_list(std::span<const ReportPart> parts) {
  Json figures = Json::array();
  each_figure(parts, [&](const auto& figure) {
    figures.push_back({{"id", figure.id},
                       {"title", figure.title},
                       {"data", "data/" + figure.id + ".csv"},
                       {"figure", "figures/" + figure.id + ".svg"}});
  });
  return figures;
}

std::vector<Answer> all_answers(std::span<const ReportPart> parts) {
  std::vector<Answer> answers;
  for (const auto& part : parts) {
    answers.insert(answers.end(), part.answers.begin(), part.answers.end());
  }
  return answers;
}

void write_report_files(const fs::path& folder, const PageFrame& frame,
                        std::span<const ReportPart> parts, const ReportOptions& options,
                        const std::function<std::string()>& document, VerbContext& context) {
  for (const char* name : {"data", "figures"}) make_output_folder(folder / name);
  const auto& overview = parts.front();
  const auto rest = parts.subspan(1);
  std::string json, page, appendix;
  std::vector<std::function<void()>> tasks{[&] { page = report_page(frame, overview, rest); },
                                           [&] { json = document(); }};
  if (options.style == ReportStyle::client) {
    tasks.emplace_back([&] { appendix = appendix_page(frame, rest); });
  }
  each_figure(parts, [&](const auto& figure) {
    tasks.emplace_back([&folder, &figure, &options] {
      put(folder / "data" / (figure.id + ".csv"), csv_of(figure));
      put(folder / "figures" / (figure.id + ".svg"),
          standalone_svg(svg_of(figure, options.figures)));
    });
  });
  for (const auto& part : parts) {
    for (const auto& file : part.files) {
      make_output_folder((folder / file.path).parent_path());
      tasks.emplace_back([&folder, &file] { put(folder / file.path, file.content); });
    }
  }
  const auto answers = all_answers(parts);
  tasks.emplace_back([&] { put(folder / "data" / "results.csv", answers_csv(answers)); });
  ident::in_parallel(tasks.size(), context.threads, [&](std::size_t i) { tasks[i](); });
  write_whole_file(folder / "report.json", json);
  write_whole_file(folder / "report.html", page);
  std::error_code error;
  if (appendix.empty()) {
    fs::remove(folder / "appendix.html", error);
  } else {
    write_whole_file(folder / "appendix.html", appendix);
  }
  if (options.pdf) write_pdfs(folder, options, context);
}

}  // namespace rigfit::apps
