#include "apps/report/campaign_report.h"

#include <chrono>
#include <fstream>
#include <span>

#include "apps/cli/plots/plot_option.h"
#include "apps/cli/progress.h"
#include "apps/describe/json_of.h"
#include "apps/report/parts/parts.h"
#include "ident/campaign/campaign.h"
#include "ident/statistics/in_parallel.h"
#include "signal/readers/recording_description.h"

namespace rigfit::apps {
namespace fs = std::filesystem;
namespace {

/// Writes a file of the report unless it is there with that content.
void put(const fs::path& path, const std::string& content) {
  std::ifstream before(path, std::ios::binary);
  if (before && std::string(std::istreambuf_iterator<char>(before), {}) == content) return;
  write_whole_file(path, content);
}

std::string csv_of(const Plot& plot) { return plot_csv(plot); }
std::string csv_of(const Picture& picture) { return picture.csv; }
std::string svg_of(const Plot& plot, const SvgOptions& options) { return svg_plot(plot, options); }
std::string svg_of(const Picture& picture, const SvgOptions&) { return picture.svg; }

void write_pdfs(const fs::path& folder, ReportStyle style, VerbContext& context) {
  const std::string browser = find_chromium();
  if (browser.empty()) {
    context.refuse(
        "no_browser",
        "no Chromium, Chrome or Edge is on PATH: no PDF is written. Install one (Debian: apt "
        "install chromium), or open report.html in any browser and print it",
        folder.string());
    return;
  }
  std::vector<std::string> names{"report"};
  if (style == ReportStyle::client) names.emplace_back("appendix");
  for (const auto& name : names) {
    const fs::path part = folder / (name + ".part.pdf"), pdf = folder / (name + ".pdf");
    std::error_code error;
    const bool printed = run_chromium(browser,
                                      {"--no-pdf-header-footer", "--generate-pdf-document-outline",
                                       "--print-to-pdf=" + fs::absolute(part).string()},
                                      fs::absolute(folder / (name + ".html")));
    if (printed) fs::rename(part, pdf, error);
    if (!printed || error) {
      fs::remove(part, error);
      context.refuse("not_printed", fmt::format("{} did not print {}.html", browser, name),
                     name + ".pdf");
    }
  }
}

/// Makes the folder. Throws UsageError when it holds another report, neither of this title nor of
/// this file, unless `force`.
void begin_folder(const fs::path& folder, const std::string& title, const std::string& campaign,
                  bool force) {
  if (std::ifstream file(folder / "report.json"); file && !force) {
    const Json before = Json::parse(file, nullptr, false);
    const bool report = before.is_object() && before.value("command", Json()) == "report" &&
                        before.contains("title");
    const Json inputs = report ? before.value("inputs", Json::array()) : Json::array();
    const auto from_this = [&](const Json& input) { return input.value("path", "") == campaign; };
    if (!report || (before["title"] != Json(title) && std::ranges::none_of(inputs, from_this))) {
      throw UsageError(fmt::format(
          "{} holds {}, this campaign is {}: name another folder by --out, or "
          "replace that report by --force",
          (folder / "report.json").string(),
          report ? before["title"].dump() : "a file of something else", Json(title).dump()));
    }
  }
  make_output_folder(folder);
}

/// Every answer of the parts, in their order.
std::vector<Answer> all_answers(std::span<const ReportPart> parts) {
  std::vector<Answer> answers;
  for (const auto& part : parts) {
    answers.insert(answers.end(), part.answers.begin(), part.answers.end());
  }
  return answers;
}

/// The lines of the summary: for the document, and on the terminal.
Json summary_json(const std::vector<ReportPart>& parts, VerbContext& context) {
  Json summary = Json::array();
  for (const auto& part : parts) {
    for (const auto& item : part.summary) {
      summary.push_back(describe::json_of(item));
      context.out << fmt::format("{}: {}\n", item.label, item.text);
    }
  }
  return summary;
}

/// Adds what every document has and writes everything: page, figures, data, files for other
/// programs, and report.json, whose text is made beside the figures. `parts`: the overview first.
void finish(const fs::path& folder, PageFrame frame, std::span<const ReportPart> parts,
            const ReportOptions& options, Json& result, VerbContext& context) {
  frame.repeat = repeat_command(context);
  for (const auto& input : context.inputs()) frame.inputs.emplace_back(input.path, input.sha256);
  context.check_inputs();
  for (const char* name : {"data", "figures"}) make_output_folder(folder / name);
  const auto rest = parts.subspan(1);
  std::string json, page, appendix;
  std::vector<std::function<void()>> tasks{
      [&] { page = report_page(frame, parts.front(), rest); },
      [&] { json = context.document("report", result).dump(2) + "\n"; }};
  if (frame.style == ReportStyle::client) {
    tasks.emplace_back([&] { appendix = appendix_page(frame, rest); });
  }
  result["figures"] = Json::array();
  for (const auto& part : parts) {
    for (const auto& [file, content] : part.files) {
      make_output_folder((folder / file).parent_path());
      put(folder / file, content);
    }
    each_figure(part.blocks, [&](const auto& figure, const std::string&) {
      const std::string data = "data/" + figure.id + ".csv", svg = "figures/" + figure.id + ".svg";
      result["figures"].push_back(
          {{"id", figure.id}, {"title", figure.title}, {"data", data}, {"figure", svg}});
      tasks.emplace_back([&folder, &figure, &options, data, svg] {
        put(folder / data, csv_of(figure));
        put(folder / svg, standalone_svg(svg_of(figure, options.figures)));
      });
    });
  }
  tasks.emplace_back(
      [&] { put(folder / "data" / "results.csv", answers_csv(all_answers(parts))); });
  ident::in_parallel(tasks.size(), context.threads, [&](std::size_t i) { tasks[i](); });
  write_whole_file(folder / "report.json", json);
  write_whole_file(folder / "report.html", page);
  std::error_code error;
  if (appendix.empty()) {
    fs::remove(folder / "appendix.html", error);
  } else {
    write_whole_file(folder / "appendix.html", appendix);
  }
  if (options.pdf) write_pdfs(folder, frame.style, context);
  context.out << fmt::format("report: {}\n", (folder / "report.html").string());
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
        for (const auto& said : signal::descriptions_of(file)) add(said);
      }
    }
  }
}

