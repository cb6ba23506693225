// Places of labels on a drawing: near what they name, and over nothing else that is drawn or
// written.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace rigfit::apps {

/// Axis-parallel, in pixels; y grows downwards.
struct PaperBox {
  double left = 0, top = 0, right = 0, bottom = 0;
};

[[nodiscard]] bool overlap(const PaperBox& a, const PaperBox& b);
[[nodiscard]] PaperBox box_around(const Eigen::Vector2d& a, const Eigen::Vector2d& b,
                                  double margin);

/// Width in pixels that a line of UTF-8 text takes at most in the common sans-serif fonts: the
/// advance widths of DejaVu Sans, the widest of them, by class of character.
[[nodiscard]] double text_width(std::string_view text, double font_size);

/// The words of a line broken into lines that are no wider than `width` pixels.
[[nodiscard]] std::vector<std::string> broken_into_lines(const std::string& text, double font_size,
                                                         double width);

class LabelPlaces {
 public:
  explicit LabelPlaces(const PaperBox& paper) : paper_(paper) {}

  /// Nothing is written over a mark; over a line only where no other place is free.
  void add_mark(const PaperBox& box) { marks_.push_back(box); }
  void add_line(const Eigen::Vector2d& from, const Eigen::Vector2d& to);
  [[nodiscard]] bool covers_mark(const PaperBox& box) const;

  /// Takes the first free one of the centres, in pixels; none where all are taken.
  [[nodiscard]] std::optional<PaperBox> place(const Eigen::Vector2d& size,
                                              std::span<const Eigen::Vector2d> centres);

 private:
  PaperBox paper_;
  std::vector<PaperBox> marks_, lines_;
};

/// Centres of a label around a point, nearest first, above and to the right first.
[[nodiscard]] std::vector<Eigen::Vector2d> centres_around(const Eigen::Vector2d& point,
                                                          const Eigen::Vector2d& size);

}  // namespace rigfit::apps
