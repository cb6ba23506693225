// What a spreadsheet's dates and formats mean, and which archives are workbooks.
#include "signal/readers/xlsx/workbook.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <optional>
#include <string>

#include "signal/readers/files/read_formats.h"

namespace rigfit::signal::cell_formats_test {
namespace {
using ::testing::HasSubstr;

TEST(ClockText, IsThatOfBothDateSystems) {
  EXPECT_EQ(clock_text(46350.5, CellFormat::date_time, false), "2026-11-24 12:00:00.00000");
  EXPECT_EQ(clock_text(46350.5 - 1462, CellFormat::date_time, true), "2026-11-24 12:00:00.00000");
  EXPECT_EQ(clock_text(61, CellFormat::date, false), "1900-03-01");
  EXPECT_EQ(clock_text(0, CellFormat::date, true), "1904-01-01");
  EXPECT_EQ(clock_text(1.5, CellFormat::time, false), "36:00:00.000000000");
  EXPECT_EQ(clock_text(2958465, CellFormat::date, false), "9999-12-31");
  EXPECT_EQ(clock_text(60, CellFormat::date, false), std::nullopt);
  EXPECT_EQ(clock_text(-1, CellFormat::time, false), std::nullopt);
  EXPECT_EQ(clock_text(2958466, CellFormat::date, false), std::nullopt);
}

TEST(CellFormats, AreToldByTheirCodes) {
  EXPECT_EQ(cell_format("General"), CellFormat::number);
  EXPECT_EQ(cell_format("0.00E+00"), CellFormat::number);
  EXPECT_EQ(cell_format("[Red]#,##0.00\\ \"days\""), CellFormat::number);
  EXPECT_EQ(cell_format("[$-409]d/mmm/yy"), CellFormat::date);
  EXPECT_EQ(cell_format("mmmm"), CellFormat::date);
  EXPECT_EQ(cell_format("mm:ss.0"), CellFormat::time);
  EXPECT_EQ(cell_format("[mm]:ss"), CellFormat::time);
  EXPECT_EQ(cell_format("dd.mm.yyyy hh:mm;@"), CellFormat::date_time);
  EXPECT_EQ(cell_format("\"unclosed"), CellFormat::number);
  EXPECT_EQ(cell_format("[unclosed"), CellFormat::number);
}

TEST(ForeignWorkbooks, AreNamedWithTheWayOut) {
  const auto name_of = [](const std::string& bytes) {
    const auto found = foreign_format(bytes);
    return found ? found->name + "; " + found->remedy : "";
  };
  const std::string compound = "\xD0\xCF\x11\xE0\xA1\xB1\x1A\xE1" + std::string(600, '\0');
  EXPECT_THAT(name_of(compound), AllOf(HasSubstr(".xls"), HasSubstr("save it as .xlsx")));
  EXPECT_THAT(name_of(compound), HasSubstr("without a password"));
  const std::string part = "PK\x03\x04" + std::string(26, '\0');
  EXPECT_EQ(name_of(part + "xl/workbook.xml"), "");
  EXPECT_EQ(name_of(part + "[Content_Types].xml" + part + "xl/workbook.xml"), "");
  EXPECT_THAT(name_of(part + "[Content_Types].xml" + part + "word/a.xml"),
              HasSubstr("zip archive"));
  EXPECT_THAT(name_of(part + "mimetype opendocument.spreadsheet xl/"), HasSubstr(".ods"));
}

}  // namespace
}  // namespace rigfit::signal::cell_formats_test
