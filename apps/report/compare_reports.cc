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

/// A value before, after, or both, and what became of it.
struct Change {
  const Answer* before = nullptr;
  const Answer* after = nullptr;
  double value = Answer::kNone, std = Answer::kNone, relative = Answer::kNone;
  std::string verdict = {};
  bool changed = false;

  [[nodiscard]] bool both() const { return before && after; }
  [[nodiscard]] const Answer& one() const { return after ? *after : *before; }

  /// The quantity; a mode by its frequency before, as its number depends on what else was found.
  [[nodiscard]] std::string quantity() const {
    const Answer& named = before ? *before : *after;
    if (!std::isfinite(named.mode_hz)) return quantity_words(named);
    return fmt::format("{}, mode near {} Hz", named.quantity.substr(0, named.quantity.rfind(' ')),
                       shown(named.mode_hz, 3));
  }
  static constexpr auto fields() {
    using T = Change;
    using describe::field;
    constexpr auto side = [](const Answer* const T::*one) {
      return [one](const T& change) {
        const Answer* a = change.*one;
        return a ? std::optional(signal::Estimate{a->value, a->std}) : std::nullopt;
      };
    };
    return std::tuple{field("key", [](const T& change) { return change.one().key; }),
                      field("quantity", &T::quantity),
                      field("unit", [](const T& change) { return unit_of(change.one()); }),
                      field("before", side(&T::before)),
                      field("after", side(&T::after)),
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

std::string shown_side(const Answer* answer) { return answer ? value_words(*answer) : "–"; }

/// The change for the first page.
Answer answer_of(const Change& change) {
  const std::string relative =
      std::isfinite(change.relative) ? fmt::format(" ({})", shown_percent(change.relative)) : "";
  return {.key = change.after->key,
          .quantity = change.quantity(),
          .how = fmt::format("{} before, {} after", shown_side(change.before),
                             shown_side(change.after)),
          .unit = change.after->unit,
          .value = change.value,
          .std = change.std,
          .anchor = "comparison",
          .verdict = change.verdict + relative,
          .rank = change.changed ? 0 : 1};
}

}  // namespace

Json comparison_schema() { return describe::schema_of<std::vector<Change>>(); }

ReportPart compare_reports(const ComparedReport& before, const ComparedReport& after) {
  ReportPart part;
  part.id = "comparison";
  part.title = "Before and after";
  part.json_key = "comparison";
  const auto head = [](const std::string& side, const Campaign& campaign) {
    std::string text = side + ": " + std::filesystem::path(campaign.file).filename().string();
    if (const auto& date = campaign.report.date; !date.empty()) text += ", " + date;
    if (const auto& one = campaign.report.revision; !one.empty()) text += ", revision " + one;
    return Column{std::move(text)};
  };
  ReportTable table{
      "comparison-values",
      fmt::format("Before: {}. After: {}. Changed: the difference is three of its standard "
                  "uncertainties or more; perhaps changed: between 1.96 and three, as one value in "
                  "twenty is by chance.",
                  before.campaign.title, after.campaign.title),
      {{"quantity", {}, false},
       {"unit", {}, false},
       head("before", before.campaign),
       head("after", after.campaign),
       {"change"},
       {"relative"},
       {"verdict", {}, false}}};
  std::size_t changed = 0;
  const auto changes = changes_of(before.answers, after.answers);
  for (const auto& change : changes) {
    const Answer& one = change.one();
    Cell verdict(change.verdict);
    verdict.doubtful = change.changed;
    table.rows.push_back({change.quantity(), std::string(describe::shown_unit(one.unit).name),
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
