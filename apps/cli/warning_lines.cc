#include "apps/cli/warning_lines.h"

namespace rigfit::apps {
namespace {

constexpr auto kAnswerMayBeWrong = std::to_array<std::string_view>({
    "model_ruled_out",   "not_identifiable", "not_converged",  "not_decided",    "outside_bounds",
    "below_catalogue",   "cross-plane",      "hits_disagree",  "clamp_slip",     "clipped",
    "no_unit",           "unscaled",         "rates_disagree", "unit_suspected", "length_suspected",
    "time_axis",         "at_bound",         "extrapolated",   "curved",         "unpaired",
    "systematic_misfit", "shapes_disagree",
});
// What was done, in normal operation: reading, choosing, leaving out with a reason.
constexpr auto kNotes = std::to_array<std::string_view>(
    {"decay_cut_off", "decaying_offset", "double_hit_hidden", "doubtful_mode", "fitted_in_band",
     "friction", "hits_rejected", "left_out", "modes_beside", "read_as", "remark", "resampled",
     "start_chosen", "thermal_expansion", "toe", "universal_file", "window_damping"});

/// Without the folders of a file.
std::string place_of(const std::string& where) {
  const auto slash = where.rfind('/', where.find(": "));
  return slash == std::string::npos ? where : where.substr(slash + 1);
}

}  // namespace

Level level_of(std::string_view code) {
  const auto in = [&](const auto& list) {
    return std::find(list.begin(), list.end(), code) != list.end();
  };
  return in(kAnswerMayBeWrong)      ? Level::answer_may_be_wrong
         : code == "taken_as_exact" ? Level::taken_as_said
         : in(kNotes)               ? Level::note
                                    : Level::look_at;
}

std::string FindingKind::listed() const {
  constexpr std::size_t kMost = 4;
  std::string list;
  for (std::size_t k = 0; k < std::min(kMost, places.size()); ++k) {
    list += (k > 0 ? "; " : "") + place_of(places[k]);
  }
  if (places.size() > kMost) list += fmt::format(" and {} more", places.size() - kMost);
  return list;
}

FindingKind* add(std::vector<FindingKind>& kinds, const Finding& one) {
  auto same = std::ranges::find_if(kinds, [&](const FindingKind& kind) {
    return !one.refused && !kind.first.refused && kind.first.code == one.code;
  });
  const bool begins = same == kinds.end();
  if (begins) same = kinds.insert(same, FindingKind{one});
  if (!begins) ++same->count;
  auto& places = same->places;
  if (!one.where.empty() && std::ranges::count(places, one.where) == 0) places.push_back(one.where);
  return begins ? &*same : nullptr;
}

void sort_by_level(std::vector<FindingKind>& kinds) {
  const auto rank = [](const FindingKind& one) {
    return one.first.refused ? -1 : static_cast<int>(level_of(one.first.code));
  };
  std::stable_sort(kinds.begin(), kinds.end(),
                   [&](const auto& a, const auto& b) { return rank(a) < rank(b); });
}

std::vector<std::string> warning_lines(std::span<const Finding> warnings, bool each) {
  std::vector<FindingKind> kinds;
  for (const auto& one : warnings) each ? kinds.push_back({one}) : void(add(kinds, one));
  sort_by_level(kinds);
  const std::size_t shown = each ? kinds.size() : std::min<std::size_t>(5, kinds.size());
  std::vector<std::string> lines;
  std::size_t others = 0;
  for (const auto& kind : kinds) {
    const auto& [code, message, where, refused] = kind.first;
    if (lines.size() == shown) {
      others += kind.count;
      continue;
    }
    auto& line = lines.emplace_back(where);
    if (!where.empty()) line += ": ";
    line += message;
    if (kind.count == 1) continue;
    line += fmt::format(" ({} of this kind, --verbose prints each{}{})", kind.count,
                        kind.places.empty() ? "" : ": ", kind.listed());
  }
  if (others > 0) {
    lines.push_back(fmt::format("{} more of {} other kinds: --verbose prints them", others,
                                kinds.size() - shown));
  }
  return lines;
}

}  // namespace rigfit::apps
