#include "apps/report/campaign_report.h"

#include <fmt/format.h>

#include <atomic>
#include <exception>
#include <functional>
#include <mutex>
#include <thread>

#include "apps/json_document.h"
#include "apps/output_file.h"
#include "apps/progress.h"
#include "apps/report/bending_part.h"
#include "apps/report/modal_part.h"
#include "apps/report/report_page.h"
#include "apps/report/scenes_part.h"
#include "apps/report/svg_plot.h"
#include "apps/sha256.h"

namespace rigfit::apps {
namespace fs = std::filesystem;
namespace {

/// Runs the tasks on so many threads; the first exception comes out again.
void run_all(const std::vector<std::function<void()>>& tasks, int threads, Progress& progress) {
  std::atomic<std::size_t> next{0};
  std::exception_ptr first;
  std::mutex mutex;
  const auto work = [&] {
    for (std::size_t i; (i = next++) < tasks.size();) {
      try {
        tasks[i]();
      } catch (...) {
        const std::lock_guard lock(mutex);
        if (!first) first = std::current_exception();
      }
      progress.advance();
    }
  };
  std::vector<std::jthread> others;
  for (int i = 1; i < threads && i < static_cast<int>(tasks.size()); ++i) others.emplace_back(work);
  work();
  others.clear();
  if (first) std::rethrow_exception(first);
}

std::string repeat_command(const VerbContext& context) {
  std::string text;
  for (std::size_t i = 0; i < context.command.size(); ++i) {
    std::string word = i == 0 ? "rigfit" : context.command[i];
    if (word.find_first_of(" \t'\"$&;()<>|*?[]\\") != std::string::npos) {
      std::string quoted = "'";
      for (const char c : word) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
      word = quoted + "'";
    }
    text += (i > 0 ? " " : "") + word;
  }
  return text;
}

void write_figures(const fs::path& folder, const std::vector<ReportPart>& parts) {
  make_output_folder(folder / "data");
  make_output_folder(folder / "figures");
  for (const auto& part : parts) {
    for (const auto& block : part.blocks) {
      const auto* plot = std::get_if<Plot>(&block);
      if (!plot) continue;
      write_whole_file(folder / "data" / (plot->id + ".csv"), plot_csv(*plot));
      write_whole_file(folder / "figures" / (plot->id + ".svg"), svg_plot(*plot));
    }
  }
}

}  // namespace

Json campaign_report(const Campaign& campaign, const fs::path& folder, VerbContext& context) {
  make_output_folder(folder);
  // Bending tests first: the others take EI(T) from them.
  std::vector<ReportPart> parts;
  StiffnessCurve EI;
  for (const auto& test : campaign.tests) {
    if (test.kind != CampaignTest::Kind::bending) continue;
    BendingPart bending = bending_part(campaign, test);
    if (EI.empty()) EI = bending.curve;
    parts.push_back(std::move(bending.part));
  }
  std::vector<std::function<void()>> tasks;
  std::vector<ReportPart> later(campaign.tests.size() + 1);
  for (std::size_t i = 0; i < campaign.tests.size(); ++i) {
    if (campaign.tests[i].kind != CampaignTest::Kind::modal) continue;
    tasks.emplace_back([&, i] { later[i] = modal_part(campaign, campaign.tests[i], EI); });
  }
  tasks.emplace_back([&] { later.back() = scenes_part(campaign); });
  {
    Progress progress("report", static_cast<long>(tasks.size()), context.quiet);
    run_all(tasks, context.threads, progress);
  }
  for (auto& part : later) {
    if (!part.id.empty()) parts.push_back(std::move(part));
  }

  PageFrame frame;
  frame.title = campaign.title;
  frame.source = campaign.source;
  frame.description = campaign.description;
  frame.version = RIGFIT_VERSION;
  frame.repeat = repeat_command(context);
  for (const auto& input : campaign.inputs) context.input(input);
  for (const auto& part : parts) {
    for (const auto& input : part.inputs) {
      std::error_code error;
      if (fs::is_regular_file(input, error)) context.input(input);
    }
  }
  for (const auto& input : context.inputs()) {
    frame.inputs.emplace_back(input, sha256_of_file(input));
  }
  Json result;
  result["title"] = campaign.title;
  result["source"] = campaign.source;
  result["seed"] = context.seed;
  Json summary = Json::array();
  for (const auto& part : parts) {
    for (const auto& item : part.summary) {
      summary.push_back({{"kind", item.kind == SummaryItem::Kind::result ? "result" : "distrust"},
                         {"label", item.label},
                         {"text", item.text},
                         {"origin", item.origin ? Json(word_of(*item.origin)) : Json(nullptr)}});
    }
    for (const auto& warning : part.warnings) {
      frame.warnings.push_back(warning);
      if (warning.refused) {
        context.refuse(warning.code, warning.message, warning.where);
      } else {
        context.warn(warning.code, warning.message, warning.where);
      }
    }
  }
  result["summary"] = std::move(summary);
  Json figures = Json::array();
  for (const auto& part : parts) {
    if (!part.json_key.empty()) {
      if (part.json.is_array()) {
        result[part.json_key] = part.json;
      } else {
        result[part.json_key].push_back(part.json);
      }
    }
    for (const auto& block : part.blocks) {
      if (const auto* plot = std::get_if<Plot>(&block)) {
        figures.push_back({{"id", plot->id},
                           {"title", plot->title},
                           {"data", "data/" + plot->id + ".csv"},
                           {"figure", "figures/" + plot->id + ".svg"}});
      }
    }
  }
  result["figures"] = std::move(figures);

  write_figures(folder, parts);
  write_whole_file(folder / "report.json", json_document(context, "report", result).dump(2) + "\n");
  write_whole_file(folder / "report.html", report_page(frame, parts));

  for (const auto& part : parts) {
    for (const auto& item : part.summary) {
      if (item.kind == SummaryItem::Kind::result) {
        context.out << fmt::format("{}: {}\n", item.label, item.text);
      }
    }
  }
  context.out << fmt::format("report: {}\n", (folder / "report.html").string());
  return result;
}

}  // namespace rigfit::apps
