// Forms in which oscilloscopes, phones, accelerometer loggers, testing machines and
// accelerogram archives write their tables.
#include <numbers>

#include "signal/readers/csv_fields.h"
#include "signal/readers/read_recording.h"
#include "tests/signal/readers/reading.h"
#include "tests/test.h"

namespace rigfit::signal::loggers_test {

using ::testing::ElementsAreArray;

Recording read(const std::string& text, const ReadOptions& options = {}) {
  return read_csv(text, "test.csv", options);
}

/// `row` (with {0} for the line's number from 0, {1} for its time in steps of `step`, {2} for a
/// value of an even sine) for each of 60 lines.
std::string lines(const std::string& row, double step = 0.01, double start = 0) {
  std::string text;
  for (int k = 0; k < 60; ++k) {
    text += fmt::format(fmt::runtime(row), k, start + step * k, std::sin(0.3 * k)) + "\n";
  }
  return text;
}

void expect_channels(const Recording& recording, const std::vector<std::string>& names,
                     const std::vector<std::string>& units, double rate_hz) {
  std::vector<std::string> is_named, is_in;
  for (const auto& channel : recording.channels) {
    is_named.push_back(channel.name);
    is_in.push_back(channel.unit);
  }
  EXPECT_THAT(is_named, ElementsAreArray(names));
  EXPECT_THAT(is_in, ElementsAreArray(units));
  EXPECT_NEAR(recording.sample_rate_hz, rate_hz, 1e-6 * rate_hz);
}

TEST(Oscilloscopes, SequenceAndIncrementStandUnderTheTitles) {
  const auto one =
      read("X,CH1,Start,Increment,\nSequence,Volt,-1.0e-05,1.0e-07,\n" + lines("{0},{2:.2e},"));
  expect_channels(one, {"CH1"}, {"V"}, 1e7);
  const auto two = read("X,CH1,CH2,Start,Increment,\nSequence,Volt,Volt,-1.0e-05,2.0e-07\n" +
                        lines("{0},{2:.2e},{2:.3e},"));
  expect_channels(two, {"CH1", "CH2"}, {"V", "V"}, 5e6);
}

TEST(Oscilloscopes, TheHeaderStandsBesideTheSamples) {
  std::string text =
      "Record Length,2.5e+03,,-0.0021,0.1,\nSample Interval,2.0e-06,,-0.002098,0.2,\n"
      "Vertical Units,V,,-0.002096,0.1,\n";
  text += lines(",,,{1:.6f},{2:.5f},", 2e-6, -0.002094);
  expect_channels(read(text), {"column 5"}, {""}, 5e5);
  EXPECT_EQ(read(text).samples(), 63);  // those beside the header among them
  EXPECT_EQ(read(text).channels[0].samples[2], 0.1);
}

TEST(Tables, NumbersAboveOfOtherColumnsAreSaidToBeLeftOut) {
  const std::string table = lines("{1:.3f},{2:.4f},{2:.3f}");
  EXPECT_TRUE(says(read("0.0\n0.005\n" + table).notes, "data_left_out"));
  EXPECT_TRUE(says(read("dt = 0.01\n0.005\n" + table).notes, "data_left_out"));
  EXPECT_FALSE(says(read("dt\n0.01\n" + table).notes, "data_left_out"));  // the step
}

TEST(Numbers, WordsForNoneAreMissing) {
  for (const char* word : {"#NV", "Overflow", "Inf"}) {
    const auto recording =
        read("Time,F\n" + lines("{1:.3f},{2:.4f}") + "0.6," + word + "\n0.61,1\n");
    EXPECT_EQ(recording.channels[0].missing_samples, 1) << word;
  }
}

TEST(Oscilloscopes, OneUnitOfAllChannels) {
  expect_channels(read("Model,ABC\nSample Interval,0.01\nVertical Units,V\n,,\nTIME,CH1,CH2\n" +
                       lines("{1:.4e},{2:.4e},{2:.3e}")),
                  {"CH1", "CH2"}, {"V", "V"}, 100);
}

TEST(Oscilloscopes, AnInfiniteValueIsMissing) {
  const auto recording = read("Time,Channel A\n(ms),(mV)\n\n" + lines("{1:.2f},{2:.4f}", 10) +
                              "600,\u221E\n610,-\u221E\n");
  EXPECT_EQ(recording.channels[0].missing_samples, 2);
  EXPECT_NEAR(recording.sample_rate_hz, 100, 1e-6);
}

TEST(Units, OfEachChannelBehindALabel) {
  expect_channels(read("Channel name\tV_0\tA_1\nUnit\tV\tg\n\nTime\tV_0\tA_1\n" +
                       lines("{1:.4f}\t{2:.4f}\t{2:.3f}")),
                  {"V_0", "A_1"}, {"V", "m/s^2"}, 100);
}

TEST(Units, PerCentInTheFirstColumnIsNoCommentSign) {
  const auto recording = read("Dehnung;Kraft;Zeit\n%;N;s\n" + lines("{0}.5;{2:.4f};{1:.3f}", 0.1));
  expect_channels(recording, {"Dehnung", "Kraft"}, {"1", "N"}, 10);
  EXPECT_NEAR(recording.channels[0].samples[2], 0.025, 1e-12);
}

TEST(Units, ARowOfThemMayHoldSomeThatAreNotKnown) {
  expect_channels(read("Time,Axial Force,Axial Strain,Current\n(s),(N),(mm/mm),(A)\n" +
                       lines("{1:.3f},{2:.4f},{2:.5f},{2:.3f}")),
                  {"Axial Force", "Axial Strain", "Current"}, {"N", "1", ""}, 100);
  expect_channels(read("Time,Force,Shaker\ns,N,furlong\n" + lines("{1:.3f},{2:.4f},{2:.3f}")),
                  {"Force", "Shaker"}, {"N", ""}, 100);
  expect_channels(read("No.;Date&Time;ms;CH1;CH2\nNO.;Time;ms;V;mA\n" +
                       lines("{0};10/09/2026 14:53:{0:02};0;{2:.4f};{2:.3f}")),
                  {"ms", "CH1", "CH2"}, {"s", "V", ""}, 1);
  // Numbers of channels above units are names.
  expect_channels(read("x-axis,1,2\nsecond,Volt,Volt\n" + lines("{1:.3f},{2:.4f},{2:.3f}")),
                  {"1", "2"}, {"V", "V"}, 100);
}

TEST(Numbers, BehindTheirSignAndBlanks) {
  const auto recording = read("Time,F\n(s),(N)\n0,+    1.5\n1,-   0.5\n2,+    2.0\n");
  EXPECT_EQ(recording.channel("F").samples, Eigen::Vector3d(1.5, -0.5, 2));
  std::string signs;  // any number of them is no number
  for (int k = 0; k < 1'000'000; ++k) signs += "+ ";
  double value = 0;
  EXPECT_EQ(parse_number(signs + "1", '.', value), 0u);
}

TEST(Times, InTheLastColumnByTheirUnit) {
  const auto recording = read(
      "Standardweg;Standardkraft;Pr\xC3\xBC"
      "fzeit\nmm;N;s\n" +
      lines("{2:.5f};{0}.5;{1:.3f}", 0.1));
  expect_channels(recording, {"Standardweg", "Standardkraft"}, {"m", "N"}, 10);
}

TEST(Times, InFewRowsByTheirUnit) {
  expect_channels(read("S/No;C_1_Temps[s];C_1_Force[kN]\n1;0.1;2\n2;0.2;3\n3;0.3;5\n"),
                  {"C_1_Force"}, {"N"}, 10);
}

TEST(Times, RoundedSoThatTheRateIsUncertainAreWarnedOf) {
  const auto recording = read("Time,F\n" + lines("14:00:{1:02.0f},{2:.4f}", 0.2));
  EXPECT_GT(recording.sample_rate_relative_std, 0);
  EXPECT_TRUE(says(recording.notes, "time_axis"));
}

TEST(Times, CalledByTheirUnit) {
  expect_channels(read("millis,ax\n" + lines("{1:.0f},{2:.3f}", 5, 1034)), {"ax"}, {""}, 200);
  for (const std::string unit : {"micros", "us", "\u00B5s"}) {
    expect_channels(read(unit + ",ax\n" + lines("{1:.0f},{2:.3f}", 5000, 1034)), {"ax"}, {""}, 200);
  }
}

TEST(Times, SinceTheEpochTellTheirUnit) {
  for (const double unit : {1e3, 1e6, 1e9}) {
    const auto recording =
        read("timestamp,x\n" + lines("{1:.0f},{2:.3f}", 0.01 * unit, 1.7e9 * unit));
    EXPECT_NEAR(recording.sample_rate_hz, 100, 1e-4) << unit;
    EXPECT_TRUE(says(recording.notes, "assumed")) << unit;
  }
  // 20 minutes in ms, or 14 days in s: nothing tells.
  EXPECT_TRUE(says(read("timestamp,x\n" + lines("{1:.0f},{2:.3f}", 10, 1.2e6)).notes, "time_axis"));
  // A spreadsheet's days since 1900, in steps of 1 ms.
  EXPECT_TRUE(says(read("Time,x\n" + lines("{1:.10f},{2:.3f}", 1e-3 / 86400, 45363.58)).notes,
                   "time_axis"));
}

TEST(Times, OfDaysInTwoHalves) {
  const auto recording = read(
      "Date/Time,Force (N)\n5/6/2021 11:59:59 AM,1.5\n5/6/2021 12:00:00 PM,2.5\n"
      "5/6/2021 12:00:01 PM,1\n5/6/2021 12:00:02 PM,3\n");
  expect_channels(recording, {"Force"}, {"N"}, 1);
  EXPECT_EQ(read("Time,F\n11:59:59 pm,1\n12:00:00 am,2\n").sample_rate_hz, 1);  // midnight
}

TEST(Counters, BesideTimesAreLeftOut) {
  expect_channels(read(",time,ax\n" + lines("{0},{1:.3f},{2:.4f}")), {"ax"}, {""}, 100);
  expect_channels(read("Sample,Time (s),F (N)\n" + lines("{0},{1:.3f},{2:.4f}")), {"F"}, {"N"},
                  100);
  // A counter, times and values under a header of labels.
  expect_channels(read("Version:\t14.1\nX-Axis Unit:\ts\nY-Axis Unit:\tm/s2\n\n" +
                       lines("{0}\t{1:.4e}\t{2:.4e}")),
                  {"column 3"}, {"m/s^2"}, 100);
}

TEST(Headers, ALabelWithItsNumberIsNoTitle) {
  expect_channels(read("MOTION IN G\nNPTS=  60, DT=   .0050 SEC\n" + lines("{2:.5f}")), {"MOTION"},
                  {"m/s^2"}, 200);
}

TEST(Headers, LinesThatLookLikeRowsSayNothingOfTheColumns) {
  expect_channels(
      read("SAMPLING_INTERVAL_S: 0.005\nNDATA: 60\nUNITS: cm/s^2\nTYPE: ACC\n" + lines("{2:.6f}")),
      {"column 1"}, {"m/s^2"}, 200);
  // A list of channels, whose lines are rows when parted by blanks.
  expect_channels(read("Sample rate: 100\nNo\tName\tUnit\n1\tAcc 1\tm/s2\n2\tLoad\tN\n\n"
                       "Time (s)\tAcc 1 (m/s2)\tLoad (N)\n" +
                       lines("{1:.4f}\t{2:.4f}\t{2:.3f}")),
                  {"Acc 1", "Load"}, {"m/s^2", "N"}, 100);
}

TEST(Headers, CommentsBySemicolonAndALabelBesideTheTitles) {
  for (const char* titles : {";Time, Ax, Ay\n", ";Headers, time,Ax,Ay\n"}) {
    expect_channels(read(std::string(";Title, X16\n;SampleRate, 50,Hz\n") + titles +
                         lines("{1:.3f},{2:.3f},{2:.4f}", 0.02)),
                    {"Ax", "Ay"}, {"", ""}, 50);
  }
}

TEST(Headers, RepeatedTitlesGiveWayToTheOnesAbove) {
  std::string text =
      "\"TOA5\",\"CR6\",\"1\",\"Std\"\n\"TIMESTAMP\",\"RECORD\",\"Ax\",\"Ay\"\n"
      "\"TS\",\"RN\",\"g\",\"g\"\n\"\",\"\",\"Smp\",\"Smp\"\n";
  text += lines("\"2021-05-06 12:01:{1:05.2f}\",10{0:02},{2:.4f},{2:.3f}", 0.02);
  expect_channels(read(text), {"RECORD", "Ax", "Ay"}, {"", "m/s^2", "m/s^2"}, 50);
  // A row that begins like the one of units is one of titles where it holds none.
  expect_channels(read("Sequence,Load,Way\n" + lines("{0},{2:.4f},{2:.3f}")),
                  {"Sequence", "Load", "Way"}, {"", "", ""}, 0);
  // With a unit each they are the channels' own.
  expect_channels(read("P 1,P 2,P 3\nTime [s],A [g],A [g]\n" + lines("{1:.3f},{2:.4f},{2:.3f}")),
                  {"A", "A_2"}, {"m/s^2", "m/s^2"}, 100);
}

TEST(Numbers, WithTheirThousandsParted) {
  const auto recording =
      read("Time (s),Load (N)\n0,\"999.5\"\n1,\"1,000.5\"\n2,\"1,234,567.25\"\n3,\"-12,000.0\"\n");
  ASSERT_EQ(recording.channels.size(), 1u);
  EXPECT_EQ(recording.channels[0].samples, (Eigen::Vector4d(999.5, 1000.5, 1234567.25, -12000)));
  const auto german = read("Zeit [s];Last [N]\n0;999,5\n1;1.000,5\n2;2.000,25\n");
  EXPECT_EQ(german.channels[0].samples, (Eigen::Vector3d(999.5, 1000.5, 2000.25)));
}

TEST(Numbers, ThatCannotBeReadAreNotLeftOutQuietly) {
  const auto recording = read(lines("14:02:03.{0:03} -> {2:.2f},{2:.3f},9.8"));
  const auto lost = std::ranges::find(recording.notes, "data_left_out", &Note::code);
  ASSERT_NE(lost, recording.notes.end());
  EXPECT_THAT(lost->message, HasSubstr("14:02:03.0"));
  // A column of dates beside one of times is no loss.
  EXPECT_FALSE(says(read("Date,Time,F\n" + lines("2021-05-06,12:01:{1:05.2f},{2:.3f}", 0.02)).notes,
                    "data_left_out"));
}

TEST(Accelerograms, SeriesOfSeveralValuesALineAreRefused) {
  std::string numbers;
  for (int k = 0; k < 42; ++k)
    numbers += fmt::format("{:15.7E}{}", std::sin(0.3 * k), k % 5 == 4 ? "\n" : "");
  const std::string title = "ACCELERATION TIME SERIES IN UNITS OF G\n";
  for (const char* counts :
       {"NPTS=    42, DT=   .0050 SEC,\n", "Sampling Freq(Hz) 200Hz\nDuration Time(s)  .21\n"}) {
    EXPECT_THAT(refusal_of([&] { return read(title + counts + numbers + "\n"); }),
                HasSubstr("one series of 42"));
  }
  // Another number than the header states: columns.
  EXPECT_EQ(read(title + "NPTS= 60, DT= .005 SEC\n" + numbers + "\n").channels.size(), 5u);
}

TEST(BlankSeparated, ALineWithoutOneOfItsValuesIsRefused) {
  EXPECT_THAT(refusal_of([] { return read("t F a\n0.0 1 2\n0.1 3\n0.2 5 6\n0.3 7 8\n"); }),
              HasSubstr("test.csv:3:1"));
}

// Tables as programs of testing machines write them (.dat): a header of remarks, titles that hold
// blanks, a row of units below, columns parted by tabs or set to a width.
const std::string kRemarks =
    "MTS793|MPT|ENU|1|2|.|/|:|1|0|0|A\n\nData Header:\t\t\tTime:\t12.5\tSec\t05/07/2024 10:21:33 "
    "AM\nData Acquisition:\tTimed\n Station Name:\tBench 1.cfg\n";

/// 200 rows at 102.4 Hz: 0.01 mm and 8.1 N a row; `form`: of one row.
std::string machine_rows(const char* form) {
  std::string text;
  for (int i = 0; i < 200; ++i) {
    text += fmt::format(fmt::runtime(form), i / 102.4, 0.01 * i - 0.5, 8.1 * i + 12.3);
  }
  return text;
}

void expect_columns(const Recording& read, const std::string& header) {
  ASSERT_EQ(read.channels.size(), 2U) << header;
  EXPECT_EQ(read.channels[0].name, "Axial Displacement") << header;
  EXPECT_EQ(read.channels[0].unit, "m") << header;
  EXPECT_NEAR(read.channels[0].samples[7], -0.43e-3, 1e-12) << header;
  EXPECT_EQ(read.channels[1].name, "Axial Force") << header;
  EXPECT_EQ(read.channels[1].unit, "N") << header;
  EXPECT_NEAR(read.channels[1].samples[7], 69, 1e-9) << header;
  // Times are printed to 1e-5 s over 1.94 s.
  EXPECT_NEAR(read.sample_rate_hz, 102.4, 1e-3) << header;
}

TEST(TestingMachine, TitlesWithBlanksAboveARowOfUnits) {
  const std::string tabs = "Running Time\tAxial Displacement\tAxial Force\nSec\tmm\tN\n";
  const std::string right =
      "      Running Time  Axial Displacement       Axial Force\n"
      "               Sec                  mm                 N\n";
  const std::string left =
      "Running Time      Axial Displacement      Axial Force\n"
      "Sec               mm                      N\n";
  for (const std::string& remarks : {std::string(), kRemarks}) {
    expect_columns(read_csv(remarks + tabs + machine_rows("{:.5f}\t{:.5f}\t{:.5f}\n"), "a.dat"),
                   tabs);
    expect_columns(read_csv(remarks + right + machine_rows("{:18.5f}{:20.5f}{:18.5f}\n"), "a.dat"),
                   right);
    expect_columns(read_csv(remarks + left + machine_rows("{:<18.5f}{:<24.5f}{:.5f}\n"), "a.dat"),
                   left);
  }
}

// One blank between titles that hold blanks: their units are known, not which word is whose.
TEST(TestingMachine, TitlesThatDoNotPartKeepTheUnits) {
  const Recording read = read_csv("Running Time Axial Displacement Axial Force\nSec mm N\n" +
                                      machine_rows("{:.5f} {:.5f} {:.5f}\n"),
                                  "a.dat");
  ASSERT_EQ(read.channels.size(), 2U);
  EXPECT_EQ(read.channels[0].name, "column 2");
  EXPECT_EQ(read.channels[0].unit, "m");
  EXPECT_EQ(read.channels[1].unit, "N");
  EXPECT_NEAR(read.sample_rate_hz, 102.4, 1e-3);
  EXPECT_EQ(read.notes.front().code, "titles_not_matched");
}

TEST(TestingMachine, ATableACycleIsRefusedWithTheWayOut) {
  const std::string titles = "Running Time\tAxial Displacement\tAxial Force\nSec\tmm\tN\n";
  const std::string table = titles + machine_rows("{:.5f}\t{:.5f}\t{:.5f}\n");
  EXPECT_THAT(refusal_of([&] {
                return read_csv(kRemarks + table + "\nData Header:\t\tTime:\t22.5\n" + table,
                                "a.dat");
              }),
              AllOf(HasSubstr("not a number"), HasSubstr("split the file")));
}

}  // namespace rigfit::signal::loggers_test
