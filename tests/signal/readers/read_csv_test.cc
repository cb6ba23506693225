#include "signal/readers/read_recording.h"

#include "tests/signal/readers/reading.h"
#include "tests/test.h"

namespace rigfit::signal::read_csv_test {

Recording read(const std::string& text, const ReadOptions& options = {}) {
  return read_csv(text, "test.csv", options);
}

RecordingError error_of(const std::string& text) {
  return signal::error_of([&] { return read(text); });
}

/// Rows "0.000<s>1<s>..." of `n` samples at 1 ms: channel c at sample k is k + c / 4, a number that
/// both decimal signs print exactly.
std::string rows(int n, int channels, const std::string& separator, char decimal = '.',
                 const std::string& line_end = "\n") {
  std::string out;
  for (int k = 0; k < n; ++k) {
    std::string line = std::to_string(k / 1000) + '.' + std::to_string(1000 + k % 1000).substr(1);
    for (int c = 0; c < channels; ++c) {
      line += '\t' + std::to_string(k) + '.' + std::to_string(100 + 25 * c).substr(1);
    }
    for (char& letter : line) {
      if (letter == '.') letter = decimal;
    }
    for (std::size_t at = 0; (at = line.find('\t', at)) != std::string::npos; ++at) {
      line.replace(at, 1, separator);
    }
    out += line + line_end;
  }
  return out;
}

void expect_rows(const Recording& r, int n, int channels) {
  EXPECT_EQ(r.sample_rate_hz, 1000);
  EXPECT_TRUE(r.time_s.size() == 0);
  ASSERT_EQ(static_cast<int>(r.channels.size()), channels);
  for (int c = 0; c < channels; ++c) {
    const auto& samples = r.channels[c].samples;
    ASSERT_EQ(samples.size(), n);
    for (int k = 0; k < n; ++k) EXPECT_EQ(samples[k], k + 0.25 * c);
  }
}

struct Writing {
  const char* separator;
  char decimal;
};

class EveryWriting : public ::testing::TestWithParam<Writing> {};

TEST_P(EveryWriting, GivesTheSameNumbers) {
  const auto [separator, decimal] = GetParam();
  const std::string s(separator);
  for (const std::string end : {"\n", "\r\n", "\r"}) {
    for (const std::string mark : {"", "\xEF\xBB\xBF"}) {
      const std::string header = "Time [s]" + s + "a [N]" + s + "b [m/s2]" + end;
      if (s != " ") expect_rows(read(mark + header + rows(30, 2, s, decimal, end)), 30, 2);
      expect_rows(read(mark + rows(700, 2, s, decimal, end)), 700, 2);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(ReadCsv, EveryWriting,
                         ::testing::Values(Writing{",", '.'}, Writing{";", '.'}, Writing{";", ','},
                                           Writing{"\t", '.'}, Writing{"\t", ','},
                                           Writing{" ", '.'}, Writing{"  ", ','},
                                           Writing{", ", '.'}, Writing{" ; ", ','}));

TEST(ReadCsv, TitlesWithUnitsInBracketsAndSuffixes) {
  const auto r = read("Time (s),Force [kN],accel_mm_s2,rate_gyro_V\n" + rows(10, 3, ","));
  ASSERT_EQ(r.channels.size(), 3u);
  EXPECT_EQ(r.channels[0].name, "Force");
  EXPECT_EQ(r.channels[0].unit, "N");
  EXPECT_EQ(r.channels[0].quantity, Quantity::force);
  EXPECT_EQ(r.channels[0].samples[3], 3000);
  EXPECT_EQ(r.channels[1].quantity, Quantity::acceleration);
  EXPECT_NEAR(r.channels[1].samples[3], 3.25e-3, 1e-18);
  EXPECT_EQ(r.channels[2].name, "rate_gyro_V");
  EXPECT_EQ(r.channels[2].unit, "V");
  EXPECT_EQ(&r.channel("force [kN]"), &r.channels[0]);
}

TEST(ReadCsv, LoggerHeaderWithLabelledRows) {
  const std::string header =
      "\"ID No.\",\"X-1\"\r\n\"Title\",\"\"\r\n\"Sampling Rate(Hz)\",1000\r\n\"CH Name\"\r\n"
      "\"CH No.\",\"CH2\",\"CH8\"\r\n\"Range\",200,5\r\n\"Offset\",-10.5,-1.25\r\n"
      "\"Unit\",\"cm/s2\",\"V\"\r\n";
  const auto r = read(header + rows(50, 2, ",", '.', "\r\n"));
  ASSERT_EQ(r.channels.size(), 2u);
  EXPECT_EQ(r.channels[0].name, "CH2");
  EXPECT_EQ(r.channels[0].unit, "m/s^2");
  EXPECT_DOUBLE_EQ(r.channels[0].nominal_range, 2);
  EXPECT_EQ(r.channels[1].name, "CH8");
  EXPECT_EQ(r.channels[1].nominal_range, 0);  // 5 V is exceeded by the numbers: noted
  EXPECT_THAT(codes(r.notes), ElementsAre("left_out"));
  EXPECT_EQ(r.sample_rate_hz, 1000);
}

TEST(ReadCsv, HeaderRateAgainstTimes) {
  const auto r = read("Sample rate: 500 Hz\nt,F\ns,N\n" + rows(20, 1, ","));
  EXPECT_EQ(r.sample_rate_hz, 1000);
  EXPECT_TRUE(says(r.notes, "rates_disagree"));
  EXPECT_EQ(r.channels[0].unit, "N");
}

TEST(ReadCsv, StrayColumnsAreLeftOutAndSaid) {
  std::string text = "CH No.,A,B,,,,\nUnit,N,V,,,,\n";
  for (int k = 0; k < 100; ++k) {
    text += std::to_string(k / 100) + "." + std::to_string(100 + k % 100).substr(1) + ",1.5," +
            std::to_string(k) + (k < 3 ? ",,Mass,2.5,kg\n" : ",,,,\n");
  }
  const auto r = read(text);
  ASSERT_EQ(r.channels.size(), 2u);
  EXPECT_EQ(r.sample_rate_hz, 100);
  ASSERT_EQ(r.notes.size(), 1u);
  EXPECT_EQ(r.notes[0].code, "left_out");
  EXPECT_THAT(r.notes[0].message, HasSubstr("column 4, 5, 6, 7"));
}

TEST(ReadCsv, MissingAndWrongFields) {
  const auto r = read("t;a;b\n0,0;1,5;2\n0,1;;NaN\n0,2;2,5;3\n0,3;3;--\n");
  EXPECT_EQ(r.channels[0].missing_samples, 1);
  EXPECT_EQ(r.channels[1].missing_samples, 2);
  EXPECT_TRUE(std::isnan(r.channels[0].samples[1]));
  EXPECT_EQ(r.sample_rate_hz, 10);

  const auto error = error_of("t,force\n0.0,1\n0.1,2\n0.2,x7\n0.3,4\n0.4,5\n");
  EXPECT_EQ(error.where().line, 4);
  EXPECT_EQ(error.where().column, 5);
  EXPECT_EQ(error.where().channel, "force");
  EXPECT_EQ(error.where().value, "x7");
  const std::string fault = "\"0.3\";FAULT\n\"0.4\";FAULT\n";
  EXPECT_EQ(error_of("\"t\";\"a\"\n\"0.1\";1.5\n\"0.2\";2.5\n" + fault).where().value, "FAULT");
}

TEST(ReadCsv, Utf16IsRefused) {
  EXPECT_THAT(error_of(std::string("\xFF\xFEt\0,\0", 6)).remedy(), HasSubstr("UTF-8"));
}

TEST(ReadCsv, ARateGivenByHandOverridesTheFilesAndSaysSo) {
  ReadOptions options{.sample_rate_hz = 20};
  const auto recording = read("t (s),a\n0,1\n0.1,2\n0.2,3\n", options);
  EXPECT_EQ(recording.sample_rate_hz, 20);
  EXPECT_TRUE(says(recording.notes, "read_as"));
  EXPECT_THAT(codes(read("t (s),a\n0,1\n0.05,2\n0.1,3\n", options).notes),
              Not(Contains("read_as")));
  const auto repeated = read("t (s),a\n0,1\n0.05,2\n0.05,3\n0.15,4\n0.2,5\n", options);
  EXPECT_EQ(repeated.time_s.size(), 0);
  EXPECT_TRUE(says(repeated.notes, "read_as") && says(repeated.notes, "time_axis"));
}

TEST(ReadCsv, ClocksGoOnOverMidnightAndInUtc) {
  for (const std::string day : {"", "2026-03-29T"}) {
    const std::string next = day.empty() ? "" : "2026-03-30T", zone = day.empty() ? "" : "+02:00";
    const auto r =
        read("Time,a (N)\n" + day + "23:59:59.50" + zone + ",1\n" + day + "23:59:59.75" + zone +
             ",2\n" + next + "00:00:00.00" + zone + ",3\n" + next + "00:00:00.25" + zone + ",4\n");
    EXPECT_EQ(r.sample_rate_hz, 4);
    EXPECT_EQ(says(r.notes, "read_as"), day.empty());
  }
}

TEST(ReadCsv, WideTablesAndRowsOfNothingLeaveTheTimesTheirDigits) {
  // Lines of 10 kB, then 4000 lines of separators as spreadsheets leave them: 60 samples at 1234
  // Hz, printed to 1 us, which over the whole record is 21 ppm of the rate; then one of them is
  // lost.
  for (const int channels : {2500, 2}) {
    std::string text = "Time (s)";
    for (int c = 0; c < channels; ++c) text += ",c" + std::to_string(c) + " (N)";
    text += '\n';
    for (int k = 0; k < 60; ++k) {
      text += std::to_string(k / 1234.0);
      for (int c = 0; c < channels; ++c) text += ",0.5";
      text += '\n';
    }
    if (channels == 2) {
      for (int k = 0; k < 4000; ++k) text += ",,\n";
    }
    const auto even = read(text);
    EXPECT_NEAR(even.sample_rate_hz, 1234, 1234 * 1e-6 / (59 / 1234.0));
    EXPECT_FALSE(says(even.notes, "read_as"));
    const std::size_t at = text.find("\n0.03079");  // sample 38
    ASSERT_NE(at, std::string::npos);
    text.erase(at, text.find('\n', at + 1) - at);
    const auto gap = read(text);
    EXPECT_EQ(gap.time_s.size(), 59);
    EXPECT_TRUE(says(gap.notes, "time_axis"));
    EXPECT_NEAR(gap.sample_rate_hz, 1234, 1234 * 1e-6 / (59 / 1234.0));
  }
}

TEST(ReadCsv, ATimeThatIsMissingAmongUnevenOnesSaysWhere) {
  const auto error = error_of("Time (s),a\n0,1\n0.1,2\n,3\n0.3,4\n0.4,5\n0.9,6\n1.0,7\n");
  EXPECT_EQ(error.where().line, 4);
  EXPECT_EQ(error.where().channel, "Time");
  EXPECT_THAT(error.remedy(), HasSubstr("give the sample rate"));
}

TEST(ReadCsv, UnknownChannelsAreAnsweredByThoseThereAre) {
  Recording r = read("t (s),a\n0,1\n1,2\n2,3\n");
  for (int k = 0; k < 29; ++k) {
    r.channels.push_back(r.channels[0]);
    r.channels.back().name = "b" + std::to_string(k);
  }
  EXPECT_EQ(r.channel_index("#2"), 1);
  const RecordingError error = signal::error_of([&] { return r.channel_index("force"); });
  EXPECT_EQ(error.where().channel, "force");
  EXPECT_THAT(error.remedy(), HasSubstr("\"a\", \"b0\""));
  EXPECT_THAT(error.remedy(), HasSubstr("\"b18\", ... (30 in all)"));
}

}  // namespace rigfit::signal::read_csv_test
