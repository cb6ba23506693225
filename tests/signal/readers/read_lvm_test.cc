#include "signal/readers/read_recording.h"

#include "tests/signal/readers/reading.h"
#include "tests/test.h"

namespace rigfit::signal::read_lvm_test {

/// A file of one segment: the segment's header lines, then titles and rows.
std::string lvm(const std::string& header, const std::string& table) {
  return "LabVIEW Measurement\t\nWriter_Version\t2\nSeparator\tTab\nDecimal_Separator\t.\n"
         "***End_of_Header***\t\n\n" +
         header + "***End_of_Header***\t\n" + table;
}

const char* const kTwo =
    "Channels\t2\nY_Unit_Label\tN\tg\nX_Dimension\tTime\tTime\nX0\t0\t0\nDelta_X\t0.001\t0.001\n";

RecordingError error_of(const std::string& text) {
  return signal::error_of([&] { return read_lvm(text, "x.lvm"); });
}

TEST(ReadLvm, ChannelsOfOneNameAreToldApart) {
  const Recording r = read_lvm(lvm("Channels\t2\nY_Unit_Label\tN\tN\nDelta_X\t0.001\t0.001\n",
                                   "X_Value\tF\tF\n\t1\t2\n\t4\t5\n\t7\t8\n"),
                               "x.lvm");
  ASSERT_EQ(r.channels.size(), 2u);
  EXPECT_EQ(r.channels[0].name, "F");
  EXPECT_EQ(r.channels[1].name, "F_2");
  EXPECT_EQ(r.channels[1].samples[2], 8);
  EXPECT_THAT(codes(r.notes), ElementsAre("duplicate_name"));
}

TEST(ReadLvm, ChannelsOfOtherTimesAreLeftOutAndSaidToBe) {
  const std::string two = "X_Value\tF\ta\n\t1\t2\n\t3\t4\n\t5\t6\n";
  const std::string each =
      "X_Value\tF\tX_Value\ta\n0.000\t1\t0.5\t2\n0.001\t3\t0.501\t4\n0.002\t5\t0.502\t6\n";
  for (const auto& text : {lvm("Channels\t2\nDelta_X\t0.001\t0.002\n", two),
                           lvm("Channels\t2\nX0\t0\t0.5\nDelta_X\t0.001\t0.001\n", two),
                           lvm("Channels\t2\nX0\t0\t\t0\nDelta_X\t0.001\t\t0.001\n", each)}) {
    const Recording r = read_lvm(text, "x");
    ASSERT_EQ(r.channels.size(), 1u);
    EXPECT_EQ(r.channels[0].samples, Eigen::Vector3d(1, 3, 5));
    const auto note = std::ranges::find(r.notes, "data_left_out", &Note::code);
    ASSERT_NE(note, r.notes.end());
    EXPECT_EQ(note->where, "\"a\"");
  }
  // Channels without samples, as LabVIEW writes them.
  const auto text = lvm("Channels\t2\nDelta_X\t1\t0.001\n", "X_Value\tF\ta\n\t\t2\n\t\t4\n");
  EXPECT_EQ(read_lvm(text, "x").sample_rate_hz, 1000);
}

TEST(ReadLvm, XThatIsUnevenIsKeptAndXThatIsMissingThereRefused) {
  const std::string table = "X_Value\tF\ta\n0.000\t1\t2\n0.001\t3\t4\n0.002\t5\t6\n0.008\t7\t8\n";
  const Recording r = read_lvm(lvm(kTwo, table), "x.lvm");
  EXPECT_TRUE(says(r.notes, "time_axis"));
  ASSERT_EQ(r.time_s.size(), 4);
  EXPECT_EQ(r.time_s[3], 0.008);
  std::string lacking = table;
  lacking.erase(lacking.find("0.002"), 5);
  const auto error = error_of(lvm(kTwo, lacking + "0.010\t9\t9\n0.011\t9\t9\n"));
  EXPECT_EQ(error.where().channel, "X_Value");
  EXPECT_EQ(error.where().line, 16);
  EXPECT_THAT(error.remedy(), HasSubstr("delete that column"));
}

TEST(ReadLvm, XValuesWinOverAStepThatDisagrees) {
  const Recording r = read_lvm(
      lvm(kTwo, "X_Value\tF\ta\n0.000\t1\t2\n0.004\t3\t4\n0.008\t5\t6\n0.012\t7\t8\n"), "x.lvm");
  EXPECT_EQ(r.sample_rate_hz, 250);
  EXPECT_TRUE(says(r.notes, "rates_disagree"));
}

TEST(ReadLvm, TablesOfNothingSayWhere) {
  EXPECT_THAT(error_of(lvm(kTwo, "X_Value\tF\ta\n")).problem(), HasSubstr("holds no numbers"));
  const auto comments = error_of(lvm(kTwo, "X_Value\tF\ta\n# stopped by hand\n"));
  EXPECT_THAT(comments.problem(), HasSubstr("holds no numbers"));
  EXPECT_EQ(comments.where().line, 14);
}

TEST(ReadLvm, ATableThatIsMostlyNothingIsRefusedBeforeMemoryIsTaken) {
  std::string table = "X_Value";
  for (int c = 0; c < 3000; ++c) table += "\tc" + std::to_string(c);
  table += '\n';
  for (int k = 0; k < 3000; ++k) table += "\t1.5\n";
  const auto error = error_of(lvm(kTwo, table));
  EXPECT_THAT(error.problem(), HasSubstr("far fewer fields"));
  EXPECT_EQ(error.where().line, 14);
}

}  // namespace rigfit::signal::read_lvm_test
