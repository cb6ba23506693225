#include "signal/recording/recording.h"

#include <algorithm>
#include <charconv>
#include <functional>
#include <iterator>
#include <vector>

#include "signal/recording/recording_error.h"
#include "signal/recording/units.h"

namespace rigfit::signal {

Eigen::Index Recording::channel_index(const std::string& name) const {
  const auto lower = [](const std::string& text) { return lower_case(text); };
  const auto at = [&](const std::string& wanted, auto&& as) {
    return std::ranges::find(channels, as(wanted), [&](const Channel& c) { return as(c.name); });
  };
  // As it is written, in any case, and as the title in the file, "Force [N]", names "Force".
  auto found = at(name, std::identity{});
  if (found == channels.end()) found = at(name, lower);
  if (found == channels.end()) found = at(split_title(name).name, lower);
  // "acc" of "run.acc", where there is one.
  const auto ends = [&](const Channel& c) { return c.name.ends_with("." + name); };
  if (found == channels.end() && std::ranges::count_if(channels, ends) == 1) {
    found = std::ranges::find_if(channels, ends);
  }
  if (found != channels.end()) return found - channels.begin();
  long number = 0;
  const char* const end = name.data() + name.size();
  if (name.starts_with('#') && std::from_chars(name.data() + 1, end, number).ptr == end &&
      number >= 1 && number <= std::ssize(channels)) {
    return number - 1;
  }
  const std::string known = listed_names(channels);
  throw RecordingError({path.string(), 0, 0, name, ""}, "no channel of that name",
                       "the recording has " + (known.empty() ? "none" : known) +
                           "; a channel may also be given by its place as \"#1\", \"#2\" ...");
}

std::string listed(const std::vector<std::string>& names) {
  std::string text;
  for (std::size_t k = 0; k < std::min(names.size(), kMostListed); ++k) {
    text += (k == 0 ? "\"" : ", \"") + names[k] + "\"";
  }
  return names.size() > kMostListed ? text + ", ... (" + std::to_string(names.size()) + " in all)"
                                    : text;
}

std::string listed_names(const std::vector<Channel>& channels) {
  std::vector<std::string> names;
  names.reserve(channels.size());
  for (const auto& channel : channels) names.push_back(channel.name);
  return listed(names);
}

}  // namespace rigfit::signal
