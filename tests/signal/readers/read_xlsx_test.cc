// Workbooks as spreadsheet programs and libraries save them, and everything in them that is
// refused.
#include <minizip/zip.h>

#include <cstddef>

#include "signal/readers/read_recording.h"
#include "signal/readers/recording_description.h"
#include "tests/signal/readers/reading.h"
#include "tests/temporary_folder.h"
#include "tests/test.h"

namespace rigfit::signal::xlsx_test {

namespace fs = std::filesystem;

// Numbers of cell styles in `kStyles`.
constexpr int kDateTime = 1, kPassed = 2, kDays = 3;
constexpr const char* kStyles =
    R"(<styleSheet><numFmts count="3"><numFmt numFmtId="164" formatCode="yyyy\-mm\-dd\ hh:mm:ss.000"/>)"
    R"(<numFmt numFmtId="165" formatCode="[h]:mm:ss.000;@"/>)"
    R"(<numFmt numFmtId="166" formatCode='[Magenta]#,##0.00\ "days";0\y'/></numFmts>)"
    R"(<cellXfs><xf numFmtId="0"/>)"
    R"(<xf numFmtId="164"/><xf numFmtId="165"/><xf numFmtId="166"/></cellXfs></styleSheet>)";
constexpr const char* kTypes =
    "http://schemas.openxmlformats.org/officeDocument/2006/relationships/";

std::string number(const std::string& cell, double value, int style = 0) {
  return fmt::format(R"(<c r="{}" s="{}"><v>{:.17g}</v></c>)", cell, style, value);
}

std::string words(const std::string& cell, const std::string& text) {
  return fmt::format(R"(<c r="{}" t="inlineStr"><is><t>{}</t></is></c>)", cell, text);
}

std::string row(int k, const std::string& cells) {
  return fmt::format(R"(<row r="{}">{}</row>)", k, cells);
}

/// Titles in row 1 and 60 samples at 100 Hz from row 2 on: time in A, force in B.
double force(int k) { return std::sin(0.3 * k) / 3; }
std::string titles() { return row(1, words("A1", "Time (s)") + words("B1", "Force [N]")); }
std::string samples(int first_row = 2, int count = 60) {
  std::string rows;
  for (int k = 0; k < count; ++k) {
    const std::string at = std::to_string(first_row + k);
    rows += row(first_row + k, number("A" + at, k / 100.0) + number("B" + at, force(k), kDays));
  }
  return rows;
}

/// A workbook of sheets by their rows, as a file.
class Workbooks : public ::testing::Test {
 protected:
  void add_sheet(const std::string& name, const std::string& rows, const std::string& tail = "") {
    const std::size_t k = ++sheets_;
    parts_[fmt::format("xl/worksheets/sheet{}.xml", k)] =
        R"(<?xml version="1.0"?><worksheet xmlns="x"><sheetData>)" + rows + "</sheetData>" + tail +
        "</worksheet>";
    listed_ += fmt::format(R"(<sheet name="{}" sheetId="{}" r:id="rId{}"/>)", name, k, k);
    relations_ += fmt::format(
        R"(<Relationship Id="rId{}" Type="{}worksheet" Target="worksheets/sheet{}.xml"/>)", k,
        kTypes, k);
  }

