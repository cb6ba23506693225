#include "apps/report/page/share_bars.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "apps/report/drawing/html_text.h"
#include "apps/report/drawing/label_places.h"

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

// Of one hue, lightness falling evenly: in order for every reader and in grey (Brewer, Hatchard and
// Harrower, ColorBrewer's "Blues", Cartogr. Geogr. Inf. Sci. 30 (2003) 5).
constexpr std::array<std::array<double, 3>, 9> kLightToDark{{{247, 251, 255},
                                                             {222, 235, 247},
                                                             {198, 219, 239},
                                                             {158, 202, 225},
                                                             {107, 174, 214},
                                                             {66, 146, 198},
                                                             {33, 113, 181},
                                                             {8, 81, 156},
                                                             {8, 48, 107}}};

struct Field {
  std::string colour;
  const char* ink;  ///< black or white, whichever stands out more
};

Field field_of(double value) {
  const double at = value * static_cast<double>(kLightToDark.size() - 1);
  const std::size_t from = std::min(static_cast<std::size_t>(at), kLightToDark.size() - 2);
  std::string colour = "#";
  double luminance = 0;  // WCAG 2
  constexpr std::array<double, 3> kWeights{0.2126, 0.7152, 0.0722};
  for (std::size_t k = 0; k < 3; ++k) {
    const double part = std::round(std::lerp(kLightToDark[from][k], kLightToDark[from + 1][k],
                                             at - static_cast<double>(from)));
    colour += fmt::format("{:02x}", static_cast<int>(part));
    const double c = part / 255;
    luminance += kWeights[k] * (c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4));
  }
  // Contrast with white over that with black: 1.05 / (Y + 0.05) against (Y + 0.05) / 0.05.
  return {colour, 1.05 * 0.05 > (luminance + 0.05) * (luminance + 0.05) ? "#fff" : "#000"};
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
          "<rect class=\"frame\" x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"20\" "
          "fill=\"{}\" stroke=\"#555\">"
          "<title>{}: {:.0f} %</title></rect>\n",
          x, y + 2, width, colour, escaped(source), 100 * share);
      if (width > 34) {
        body += fmt::format(
            "<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"middle\" fill=\"{}\" "
            "font-size=\"11\">{:.0f} %"
            "</text>\n",
            x + 0.5 * width, y + 16, colour == kSources[0] ? "#fff" : "#000", 100 * share);
      }
      x += width;
    }
    y += kRow;
  }
  double x = 12;
  y += 22;
  for (std::size_t i = 0; i < sources.size(); ++i) {
    const double width = 34 + text_width(sources[i], 12);
    if (x + width > kBarsWidth && x > 12) {
      x = 12;
      y += 20;
    }
    body += fmt::format(
        "<rect class=\"frame\" x=\"{:.1f}\" y=\"{:.1f}\" width=\"14\" height=\"12\" fill=\"{}\" "
        "stroke=\"#555\"/>\n",
        x, y - 11, kSources[i % kSources.size()]);
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
  constexpr double kName = 76, kTop = 56, kWidth = 520;
  constexpr Eigen::Index kMostWritten = 24;  // columns whose fields are wide enough for a number
  const double field = std::clamp(
      (kWidth - kName - 20) / static_cast<double>(std::max<Eigen::Index>(values.cols(), 1)),
      values.cols() > kMostWritten ? 12.0 : 30.0, 40.0);
  const double height = std::min(field, 24.0);
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
      const double value = std::isfinite(values(i, j)) ? std::clamp(values(i, j), 0.0, 1.0) : 0.0;
      picture.csv += fmt::format("{},{},{}\n", csv_quoted(rows[static_cast<std::size_t>(i)]),
                                 csv_quoted(columns[static_cast<std::size_t>(j)]), values(i, j));
      const Field drawn = field_of(value);
      body += fmt::format(
          "<rect class=\"frame\" x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\" "
          "fill=\"{}\" stroke=\"#bbb\"/>\n",
          x, y, field, height, drawn.colour);
      if (field < 28) continue;
      body += fmt::format(
          "<text fill=\"{}\" x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"middle\" "
          "font-size=\"11\">{:.2f}</text>\n",
          drawn.ink, x + 0.5 * field, y + 0.5 * height + 4, values(i, j));
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
