#include "apps/report/figures/hit_gallery.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iterator>

#include "apps/report/drawing/html_text.h"
#include "apps/report/drawing/palette.h"

namespace rigfit::apps {
namespace {

using Eigen::Index;

/// One hit and the force around it.
struct ShownHit {
  const signal::Hit* hit = nullptr;
  std::size_t number = 0;  ///< in its place, from 1
  std::string title;
  std::vector<double> time_ms, force;  ///< from the pulse's begin; offset removed, pulse upwards
};

/// From before the pulse to after a second contact, where there is one.
void take_force(ShownHit& shown_hit, const signal::Recording& recording, Index channel, int sign) {
  const signal::Hit& hit = *shown_hit.hit;
  const auto& samples = recording.channels[static_cast<std::size_t>(channel)].samples;
  const double rate = recording.sample_rate_hz;
  const Index width = std::max<Index>(hit.pulse_last - hit.pulse_first + 1, 4);
  Index first = hit.pulse_first - 2 * width, last = hit.pulse_last + 4 * width;
  if (hit.second_hit > 0) {
    const auto second =
        hit.peak_sample + static_cast<Index>(std::lround(hit.second_hit_delay_s * rate));
    first = std::min(first, second - 2 * width);
    last = std::max(last, second + 2 * width);
  }
  first = std::max<Index>(first, 0);
  last = std::min<Index>(last, samples.size() - 1);
  const Index every = 1 + (last - first) / 400;
  for (Index i = first; i <= last; i += every) {
    // The largest of the samples passed over: a pulse is not lost.
    double force = samples[i];
    for (Index k = i; k < std::min(i + every, last + 1); ++k) {
      if (std::abs(samples[k] - hit.offset) > std::abs(force - hit.offset)) force = samples[k];
    }
    shown_hit.time_ms.push_back(1e3 * static_cast<double>(i - hit.pulse_first) / rate);
    shown_hit.force.push_back(sign * (force - hit.offset));
  }
}

std::vector<ShownHit> hits_of(const std::vector<ident::StruckPlace>& places,
                              const ident::HammerTest& test, std::size_t most) {
  std::vector<ShownHit> all;
  for (const bool accepted : {false, true}) {
    for (std::size_t p = 0; p < test.tests.size() && p < places.size(); ++p) {
      const auto& search = test.tests[p].search;
      for (std::size_t h = 0; h < search.hits.size() && all.size() < most; ++h) {
        const auto& hit = search.hits[h];
        if (hit.accepted != accepted || hit.recording >= places[p].recordings.size()) continue;
        const auto& recording = places[p].recordings[hit.recording];
        const Index channel = recording.channel_index(test.force);
        ShownHit one;
        one.hit = &hit;
        one.number = h + 1;
        one.title = places[p].name.empty() ? fmt::format("hit {}", h + 1)
                                           : fmt::format("{}, hit {}", places[p].name, h + 1);
        take_force(one, recording, channel, search.sign);
        all.push_back(std::move(one));
      }
    }
  }
  return all;
}

/// Words in lines of at most so many characters.
std::vector<std::string> wrapped(const std::string& text, std::size_t width, std::size_t most) {
  std::vector<std::string> lines;
  std::size_t at = 0;
  while (at < text.size() && lines.size() < most) {
    std::size_t end = std::min(at + width, text.size());
    if (end < text.size()) {
      const auto blank = text.rfind(' ', end);
      if (blank != std::string::npos && blank > at) end = blank;
    }
    lines.push_back(text.substr(at, end - at));
    at = end;
    while (at < text.size() && text[at] == ' ') ++at;
  }
  if (at < text.size() && !lines.empty()) lines.back() += " …";
  return lines;
}

constexpr double kWidth = 236, kHeight = 190, kPlotHeight = 96;

std::string cell(const ShownHit& one, double left, double top, Origin origin,
                 const std::string& unit) {
  const bool accepted = one.hit->accepted;
  const double x0 = left + 10, x1 = left + kWidth - 10, y0 = top + 26 + kPlotHeight, y1 = top + 26;
  const double from = one.time_ms.front(), to = one.time_ms.back();
  const auto [low, high] = std::minmax_element(one.force.begin(), one.force.end());
  const double bottom = std::min(0.0, *low), height = std::max(*high - bottom, 1e-300);
  std::string path;
  for (std::size_t i = 0; i < one.force.size(); ++i) {
    if (!std::isfinite(one.force[i])) continue;
    path += fmt::format("{}{:.1f} {:.1f}", path.empty() ? "M" : "L",
                        x0 + (x1 - x0) * (one.time_ms[i] - from) / std::max(to - from, 1e-300),
                        y0 - (y0 - y1) * (one.force[i] - bottom) / (1.05 * height));
  }
  const Origin ink = accepted ? origin : Origin::modelled;
  std::string svg = fmt::format(
      "<rect class=\"frame\" x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\" "
      "fill=\"none\" stroke=\"#888\"{}/>\n",
      x0, y1, x1 - x0, y0 - y1, accepted ? "" : " stroke-dasharray=\"4 3\"");
  svg += fmt::format(
      "<path class=\"o-{} line\" d=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"1.5\"{}/>\n",
      word_of(ink), path, colour_of(ink), accepted ? "" : " stroke-dasharray=\"5 2\"");
  const auto text = [&](double x, double y, const char* anchor, const std::string& words,
                        bool bold) {
    svg += fmt::format(
        "<text class=\"t\" x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"{}\" "
        "fill=\"#222\"{}>{}</text>\n",
        x, y, anchor, bold ? " font-weight=\"bold\"" : "", escaped(words));
  };
  text(x0, top + 18, "start", one.title, true);
  text(x1, top + 18, "end", fmt::format("{} {}", shown(std::abs(one.hit->peak), 3), unit), false);
  text(x0, y0 + 14, "start", fmt::format("{:.3g} ms", from), false);
  text(x1, y0 + 14, "end", fmt::format("{:.3g} ms", to), false);
  double y = y0 + 30;
  const std::string reason =
      accepted ? (one.hit->reason.empty() ? "accepted" : "kept: " + one.hit->reason)
               : "rejected: " + one.hit->reason;
  for (const auto& line : wrapped(reason, 36, 3)) {
    text(x0, y, "start", line, !accepted && y == y0 + 30);
    y += 14;
  }
  return svg;
}

}  // namespace

Picture hit_gallery(const std::string& id, const std::vector<ident::StruckPlace>& places,
                    const ident::HammerTest& test, Origin origin, std::size_t most) {
  Picture picture;
  picture.id = id;
  picture.title = "Hits and why they were kept or rejected";
  const auto hits = hits_of(places, test, most);
  const std::size_t all = test.hits(), accepted = test.accepted_hits();
  picture.caption = fmt::format(
      "The force of each hit about its pulse. {} of {} hits accepted{}. Rejected hits are broken "
      "lines and come first.",
      accepted, all, all > hits.size() ? fmt::format("; {} are shown", hits.size()) : "");
  const std::size_t columns = std::min<std::size_t>(4, std::max<std::size_t>(hits.size(), 1));
  const std::size_t rows = (hits.size() + columns - 1) / columns;
  picture.width = kWidth * static_cast<double>(columns);
  picture.height = kHeight * static_cast<double>(std::max<std::size_t>(rows, 1));
  picture.csv = "hit,accepted,reason,time_ms,force\n";
  std::string body;
  for (std::size_t i = 0; i < hits.size(); ++i) {
    if (hits[i].force.empty()) continue;
    body += cell(hits[i], kWidth * static_cast<double>(i % columns),
                 kHeight * static_cast<double>(i / columns), origin, test.force_unit);
    std::string reason;
    for (const char c : hits[i].hit->reason)
      reason += c == '"' ? std::string("\"\"") : std::string(1, c);
    for (std::size_t k = 0; k < hits[i].force.size(); ++k) {
      if (!std::isfinite(hits[i].force[k])) continue;
      fmt::format_to(std::back_inserter(picture.csv), "\"{}\",{},\"{}\",{},{}\n", hits[i].title,
                     hits[i].hit->accepted, reason, hits[i].time_ms[k], hits[i].force[k]);
    }
  }
  picture.svg = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {0:g} {1:g}\" width=\"{0:g}\" "
      "height=\"{1:g}\" role=\"img\" font-family=\"sans-serif\" "
      "font-size=\"11\">\n<title>{2}</title>\n"
      "<desc>{3}</desc>\n{4}</svg>\n",
      picture.width, picture.height, escaped(picture.title), escaped(picture.caption), body);
  return picture;
}

}  // namespace rigfit::apps
