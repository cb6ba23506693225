#include "apps/report/plot.h"

#include <fmt/format.h>

#include <cmath>

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
  const auto cell = [](double value) {
    return std::isfinite(value) ? fmt::format("{}", value) : std::string();
  };
  std::string text =
      fmt::format("series,origin,{},{},low,high\n", quoted(plot.x_label), quoted(plot.y_label));
  for (const auto& series : plot.series) {
    for (std::size_t i = 0; i < series.x.size(); ++i) {
      text += fmt::format("{},{},{},{},{},{}\n", quoted(series.name), word_of(series.origin),
                          cell(series.x[i]), cell(series.y[i]),
                          i < series.low.size() ? cell(series.low[i]) : "",
                          i < series.high.size() ? cell(series.high[i]) : "");
    }
  }
  return text;
}

}  // namespace rigfit::apps