/// Reads the recordings, works out the campaign, shows what came of it: the parts in the order of
/// the page. `times`: what each stage took.
std::vector<ReportPart> campaign_parts(const Campaign& campaign, const VerbContext& context,
                                       ReportTable& times) {
  using Clock = std::chrono::steady_clock;
  const auto took = [&](const std::string& stage, double time_s) {
    times.rows.push_back({stage, fmt::format("{:.2g}", time_s)});
  };
  const auto since = [](Clock::time_point begin) {
    return std::chrono::duration<double>(Clock::now() - begin).count();
  };
  const auto begin = Clock::now();
  const std::size_t tests = campaign.tests.size(), fits = campaign.fits.size();
  std::size_t files = 0;
  for (const auto& test : campaign.tests) {
    for (const auto& group : test.recordings) files += group.files.size();
  }
  Progress progress("report", static_cast<long>(files + 2 * (tests + fits)), context.quiet);
  const auto advance = [&] { progress.advance(); };
  std::vector<std::unique_ptr<TestPart>> shown;
  for (std::size_t i = 0; i < tests; ++i) {
    shown.push_back(test_part(campaign, campaign.tests[i], context.threads));
  }
  ident::in_parallel(tests, context.threads, [&](std::size_t i) { shown[i]->read(advance); });
  took("recordings read", since(begin));

  ident::CampaignInputs inputs;
  inputs.threads = context.threads;
  inputs.advance = advance;
  for (auto& part : shown) inputs.tests.push_back(part->inputs());
  for (const auto& fit : campaign.fits) {
    inputs.fits.push_back(fit);
    inputs.fits.back().options.threads = context.threads;
  }
  auto result = ident::run_campaign(std::move(inputs));
  for (std::size_t i = 0; i < tests; ++i) took(campaign.tests[i].title, result.test_s[i]);
  for (std::size_t i = 0; i < fits; ++i) took(campaign.fits[i].title, result.fit_s[i]);
  const auto drawn = Clock::now();

  std::vector<std::vector<ReportPart>> pages(tests + fits);
  ident::in_parallel(pages.size(), context.threads, [&](std::size_t i) {
    if (i < tests) {
      pages[i] = shown[i]->show(result.inputs.tests[i], result.tests[i]);
    } else {
      pages[i] = {fit_part(campaign, campaign.fits[i - tests], result.fits[i - tests])};
    }
    advance();
  });
  std::vector<ReportPart> parts;
  for (auto& page : pages) std::ranges::move(page, std::back_inserter(parts));
  parts.push_back(scenes_part(campaign));
  took("figures and tables", since(drawn));
  return parts;
}

}  // namespace

