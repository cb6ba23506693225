#include "apps/cli/warning_lines.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

namespace rigfit::apps {
namespace {

constexpr auto kAnswerMayBeWrong = std::to_array<std::string_view>({
    "model_ruled_out",   "not_identifiable", "not_converged",  "not_decided",    "outside_bounds",
    "below_catalogue",   "cross-plane",      "hits_disagree",  "clamp_slip",     "clipped",
    "no_unit",           "unscaled",         "rates_disagree", "unit_suspected", "length_suspected",
    "time_axis",         "at_bound",         "extrapolated",   "curved",         "unpaired",
    "systematic_misfit",
});
constexpr std::array<std::string_view, 1> kTakenAsSaid = {"taken_as_exact"};
// What was done, in normal operation: reading, choosing, leaving out with a reason.
constexpr auto kNotes = std::to_array<std::string_view>(
    {"decay_cut_off", "decaying_offset", "double_hit_hidden", "doubtful_mode", "fitted_in_band",
     "force_window_chosen", "friction", "hits_rejected", "left_out", "mains_hum", "modes_beside",
     "read_as", "remark", "start_chosen", "thermal_expansion", "toe", "uff_remark",
     "universal_file", "window_damping"});

struct Kind {
  std::string_view code;
  std::vector<const Finding*> all;
};

std::vector<Kind> kinds_of(std::span<const Finding> warnings) {
  std::vector<Kind> kinds;
  for (const auto& warning : warnings) {
    auto same = std::find_if(kinds.begin(), kinds.end(),
                             [&](const Kind& one) { return one.code == warning.code; });
    if (same == kinds.end()) same = kinds.insert(kinds.end(), Kind{warning.code, {}});
    same->all.push_back(&warning);
  }
  std::stable_sort(kinds.begin(), kinds.end(), [](const Kind& a, const Kind& b) {
    return level_of(a.code) < level_of(b.code);
  });
  return kinds;
}

std::string line_of(const Kind& kind) {
  const Finding& first = *kind.all.front();
  const std::size_t more = kind.all.size() - 1;
  bool alike = true;
  std::vector<std::string_view> places;
  for (const Finding* one : kind.all) {
    alike &= one->message == first.message;
    const std::string& where = one->where;
    if (!where.empty() && std::find(places.begin(), places.end(), where) == places.end()) {
      places.emplace_back(where);
    }
  }
  const bool by_itself = more == 0 || !alike;
  if (by_itself) std::erase(places, std::string_view(first.where));
  constexpr std::size_t kShown = 4;
  std::string list;
  for (std::size_t k = 0; k < std::min(kShown, places.size()); ++k) {
    list += k == 0 ? "" : ", ";
    list += places[k];
  }
  if (places.size() > kShown) list += " ...";
  if (!by_itself) {
    return fmt::format("{} times: {}{}", more + 1, first.message,
                       list.empty() ? "" : " (" + list + ")");
  }
  std::string line = (first.where.empty() ? "" : first.where + ": ") + first.message;
  if (more > 0) {
    line += fmt::format(" (and {} more of this kind{}{})", more, list.empty() ? "" : ": ", list);
  }
  return line;
}

}  // namespace

Level level_of(std::string_view code) {
  const auto in = [&](const auto& list) {
    return std::find(list.begin(), list.end(), code) != list.end();
  };
  return in(kAnswerMayBeWrong) ? Level::answer_may_be_wrong
         : in(kTakenAsSaid)    ? Level::taken_as_said
         : in(kNotes)          ? Level::note
                               : Level::look_at;
}

std::vector<std::string> warning_lines(std::span<const Finding> warnings, std::size_t most) {
  const std::vector<Kind> kinds = kinds_of(warnings);
  const std::size_t shown = std::min(most, kinds.size());
  std::vector<std::string> lines;
  for (std::size_t k = 0; k < shown; ++k) lines.push_back(line_of(kinds[k]));
  std::size_t others = 0;
  for (std::size_t k = shown; k < kinds.size(); ++k) others += kinds[k].all.size();
  if (others > 0) {
    lines.push_back(fmt::format("{} more of {} other kinds: --verbose prints them", others,
                                kinds.size() - shown));
  }
  return lines;
}

}  // namespace rigfit::apps
