#include "signal/recording/units.h"

#include "tests/test.h"

namespace rigfit::signal::units_test {
namespace {

struct Case {
  const char* text;
  const char* si;
  double factor;
  Quantity quantity;
};

TEST(Units, UsualSpellings) {
  constexpr double kG = 9.80665, kPi = std::numbers::pi;
  // A superscript in UTF-8 read as Latin-1, in Latin-1, and lost, too.
  const Case cases[] = {{"m/s2", "m/s^2", 1, Quantity::acceleration},
                        {"m/s^2", "m/s^2", 1, Quantity::acceleration},
                        {"m/s**2", "m/s^2", 1, Quantity::acceleration},
                        {"m/s\u00B2", "m/s^2", 1, Quantity::acceleration},
                        {"m/s\u00C2\u00B2", "m/s^2", 1, Quantity::acceleration},
                        {"m/s\xB2", "m/s^2", 1, Quantity::acceleration},
                        {"m/s\uFFFD", "m/s^2", 1, Quantity::acceleration},
                        {"m/s/s", "m/s^2", 1, Quantity::acceleration},
                        {"ms-2", "m/s^2", 1, Quantity::acceleration},
                        {"m.s^-2", "m/s^2", 1, Quantity::acceleration},
                        {"m\u00B7s\u207B\u00B2", "m/s^2", 1, Quantity::acceleration},
                        {"[mm/s^2]", "m/s^2", 1e-3, Quantity::acceleration},
                        {"cm/s2", "m/s^2", 1e-2, Quantity::acceleration},
                        {"Gal", "m/s^2", 1e-2, Quantity::acceleration},
                        {"g", "m/s^2", kG, Quantity::acceleration},
                        {"G", "m/s^2", kG, Quantity::acceleration},
                        {"gn", "m/s^2", kG, Quantity::acceleration},
                        {"mg", "m/s^2", 1e-3 * kG, Quantity::acceleration},
                        {"N", "N", 1, Quantity::force},
                        {"(kN)", "N", 1e3, Quantity::force},
                        {"KN", "N", 1e3, Quantity::force},
                        {"Newtons", "N", 1, Quantity::force},
                        {"kgf", "N", kG, Quantity::force},
                        {"lbf", "N", 4.4482216152605, Quantity::force},
                        {"lbs", "N", 4.4482216152605, Quantity::force},
                        {"mm", "m", 1e-3, Quantity::displacement},
                        {"MM", "m", 1e-3, Quantity::displacement},
                        {"\u00B5m", "m", 1e-6, Quantity::displacement},
                        {"in", "m", 0.0254, Quantity::displacement},
                        {"mm/s", "m/s", 1e-3, Quantity::velocity},
                        {"V", "V", 1, Quantity::voltage},
                        {"mV", "V", 1e-3, Quantity::voltage},
                        {"MV", "V", 1e6, Quantity::voltage},
                        {"deg", "rad", kPi / 180, Quantity::angle},
                        {"\u00B0", "rad", kPi / 180, Quantity::angle},
                        {"rad/s", "rad/s", 1, Quantity::angular_velocity},
                        {"deg/s", "rad/s", kPi / 180, Quantity::angular_velocity},
                        {"\u00B0/s", "rad/s", kPi / 180, Quantity::angular_velocity},
                        {"rpm", "rad/s", kPi / 30, Quantity::angular_velocity},
                        {"Nm", "N m", 1, Quantity::torque},
                        {"N*mm", "N m", 1e-3, Quantity::torque},
                        {"kN m", "N m", 1e3, Quantity::torque},
                        {"Pa", "Pa", 1, Quantity::pressure},
                        {"MPa", "Pa", 1e6, Quantity::pressure},
                        {"psi", "Pa", 6894.757293168361, Quantity::pressure},
                        {"N/mm2", "Pa", 1e6, Quantity::pressure},
                        {"um/m", "1", 1e-6, Quantity::strain},
                        {"\u00B5strain", "1", 1e-6, Quantity::strain},
                        {"Hz", "Hz", 1, Quantity::unknown},
                        {"kHz", "Hz", 1e3, Quantity::unknown},
                        {"ms", "s", 1e-3, Quantity::time},
                        {"sec", "s", 1, Quantity::time},
                        {"g/N", "1/kg", kG, Quantity::unknown},
                        {"(m/s^2)/N", "1/kg", 1, Quantity::unknown}};
  for (const auto& c : cases) {
    const auto unit = parse_unit(c.text);
    ASSERT_TRUE(unit) << c.text;
    EXPECT_EQ(unit->si, c.si) << c.text;
    // A few roundings of doubles.
    EXPECT_NEAR(unit->factor / c.factor, 1, 1e-14) << c.text;
    EXPECT_EQ(unit->quantity, c.quantity) << c.text;
    EXPECT_EQ(unit->offset, 0) << c.text;
  }
}

TEST(Units, InWords) {
  for (const auto& [text, factor] : {std::pair<const char*, double>{"grams", 1e-3},
                                     {"kilograms", 1},
                                     {"centimeters", 1e-2},
                                     {"Millimetres", 1e-3}}) {
    ASSERT_TRUE(parse_unit(text)) << text;
    EXPECT_DOUBLE_EQ(parse_unit(text)->factor, factor) << text;
  }
}

TEST(Units, TemperaturesHaveAnOffset) {
  for (const char* text : {"degC", "\u00B0C",
                           "\xB0"
                           "C",
                           "Celsius", "\u2103"}) {
    const auto unit = parse_unit(text);
    ASSERT_TRUE(unit) << text;
    EXPECT_EQ(unit->offset, 273.15) << text;
    EXPECT_EQ(unit->quantity, Quantity::temperature) << text;
  }
  const auto f = parse_unit("degF");
  ASSERT_TRUE(f);
  EXPECT_NEAR(212 * f->factor + f->offset, 373.15, 1e-12);
}

TEST(Units, WhatIsNoUnit) {
  for (const char* text : {"", " ", "-", "NONE", "EU", "counts", "hammer", "m/", "/s", "m//s", "m)",
                           "((m))", "m^9", "ch1", "Excitation (Trigger)"}) {
    EXPECT_FALSE(parse_unit(text)) << text;
  }
  EXPECT_FALSE(parse_unit(std::string(1000, 'm')));
}

TEST(Units, TitlesAreSplit) {
  const struct {
    const char *title, *name, *unit;
  } cases[] = {{"Force [N]", "Force", "N"},
               {"Force (kN)", "Force", "kN"},
               {"a (m/s^2)", "a", "m/s^2"},
               {"Load / kN", "Load", "kN"},
               {"Load, N", "Load", "N"},
               {"rate_gyro_V", "rate_gyro_V", "V"},
               {"time_s", "time_s", "s"},
               {"accel_m_s2", "accel_m_s2", "m/s2"},
               {"Excitation (Trigger)", "Excitation (Trigger)", ""},
               {"accel_x", "accel_x", ""},
               {"Load [counts]", "Load", "counts"},
               {"beam 0.45 m", "beam 0.45 m", ""},
               {"[N]", "[N]", ""},
               {"plain", "plain", ""}};
  for (const auto& c : cases) {
    const TitledUnit split = split_title(c.title);
    EXPECT_EQ(split.name, c.name) << c.title;
    EXPECT_EQ(split.unit, c.unit) << c.title;
  }
}

TEST(Units, TextBecomesUtf8) {
  EXPECT_EQ(to_utf8("m/s\u00B2"), "m/s\u00B2");
  EXPECT_EQ(to_utf8("m/s\xB2"), "m/s\u00B2");
  EXPECT_EQ(to_utf8("\x80"), "\u20AC");
  EXPECT_EQ(to_utf8("a\tb"), "a b");
  EXPECT_EQ(to_utf8("\xED\xA0\x80").find('\xED'), std::string::npos);  // a surrogate is not UTF-8
}

}  // namespace
}  // namespace rigfit::signal::units_test