Json campaign_report(const Campaign& campaign, const fs::path& folder, const ReportOptions& options,
                     VerbContext& context, std::vector<Answer>* given) {
  begin_folder(folder, campaign.title, campaign.file, options.force);
  take_inputs(campaign, context);
  PageFrame frame{campaign.title, campaign.source, campaign.description, campaign.report,
                  options.style};
  std::vector<ReportPart> parts = campaign_parts(campaign, context, frame.times);
  std::vector<Answer*> found;
  for (auto& part : parts) {
    for (auto& answer : part.answers) found.push_back(&answer);
  }
  recommend(found);
  parts.insert(parts.begin(), overview_part(campaign, parts));
  for (auto& kind : findings_of(parts)) {
    kind.first.where = kind.listed();
    context.tell({kind.first});
  }
  Json result{{"title", campaign.title}, {"source", campaign.source}, {"seed", context.seed}};
  result["summary"] = summary_json(parts, context);
  const auto answers = all_answers(parts);
  result["answers"] = describe::json_of(answers);
  if (given) *given = answers;
  for (const auto& part : parts) {
    if (part.json_key.empty()) continue;
    if (part.json.is_array()) {
      result[part.json_key] = part.json;
    } else {
      result[part.json_key].push_back(part.json);
    }
  }
  finish(folder, std::move(frame), parts, options, result, context);
  return result;
}

Json report_schema() {
  using describe::schema_of;
  Json all = describe::schema_of_keys({{"title", schema_of<std::string>()},
                                       {"source", schema_of<std::string>()},
                                       {"seed", schema_of<long>()},
                                       {"summary", schema_of<std::vector<SummaryItem>>()}});
  all["properties"]["answers"] = schema_of<std::vector<Answer>>();
  all["properties"]["comparison"] = comparison_schema();
  return all;
}

Json compared_campaigns(const Campaign& before, const Campaign& after, const fs::path& folder,
                        const ReportOptions& options, VerbContext& context) {
  const std::string title = after.title == before.title ? before.title + ": before and after"
                                                        : before.title + " against " + after.title;
  begin_folder(folder, title, "", options.force);  // no campaign by itself has its report there
  ComparedReport first{before}, second{after};
  static_cast<void>(campaign_report(before, folder / "before", options, context, &first.answers));
  static_cast<void>(campaign_report(after, folder / "after", options, context, &second.answers));
  std::vector<ReportPart> parts{{}, compare_reports(first, second)};
  PageFrame frame{title, "",
                  fmt::format("Before: {} ({}). After: {} ({}).", before.title, before.file,
                              after.title, after.file),
                  after.report};  // one page
  frame.links = {{"before/report.html", "Before: " + before.title},
                 {"after/report.html", "After: " + after.title}};
  Json result{{"title", title}, {"source", after.source}, {"seed", context.seed}};
  result["summary"] = summary_json(parts, context);
  result["comparison"] = parts.back().json;
  finish(folder, std::move(frame), parts, options, result, context);
  return result;
}

}  // namespace rigfit::apps
