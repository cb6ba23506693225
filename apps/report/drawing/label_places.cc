#include "apps/report/drawing/label_places.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace rigfit::apps {

using Eigen::Vector2d;

bool overlap(const PaperBox& a, const PaperBox& b) {
  return a.left < b.right && b.left < a.right && a.top < b.bottom && b.top < a.bottom;
}

PaperBox box_around(const Vector2d& a, const Vector2d& b, double margin) {
  return {std::min(a[0], b[0]) - margin, std::min(a[1], b[1]) - margin,
          std::max(a[0], b[0]) + margin, std::max(a[1], b[1]) + margin};
}

double text_width(std::string_view text, double font_size) {
  constexpr std::string_view kNarrow = " iIjlftr.,:;'|!()[]/-", kWide = "mwMW%@";
  double ems = 0;
  for (const char c : text) {
    if ((static_cast<unsigned char>(c) & 0xC0U) == 0x80U) continue;  // goes on with a character
    if (static_cast<unsigned char>(c) >= 0x80) {
      ems += 0.84;
    } else if (kNarrow.find(c) != std::string_view::npos) {
      ems += 0.41;
    } else if (kWide.find(c) != std::string_view::npos) {
      ems += 1.0;
    } else {
      ems += c >= 'A' && c <= 'Z' ? 0.79 : 0.64;
    }
  }
  return ems * font_size;
}

std::vector<std::string> broken_into_lines(const std::string& text, double font_size,
                                           double width) {
  std::vector<std::string> lines(1);
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find(' ', at), text.size());
    const std::string word = text.substr(at, end - at);
    std::string& line = lines.back();
    if (line.empty()) {
      line = word;
    } else if (text_width(line, font_size) + text_width(" ", font_size) +
                   text_width(word, font_size) <=
               width) {
      line.append(" ").append(word);
    } else {
      lines.push_back(word);
    }
    at = end + 1;
  }
  return lines;
}

void LabelPlaces::add_line(const Vector2d& from, const Vector2d& to) {
  // As a chain of boxes of 3 px, which a label of some 10 px cannot slip through.
  const int pieces = std::max(1, static_cast<int>((to - from).norm() / 3));
  for (int k = 0; k < pieces; ++k) {
    const Vector2d step = (to - from) / pieces;
    lines_.push_back(box_around(from + k * step, from + (k + 1) * step, 0.5));
  }
}

bool LabelPlaces::covers_mark(const PaperBox& box) const {
  return std::any_of(marks_.begin(), marks_.end(),
                     [&](const PaperBox& mark) { return overlap(mark, box); });
}

std::optional<PaperBox> LabelPlaces::place(const Vector2d& size,
                                           std::span<const Vector2d> centres) {
  for (const bool anywhere : {false, true}) {
    for (const auto& centre : centres) {
      const PaperBox box = box_around(centre - 0.5 * size, centre + 0.5 * size, 0);
      if (box.left < paper_.left || box.right > paper_.right || box.top < paper_.top ||
          box.bottom > paper_.bottom || covers_mark(box)) {
        continue;
      }
      if (!anywhere && std::any_of(lines_.begin(), lines_.end(),
                                   [&](const PaperBox& line) { return overlap(line, box); })) {
        continue;
      }
      marks_.push_back(box);
      return box;
    }
  }
  return std::nullopt;
}

std::vector<Vector2d> centres_around(const Vector2d& point, const Vector2d& size) {
  std::vector<Vector2d> centres;
  for (const double distance : {8.0, 14.0, 20.0, 28.0, 38.0, 50.0}) {
    for (const int eighth : {1, 3, 7, 5, 2, 6, 0, 4}) {
      const double angle = eighth * std::numbers::pi / 4;
      const Vector2d out(std::cos(angle), -std::sin(angle));
      const Vector2d side(std::abs(out[0]) < 0.1 ? 0 : std::copysign(1, out[0]),
                          std::abs(out[1]) < 0.1 ? 0 : std::copysign(1, out[1]));
      centres.emplace_back(point + distance * out + 0.5 * side.cwiseProduct(size));
    }
  }
  return centres;
}

}  // namespace rigfit::apps
