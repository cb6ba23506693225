// Tables as programs of testing machines write them (.dat): a header of remarks, titles that hold
// blanks, a row of units below, columns parted by tabs or set to a width.
#include "tests/test.h"
#include "signal/readers/read_recording.h"
#include "tests/signal/readers/reading.h"

namespace rigfit::signal::testing_machine_test {

const std::string kRemarks =
    "MTS793|MPT|ENU|1|2|.|/|:|1|0|0|A\n\nData Header:\t\t\tTime:\t12.5\tSec\t05/07/2024 10:21:33 "
    "AM\nData Acquisition:\tTimed\n Station Name:\tBench 1.cfg\n";

/// 200 rows at 102.4 Hz: 0.01 mm and 8.1 N a row; `form`: of one row.
std::string rows(const char* form) {
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
    expect_columns(read_csv(remarks + tabs + rows("{:.5f}\t{:.5f}\t{:.5f}\n"), "a.dat"), tabs);
    expect_columns(read_csv(remarks + right + rows("{:18.5f}{:20.5f}{:18.5f}\n"), "a.dat"), right);
    expect_columns(read_csv(remarks + left + rows("{:<18.5f}{:<24.5f}{:.5f}\n"), "a.dat"), left);
  }
}

// One blank between titles that hold blanks: their units are known, not which word is whose.
TEST(TestingMachine, TitlesThatDoNotPartKeepTheUnits) {
  const Recording read = read_csv(
      "Running Time Axial Displacement Axial Force\nSec mm N\n" + rows("{:.5f} {:.5f} {:.5f}\n"),
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
  const std::string table = titles + rows("{:.5f}\t{:.5f}\t{:.5f}\n");
  EXPECT_THAT(refusal_of([&] {
                return read_csv(kRemarks + table + "\nData Header:\t\tTime:\t22.5\n" + table,
                                "a.dat");
              }),
              AllOf(HasSubstr("not a number"), HasSubstr("split the file")));
}

}  // namespace rigfit::signal::testing_machine_test
