// What the program says of itself and of mistakes on its command line.
#include "apps/cli/verb.h"

#include "apps/cli/verb_context.h"
#include "apps/cli/warning_lines.h"
#include "tests/apps/apps_test.h"
#include "tests/temporary_folder.h"
#include "tests/test.h"

namespace rigfit::apps::usage_test {

using ::testing::StartsWith;

TEST(Usage, MisspeltWordsAreNamedWithTheNearest) {
  const auto verb = run_line("inspct x.csv");
  EXPECT_EQ(verb.exit_code, 2);
  EXPECT_THAT(verb.err, StartsWith("error: there is no verb \"inspct\"; did you mean inspect?"));
  const auto option = run_line("decay x.csv --chanel a");
  EXPECT_EQ(option.exit_code, 2);
  EXPECT_THAT(option.err,
              StartsWith("error: rigfit decay has no option --chanel; did you mean --channel?"));
  EXPECT_THAT(run_line("decay").err, StartsWith("error: "));
}

TEST(Usage, HelpIsThereForEveryVerbAndFile) {
  const auto bare = run_line("");
  EXPECT_EQ(bare.exit_code, 2);
  EXPECT_THAT(bare.err, HasSubstr("inspect"));
  const std::string modal = run_line("help modal").out;
  EXPECT_THAT(modal, HasSubstr("Usage: rigfit modal FILE ... [OPTIONS]"));
  for (const char* internal : {"FLOAT", "TEXT:", "(1x)"}) {
    EXPECT_THAT(modal + run_line("help report").out, Not(HasSubstr(internal)));
  }
  const auto wrong = run_line("help scen");
  EXPECT_EQ(wrong.exit_code, 2);
  EXPECT_THAT(wrong.err, HasSubstr("did you mean scene?"));
}

/// The keys that a reader lists when it meets one that it does not know.
std::vector<std::string> keys_known(const ProgramRun& run) {
  const std::string sign = "known keys: ";
  const std::size_t at = run.err.find(sign);
  EXPECT_NE(at, std::string::npos) << run.err;
  if (at == std::string::npos) return {};
  std::string list = run.err.substr(at + sign.size());
  list = list.substr(0, list.find('\n'));
  for (std::size_t k = list.find(" or "); k != std::string::npos; k = list.find(" or ")) {
    list.replace(k, 4, ", ");
  }
  std::vector<std::string> keys;
  std::stringstream stream(list);
  for (std::string key; std::getline(stream, key, ',');) {
    key.erase(0, key.find_first_not_of(' '));
    keys.push_back(key);
  }
  return keys;
}

TEST(KeyReference, HoldsEveryKeyThatTheReadersKnow) {
  const TemporaryFolder folder;
  const std::string node =
      "[[node]]\nname = \"a\"\nposition = [0, 0, 0]\nsupport = \"clamped\"\n"
      "[[node]]\nname = \"b\"\nposition = [1, 0, 0]\n";
  const std::string member =
      "[[member]]\nname = \"m\"\nkind = \"beam\"\nnodes = [\"a\", \"b\"]\n"
      "mass_per_length = 1.0\nEA = 1e6\nEI = 10.0\n";
  const std::string place = "node = \"b\"\n";
  const std::string unknown = "qqqqqqqqqqqqqqqq = 1\n";
  const std::string sensor = "[[sensor]]\nname = \"s\"\nnode = \"b\"\n";
  const std::string scene = folder.write("good.toml", node + member + sensor);
  const auto check = [&](const char* document, const std::vector<std::string>& command) {
    const auto run = run_program(command);
    EXPECT_EQ(run.exit_code, 3) << run.err;
    const std::string reference = key_reference(document);
    for (const auto& key : keys_known(run)) EXPECT_THAT(reference, HasSubstr(key)) << run.err;
  };
  int number = 0;
  for (const std::string& text : {unknown + node + member, node + unknown + member,
                                  node + member + unknown, node + member + sensor + unknown,
                                  node + member + "[[load]]\nname = \"l\"\nkind = \"impact\"\n" +
                                      place + "peak = 1.0\nduration = 0.01\n" + unknown}) {
    check("scene", {"modes", folder.write(fmt::format("scene{}.toml", ++number), text)});
  }
  folder.write("r.csv", "Time (s),a (m/s^2)\n0,1\n0.1,2\n0.2,1\n");
  folder.write("r.toml", unknown);
  check("sidecar", {"inspect", folder.at("r.csv")});
  folder.write("r.toml", "[[channel]]\nsource = \"a\"\n" + unknown);
  check("sidecar", {"inspect", folder.at("r.csv")});
  const std::string title = "title = \"x\"\n";
  const std::string recording = "[[test.recording]]\nfiles = [\"r.csv\"]\n";
  for (const std::string& text :
       {title + unknown + "[[test]]\nname = \"t\"\nkind = \"decay\"\n" + recording,
        title + "[[test]]\nname = \"t\"\nkind = \"decay\"\n" + unknown + recording,
        title + "[[test]]\nname = \"t\"\nkind = \"modal\"\nforce = \"a\"\n" + unknown + recording,
        title + "[[test]]\nname = \"t\"\nkind = \"bending\"\nspan = 1.0\n" + unknown + recording,
        title + "[[test]]\nname = \"t\"\nkind = \"axial\"\nmass = 1.0\n" + unknown + recording +
            "length = 1.0\n",
        title +
            "[[test]]\nname = \"t\"\nkind = \"tension\"\nlength = 1.0\nmass_per_length = 1.0\n" +
            unknown + recording,
        title + "[[test]]\nname = \"t\"\nkind = \"decay\"\n" + recording + unknown}) {
    check("campaign", {"report", folder.write(fmt::format("campaign{}.toml", ++number), text),
                       "--out", folder.at("out")});
  }
}

// Warnings on the terminal: grouped by kind, the grave ones first, never more lines than are read.

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

}  // namespace rigfit::apps::usage_test
