// Tables that can be taken for something else than they are: each is read rightly, asked about, or
// left with a note, never taken wrongly without a word.
#include "signal/readers/read_recording.h"
#include "signal/recording/recording_time.h"
#include "tests/signal/readers/reading.h"
#include "tests/test.h"

namespace rigfit::signal::wrong_readings_test {

Recording read(const std::string& text, const ReadOptions& options = {}) {
  return read_csv(text, "test.csv", options);
}

TEST(DecimalCommas, WhatCanBeReadInTwoWaysIsAskedAbout) {
  EXPECT_EQ(read("force,count\n1,5\n2,7\n9,2\n").channels.size(), 2u);
  EXPECT_THAT(refusal_of([] { return read("force\n1,05\n2,7\n3,2\n"); }), HasSubstr("decimal"));
  const std::string text = "1,5\n4,7\n3,2\n9,9\n";
  const RecordingError question = error_of([&] { return read(text); });
  EXPECT_THAT(question.what(), HasSubstr("may part columns of whole numbers or be decimal signs"));
  EXPECT_THAT(question.remedy(), HasSubstr("--decimal comma"));
  ReadOptions decimal;
  decimal.decimal = ',';
  ASSERT_EQ(read(text, decimal).channels.size(), 1u);
  EXPECT_EQ(read(text, decimal).channels[0].samples[1], 4.7);
  ReadOptions separator;
  separator.separator = ',';
  EXPECT_EQ(read(text, separator).channels.size(), 2u);
  // Whole numbers among them have no comma.
  EXPECT_THAT(refusal_of([] { return read("1,05\n2\n3,07\n"); }), HasSubstr("decimal"));
  // A sign behind the comma.
  EXPECT_EQ(read("1,-5\n4,7\n3,2\n").channels.size(), 2u);
}

TEST(DecimalCommas, InQuotesBeforeThreeDigitsAreAskedAbout) {
  const std::string text = "\"load (N)\",\"travel (um)\"\n\"0\",\"0\"\n\"20,938\",\"30,121\"\n";
  EXPECT_THAT(error_of([&] { return read(text); }).remedy(), HasSubstr("--decimal comma"));
  EXPECT_EQ(read(text, {.decimal = ','}).channels[0].samples[1], 20.938);
  EXPECT_EQ(read(text + "\"0,500\",\"0,100\"\n").channels[0].samples[1], 20.938);
}

TEST(Titles, ThatHoldBlanksStayWithTheirColumns) {
  // Parted by tabs, by wide gaps, with units in brackets: the table itself by blanks.
  for (const std::string title :
       {"Time\tForce 1 (N)\tDisplacement 1 (mm)", "Time   Force 1 (N)   Displacement 1 (mm)",
        "Time;Force 1 (N);Displacement 1 (mm)"}) {
    std::string text = title + "\n";
    for (int k = 0; k < 30; ++k) text += fmt::format("{:.3f}  {}.5  {}.25\n", 1e-3 * k, k, 2 * k);
    const auto recording = read(text);
    ASSERT_EQ(recording.channels.size(), 2u) << title;
    EXPECT_EQ(recording.channels[0].name, "Force 1");
    EXPECT_EQ(recording.channels[0].samples[3], 3.5);
    EXPECT_EQ(recording.channels[1].name, "Displacement 1");
    EXPECT_NEAR(recording.channels[1].samples[3], 6.25e-3, 1e-15);
    EXPECT_EQ(recording.sample_rate_hz, 1000);
  }
  const auto brackets = read("Time (s) Force (N)\n0.0 1.5\n0.1 2.5\n0.2 4.5\n");
  ASSERT_EQ(brackets.channels.size(), 1u);
  EXPECT_EQ(brackets.channels[0].name, "Force");
  EXPECT_EQ(brackets.channels[0].unit, "N");
}

TEST(Titles, ThatCannotBePartedNameNoColumn) {
  std::string text = "Time Displacement 1 Force 1\n";
  for (int k = 0; k < 30; ++k)
    text += fmt::format("{:.3f} {}.5 {}.25\n", 1e-3 * k, k * k, 2 * k * k);
  const auto recording = read(text);
  EXPECT_TRUE(says(recording.notes, "titles_not_matched"));
  ASSERT_EQ(recording.channels.size(), 2u);
  EXPECT_EQ(recording.channels[0].name, "column 2");
  EXPECT_EQ(recording.channels[1].name, "column 3");
  EXPECT_EQ(recording.sample_rate_hz, 1000);
}

TEST(Times, MassesOfAFewRowsAreNone) {
  const auto recording = read("0.5;0.12\n1.0;0.25\n1.5;0.36\n2.0;0.49\n2.5;0.61\n");
  EXPECT_EQ(recording.channels.size(), 2u);
  EXPECT_EQ(recording.sample_rate_hz, 0);
  EXPECT_TRUE(says(recording.notes, "assumed"));
}

TEST(Times, InWholeStepsShowRowsThatAreLostOrDoubled) {
  const auto table = [](double step, const std::vector<int>& lost, int doubled) {
    std::string text = "Time (ms);a (N)\n";
    for (int k = 0; k < 1000; ++k) {
      const std::string row = fmt::format("{:.0f};{}.5\n", k * step, k % 7);
      if (std::ranges::count(lost, k) == 0) text += row + (k == doubled ? row : "");
    }
    return read(text);
  };
  for (const auto& [lost, doubled] :
       {std::pair{std::vector{500}, -1}, {{300, 700}, -1}, {{100, 120, 700}, -1}, {{}, 500}}) {
    const auto recording = table(1, lost, doubled);
    EXPECT_TRUE(says(recording.notes, "time_axis")) << lost.size();
    EXPECT_NEAR(recording.sample_rate_hz, 1000, 0.01);
  }
  EXPECT_THAT(table(1, {500}, -1).notes[0].where, HasSubstr("line 502"));
  // No loss, also at a rate that whole milliseconds do not give.
  for (const double step : {1.0, 1 / 1.2, 1 / 0.97}) {
    const auto recording = table(step, {}, -1);
    EXPECT_FALSE(says(recording.notes, "time_axis")) << step;
    EXPECT_NEAR(recording.sample_rate_hz * step, 1000, 1) << step;
  }
}

TEST(Times, OfOtherChannelsAreNotTakenForAll) {
  const auto table = [](double step, double start) {
    std::string text = "Time 1 (s);a (N);Time 2 (s);b (N)\n";
    for (int k = 0; k < 30; ++k)
      text += fmt::format("{:.3f};{}.5;{:.3f};1.5\n", 0.01 * k, k % 7, start + step * k);
    return read(text);
  };
  for (const auto& other : {table(0.02, 0), table(0.01, 0.5)}) {
    EXPECT_TRUE(says(other.notes, "data_left_out"));
    EXPECT_EQ(other.channels.size(), 1u);
  }
  EXPECT_EQ(table(0.01, 0).channels.size(), 2u);
  const std::string clock = "Clock,Time (s),a\n10:11:12,0.0,1\n10:11:12,0.4,2\n10:11:12,0.8,4\n";
  EXPECT_EQ(read(clock + "10:11:13,1.2,5\n").channels.size(), 2u);
  EXPECT_TRUE(says(read("Time (foo),a\n0,1\n1,2\n2,4\n").notes, "time_axis"));
  EXPECT_EQ(read("Elapsed Cycles,Start Time (s),a\n0,0,1\n1,4,2\n2,8,4\n").sample_rate_hz, 0.25);
}

TEST(Times, WithoutAUnitInWholeNumbersAreSuspected) {
  std::string text = "t;a\n";
  for (int k = 0; k < 50; ++k) text += fmt::format("{};{}.5\n", 2000 * k, k % 5);
  const auto suspected = read(text);
  EXPECT_TRUE(says(suspected.notes, "time_axis"));
  const auto given = read(text, {.time_unit_s = 1e-6});
  EXPECT_NEAR(given.sample_rate_hz, 500, 1e-9);
  EXPECT_FALSE(says(given.notes, "time_axis"));
  EXPECT_TRUE(says(read("fs = 500 Hz\n" + text).notes, "rates_disagree"));
  EXPECT_FALSE(says(read("F.S.;200\n" + text).notes, "rates_disagree"));  // full scale
  EXPECT_TRUE(says(read("t [ms];<a>\n" + text.substr(4), {.time_unit_s = 1}).notes, "read_as"));
}

TEST(RateOfStep, OfFewDigitsIsTheUsualRateWithItsUncertainty) {
  EXPECT_EQ(rate_of_step(0.001, 5e-7).rate_hz, 1000);
  EXPECT_EQ(rate_of_step(0.001, 5e-7).relative_std, 0);
  const auto rounded = rate_of_step(0.000977, 5e-7);
  EXPECT_EQ(rounded.rate_hz, 1024);
  EXPECT_NEAR(rounded.relative_std, 5e-7 / 0.000977 / std::sqrt(3.0), 1e-9);
  // 4096 and 4100 Hz both print as 0.000244: neither is taken.
  const auto open = rate_of_step(0.000244, 5e-7);
  EXPECT_NEAR(open.rate_hz, 1 / 0.000244, 1e-6);
  EXPECT_GT(open.relative_std * open.rate_hz, 2);
  EXPECT_EQ(rate_of_step(0.0009765625, 5e-11).rate_hz, 1024);
  EXPECT_EQ(rate_of_step(1.95312e-05, 5e-11).rate_hz, 51200);
  EXPECT_EQ(rate_of_step(2.26757e-05, 5e-11).rate_hz, 44100);
  EXPECT_EQ(rate_of_step(3.32e-05, 5e-8).rate_hz, 1 / 3.32e-05);  // 30075 to 30166 Hz
}

std::string refusal_of(const std::string& text) {
  return signal::refusal_of([&] { return read(text); });
}

/// `count` lines of `k / 100` seconds and a swing, behind `before` each.
std::string rows(int count, bool numbered) {
  std::string text;
  for (int k = 0; k < count; ++k) {
    text += (numbered ? fmt::format("{},", k) : "") +
            fmt::format("{:.2f},{:.4f}\n", 0.01 * k, std::sin(0.3 * k));
  }
  return text;
}

TEST(Rows, AtTheBeginningThatHoldFewNumbersAreRows) {
  const std::string text = "Time (s),F (N),A (V)\n0.0,n/a,OL\n0.1,,\n" + rows(40, true);
  const auto recording = read(text);
  EXPECT_EQ(recording.samples(), 42);
  EXPECT_EQ(recording.channels[1].missing_samples, 2);
  EXPECT_THAT(refusal_of("Time (s),F (N),A (V)\n0,1.5,start\n" + rows(40, true)),
              AllOf(HasSubstr("test.csv:2:7"), HasSubstr("start")));
}

TEST(Rows, BehindAChangeOfSignsAreRefused) {
  const std::string titles = "Nr;Time (s);F (N)\n";
  std::string commas = rows(8, true), points = rows(40, true);
  std::ranges::replace(points, ',', ';');
  EXPECT_THAT(refusal_of(titles + points + commas), HasSubstr("test.csv:42"));
  EXPECT_THAT(refusal_of(titles + commas + points), HasSubstr("test.csv:9"));
  EXPECT_THAT(refusal_of(titles + points + "9;0,09;1,5\n"), HasSubstr("test.csv:42"));
  const auto footer = read(titles + points + "End of the recording;;\nPeak;;2\n");
  EXPECT_EQ(footer.samples(), 40);
  EXPECT_TRUE(says(footer.notes, "left_out"));
}

TEST(Rows, OfMoreFieldsThanTitlesAreRefused) {
  EXPECT_THAT(refusal_of("Time (s),F (N)\n" + rows(9, false) + "0.09,1.5,7\n0.10,2.5\n"),
              AllOf(HasSubstr("test.csv:11"), HasSubstr("(\"7\")")));
  EXPECT_THAT(refusal_of("Time (s),F (N)\n0,1,2\n1,1,3\n2,1,4\n"), HasSubstr("fewer titles"));
}

TEST(Columns, OfWordsAndNumbersAreWarnedOf) {
  const auto recording = read("Time (s),F (N),A (V)\n0,1,bad\n1,2,bad\n2,3,4.5\n3,4,bad\n");
  const auto lost = std::ranges::find(recording.notes, "data_left_out", &Note::code);
  ASSERT_NE(lost, recording.notes.end());
  EXPECT_THAT(lost->message, HasSubstr("\"bad\" (line 2)"));
}

TEST(Columns, InAnotherWritingAreReadOrRefused) {
  EXPECT_EQ(read("a|b\n1,5|2\n2,5|3\n3,5|4\n").channels[1].samples[2], 4);
  EXPECT_EQ(read("t;F\n0,1;1 234,5\n0,2;1'235,5\n").channels[0].samples[1], 1235.5);
  EXPECT_THAT(refusal_of("t (s),F (N)\n0.1,\"1,234\"\n0.2,\"1,235\"\n0.3,\"1,236\"\n"),
              HasSubstr("thousands"));
  EXPECT_THAT(refusal_of("t (s),F (N)\n0.1,\"1\"2\n0.2,2\n0.3,3\n0.4,4\n"),
              HasSubstr("test.csv:2:5"));
}

TEST(Titles, WithLineBreaksInsideQuotesAreRefused) {
  EXPECT_THAT(refusal_of("\"Time\n(s)\",\"Force\n(N)\"\n" + rows(40, false)),
              HasSubstr("test.csv:1"));
}

TEST(Rates, ThatContradictEachOtherAreRefused) {
  const std::string text = "Sampling interval: 10 ms\nSample rate: 200 Hz\nF (N)\n1\n2\n3\n";
  EXPECT_THAT(refusal_of(text), HasSubstr("test.csv:2"));
  EXPECT_EQ(read(text, {.sample_rate_hz = 100}).sample_rate_hz, 100);
}

TEST(Titles, AColumnBesideTheirNumbersAreRefused) {
  EXPECT_THAT(refusal_of("Time (s),Force (N)\n" + rows(40, true)), HasSubstr("beside"));
  EXPECT_THAT(refusal_of("Nr,Time (s),Force (N)\n" + rows(40, false)), HasSubstr("beside"));
  EXPECT_EQ(read("Nr,Time (s),Force (N)\n" + rows(40, true)).sample_rate_hz, 100);
  EXPECT_EQ(read(",Time (s),Force (N)\n" + rows(40, true)).channels.back().unit, "N");
}

TEST(Units, OfAllChannelsInALineOfTheirOwn) {
  for (const char* line : {"Einheit;V\n", "Unit: V\n", "Unit;V;\n"}) {
    const auto recording =
        read(std::string(line) + "Zeit;CH1;CH2\n0,0;1,5;2,5\n0,1;2,5;1,5\n0,2;1;2\n");
    EXPECT_EQ(recording.channels.size(), 2u) << line;
    for (const auto& channel : recording.channels) EXPECT_EQ(channel.unit, "V") << line;
    EXPECT_NEAR(recording.sample_rate_hz, 10, 1e-9);
  }
}

TEST(Spectra, CalledOverTimeAreAskedAbout) {
  const std::string table =
      "Time (s),Acceleration (FFT - (RMS)) (dB)\n0,-20\n1,-10\n2,-30\n3,-40\n";
  EXPECT_THAT(refusal_of(table), HasSubstr("--format csv"));
  EXPECT_EQ(read(table, {.format = "csv"}).channels.size(), 1u);
}

TEST(FrfTables, FrequenciesThatRepeatAreNamed) {
  const std::string text = "Frequency (Hz),Real,Imag\n1,1,0\n2,2,0\n3,1,0\n1,1,0\n2,2,0\n3,1,0\n";
  EXPECT_THAT(refusal_of(text), HasSubstr("test.csv:5"));
  EXPECT_THAT(refusal_of("Frequency (Hz),Real,Imag\n1,1,0\n2,2,0\n2,3,0\n3,1,0\n"),
              HasSubstr("repeats"));
  EXPECT_THAT(refusal_of("Frequency (foo),Real,Imag\n1,1,0\n2,2,0\n3,1,0\n"), HasSubstr("in Hz"));
}

// A message stays readable however many columns a table has.
TEST(Notes, OfVeryManyColumnsAreShort) {
  std::string line;
  for (int k = 0; k < 3000; ++k) line += "1;";
  const auto recording = read(line + "\n" + line + "\n" + line + "\n");
  std::size_t length = 0;
  for (const auto& note : recording.notes) length += note.message.size() + note.where.size();
  EXPECT_LT(length, 2000u);
}

}  // namespace rigfit::signal::wrong_readings_test
