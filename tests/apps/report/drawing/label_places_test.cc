// Labels of a drawing: as near as they can be, over nothing else.
#include "apps/report/drawing/label_places.h"

#include <gtest/gtest.h>

#include <vector>

namespace rigfit::apps::label_places_test {
namespace {

using Eigen::Vector2d;

// Twenty sensors 24 px apart on a line: every label lies beside the line and the marks and over no
// other label.
TEST(LabelPlaces, KeepOffMarksLinesAndEachOther) {
  LabelPlaces places({0, 0, 500, 120});
  places.add_line({10, 60}, {490, 60});
  std::vector<PaperBox> taken;
  std::vector<Vector2d> marks;
  marks.reserve(20);
  for (int k = 0; k < 20; ++k) marks.emplace_back(20 + 24 * k, 60);
  for (const auto& mark : marks) {
    taken.push_back(box_around(mark, mark, 6));
    places.add_mark(taken.back());
  }
  const Vector2d size(text_width("S10", 13), 17);
  for (const auto& mark : marks) {
    const auto box = places.place(size, centres_around(mark, size));
    ASSERT_TRUE(box);
    for (const auto& other : taken) EXPECT_FALSE(overlap(*box, other));
    EXPECT_TRUE(box->bottom <= 60 || box->top >= 60) << "on the line";
    taken.push_back(*box);
  }
}

TEST(LabelPlaces, LeaveOutWhatHasNoRoom) {
  LabelPlaces places({0, 0, 100, 100});
  places.add_mark({0, 0, 100, 100});
  const Vector2d size(20, 17);
  EXPECT_FALSE(places.place(size, centres_around({50, 50}, size)));
}

TEST(BrokenIntoLines, KeepsWordsWhole) {
  const auto lines = broken_into_lines("left cable mid-span: acceleration, y", 13, 150);
  ASSERT_GE(lines.size(), 2u);
  std::string again;
  for (const auto& line : lines) {
    EXPECT_LE(text_width(line, 13), 150);
    again += (again.empty() ? "" : " ") + line;
  }
  EXPECT_EQ(again, "left cable mid-span: acceleration, y");
}

}  // namespace
}  // namespace rigfit::apps::label_places_test