  void write(int level = 6) {
    parts_["[Content_Types].xml"] = "<Types/>";
    parts_["xl/workbook.xml"] = "<workbook><sheets>" + listed_ + "</sheets></workbook>";
    parts_["xl/styles.xml"] = kStyles;
    std::string relations = relations_;
    for (const char* kind : {"styles", "sharedStrings"}) {
      if (!parts_.contains(fmt::format("xl/{}.xml", kind))) continue;
      relations += fmt::format(R"(<Relationship Id="{}" Type="{}{}" Target="/xl/{}.xml"/>)", kind,
                               kTypes, kind, kind);
    }
    parts_["xl/_rels/workbook.xml.rels"] = "<Relationships>" + relations + "</Relationships>";
    const zipFile zip = ::zipOpen64(path_.c_str(), APPEND_STATUS_CREATE);
    ASSERT_NE(zip, nullptr);
    for (const auto& [name, text] : parts_) {
      zip_fileinfo info{};
      ASSERT_EQ(::zipOpenNewFileInZip64(zip, name.c_str(), &info, nullptr, 0, nullptr, 0, nullptr,
                                        Z_DEFLATED, level, 0),
                ZIP_OK);
      ASSERT_EQ(::zipWriteInFileInZip(zip, text.data(), static_cast<unsigned>(text.size())),
                ZIP_OK);
      ASSERT_EQ(::zipCloseFileInZip(zip), ZIP_OK);
    }
    ASSERT_EQ(::zipClose(zip, nullptr), ZIP_OK);
  }

  void write_one(const std::string& rows, const std::string& tail = "") {
    listed_.clear(), relations_.clear(), sheets_ = 0;
    add_sheet("Run 1", rows, tail);
    write();
  }

  Recording read(const std::string& sheet = "") { return read_recording(path_, {.sheet = sheet}); }

  std::string refusal(const std::string& sheet = "") {
    return refusal_of([&] { return read(sheet); });
  }

  std::string bytes() const { return folder_.read("book.xlsx"); }
  void put(const std::string& bytes) const { folder_.write("book.xlsx", bytes); }

