#include "signal/recording/recording.h"

#include <algorithm>
#include <cctype>
#include <charconv>

#include "signal/recording/recording_error.h"
#include "signal/recording/units.h"

namespace rigfit::signal {
namespace {

bool same_ignoring_case(const std::string& a, const std::string& b) {
  return a.size() == b.size() && std::equal(a.begin(), a.end(), b.begin(), [](char x, char y) {
           return std::tolower(static_cast<unsigned char>(x)) ==
                  std::tolower(static_cast<unsigned char>(y));
         });
}

}  // namespace

Eigen::Index Recording::channel_index(const std::string& name) const {
  Eigen::Index index = -1;
  const auto look_for = [&](auto&& matches) {
    const auto at = std::find_if(channels.begin(), channels.end(), matches);
    if (index < 0 && at != channels.end()) index = at - channels.begin();
  };
  look_for([&](const Channel& c) { return c.name == name; });
  look_for([&](const Channel& c) { return same_ignoring_case(c.name, name); });
  // "acc" of "run.acc", where there is one.
  const auto ends = [&](const Channel& c) { return c.name.ends_with("." + name); };
  if (std::count_if(channels.begin(), channels.end(), ends) == 1) look_for(ends);
  long number = 0;
  const char* const end = name.data() + name.size();
  if (index < 0 && name.starts_with('#') &&
      std::from_chars(name.data() + 1, end, number).ptr == end && number >= 1 &&
      number <= static_cast<long>(channels.size())) {
    index = number - 1;
  }
  // The title as the file writes it, "Force [N]", names the channel "Force" too.
  const TitledUnit titled = split_title(name);
  if (!titled.unit.empty() && titled.name != name) {
    look_for([&](const Channel& c) { return same_ignoring_case(c.name, titled.name); });
  }
  if (index >= 0) return index;
  const std::string known = listed_names(channels);
  throw RecordingError({path.string(), 0, 0, name, ""}, "no channel of that name",
                       "the recording has " + (known.empty() ? "none" : known) +
                           "; a channel may also be given by its place as \"#1\", \"#2\" ...");
}

namespace {

template <typename Items, typename NameOf>
std::string list_of(const Items& items, NameOf&& name_of) {
  std::string text;
  for (std::size_t k = 0; k < std::min(items.size(), kMostListed); ++k) {
    text += (k == 0 ? "\"" : ", \"") + name_of(items[k]) + "\"";
  }
  return items.size() > kMostListed ? text + ", ... (" + std::to_string(items.size()) + " in all)"
                                    : text;
}

}  // namespace

std::string listed(const std::vector<std::string>& names) {
  return list_of(names, [](const std::string& name) { return name; });
}

std::string listed_names(const std::vector<Channel>& channels) {
  return list_of(channels, [](const Channel& channel) { return channel.name; });
}

}  // namespace rigfit::signal
