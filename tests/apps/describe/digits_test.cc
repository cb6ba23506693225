#include "apps/describe/sheet.h"

#include <gtest/gtest.h>

#include <cmath>

namespace rigfit::apps::digits_test {
namespace {

TEST(Digits, TwoOfTheUncertaintyAndTheValueToTheSamePlace) {
  struct Case {
    double value, std;
    const char *shown, *shown_std;
  };
  for (const Case& c :
       {Case{205187.6, 343.7, "205190", "340"},
        Case{0.009999934, 7.7e-7, "0.00999993", "0.00000077"},
        Case{7.280687, 0.0041, "7.2807", "0.0041"}, Case{3.95e6, 1.8e5, "3950000", "180000"},
        Case{0.5, 0.0996, "0.50", "0.10"}, Case{-12.345, 1.0, "-12.3", "1.0"},
        Case{3.2e-14, 1.1e-15, "3.20e-14", "1.1e-15"}, Case{2.07e11, 3.1e9, "2.070e+11", "3.1e+09"},
        Case{1.5, 0, "1.5", "0"}}) {
    EXPECT_EQ(value_digits(c.value, c.std), c.shown);
    EXPECT_EQ(std_digits(c.std), c.shown_std);
  }
  EXPECT_EQ(value_digits(NAN, 1), "-");
  EXPECT_EQ(value_digits(1.23456789, NAN), "1.23457");
  EXPECT_EQ(std_digits(INFINITY), "-");
}

}  // namespace
}  // namespace rigfit::apps::digits_test
