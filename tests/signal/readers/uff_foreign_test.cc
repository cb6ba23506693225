// Universal files as other programs write them: every kind of function, unit and channel, and what
// is said of those that cannot be taken.
#include "signal/readers/read_recording.h"
#include "signal/readers/uff58.h"
#include "signal/writers/writers.h"
#include "tests/signal/readers/reading.h"
#include "tests/test.h"

namespace rigfit::signal::uff_foreign_test {

struct Axis {
  int type = 0;
  std::string label = "NONE", unit = "NONE";
};

/// One dataset 58 as text; an FRF in m/s^2 per N from 1 Hz in steps of 1 Hz unless told.
struct Dataset {
  int type = 4;     ///< type of the function
  int numbers = 5;  ///< 2 and 4: real; 5 and 6: complex
  int spacing = 1;  ///< 1: even
  int response = 1, response_direction = 2, reference = 5, reference_direction = 2;
  double start = 1, step = 1;
  Axis abscissa{18, "Frequency", "Hz"}, ordinate{12, "Acceleration", "m/s^2"},
      denominator{13, "Force", "N"};
  std::vector<std::string> values{"1", "2", "3", "4", "5", "6"};

  [[nodiscard]] std::string text() const {
    const auto per_value = static_cast<std::size_t>((numbers >= 5 ? 2 : 1) + (spacing == 0));
    std::string out = fmt::format("    -1\n    58\nNONE\nNONE\nNONE\nNONE\nNONE\n");
    out +=
        fmt::format("{:5d}{:10d}{:5d}{:10d} {:<10s}{:10d}{:4d} {:<10s}{:10d}{:4d}\n", type, 0, 0, 0,
                    "NONE", response, response_direction, "NONE", reference, reference_direction);
    out += fmt::format("{:10d}{:10d}{:10d}{:13.6e}{:13.6e}{:13.6e}\n", numbers,
                       values.size() / per_value, spacing, start, step, 0.0);
    for (const Axis& a : {abscissa, ordinate, denominator, Axis{}}) {
      out +=
          fmt::format("{:10d}{:5d}{:5d}{:5d} {:<20s} {:<20s}\n", a.type, 0, 0, 0, a.label, a.unit);
    }
    for (std::size_t k = 0; k < values.size(); ++k) {
      out += fmt::format("{:>{}s}", values[k], numbers == 2 || numbers == 5 ? 13 : 20);
      if ((k + 1) % per_value == 0) out += '\n';
    }
    return out + "    -1\n";
  }
};

Dataset time_history(std::vector<std::string> values) {
  Dataset d;
  d.type = 1;
  d.numbers = 2;
  d.start = 0;
  d.step = 1e-3;
  d.abscissa = {17, "Time", "s"};
  d.denominator = {};
  d.values = std::move(values);
  return d;
}

RecordingError frf_error(const std::string& text) {
  return error_of([&] { return read_uff_frfs(text, "x.uff"); });
}

TEST(UffForeign, QuantitiesComeFromDataTypesWhereUnitsAreUnknown) {
  const std::pair<int, Quantity> kinds[] = {
      {3, Quantity::strain}, {5, Quantity::temperature}, {8, Quantity::displacement},
      {9, Quantity::force},  {11, Quantity::velocity},   {12, Quantity::acceleration},
      {13, Quantity::force}, {15, Quantity::pressure},   {17, Quantity::time},
      {1, Quantity::unknown}};
  for (const auto& [type, quantity] : kinds) {
    Dataset d = time_history({"1", "2", "3"});
    d.ordinate = {type, "what", "furlong"};
    const Recording r = read_uff(d.text(), "x.uff");
    EXPECT_EQ(r.channels[0].quantity, quantity) << type;
    EXPECT_EQ(r.channels[0].samples[2], 3);
    EXPECT_TRUE(says(r.notes, "unknown_unit"));
  }
}

TEST(UffForeign, ChannelsOfAnotherLengthAreLeftOutAndSaid) {
  const Dataset one = time_history({"1", "2", "3", "4", "5"});
  Dataset two = time_history({"6", "7", "8"});
  two.response = 2;
  two.ordinate.label = "short";
  const Recording r = read_uff(one.text() + two.text(), "x.uff");
  ASSERT_EQ(r.channels.size(), 1u);
  EXPECT_EQ(r.samples(), 5);
  ASSERT_THAT(codes(r.notes), ElementsAre("data_left_out"));
  EXPECT_THAT(r.notes[0].where, HasSubstr("short (line"));
}

TEST(UffForeign, FunctionsThatAreNoTimeHistoriesAreNamed) {
  for (const auto& [type, name] : {std::pair<int, const char*>{0, "general function"},
                                   {4, "frequency response function"},
                                   {12, "spectrum"},
                                   {13, "function of another type"}}) {
    Dataset d;
    d.type = type;
    const auto alone = error_of([&] { return read_uff(d.text(), "x.uff"); });
    EXPECT_THAT(alone.problem(), ::testing::EndsWith(std::string("but: ") + name));
    EXPECT_EQ(alone.where().line, 2);
    const Recording r = read_uff(d.text() + time_history({"1", "2"}).text(), "x.uff");
    ASSERT_EQ(r.channels.size(), 1u);
    ASSERT_THAT(codes(r.notes), ElementsAre("left_out"));
    EXPECT_THAT(r.notes[0].message, HasSubstr(name));
  }
}

TEST(UffForeign, UnevenTimesThatAreMissingAndUnknownSpacingAreRefused) {
  Dataset d = time_history({"0", "1", "NaN", "2", "0.3", "3", "0.9", "4"});
  d.spacing = 0;
  const auto missing = error_of([&] { return read_uff(d.text(), "x.uff"); });
  EXPECT_THAT(missing.problem(), HasSubstr("the time is missing"));
  EXPECT_EQ(missing.where().value, "sample 2");
  d.spacing = 2;
  const auto spacing = error_of([&] { return read_uff(d.text(), "x.uff"); });
  EXPECT_EQ(spacing.problem(), "unknown spacing of the abscissa");
  EXPECT_EQ(spacing.where().line, 9);
  EXPECT_EQ(spacing.where().value, "2");
}

TEST(UffForeign, FormsAndUnitsOfFrfs) {
  struct Case {
    Axis ordinate, denominator;
    FrfForm form;
    std::string unit;
    double factor;
  };
  const Case cases[] = {
      {{8, "d", "mm"}, {13, "F", "kN"}, FrfForm::receptance, "(m)/N", 1e-6},
      {{11, "v", "m/s"}, {13, "F", "N"}, FrfForm::mobility, "(m/s)/N", 1},
      {{0, "a", "m/s2/N"}, {}, FrfForm::accelerance, "(m/s^2)/N", 1},
      {{12, "a", "g"}, {13, "F", "NONE"}, FrfForm::accelerance, "(m/s^2)/N", 9.80665},
      {{8, "d", "furlong"}, {13, "F", "N"}, FrfForm::receptance, "", 1},
      {{11, "v", "furlong/s"}, {13, "F", "N"}, FrfForm::mobility, "", 1},
      {{12, "a", "furlong"}, {13, "F", "N"}, FrfForm::accelerance, "", 1},
      {{0, "x", "furlong"}, {13, "F", "N"}, FrfForm::unknown, "", 1}};
  for (const auto& c : cases) {
    Dataset d;
    d.ordinate = c.ordinate;
    d.denominator = c.denominator;
    const FrfSet f = read_uff_frfs(d.text(), "x.uff");
    EXPECT_EQ(f.form, c.form) << c.ordinate.unit;
    EXPECT_EQ(f.unit, c.unit) << c.ordinate.unit;
    EXPECT_NEAR(std::abs(f.H(1, 0) - c.factor * Complex(3, 4)), 0, 1e-15 * c.factor);
    EXPECT_EQ(f.frequency_hz[2], 3);
  }
}

TEST(UffForeign, FrequenciesAreTakenInTheirUnit) {
  Dataset d;
  d.abscissa = {18, "omega", "rad/s"};
  EXPECT_NEAR(read_uff_frfs(d.text(), "x.uff").frequency_hz[2], 3 / (2 * kPi), 1e-15);
  for (const auto& [unit, hz] : {std::pair{"kHz", 1e3}, {"rpm", 1 / 60.0}, {"orders", 1.0}}) {
    d.abscissa.unit = unit;
    const FrfSet f = read_uff_frfs(d.text(), "x.uff");
    EXPECT_NEAR(f.frequency_hz[2], 3 * hz, 1e-12);
    EXPECT_EQ(says(f.notes, "no_unit"), hz == 1);
  }
}

TEST(UffForeign, ZerosThatFillTheLastLineAreNoValues) {
  std::string text = time_history({"1", "2", "4"}).text();
  const auto end = text.rfind("    -1");
  EXPECT_EQ(read_uff(text.insert(end, "  0.0  0.0\n"), "x.uff").samples(), 3);
  EXPECT_THROW((void)read_uff(text.insert(end, "  1.0\n"), "x.uff"), RecordingError);
}

TEST(UffForeign, FrfsThatDoNotFitEachOtherSayWhich) {
  const Dataset first;  // 17 lines long: a second one begins in line 18, its number is in line 19
  Dataset d;
  d.step = 0;
  EXPECT_EQ(frf_error(d.text()).problem(), "the frequencies do not rise");
  d = {};
  const auto twice = frf_error(first.text() + d.text());
  EXPECT_EQ(twice.problem(), "is a second FRF from \"5+Y\" to \"1+Y\"");
  EXPECT_EQ(twice.where().line, 19);
  d.response = 2;
  d.step = 1.5;
  EXPECT_EQ(frf_error(first.text() + d.text()).problem(),
            "has other frequencies than the first FRF");
  d.step = 1;
  d.ordinate = {8, "d", "m"};
  EXPECT_THAT(frf_error(first.text() + d.text()).problem(), HasSubstr("another form"));
  d = {};
  d.response = 2, d.reference = 6;
  EXPECT_EQ(frf_error(first.text() + d.text()).problem(), "no FRF from \"6+Y\" to \"1+Y\"");
  d = {};
  d.values[2] = "NaN";
  EXPECT_EQ(frf_error(d.text()).problem(), "an FRF holds values that are no numbers");
}

TEST(UffForeign, WhatIsNoNumberAtRestOrInCoherenceIsLeftOut) {
  Dataset mobility;
  mobility.start = 0;
  mobility.values[0] = "NaN";
  Dataset coherence = mobility;
  coherence.type = 6, coherence.numbers = 2;
  coherence.values = {"NaN", "0.5", "0.75"};
  const FrfSet f = read_uff_frfs(mobility.text() + coherence.text(), "x.uff");
  EXPECT_TRUE(says(f.notes, "data_left_out"));
  ASSERT_EQ(f.frequency_hz.size(), 2);
  EXPECT_EQ(f.frequency_hz[0], 1);
  EXPECT_EQ(f.H(0, 0), Complex(3, 4));
  ASSERT_EQ(f.coherence.rows(), 2);
  EXPECT_EQ(f.coherence(1, 0), 0.75);

  coherence.values[1] = "NaN";
  const FrfSet without = read_uff_frfs(mobility.text() + coherence.text(), "x.uff");
  EXPECT_TRUE(says(without.notes, "not_a_number"));
  EXPECT_EQ(without.coherence.size(), 0);

  Dataset other = mobility;
  other.response = 2;
  const FrfSet some = read_uff_frfs(mobility.text() + other.text() + coherence.text(), "x.uff");
  EXPECT_TRUE(says(some.notes, "incomplete"));
  EXPECT_EQ(some.coherence.size(), 0);
}

}  // namespace rigfit::signal::uff_foreign_test
