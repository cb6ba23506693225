#include "signal/recording/units.h"

#include "tests/test.h"

namespace rigfit::signal::units_test {

// Spellings of one unit share a row. A superscript may be UTF-8 read as Latin-1, Latin-1, or lost.
TEST(Units, UsualSpellings) {
  using enum Quantity;
  constexpr double kG = 9.80665, kPound = 4.4482216152605;
  const struct {
    const char* si;
    double factor;
    Quantity quantity;
    std::vector<const char*> texts;
  } units[] = {
      {"m/s^2", 1, acceleration, {"m/s2", "m/s^2", "m/s**2", "m/s\u00B2", "m/s\u00C2\u00B2"}},
      {"m/s^2", 1, acceleration, {"m/s\xB2", "m/s\uFFFD", "m/s/s", "ms2", "ms-2", "m.s^-2"}},
      {"m/s^2", 1, acceleration, {"m\u00B7s\u207B\u00B2"}},
      {"m/s^2", 1e-3, acceleration, {"[mm/s^2]"}},
      {"m/s^2", 1e-2, acceleration, {"cm/s2", "Gal"}},
      {"m/s^2", kG, acceleration, {"g", "G", "gn"}},
      {"m/s^2", 1e-3 * kG, acceleration, {"mg"}},
      {"N", 1, force, {"N", "Newtons"}},
      {"N", 1e3, force, {"(kN)", "KN"}},
      {"N", kG, force, {"kgf"}},
      {"N", kPound, force, {"lbf", "lbs"}},
      {"m", 1e-3, displacement, {"mm", "MM"}},
      {"m", 1e-6, displacement, {"\u00B5m"}},
      {"m", 0.0254, displacement, {"in"}},
      {"m/s", 1e-3, velocity, {"mm/s"}},
      {"V", 1, voltage, {"V"}},
      {"V", 1e-3, voltage, {"mV"}},
      {"V", 1e6, voltage, {"MV"}},
      {"rad", kPi / 180, angle, {"deg", "\u00B0"}},
      {"rad/s", 1, angular_velocity, {"rad/s"}},
      {"rad/s", kPi / 180, angular_velocity, {"deg/s", "\u00B0/s"}},
      {"rad/s", kPi / 30, angular_velocity, {"rpm"}},
      {"N m", 1, torque, {"Nm"}},
      {"N m", 1e-3, torque, {"N*mm"}},
      {"N m", 1e3, torque, {"kN m"}},
      {"Pa", 1, pressure, {"Pa"}},
      {"Pa", 1e6, pressure, {"MPa", "N/mm2"}},
      {"Pa", 6894.757293168361, pressure, {"psi"}},
      {"1", 1e-6, strain, {"um/m", "\u00B5strain"}},
      {"Hz", 1, unknown, {"Hz"}},
      {"Hz", 1e3, unknown, {"kHz"}},
      {"s", 1e-3, time, {"ms"}},
      {"kg", 1e-3, unknown, {"grams"}},
      {"m", 1e-2, displacement, {"centimeters"}},
      {"s", 1, time, {"sec"}},
      {"1/kg", kG, unknown, {"g/N"}},
      {"1/kg", 1, unknown, {"(m/s^2)/N"}},
  };
  for (const auto& [si, factor, quantity, texts] : units) {
    for (const char* text : texts) {
      const auto unit = parse_unit(text);
      ASSERT_TRUE(unit) << text;
      EXPECT_EQ(unit->si, si) << text;
      EXPECT_NEAR(unit->factor / factor, 1, 1e-14) << text;  // a few roundings of doubles
      EXPECT_EQ(unit->quantity, quantity) << text;
      EXPECT_EQ(unit->offset, 0) << text;
    }
  }
}

TEST(Units, TemperaturesHaveAnOffset) {
  for (const char* text : {"degC", "\u00B0C",
                           "\xB0"
                           "C",
                           "Celsius", "Deg C", "\u2103"}) {
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
               {"Acc m/s^2", "Acc", "m/s^2"},
               {"Acc/m/s^2", "Acc", "m/s^2"},
               {"Stress N/mm^2", "Stress", "N/mm^2"},
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
  EXPECT_EQ(to_utf8("a\tb"), "a b");
  EXPECT_THAT(to_utf8("\xED\xA0\x80"), Not(HasSubstr("\xED")));  // a surrogate is not UTF-8
}

}  // namespace rigfit::signal::units_test
