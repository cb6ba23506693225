#include "apps/report/campaign_report.h"

#include "apps/describe/sheet.h"
#include "apps/report/drawing/html_text.h"
#include "signal/numerics/numbers.h"

namespace rigfit::apps {
namespace {

constexpr double kPerhaps = 1.96, kSurely = 3;  // standard uncertainties of the difference
constexpr double kFarthest = 0.15;  // log of the ratio of two values that may be the same mode

/// What a value is recognised by among others of its key: the frequency of its mode, or itself.
double mark_of(const Answer& answer) {
  return std::isfinite(answer.mode_hz) ? answer.mode_hz : answer.value;
}

struct Change;
std::string quantity_of(const Change& change);

/// A value before, after, or both, and what became of it.
struct Change {
  const Answer* before = nullptr;
  const Answer* after = nullptr;
  double value = Answer::kNone, std = Answer::kNone, relative = Answer::kNone;
  std::string verdict = {};
  bool changed = false;

  [[nodiscard]] bool both() const { return before && after; }
  [[nodiscard]] const Answer& one() const { return after ? *after : *before; }

  [[nodiscard]] const std::string& key() const { return one().key; }
  [[nodiscard]] std::string unit() const { return unit_of(one()); }
  using Side = std::optional<signal::Estimate>;
  static Side side(const Answer* a) {
    return a ? Side(signal::Estimate{a->value, a->std}) : Side();
  }
  [[nodiscard]] Side side_before() const { return side(before); }
  [[nodiscard]] Side side_after() const { return side(after); }
  static constexpr auto fields() {
    using T = Change;
    using describe::field;
    return std::tuple{field("key", &T::key),
                      field("quantity", quantity_of),
                      field("unit", &T::unit),
                      field("before", &T::side_before),
                      field("after", &T::side_after),
                      field("change", &T::value),
                      field("change_std", &T::std, "", "", "both independent"),
                      field("relative_change", &T::relative),
                      field("changed", &T::changed),
                      field("verdict", &T::verdict)};
  }
};

Change change_of(const Answer* before, const Answer* after) {
  Change change{before, after};
  if (!change.both()) {
    change.verdict = before ? "only before" : "only after";
    if (change.one().verdict == "doubtful mode") change.verdict += ", a doubtful mode";
    return change;
  }
  change.value = after->value - before->value;
  change.relative = after->value / before->value - 1;
  change.std = std::hypot(before->std, after->std);
  const double ratio = std::abs(change.value) / change.std;
  const bool known = before->determined && after->determined;
  change.changed = known && change.std > 0 && ratio >= kSurely;
  change.verdict = !known              ? "not determined in one of them"
                   : !(change.std > 0) ? "uncertainty not known"
                   : ratio < kPerhaps  ? "no change beyond its uncertainty"
                   : ratio < kSurely   ? "perhaps changed"
                                       : "changed";
  return change;
}

/// Each value before with the nearest one after of its key (a key may have several, such as the
/// modes of a state); then the lonely ones.
std::vector<Change> changes_of(const std::vector<Answer>& before,
                               const std::vector<Answer>& after) {
  std::vector<Change> changes;
  std::vector<bool> taken(after.size(), false);
  for (const auto& one : before) {
    double nearest = std::ranges::count(before, one.key, &Answer::key) > 1 ? kFarthest : HUGE_VAL;
    std::size_t partner = after.size();
    for (std::size_t b = 0; b < after.size(); ++b) {
      if (after[b].key != one.key || taken[b]) continue;
      double distance = std::abs(std::log(mark_of(after[b]) / mark_of(one)));
      if (!std::isfinite(distance)) distance = 0;
      if (distance < nearest) nearest = distance, partner = b;
    }
    if (partner < after.size()) taken[partner] = true;
    changes.push_back(change_of(&one, partner < after.size() ? &after[partner] : nullptr));
  }
  for (std::size_t b = 0; b < after.size(); ++b) {
    if (!taken[b]) changes.push_back(change_of(nullptr, &after[b]));
  }
  return changes;
}

/// The quantity; a mode by its frequency before, as its number depends on what else was found.
std::string quantity_of(const Change& change) {
  const Answer& one = change.before ? *change.before : *change.after;
  if (!std::isfinite(one.mode_hz)) return quantity_words(one);
  return fmt::format("{}, mode near {} Hz", one.quantity.substr(0, one.quantity.rfind(' ')),
                     shown(one.mode_hz, 3));
}

std::string shown_side(const Answer* answer) { return answer ? value_words(*answer) : "–"; }

/// The change for the first page.
Answer answer_of(const Change& change) {
  Answer answer;
  answer.key = change.after->key;
  answer.quantity = quantity_of(change);
  answer.how =
      fmt::format("{} before, {} after", shown_side(change.before), shown_side(change.after));
  answer.unit = change.after->unit;
  answer.value = change.value;
  answer.std = change.std;
  answer.verdict = change.verdict;
  if (std::isfinite(change.relative)) {
    answer.verdict += fmt::format(" ({})", shown_percent(change.relative));
  }
  answer.anchor = "comparison";
  answer.rank = change.changed ? 0 : 1;
  return answer;
}

}  // namespace

Json comparison_schema() { return describe::schema_of<std::vector<Change>>(); }

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
  std::size_t changed = 0;
  const auto changes = changes_of(before.answers, after.answers);
  for (const auto& change : changes) {
    const Answer& one = change.one();
    Cell verdict(change.verdict);
    verdict.doubtful = change.changed;
    table.rows.push_back({quantity_of(change), std::string(describe::shown_unit(one.unit).name),
                          shown_side(change.before), shown_side(change.after),
                          with_signs(describe::estimate_text(change.value, change.std, one.unit)),
                          shown_percent(change.relative), std::move(verdict)});
    if (!change.both()) continue;
    changed += change.changed;
    part.answers.push_back(answer_of(change));
  }
  part.summary.push_back(
      {SummaryItem::Kind::result, "Changed",
       fmt::format("{} of {} compared", changed, counted(part.answers.size(), "value"))});
  part.brief = {table.id};
  part.blocks.push_back(std::move(table));
  part.json = describe::json_of(changes);
  return part;
}

}  // namespace rigfit::apps
