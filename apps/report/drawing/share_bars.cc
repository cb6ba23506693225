#include "apps/report/drawing/share_bars.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "apps/report/page/html_text.h"

namespace rigfit::apps {
namespace {

// Okabe and Ito's colours for what has no order (Okabe and Ito, Color Universal Design, 2008).
constexpr std::array<const char*, 8> kSources{"#0072b2", "#e69f00", "#009e73", "#cc79a7",
                                              "#56b4e9", "#d55e00", "#f0e442", "#999999"};
constexpr double kBarsWidth = 760;

std::string csv_quoted(const std::string& text) {
  std::string result = "\"";
  for (const char c : text) result += c == '"' ? std::string("\"\"") : std::string(1, c);
  return result + "\"";
}

std::string text_at(double x, double y, const char* anchor, const std::string& words) {
  return fmt::format(
      "<text class=\"t\" x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"{}\" fill=\"#222\">{}</text>\n", x,
      y, anchor, escaped(words));
}

std::string svg_of(const Picture& picture, const std::string& body) {
  return fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {0:g} {1:g}\" width=\"{0:g}\" "
      "height=\"{1:g}\" role=\"img\" font-family=\"sans-serif\" "
      "font-size=\"12\">\n<title>{2}</title>\n"
      "<desc>{3}</desc>\n{4}</svg>\n",
      picture.width, picture.height, escaped(picture.title), escaped(picture.caption), body);
}

}  // namespace

Picture share_bars(const std::string& id, const std::string& title, const std::string& caption,
                   const std::vector<ShareBar>& bars) {
  constexpr double kRow = 30, kName = 180, kValue = 190;
  Picture picture;
  picture.id = id;
  picture.title = title;
  picture.caption = caption;
  picture.csv = "quantity,source,size,share\n";
  std::vector<std::string> sources;  // in the order in which they come
  std::string body;
  double y = 6;
  for (const auto& bar : bars) {
    double sum = 0;
    for (const auto& part : bar.parts) sum += part.second;
    body += text_at(kName - 10, y + 17, "end", bar.name);
    body += text_at(kBarsWidth - kValue + 10, y + 17, "start", bar.value);
    double x = kName;
    for (const auto& [source, size] : bar.parts) {
      auto at = std::find(sources.begin(), sources.end(), source);
      if (at == sources.end()) at = sources.insert(at, source);
      const double share = sum > 0 ? size / sum : 0;
      picture.csv +=
          fmt::format("{},{},{},{}\n", csv_quoted(bar.name), csv_quoted(source), size, share);
      const double width = share * (kBarsWidth - kName - kValue);
      const auto colour =
          kSources[static_cast<std::size_t>(at - sources.begin()) % kSources.size()];
      body += fmt::format(
          "<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"20\" fill=\"{}\" "
          "stroke=\"#fff\">"
          "<title>{}: {:.0f} %</title></rect>\n",
          x, y + 2, width, colour, escaped(source), 100 * share);
      if (width > 34) {
        body += fmt::format(
            "<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"middle\" fill=\"{}\" "
            "font-size=\"11\">{:.0f} %"
            "</text>\n",
            x + 0.5 * width, y + 16,
            colour == kSources[0] || colour == kSources[5] ? "#fff" : "#000", 100 * share);
      }
      x += width;
    }
    y += kRow;
  }
  double x = 12;
  y += 22;
  for (std::size_t i = 0; i < sources.size(); ++i) {
    const double width = 34 + 6.8 * static_cast<double>(sources[i].size());
    if (x + width > kBarsWidth && x > 12) {
      x = 12;
      y += 20;
    }
    body +=
        fmt::format("<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"14\" height=\"12\" fill=\"{}\"/>\n", x,
                    y - 11, kSources[i % kSources.size()]);
    body += text_at(x + 20, y, "start", sources[i]);
    x += width;
  }
  picture.width = kBarsWidth;
  picture.height = y + 12;
  picture.svg = svg_of(picture, body);
  return picture;
}

Picture matrix_picture(const std::string& id, const std::string& title, const std::string& caption,
                       const Eigen::MatrixXd& values, const std::vector<std::string>& rows,
                       const std::vector<std::string>& columns) {
  constexpr double kName = 110, kTop = 64;
  const double field = std::clamp(
      (kBarsWidth - kName - 20) / static_cast<double>(std::max<Eigen::Index>(values.cols(), 1)),
      12.0, 54.0);
  const double height = std::min(field, 30.0);
  Picture picture;
  picture.id = id;
  picture.title = title;
  picture.caption = caption;
  picture.csv = "row,column,value\n";
  std::string body;
  for (Eigen::Index i = 0; i < values.rows(); ++i) {
    const double y = kTop + height * static_cast<double>(i);
    body += text_at(kName - 8, y + 0.5 * height + 4, "end", rows[static_cast<std::size_t>(i)]);
    for (Eigen::Index j = 0; j < values.cols(); ++j) {
      const double x = kName + field * static_cast<double>(j);
      const double value = std::clamp(values(i, j), 0.0, 1.0);
      picture.csv += fmt::format("{},{},{}\n", csv_quoted(rows[static_cast<std::size_t>(i)]),
                                 csv_quoted(columns[static_cast<std::size_t>(j)]), values(i, j));
      body += fmt::format(
          "<rect class=\"frame\" x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\" "
          "fill=\"#0c54d6\" fill-opacity=\"{:.2f}\" stroke=\"#bbb\"/>\n",
          x, y, field, height, 0.85 * value);
      if (field < 28) continue;
      const char* ink = value > 0.55 ? "fill=\"#fff\"" : "class=\"t\" fill=\"#222\"";
      body += fmt::format(
          "<text {} x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"middle\" "
          "font-size=\"11\">{:.2f}</text>\n",
          ink, x + 0.5 * field, y + 0.5 * height + 4, values(i, j));
    }
  }
  for (Eigen::Index j = 0; j < values.cols(); ++j) {
    body += fmt::format(
        "<text class=\"t\" transform=\"translate({:.1f} {:.1f}) rotate(-40)\" fill=\"#222\" "
        "font-size=\"11\">{}</text>\n",
        kName + field * (static_cast<double>(j) + 0.4), kTop - 6,
        escaped(columns[static_cast<std::size_t>(j)]));
  }
  picture.width = std::max(kName + field * static_cast<double>(values.cols()) + 60, 320.0);
  picture.height = kTop + height * static_cast<double>(values.rows()) + 12;
  picture.svg = svg_of(picture, body);
  return picture;
}

}  // namespace rigfit::apps
