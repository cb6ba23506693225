#include "signal/recording/recording.h"

#include <algorithm>
#include <charconv>

#include "signal/recording/recording_error.h"
#include "signal/recording/units.h"

namespace rigfit::signal {

Eigen::Index Recording::channel_index(const std::string& name) const {
  Eigen::Index index = -1;
  const auto look_for = [&](auto&& matches) {
    const auto at = std::find_if(channels.begin(), channels.end(), matches);
    if (index < 0 && at != channels.end()) index = at - channels.begin();
  };
  look_for([&](const Channel& c) { return c.name == name; });
  look_for([&](const Channel& c) { return lower_case(c.name) == lower_case(name); });
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
    look_for([&](const Channel& c) { return lower_case(c.name) == lower_case(titled.name); });
  }
  if (index >= 0) return index;
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
  for (const auto& channel : channels) names.push_back(channel.name);
  return listed(names);
}

}  // namespace rigfit::signal
