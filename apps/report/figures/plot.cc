#include "apps/report/figures/plot.h"

#include <fmt/compile.h>
#include <fmt/format.h>

#include <cmath>
#include <iterator>

namespace rigfit::apps {

const char* name_of(Origin origin) {
  switch (origin) {
    case Origin::measured:
      return "measured";
    case Origin::published:
      return "published test";
    case Origin::published_model:
      return "published model";
    case Origin::synthetic:
      return "synthetic";
    case Origin::modelled:
      return "rigfit model";
  }
  return "";
}

const char* word_of(Origin origin) {
  switch (origin) {
    case Origin::measured:
      return "measured";
    case Origin::published:
      return "published";
    case Origin::published_model:
      return "published-model";
    case Origin::synthetic:
      return "synthetic";
    case Origin::modelled:
      return "modelled";
  }
  return "";
}

std::string plot_csv(const Plot& plot) {
  const auto quoted = [](const std::string& text) {
    std::string result = "\"";
    for (const char c : text) result += c == '"' ? std::string("\"\"") : std::string(1, c);
    return result + "\"";
  };
  std::string text =
      fmt::format("series,origin,{},{},low,high\n", quoted(plot.x_label), quoted(plot.y_label));
  const auto out = std::back_inserter(text);
  const auto cell = [&](double value) {
    if (std::isfinite(value)) fmt::format_to(out, FMT_COMPILE("{}"), value);
  };
  for (const auto& series : plot.series) {
    const std::string head = fmt::format("{},{},", quoted(series.name), word_of(series.origin));
    for (std::size_t i = 0; i < series.x.size(); ++i) {
      text += head;
      cell(series.x[i]);
      text += ',';
      cell(series.y[i]);
      text += ',';
      if (i < series.low.size()) cell(series.low[i]);
      text += ',';
      if (i < series.high.size()) cell(series.high[i]);
      text += '\n';
    }
  }
  return text;
}

}  // namespace rigfit::apps
