#include "apps/results/text_table.h"

#include "model/scene/scene_error.h"
#include "signal/recording/recording_error.h"
#include "tests/apps/apps_test.h"

namespace rigfit::apps::text_table_test {

TEST(TextTable, ReadsNumbersBlanksAndRemarks) {
  const TemporaryFolder folder;
  const auto table = read_text_table(folder.write(
      "t.csv", "\xef\xbb\xbf# a remark\r\ntension_N, \"test_Hz\"\r\n25,1.5\r\n\r\n100,\r\n"));
  EXPECT_EQ(table.columns[0].name, "tension_N");
  ASSERT_EQ(table.rows.size(), 2u);
  EXPECT_EQ(table.number(table.rows[0], 1), 1.5);
  EXPECT_TRUE(std::isnan(table.number(table.rows[1], 1)));
  EXPECT_EQ(table.rows[0].line, 3);
  EXPECT_EQ(table.rows[1].line, 5);
  EXPECT_EQ(table.column("test_Hz"), 1u);
  const auto semicolons = read_text_table(folder.write("s.csv", "a;b\n1;2\n"));
  EXPECT_EQ(semicolons.number(semicolons.rows[0], 1), 2);
}

// As a spreadsheet of a country with decimal commas writes it: a title, units in brackets or in a
// line of their own, semicolons or tabs.
TEST(TextTable, ReadsWhatARecordingReaderReads) {
  const TemporaryFolder folder;
  for (const char* text :
       {"\xef\xbb\xbfTension (kN);test [Hz];note\r\n0,025;5,26;first\r\n0,1;;\r\n",
        "Cable 7x19\n\nTension (kN)\ttest [Hz]\n0,025\t5,26\n# remark\n0,1\t-\n",
        "tension_kN,test_Hz\n0.025,5.26\n0.1,n/a\n", "tension;test\nkN;Hz\n0,025;5,26\n0,1;\n",
        "\"tension [kN]\",\"test [Hz]\"\n\"0,025\",\"5,26\"\n\"0,1\",\"\"\n"}) {
    SCOPED_TRACE(text);
    const auto table = read_text_table(folder.write("t.csv", text));
    const bool suffix = table.columns[0].name == "tension_kN";
    const auto tension = table.column(suffix ? "tension_kN" : "tension (kN)");
    const auto test = table.column(suffix ? "test_Hz" : "Test");
    ASSERT_EQ(table.rows.size(), 2u);
    // Products of decimals with 1000: one rounding each.
    EXPECT_DOUBLE_EQ(table.number(table.rows[0], tension), 25);
    EXPECT_DOUBLE_EQ(table.number(table.rows[1], tension), 100);
    EXPECT_EQ(table.number(table.rows[0], test), 5.26);
    EXPECT_TRUE(std::isnan(table.number(table.rows[1], test)));
  }
  // A suffix that looks like a unit stays a name: neither inches nor degrees Celsius.
  const auto names = read_text_table(folder.write("n.csv", "f_in,case_C\n5,6\n7,8\n"));
  EXPECT_EQ(names.number(names.rows[0], 0), 5);
  EXPECT_EQ(names.number(names.rows[1], 1), 8);
}

TEST(TextTable, RefusesWhatIsNoTable) {
  const TemporaryFolder folder;
  const auto message = [&](const std::string& text) -> std::string {
    try {
      const auto table = read_text_table(folder.write("t.csv", text));
      const auto column = table.column("test_Hz");
      for (const auto& row : table.rows) static_cast<void>(table.number(row, column));
    } catch (const model::SceneError& error) {
      return error.what();
    }
    return "accepted";
  };
  EXPECT_THAT(message("a,test_Hz\n1,x\n"), HasSubstr("t.csv:2:2: \"x\" in column \"test_Hz\""));
  EXPECT_THAT(message("a,test_Hz\n1,inf\n"), HasSubstr("is not a number"));
  EXPECT_THAT(message("a,test_Hz\n1,2,3\n"), HasSubstr("has 3 values, the header 2"));
  // The first and the last row as well; a line is not taken for a header or a footer.
  EXPECT_THAT(message("a,test_Hz\n1,x\n2,3\n4,5\n"), HasSubstr("t.csv:2:2: \"x\" in column"));
  EXPECT_THAT(message("a;test_Hz\n1,5;3,5\n2;x\n"), HasSubstr("t.csv:3:2: \"x\" in column"));
  EXPECT_THAT(message("a,test_Hz\n1,3\n2,y y\n"), HasSubstr("t.csv:3:2: \"y y\" in column"));
  EXPECT_THAT(message("a,test_Hz\n"), HasSubstr("no rows"));
  EXPECT_THAT(message("a,tset_Hz\n1,2\n"), HasSubstr("did you mean \"tset_Hz\"?"));
  EXPECT_THROW(static_cast<void>(read_text_table(folder.write("empty.csv", ""))),
               signal::RecordingError);
  EXPECT_THROW(static_cast<void>(read_text_table(folder.path() / "none.csv")),
               signal::RecordingError);
  EXPECT_THROW(static_cast<void>(read_text_table(folder.path())), signal::RecordingError);
  try {
    static_cast<void>(read_text_table(folder.write("book.xlsx", "PK\x03\x04 and so on\n1\n")));
    FAIL() << "a workbook was read as a table";
  } catch (const signal::RecordingError& error) {
    EXPECT_NE(std::string(error.what()).find("save the sheet as CSV"), std::string::npos);
  }
}

}  // namespace rigfit::apps::text_table_test
