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
  const auto find = [&](auto&& matches) {
    const auto at = std::find_if(channels.begin(), channels.end(), matches);
    return at == channels.end() ? Eigen::Index{-1} : Eigen::Index{at - channels.begin()};
  };
  Eigen::Index index = find([&](const Channel& c) { return c.name == name; });
  if (index < 0) index = find([&](const Channel& c) { return same_ignoring_case(c.name, name); });
  if (index < 0 && name.size() > 1 && name.front() == '#') {
    long number = 0;
    const auto [end, error] = std::from_chars(name.data() + 1, name.data() + name.size(), number);
    if (error == std::errc() && end == name.data() + name.size() && number >= 1 &&
        number <= static_cast<long>(channels.size())) {
      index = number - 1;
    }
  }
  if (index < 0) {
    // The title as the file writes it, "Force [N]", names the channel "Force" too.
    const TitledUnit titled = split_title(name);
    if (!titled.unit.empty() && titled.name != name) {
      index = find([&](const Channel& c) { return same_ignoring_case(c.name, titled.name); });
    }
  }
  if (index >= 0) return index;
  std::string known;
  for (std::size_t k = 0; k < channels.size(); ++k) {
    known += (k == 0 ? "" : ", ") + ("\"" + channels[k].name + "\"");
    if (k == 19 && channels.size() > 20) {
      known += ", ... (" + std::to_string(channels.size()) + " in all)";
      break;
    }
  }
  throw RecordingError({path.string(), 0, 0, name, ""}, "no channel of that name",
                       "the recording has " + (known.empty() ? "none" : known) +
                           "; a channel may also be given by its place as \"#1\", \"#2\" ...");
}

}  // namespace rigfit::signal
