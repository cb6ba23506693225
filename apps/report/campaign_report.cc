#include "apps/report/campaign_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <functional>

#include "apps/cli/json_document.h"
#include "apps/cli/output_file.h"
#include "apps/cli/progress.h"
#include "apps/report/compare_reports.h"
#include "apps/report/fit/fit_part.h"
#include "apps/report/modal/modal_part.h"
#include "apps/report/modal/recorded_modal.h"
#include "apps/report/parts/axial_part.h"
#include "apps/report/parts/bending_part.h"
#include "apps/report/parts/cost_part.h"
#include "apps/report/parts/decay_part.h"
#include "apps/report/parts/overview_part.h"
#include "apps/report/parts/scenes_part.h"
#include "apps/report/parts/tension_part.h"
#include "ident/statistics/in_parallel.h"

namespace rigfit::apps {
namespace fs = std::filesystem;
namespace {

/// Runs the tasks on so many threads; the first exception comes out again.
void run_all(const std::vector<std::function<void()>>& tasks, int threads, Progress& progress) {
  ident::in_parallel(tasks.size(), threads, [&](std::size_t i) {
    tasks[i]();
    progress.advance();
  });
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

const char* word_of_kind(SummaryItem::Kind kind) {
  switch (kind) {
    case SummaryItem::Kind::result:
      return "result";
    case SummaryItem::Kind::error:
      return "error";
    case SummaryItem::Kind::distrust:
      return "distrust";
    case SummaryItem::Kind::recorded:
      return "recorded";
  }
  return "";
}

/// Names and hashes all that a campaign reads, before it is read.
void take_inputs(const Campaign& campaign, VerbContext& context) {
  const auto add = [&](const fs::path& file) {
    std::error_code error;
    if (fs::is_regular_file(file, error)) context.input(file.string());
  };
  for (const auto& input : campaign.inputs) add(input);
  for (const auto& test : campaign.tests) {
    for (const auto& group : test.recordings) {
      for (const auto& file : group.files) {
        add(file);
        add(fs::path(file).replace_extension(".toml"));
      }
    }
  }
}

/// The parts of a campaign's report, in the order of the page.
class Stages {
 public:
  Stages(const Campaign& campaign, VerbContext& context)
      : campaign_(campaign), context_(context), recorded_(campaign.tests.size()) {}

  std::vector<ReportPart> run() {
    const std::size_t tests = campaign_.tests.size();
    std::vector<ReportPart> second(tests);
    std::vector<FitPart> fits(campaign_.fits.size());
    std::vector<BendingPart> bending(tests);
    std::vector<AxialPart> axial(tests);
    std::vector<std::function<void()>> tasks;
    for (std::size_t i = 0; i < tests; ++i) {
      const auto& test = campaign_.tests[i];
      tasks.emplace_back([&, i] {
        switch (test.kind) {
          case CampaignTest::Kind::bending:
            bending[i] = bending_part(campaign_, test);
            break;
          case CampaignTest::Kind::axial:
            axial[i] = axial_part(test, context_.seed, context_.threads);
            break;
          case CampaignTest::Kind::modal:
            if (!test.recordings.empty()) recorded_[i] = recorded_modal(campaign_, test);
            break;
          case CampaignTest::Kind::tension:
            second[i] = tension_part(test);
            break;
          case CampaignTest::Kind::decay:
            break;
        }
      });
    }
    Progress progress("report", static_cast<long>(2 * tests + campaign_.fits.size() + 1),
                      context_.quiet);
    run_all(tasks, context_.threads, progress);
    // EI(T) and EA go on to the tests whose scenes take them.
    for (std::size_t i = 0; i < tests; ++i) {
      if (known_.EI.empty()) known_.EI = bending[i].curve;
      if (!known_.axial) known_.axial = axial[i].known;
    }
    tasks.clear();
    std::vector<std::vector<ident::ModalTestState>> states(tests);
    for (std::size_t i = 0; i < tests; ++i) states[i] = recorded_[i].states;
    for (std::size_t f = 0; f < campaign_.fits.size(); ++f) {
      tasks.emplace_back([&, f] {
        fits[f] =
            fit_part(campaign_, campaign_.fits[f], known_, states, context_.threads, context_.seed);
      });
    }
    for (std::size_t i = 0; i < tests; ++i) {
      const auto& test = campaign_.tests[i];
      if (test.kind == CampaignTest::Kind::modal && test.scene) {
        tasks.emplace_back([&, i] { second[i] = modal_part(campaign_, test, known_, states[i]); });
      }
    }
    run_all(tasks, context_.threads, progress);
    tasks.clear();
    for (std::size_t i = 0; i < tests; ++i) {
      const auto& test = campaign_.tests[i];
      if (test.kind != CampaignTest::Kind::decay) continue;
      tasks.emplace_back([&, i] {
        second[i] = decay_part(campaign_, test, known_, fits_of(i, fits), context_.threads);
      });
    }
    run_all(tasks, context_.threads, progress);

    // On the page: what was measured, what the model says of it, what was fitted.
    std::vector<ReportPart> parts;
    const auto add = [&](ReportPart& part) {
      if (!part.id.empty()) parts.push_back(std::move(part));
    };
    for (auto& part : bending) add(part.part);
    for (auto& part : axial) add(part.part);
    for (std::size_t i = 0; i < tests; ++i) {
      add(recorded_[i].part);
      add(second[i]);
    }
    for (auto& fit : fits) add(fit.part);
    auto costs = cost_part(parts);
    parts.push_back(scenes_part(campaign_));
    parts.push_back(std::move(costs));
    return parts;
  }

 private:
  /// What was found by the fits that predict a test.
  [[nodiscard]] std::vector<FitOfDecay> fits_of(std::size_t test,
                                                const std::vector<FitPart>& fits) const {
    std::vector<FitOfDecay> list;
    for (std::size_t f = 0; f < fits.size(); ++f) {
      const auto& named = campaign_.fits[f].predicts;
      if (std::find(named.begin(), named.end(), test) == named.end()) continue;
      list.push_back({campaign_.fits[f].title, fits[f].values});
    }
    return list;
  }

  const Campaign& campaign_;
  VerbContext& context_;
  std::vector<RecordedModal> recorded_;
  KnownValues known_;
};

}  // namespace

Json campaign_report(const Campaign& campaign, const fs::path& folder, const ReportOptions& options,
                     VerbContext& context) {
  if (!options.force) require_own_report(folder, campaign.title);
  take_inputs(campaign, context);
  make_output_folder(folder);
  for (const char* place : {"", "data", "figures", "uff"}) sweep_parts(folder / place);
  std::vector<ReportPart> parts = Stages(campaign, context).run();
  parts.insert(parts.begin(), overview_part(campaign, parts));

  PageFrame frame;
  frame.title = campaign.title;
  frame.source = campaign.source;
  frame.description = campaign.description;
  frame.details = campaign.report;
  frame.style = options.style;
  frame.version = RIGFIT_VERSION;
  frame.repeat = repeat_command(context);
  for (const auto& part : parts) {
    for (const auto& input : part.inputs) {
      std::error_code error;
      if (fs::is_regular_file(input, error)) context.input(input);
    }
  }
  for (const auto& input : context.inputs()) {
    frame.inputs.emplace_back(input.path, input.sha256);
  }
  Json result;
  result["title"] = campaign.title;
  result["source"] = campaign.source;
  result["seed"] = context.seed;
  Json summary = Json::array();
  for (const auto& part : parts) {
    for (const auto& item : part.summary) {
      summary.push_back({{"kind", word_of_kind(item.kind)},
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
  Json answers = Json::array();
  for (const auto& answer : all_answers(parts)) answers.push_back(answer_json(answer));
  result["answers"] = std::move(answers);
  for (const auto& part : parts) {
    if (part.json_key.empty()) continue;
    if (part.json.is_array()) {
      result[part.json_key] = part.json;
    } else {
      result[part.json_key].push_back(part.json);
    }
  }
  result["figures"] = figure_list(parts);

  context.check_inputs();
  write_report_files(
      folder, frame, parts, options,
      [&] { return json_document(context, "report", result).dump(2) + "\n"; }, context);

  for (const auto& part : parts) {
    for (const auto& item : part.summary) {
      if (item.kind != SummaryItem::Kind::distrust) {
        context.out << fmt::format("{}: {}\n", item.label, item.text);
      }
    }
  }
  context.out << fmt::format("report: {}\n", (folder / "report.html").string());
  return result;
}

Json compared_campaigns(const Campaign& before, const Campaign& after, const fs::path& folder,
                        const ReportOptions& options, VerbContext& context) {
  const std::string title = after.title == before.title ? before.title + ": before and after"
                                                        : before.title + " against " + after.title;
  if (!options.force) require_own_report(folder, title);
  make_output_folder(folder);
  for (const char* place : {"", "data", "figures"}) sweep_parts(folder / place);
  ComparedReport first{before.title, "before", {}}, second{after.title, "after", {}};
  first.document = campaign_report(before, folder / "before", options, context);
  second.document = campaign_report(after, folder / "after", options, context);
  std::vector<ReportPart> parts{{}, compare_reports(first, second)};
  parts.front().id = "overview";

  PageFrame frame;
  frame.title = title;
  frame.description = fmt::format("Before: {} ({}). After: {} ({}).", before.title, before.file,
                                  after.title, after.file);
  frame.details = after.report;
  frame.version = RIGFIT_VERSION;
  frame.repeat = repeat_command(context);
  for (const auto& input : context.inputs()) {
    frame.inputs.emplace_back(input.path, input.sha256);
  }
  frame.links = {{"before/report.html", "Before: " + before.title},
                 {"after/report.html", "After: " + after.title}};
  Json result;
  result["title"] = frame.title;
  result["source"] = after.source;
  result["seed"] = context.seed;
  result["summary"] = Json::array();
  for (const auto& item : parts.back().summary) {
    result["summary"].push_back({{"kind", word_of_kind(item.kind)},
                                 {"label", item.label},
                                 {"text", item.text},
                                 {"origin", nullptr}});
    context.out << fmt::format("{}: {}\n", item.label, item.text);
  }
  result["scenes"] = Json::array();
  result["comparison"] = parts.back().json;
  result["figures"] = figure_list(parts);
  context.check_inputs();
  ReportOptions one_page = options;
  one_page.style = ReportStyle::lab;
  write_report_files(
      folder, frame, parts, one_page,
      [&] { return json_document(context, "report", result).dump(2) + "\n"; }, context);
  context.out << fmt::format("comparison: {}\n", (folder / "report.html").string());
  return result;
}

}  // namespace rigfit::apps
