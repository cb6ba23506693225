// Warnings on the terminal: grouped by kind, the grave ones first, never more lines than are read.
#include "apps/cli/warning_lines.h"

#include "apps/cli/verb_context.h"
#include "tests/temporary_folder.h"
#include "tests/test.h"

namespace rigfit::apps::warning_lines_test {

Finding warning(std::string code, std::string message, std::string where = "") {
  return {std::move(code), std::move(message), std::move(where), false};
}

TEST(WarningLines, CountWhatIsAlikeOrSayEach) {
  const std::vector<Finding> said{
      warning("spike", "a spike", "a.csv"), warning("set", "3 mm are left", "b.csv"),
      warning("spike", "a spike", "c.csv"), warning("set", "5 mm are left", "d.csv")};
  EXPECT_THAT(
      warning_lines(said),
      ElementsAre("a.csv: a spike (2 of this kind, --verbose prints each: a.csv; c.csv)",
                  "b.csv: 3 mm are left (2 of this kind, --verbose prints each: b.csv; d.csv)"));
  EXPECT_THAT(warning_lines(said, true), ElementsAre("a.csv: a spike", "b.csv: 3 mm are left",
                                                     "c.csv: a spike", "d.csv: 5 mm are left"));
}

TEST(WarningLines, GraveOnesFirstAndTheRestCounted) {
  std::vector<Finding> warnings{warning("taken_as_exact", "span taken as exact")};
  for (int kind = 0; kind < 9; ++kind) {
    warnings.push_back(warning(fmt::format("kind_{}", kind), fmt::format("message {}", kind)));
    warnings.push_back(warnings.back());
  }
  warnings.push_back(warning("model_ruled_out", "the data rule this model out"));
  const auto lines = warning_lines(warnings);
  ASSERT_EQ(lines.size(), 6u);
  EXPECT_EQ(lines[0], "the data rule this model out");
  EXPECT_EQ(lines[1], "message 0 (2 of this kind, --verbose prints each)");
  // Shown: one and four kinds of two; left: five kinds of two and what is taken as exact.
  EXPECT_THAT(lines[5], HasSubstr("11 more of 6 other kinds"));
  // Five kinds need no line that counts.
  warnings.erase(warnings.begin() + 7, warnings.end());
  EXPECT_EQ(warning_lines(warnings).size(), 4u);
}

TEST(WarningLines, NormalOperationIsANote) {
  std::ostringstream out;
  VerbContext context(out);
  context.silent = true;
  context.warn("start_chosen", "the fit starts at sample 702");
  context.warn("clipped", "12 samples are clipped");
  ASSERT_EQ(context.warnings().size(), 1u);
  ASSERT_EQ(context.notes().size(), 1u);
  EXPECT_EQ(context.notes()[0].code, "start_chosen");
}

TEST(WarningLines, ACopyOfARecordingIsNoSecondOne) {
  const testing::TemporaryFolder folder;
  std::ostringstream out;
  VerbContext context(out);
  context.silent = true;
  for (const char* name : {"a.csv", "a.toml", "b.toml", "b.csv"}) {
    context.input(folder.write(name, std::string("t,x\n0,") + (name[2] == 'c' ? "1" : "2")));
  }
  ASSERT_EQ(context.warnings().size(), 1u);
  EXPECT_THAT(context.warnings()[0].message, HasSubstr("a.csv"));
  EXPECT_THAT(context.warnings()[0].where, HasSubstr("b.csv"));
}

}  // namespace rigfit::apps::warning_lines_test