  testing::TemporaryFolder folder_;
  const fs::path path_ = folder_.path() / "book.xlsx";
  std::map<std::string, std::string> parts_;
  std::size_t sheets_ = 0;
  std::string listed_, relations_;
};

std::string note_of(const Recording& recording, const std::string& code) {
  for (const auto& note : recording.notes) {
    if (note.code == code) return note.message + " " + note.where;
  }
  return "";
}

/// The samples of `samples()`, bit by bit.
void expect_force(const Recording& recording, int count = 60) {
  ASSERT_EQ(recording.channels.size(), 1u);
  EXPECT_EQ(recording.channels[0].name, "Force");
  EXPECT_EQ(recording.channels[0].unit, "N");
  EXPECT_EQ(recording.format, "xlsx");
  EXPECT_DOUBLE_EQ(recording.sample_rate_hz, 100);
  ASSERT_EQ(recording.samples(), count);
  for (int k = 0; k < count; ++k) EXPECT_EQ(recording.channels[0].samples[k], force(k)) << k;
}

TEST_F(Workbooks, GiveTheNumbersAsSaved) {
  write_one(titles() + samples());
  const Recording recording = read();
  expect_force(recording);
  EXPECT_TRUE(recording.notes.empty()) << recording.notes.front().message;
}

TEST_F(Workbooks, TextsMayBeSharedInRunsOfFontsOrOverTwoLines) {
  parts_["xl/sharedStrings.xml"] =
      "<sst><si><r><t>Ti</t></r><r><rPr><b/></rPr><t>me (s)</t></r></si>"
      "<si><t>Force&#10;[N]</t><rPh sb=\"0\" eb=\"1\"><t>reading</t></rPh></si></sst>";
  write_one(R"(<row r="1"><c r="A1" t="s"><v>0</v></c><c r="B1" t="s"><v>1</v></c></row>)" +
            samples());
  expect_force(read());
}

TEST_F(Workbooks, FormulasGiveTheirSavedValues) {
  std::string rows = titles();
  for (int k = 0; k < 60; ++k) {
    rows += row(2 + k, fmt::format(R"(<c r="A{0}"><f>(ROW()-2)/100</f><v>{1:.17g}</v></c>)"
                                   R"(<c r="B{0}"><f t="shared" si="0"/><v>{2:.17g}</v></c>)",
                                   2 + k, k / 100.0, force(k)));
  }
  write_one(rows);
  expect_force(read());
}

TEST_F(Workbooks, TheTableMayStandAnywhereWithNamespaces) {
  std::string rows =
      R"(<x:row r="2"><x:c r="C2" t="str"><x:v>"new" rope; 3 May</x:v></x:c></x:row>)"
      R"(<x:row r="4"><x:c r="C4" t="str"><x:v>Time (ms)</x:v></x:c>)"
      R"(<x:c t="str"><x:v>Force (kN)</x:v></x:c></x:row>)";
  for (int k = 0; k < 30; ++k) {
    rows +=
        fmt::format(R"(<x:row><x:c r="C{}"><x:v>{}</x:v></x:c><x:c><x:v>{}</x:v></x:c></x:row>)",
                    5 + k, 10 * k, 0.5 * k);
  }
  add_sheet("Run 1", "");
  parts_["xl/worksheets/sheet1.xml"] =
      "<x:worksheet xmlns:x=\"x\"><x:sheetData>" + rows + "</x:sheetData></x:worksheet>";
  write();
  const Recording recording = read();
  EXPECT_DOUBLE_EQ(recording.sample_rate_hz, 100);
  ASSERT_EQ(recording.channels.size(), 1u);
  for (int k = 0; k < 30; ++k) EXPECT_EQ(recording.channels[0].samples[k], 500.0 * k);
}

TEST_F(Workbooks, EmptyCellsAndRowsAreMissingSamples) {
  std::string rows = row(1, words("A1", "Force [N]") + words("B1", "Load [N]"));
  for (int k = 2; k < 30; ++k) {
    if (k == 9) continue;
    const std::string at = std::to_string(k);
    rows += row(k, (k == 5 ? R"(<c r="A5" t="e"><v>#N/A</v></c>)" : number("A" + at, k)) +
                       (k == 7 ? R"(<c r="B7" s="1"/>)" : number("B" + at, -k)));
  }
  write_one(rows);
  const Recording recording = read();
  ASSERT_EQ(recording.samples(), 28);
  EXPECT_EQ(recording.channels[0].missing_samples, 2);
  EXPECT_EQ(recording.channels[1].missing_samples, 2);
  EXPECT_TRUE(std::isnan(recording.channels[0].samples[3]));
  EXPECT_TRUE(std::isnan(recording.channels[1].samples[5]));
  EXPECT_TRUE(std::isnan(recording.channels[0].samples[7]));
  EXPECT_EQ(recording.channels[0].samples[8], 10);
  EXPECT_EQ(note_of(recording, "incomplete"), "");
}

TEST_F(Workbooks, TheFirstSheetIsTakenUnlessOneIsNamed) {
  add_sheet("Notes", row(1, words("A1", "no numbers")));
  listed_.insert(listed_.find(" sheetId"), R"( state="hidden")");
  add_sheet("Run 1", titles() + samples());
  add_sheet("Run 2", titles() + samples(2, 40));
  write();
  expect_force(read());
  EXPECT_THAT(note_of(read(), "assumed"),
              AllOf(HasSubstr("--sheet"), HasSubstr("\"Run 1\""), HasSubstr("\"Run 2\"")));
  expect_force(read("Run 2"), 40);
  expect_force(read("#3"), 40);
  EXPECT_EQ(note_of(read("Run 2"), "assumed"), "");
  EXPECT_THAT(refusal("Run 3"), AllOf(HasSubstr("no sheet of that name"), HasSubstr("\"Run 2\"")));
  EXPECT_THAT(refusal("Notes"), AllOf(HasSubstr("Notes"), HasSubstr("holds no numbers")));
}

TEST_F(Workbooks, RefusalsNameTheCell) {
  const std::string good = titles() + samples(2, 30);
  const auto refused = [&](const std::string& cells) {
    write_one(good + row(32, number("A32", 0.3) + cells) + samples(33, 10), "");
    return refusal();
  };
  const auto cell = HasSubstr("cell Run 1!B32");
  EXPECT_THAT(refused(R"(<c r="B32" t="e"><f>1/0</f><v>#DIV/0!</v></c>)"),
              AllOf(cell, HasSubstr("#DIV/0!"), HasSubstr("empty the cell")));
  EXPECT_THAT(refused(R"(<c r="B32"><f>A32*2</f></c>)"),
              AllOf(cell, HasSubstr("without its value")));
  for (const int style : {kDateTime, kPassed}) {
    EXPECT_THAT(refused(number("B32", 0.3, style)), AllOf(cell, HasSubstr("in seconds")));
  }
  EXPECT_THAT(refused(R"(<c r="B32"><v>1e400</v></c>)"), cell);
  EXPECT_THAT(refused(R"(<c r="B32" t="s"><v>0</v></c>)"), cell);
  // By the rules of tables: with the row.
  for (const char* text : {"slipped", "#4 slipped", "1,25"}) {
    EXPECT_THAT(refused(words("B32", text)),
                AllOf(HasSubstr(":32: channel \"Force\""), HasSubstr(text)));
  }
  EXPECT_THAT(refused(R"(<c r="B32" t="b"><v>1</v></c>)"), HasSubstr("TRUE"));
}

TEST_F(Workbooks, FrfsAreReadFromASheet) {
  std::string rows = row(1, words("A1", "Frequency (Hz)") + words("B1", "Real ((m/s^2)/N)") +
                                words("C1", "Imag ((m/s^2)/N)"));
  for (int k = 0; k < 50; ++k) {
    rows += row(2 + k, number(fmt::format("A{}", 2 + k), 1 + k) +
                           number(fmt::format("B{}", 2 + k), force(k)) +
                           number(fmt::format("C{}", 2 + k), -force(k)));
  }
  write_one(rows);
  const FrfSet set = read_frfs({path_});
  ASSERT_EQ(set.H.rows(), 50);
  EXPECT_EQ(set.H(7, 0), Complex(force(7), -force(7)));
  EXPECT_THAT(refusal(), AllOf(HasSubstr(".xlsx:2:"), HasSubstr("rigfit modal")));
}

TEST_F(Workbooks, ScatteredCellsDoNotFillTheMemory) {
  write_one(titles() + samples() + row(1048576, number("XFD1048576", 1)));
  EXPECT_THAT(refusal(), AllOf(HasSubstr("XFD1048576"), HasSubstr("134 million fields")));
}

TEST_F(Workbooks, WhatUnpacksToTooMuchIsRefused) {
  add_sheet("Run 1", std::string((std::size_t{1} << 27) + 1, ' '));
  write(1);
  EXPECT_LT(fs::file_size(path_), 1 << 20);
  EXPECT_THAT(refusal(), HasSubstr("unpacks to more"));
}

TEST_F(Workbooks, DamagedOnesAreRefused) {
  write_one(titles() + samples());
  std::string encrypted = bytes();
  for (std::size_t at = encrypted.find("PK\1\2"); at != std::string::npos;
       at = encrypted.find("PK\1\2", at + 1)) {
    encrypted[at + 8] = static_cast<char>(encrypted[at + 8] | 1);
  }
  put(encrypted);
  EXPECT_THAT(refusal(), AllOf(HasSubstr("encrypted"), HasSubstr("password")));

  write();
  parts_["xl/worksheets/sheet1.xml"] = "<worksheet><sheetData><row><c></row></sheetData>";
  write();
  EXPECT_THAT(refusal(), HasSubstr("damaged"));
  for (const char* cells : {R"(<row r="2"/><row r="2"><c r="A2"><v>1</v></c></row>)",
                            R"(<row r="2"><c r="B2"><v>1</v></c><c r="A2"><v>1</v></c></row>)",
                            R"(<row r="2"><c r="A3"><v>1</v></c></row>)",
                            R"(<row r="2"><c r="XFE2"><v>1</v></c></row>)",
                            R"(<row r="1048577"><c><v>1</v></c></row>)"}) {
    parts_["xl/worksheets/sheet1.xml"] =
        std::string("<worksheet><sheetData>") + cells + "</sheetData></worksheet>";
    write();
    EXPECT_THAT(refusal(), HasSubstr("damaged")) << cells;
  }
}

}  // namespace rigfit::signal::xlsx_test
