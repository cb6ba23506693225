#include "apps/report/campaign_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "apps/describe/json_of.h"
#include "apps/report/drawing/html_text.h"
#include "signal/numerics/estimate.h"

namespace rigfit::apps {
namespace {

constexpr double kPerhaps = 1.96, kSurely = 3;  // standard uncertainties of the difference
constexpr double kFarthest = 0.15;  // log of the ratio of two values that may be the same mode

/// What a value is recognised by among others of its key: the frequency of its mode, or itself.
double mark_of(const Answer& answer) {
  return std::isfinite(answer.mode_hz) ? answer.mode_hz : answer.value;
}

struct Pair {
  const Answer* before = nullptr;
  const Answer* after = nullptr;

  [[nodiscard]] const Answer& one() const { return after ? *after : *before; }
};

/// Each value before with the nearest one after of its key (a key may have several, such as the
/// modes of a state); then the lonely ones.
std::vector<Pair> pairs_of(const std::vector<Answer>& before, const std::vector<Answer>& after) {
  std::vector<Pair> pairs;
  std::vector<bool> taken(after.size(), false);
  for (const auto& one : before) {
    const auto count = std::count_if(before.begin(), before.end(),
                                     [&](const Answer& other) { return other.key == one.key; });
    double nearest = count > 1 ? kFarthest : HUGE_VAL;
    std::size_t partner = after.size();
    for (std::size_t b = 0; b < after.size(); ++b) {
      if (after[b].key != one.key || taken[b]) continue;
      double distance = std::abs(std::log(mark_of(after[b]) / mark_of(one)));
      if (!std::isfinite(distance)) distance = 0;
      if (distance < nearest) nearest = distance, partner = b;
    }
    if (partner < after.size()) taken[partner] = true;
    pairs.push_back({&one, partner < after.size() ? &after[partner] : nullptr});
  }
  for (std::size_t b = 0; b < after.size(); ++b) {
    if (!taken[b]) pairs.push_back({nullptr, &after[b]});
  }
  return pairs;
}

struct Change {
  double value = Answer::kNone, std = Answer::kNone, relative = Answer::kNone;
  std::string verdict;
  bool changed = false;
};

Change change_of(const Pair& pair) {
  Change change;
  if (!pair.before || !pair.after) {
    change.verdict = pair.before ? "only before" : "only after";
    if (pair.one().verdict == "doubtful mode") change.verdict += ", a doubtful mode";
    return change;
  }
  const bool known = pair.before->determined && pair.after->determined;
  const double a = pair.before->value, b = pair.after->value;
  change.value = b - a;
  change.relative = b / a - 1;
  change.std = std::hypot(pair.before->std, pair.after->std);
  if (!known) {
    change.verdict = "not determined in one of them";
  } else if (!(change.std > 0)) {
    change.verdict = "uncertainty not known";
  } else {
    const double ratio = std::abs(change.value) / change.std;
    change.changed = ratio >= kSurely;
    change.verdict = ratio < kPerhaps  ? "no change beyond its uncertainty"
                     : ratio < kSurely ? "perhaps changed"
                                       : "changed";
  }
  return change;
}

/// The quantity; a mode by its frequency before, as its number depends on what else was found.
std::string quantity_of(const Pair& pair) {
  const Answer& one = pair.before ? *pair.before : *pair.after;
  if (!std::isfinite(one.mode_hz)) return quantity_words(one);
  return fmt::format("{}, mode near {} Hz", one.quantity.substr(0, one.quantity.rfind(' ')),
                     shown(one.mode_hz, 3));
}

std::string shown_side(const Answer* answer) { return answer ? value_words(*answer) : "–"; }

Json side_json(const Answer* answer) {
  if (!answer) return nullptr;
  return describe::json_of(signal::Estimate{answer->value, answer->std});
}

/// The change for the first page.
Answer answer_of(const Pair& pair, const Change& change) {
  Answer answer;
  answer.key = pair.after->key;
  answer.quantity = quantity_of(pair);
  answer.how = fmt::format("{} before, {} after", shown_side(pair.before), shown_side(pair.after));
  answer.percent = pair.after->percent;
  answer.unit = pair.after->unit;
  answer.value = change.value;
  answer.std = change.std;
  answer.verdict = change.verdict + (std::isfinite(change.relative)
                                         ? fmt::format(" ({})", shown_percent(change.relative))
                                         : std::string());
  answer.anchor = "comparison";
  answer.rank = change.changed ? 0 : 1;
  return answer;
}

}  // namespace

ReportPart compare_reports(const ComparedReport& before, const ComparedReport& after) {
  ReportPart part;
  part.id = "comparison";
  part.title = "Before and after";
  part.json_key = "comparison";
  const auto head = [](const char* side, const ComparedReport& report) {
    std::string text = std::string(side) + ": " + report.file;
    if (!report.date.empty()) text += ", " + report.date;
    if (!report.revision.empty()) text += ", revision " + report.revision;
    return Column{std::move(text)};
  };
  ReportTable table{
      "comparison-values",
      fmt::format("Before: {}. After: {}. Changed: the difference is three of its standard "
                  "uncertainties or more; perhaps changed: between 1.96 and three, as one value in "
                  "twenty is by chance.",
                  before.title, after.title),
      {{"quantity", {}, false},
       {"unit", {}, false},
       head("before", before),
       head("after", after),
       {"change"},
       {"relative"},
       {"verdict", {}, false}}};
  Json list = Json::array();
  std::size_t changed = 0, compared = 0;
  for (const auto& pair : pairs_of(before.answers, after.answers)) {
    const Change change = change_of(pair);
    const Answer& one = pair.one();
    const double scale = one.percent ? 100 : 1;
    Cell verdict(change.verdict);
    verdict.doubtful = change.changed;
    table.rows.push_back(
        {quantity_of(pair), shown_unit(one), shown_side(pair.before), shown_side(pair.after),
         std::isfinite(change.value) ? shown_estimate(scale * change.value, scale * change.std)
                                     : std::string("–"),
         shown_percent(change.relative), std::move(verdict)});
    list.push_back({{"key", one.key},
                    {"quantity", quantity_of(pair)},
                    {"unit", one.unit.empty() ? "1" : one.unit},
                    {"before", side_json(pair.before)},
                    {"after", side_json(pair.after)},
                    {"change", describe::number_json(change.value)},
                    {"change_std", describe::number_json(change.std)},
                    {"relative_change", describe::number_json(change.relative)},
                    {"changed", change.changed},
                    {"verdict", change.verdict}});
    if (!pair.before || !pair.after) continue;
    ++compared;
    changed += change.changed;
    part.answers.push_back(answer_of(pair, change));
  }
  part.summary.push_back({SummaryItem::Kind::result, "Changed",
                          fmt::format("{} of {} compared", changed, counted(compared, "value"))});
  part.brief = {table.id};
  part.blocks.push_back(std::move(table));
  part.json = std::move(list);
  return part;
}

}  // namespace rigfit::apps
