#include "ident/statistics/probability_text.h"

#include <gtest/gtest.h>

#include <cmath>

namespace rigfit::ident::probability_text_test {
namespace {

TEST(ProbabilityText, HasTwoDigitsAndALeastValue) {
  EXPECT_EQ(probability_text(0.01234), "0.012");
  EXPECT_EQ(probability_text(2e-6), "2e-06");
  EXPECT_EQ(probability_text(9.9e-146), "below 1e-6");
  EXPECT_EQ(probability_text(0), "below 1e-6");
  EXPECT_EQ(probability_text(std::nan("")), "-");
  EXPECT_EQ(p_text(1), "p = 1");
  EXPECT_EQ(p_text(0), "p below 1e-6");
}

}  // namespace
}  // namespace rigfit::ident::probability_text_test
