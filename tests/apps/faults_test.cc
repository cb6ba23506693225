// What may go wrong around a run: a full disk, a folder that cannot be written to, a kill in the
// middle, an input that changes, very many files. Inputs stay as they are, outputs are whole or not
// there, and a message says what happened.
#include <signal.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <cstdlib>
#include <thread>

#include "apps/cli/verb_context.h"
#include "tests/apps/apps_test.h"

namespace rigfit::apps::faults_test {

namespace fs = std::filesystem;

/// Every file below a folder and its hash.
std::map<std::string, std::string> files_below(const fs::path& folder) {
  std::map<std::string, std::string> files;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (!entry.is_regular_file()) continue;
    files[fs::relative(entry.path(), folder).string()] = sha256_of_file(entry.path());
  }
  return files;
}

/// A campaign of the published tables, small enough to be run several times.
class Faults : public ::testing::Test {
 protected:
  void SetUp() override {
    const fs::path source = fs::path(RIGFIT_TESTDATA) / "jalali2021";
    fs::create_directories(folder_.path() / "in" / "scenes");
    for (const char* name : {"scenes/cable.toml", "table1_bending_stiffness.csv",
                             "table3_cable_in_plane.csv", "table4_cable_out_of_plane.csv"}) {
      fs::copy_file(source / name, folder_.path() / "in" / name);
    }
    campaign_ = folder_.write("in/campaign.toml", R"(title = "cable"
[[scene]]
name = "cable"
file = "scenes/cable.toml"
[[test]]
name = "bending"
kind = "bending"
span = 1.0
[test.table]
file = "table1_bending_stiffness.csv"
tension = "tension_N"
EI = "EI_Nm2"
[[test]]
name = "in-plane"
kind = "modal"
scene = "cable"
planes = ["in"]
tension_of = ["cable.tension"]
EI_of = ["cable.EI"]
[test.table]
file = "table3_cable_in_plane.csv"
tension = "tension_N"
measured = "test_Hz"
)");
    inputs_ = files_below(folder_.path() / "in");
  }
  void TearDown() override { EXPECT_EQ(files_below(folder_.path() / "in"), inputs_); }

  [[nodiscard]] std::string at(const std::string& name) const {
    return (folder_.path() / name).string();
  }
  [[nodiscard]] std::vector<std::string> report_to(const std::string& out) const {
    return {"report", campaign_, "--out", at(out), "--quiet"};
  }

  /// What two clean runs agree on, by name: all but the page, which holds its own command line.
  [[nodiscard]] std::map<std::string, std::string> clean_report() const {
    EXPECT_EQ(run_program(report_to("clean")).exit_code, 0);
    EXPECT_EQ(run_program(report_to("clean-2")).exit_code, 0);
    const auto second = files_below(at("clean-2"));
    auto files = files_below(at("clean"));
    std::erase_if(files, [&](const auto& file) { return second.at(file.first) != file.second; });
    EXPECT_TRUE(files.contains("report.json"));
    EXPECT_TRUE(files.contains("data/in-plane-frequency.csv"));
    return files;
  }
  /// The files of a folder that `expected` has.
  [[nodiscard]] static std::map<std::string, std::string> only(
      std::map<std::string, std::string> files,
      const std::map<std::string, std::string>& expected) {
    std::erase_if(files, [&](const auto& file) { return !expected.contains(file.first); });
    return files;
  }

  TemporaryFolder folder_;
  std::string campaign_;
  std::map<std::string, std::string> inputs_;
};

/// Runs the program in a child whose files may not grow beyond so many bytes, as on a full disk.
ProgramRun with_file_limit(rlim_t bytes, const std::vector<std::string>& arguments) {
  struct rlimit before {};
  ::getrlimit(RLIMIT_FSIZE, &before);
  // Instead of a signal the write fails, with EFBIG where a full disk gives ENOSPC. Both stay so in
  // the child.
  const auto handler = ::signal(SIGXFSZ, SIG_IGN);
  struct rlimit limit = before;
  limit.rlim_cur = bytes;
  ::setrlimit(RLIMIT_FSIZE, &limit);
  ProgramRun run = run_program(arguments);
  ::setrlimit(RLIMIT_FSIZE, &before);
  ::signal(SIGXFSZ, handler);
  return run;
}

// What is no regular file is written through, one file is no place for two outputs, and what has no
// end is no recording.
TEST_F(Faults, DevicesPipesAndOneFileForTwoOutputs) {
  const std::string record = folder_.write("r.csv", "t (s),x (N)\n0,1\n0.1,2\n0.2,1\n0.3,2\n");
  EXPECT_EQ(run_program({"inspect", record, "--json", "/dev/null"}).exit_code, 0);
  EXPECT_TRUE(fs::is_character_file("/dev/null"));
  const auto full = run_program({"inspect", record, "--json", "/dev/full"});
  EXPECT_EQ(full.exit_code, 3);
  EXPECT_THAT(full.err, HasSubstr("/dev/full"));
  const auto both = run_program({"resample", record, "--out", at("x"), "--json", at("./x")});
  EXPECT_EQ(both.exit_code, 2);
  EXPECT_THAT(both.err, HasSubstr("name one file"));
  EXPECT_FALSE(fs::exists(at("x")));
  ASSERT_EQ(::mkfifo(at("pipe").c_str(), 0600), 0);
  for (const std::string& endless : {std::string("/dev/zero"), at("pipe")}) {
    const auto run = run_program({"inspect", endless});
    EXPECT_EQ(run.exit_code, 3);
    EXPECT_THAT(run.err, HasSubstr("is not a file"));
  }
}

TEST_F(Faults, AFullDiskLeavesNoHalfWrittenFile) {
  const auto run = with_file_limit(20000, report_to("out"));
  EXPECT_EQ(run.exit_code, 3) << run.err;
  EXPECT_THAT(run.err, HasSubstr("cannot write"));
  EXPECT_THAT(run.err, HasSubstr(at("out")));
  EXPECT_FALSE(fs::exists(at("out/report.html")));
  for (const auto& [name, hash] : files_below(at("out"))) {
    EXPECT_THAT(name, Not(HasSubstr(".part")));
  }
  // Once there is room again the run ends as if nothing had been.
  EXPECT_EQ(run_program(report_to("out")).exit_code, 0);
  const auto clean = clean_report();
  EXPECT_EQ(only(files_below(at("out")), clean), clean);
}

TEST_F(Faults, AFullDiskKeepsTheFileThatWasThere) {
  folder_.write("r.csv", "before");
  const auto run =
      with_file_limit(20000, {"respond", RIGFIT_TESTDATA "/scenes/cable-hit.toml", "--duration",
                              "10", "--rate", "2000", "--out", at("r.csv")});
  EXPECT_EQ(run.exit_code, 3) << run.err;
  EXPECT_THAT(run.err, HasSubstr("r.csv"));
  EXPECT_EQ(folder_.read("r.csv"), "before");
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_.path()), {}), 2);  // in, r.csv
}

TEST_F(Faults, FullStandardOutputIsAFault) {
  if (!fs::exists("/dev/full")) GTEST_SKIP() << "no /dev/full here";
  const std::string command = "'" RIGFIT_PROGRAM "' modes '" RIGFIT_TESTDATA
                              "/jalali2021/scenes/cable.toml' --json - >/dev/full 2>'" +
                              at("err") + "'";
  const int status = std::system(command.c_str());
  EXPECT_EQ(WEXITSTATUS(status), 1);
  EXPECT_THAT(folder_.read("err"), HasSubstr("standard output"));
}

TEST_F(Faults, FoldersThatCannotBeWrittenToAreRefusedBeforeTheWork) {
  folder_.write("a-file", "x");
  // Two hold for root too: a file in the folder's place, and a file system that makes none.
  for (const std::string& out : {at("a-file"), at("a-file/below"), std::string("/proc/rigfit")}) {
    const auto run = run_program({"report", campaign_, "--out", out, "--quiet"});
    EXPECT_EQ(run.exit_code, 3) << out << "\n" << run.err;
    EXPECT_THAT(run.err, HasSubstr(out));
  }
  if (::geteuid() != 0) {
    fs::create_directory(at("locked"));
    fs::permissions(at("locked"), fs::perms::owner_read | fs::perms::owner_exec);
    EXPECT_EQ(run_program(report_to("locked/out")).exit_code, 3);
    fs::permissions(at("locked"), fs::perms::owner_all);
  }
  EXPECT_EQ(folder_.read("a-file"), "x");
  const auto run = run_program({"modes", RIGFIT_TESTDATA "/jalali2021/scenes/cable.toml", "--json",
                                at("none/there/m.json")});
  EXPECT_NE(run.exit_code, 0);
  EXPECT_THAT(run.err, HasSubstr("none/there/m.json"));
}

/// Starts a report and ends it by a signal after so long; true: it was still running.
bool killed(const std::vector<std::string>& arguments, int signal_number, int after_ms) {
  const TemporaryFolder folder;
  const pid_t child = start_program(arguments, folder);
  std::this_thread::sleep_for(std::chrono::milliseconds(after_ms));
  ::kill(child, signal_number);
  int status = 0;
  ::waitpid(child, &status, 0);
  return WIFSIGNALED(status);
}

// Killed ever later until a run gets through: wherever it was, what is there is whole, and the next
// run gives what a clean one gives.
TEST_F(Faults, KilledInTheMiddleTheNextRunGivesTheSame) {
  const auto clean = clean_report();
  int kills = 0;
  for (int after_ms = 5; after_ms < 20000; after_ms = after_ms * 3 / 2 + 10) {
    if (!killed(report_to("out"), kills % 2 == 0 ? SIGKILL : SIGTERM, after_ms)) break;
    ++kills;
    if (!fs::exists(at("out"))) continue;
    for (const auto& [name, hash] : only(files_below(at("out")), clean)) {
      EXPECT_EQ(hash, clean.at(name)) << name;
    }
  }
  EXPECT_GE(kills, 1);
  EXPECT_EQ(run_program(report_to("out")).exit_code, 0);
  EXPECT_EQ(only(files_below(at("out")), clean), clean);
}

TEST_F(Faults, AnInputThatChangesMeanwhileIsRefused) {
  const std::string input = folder_.write("input.csv", "t,x\n0,1\n");
  std::ostream nowhere(nullptr);
  VerbContext context(nowhere);
  context.input(input);
  EXPECT_NO_THROW(context.check_inputs());
  // The same content written again is no change.
  std::this_thread::sleep_for(std::chrono::milliseconds(20));
  folder_.write("input.csv", "t,x\n0,1\n");
  EXPECT_NO_THROW(context.check_inputs());
  folder_.write("input.csv", "t,x\n0,2\n");
  EXPECT_THROW(context.check_inputs(), InputChanged);
  EXPECT_THROW(context.write(at("result"), "x"), InputChanged);
  EXPECT_FALSE(fs::exists(at("result")));
  fs::remove(input);
  EXPECT_THROW(context.check_inputs(), InputChanged);
  EXPECT_EQ(exit_code_of(InputChanged("")), ExitCode::bad_input);
}

TEST_F(Faults, ARunNeverWritesOnItsInput) {
  const std::string scene = folder_.write("s.toml", folder_.read("in/scenes/cable.toml"));
  const std::string before = folder_.read("s.toml");
  const auto run = run_program({"modes", scene, "--json", scene});
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_THAT(run.err, HasSubstr("is an input of this run"));
  EXPECT_EQ(folder_.read("s.toml"), before);
}

// A logger still writes: rows come once a millisecond, reading and judging takes many of them.
TEST_F(Faults, ARecordingThatGrowsDuringTheRunEndsIt) {
  std::string rows = "time (s),force (N)\n";
  for (int k = 0; k < 400000; ++k)
    rows += std::to_string(k) + "e-4," + std::to_string(k % 7) + "\n";
  const std::string file = folder_.write("long.csv", rows);
  std::atomic<bool> done{false};
  std::jthread logger([&] {
    std::ofstream stream(file, std::ios::app);
    for (int k = 400000; !done; ++k) {
      stream << k << "e-4,1\n" << std::flush;
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
  });
  const auto run = run_program({"inspect", file, "--json", at("out.json"), "--quiet"});
  done = true;
  EXPECT_EQ(run.exit_code, 3) << run.err;
  EXPECT_THAT(run.err, HasSubstr("long.csv"));
  EXPECT_FALSE(fs::exists(at("out.json")));
}

// Cut at several moments: before it is looked at, while it is hashed or read, or after. A run that
// ends well has read all of what its document names.
TEST_F(Faults, ARecordingCutShortWhileItIsReadIsNoCrash) {
  std::string rows = "time (s),force (N)\n";
  for (int k = 0; k < 1000000; ++k) rows += std::to_string(k) + "e-4,1\n";
  const std::string whole = sha256(rows), cut = sha256(rows.substr(0, 100));
  for (const int after_ms : {10, 40, 80, 150}) {
    const std::string file = folder_.write("long.csv", rows);
    fs::remove(at("out.json"));
    std::jthread other([&] {
      std::this_thread::sleep_for(std::chrono::milliseconds(after_ms));
      fs::resize_file(file, 100);
    });
    const auto run = run_program({"inspect", file, "--json", at("out.json"), "--quiet"});
    if (run.exit_code != 0) {
      EXPECT_EQ(run.exit_code, 3) << run.err;
      EXPECT_FALSE(run.err.empty());
      EXPECT_FALSE(fs::exists(at("out.json")));
      continue;
    }
    const auto document = parsed(folder_.read("out.json"));
    const bool all = document["recordings"][0]["samples"] == 1000000;
    EXPECT_EQ(document["inputs"][0]["sha256"], all ? whole : cut);
  }
}

// The same inputs, version and seed give the same document, from run to run and with one thread or
// two: to the last digit, since every sum is taken in an order of its own making. Reports:
// PublishedTables.

std::vector<std::string> commands() {
  std::string hits, axial, lengths;
  for (const char* hit : {"1", "2", "3", "4", "5"}) {
    hits += fmt::format(" $/virtual_laboratory/beam/rig/hammer-hit{}.uff", hit);
  }
  for (const char* length : {"0.7", "1", "1.3"}) {
    for (const char* tap : {"1", "2"}) {
      axial += fmt::format(" $/virtual_laboratory/bench/axial/L{}m-{}.csv", length, tap);
      lengths += fmt::format(" {}", length);
    }
  }
  return {"frf" + hits + " --force force --band 1 160",
          "modal" + hits + " --force force --band 1 160",
          "axial" + axial + " --length" + lengths +
              " --length-std 0.001 --mass 2.2 --mass-std 0.002 --mass-per-length 0.16667 --band 20 "
              "100",
          "update $/jalali2021/scenes/beam.toml --measured "
          "$/jalali2021/table2_beam_frequencies.csv --column test_Hz --plane in --free beam.EI_z "
          "tip.mass --out OUT/beam.toml"};
}

/// The document less what names its folder and what measures time.
std::string numbers_of(nlohmann::ordered_json document) {
  const auto prune = [](auto&& self, nlohmann::ordered_json& value) -> void {
    for (const char* key : {"wall_s", "out", "files", "scenes_written"}) {
      if (value.is_object()) value.erase(key);
    }
    if (!value.is_structured()) return;
    for (auto& child : value) self(self, child);
  };
  prune(prune, document);
  return document.dump(1);
}

void replace_all(std::string& text, const std::string& from, const std::string& to) {
  for (std::size_t at; (at = text.find(from)) != std::string::npos;) {
    text.replace(at, from.size(), to);
  }
}

std::string run(std::string line, const std::string& threads) {
  const TemporaryFolder folder;
  replace_all(line, "OUT", folder.path().string());
  const auto done = run_line(line + " --seed 1 --json - --threads " + threads);
  EXPECT_EQ(done.exit_code, 0) << line << "\n" << done.err;
  if (done.exit_code != 0) return "";
  std::string text = numbers_of(nlohmann::ordered_json::parse(done.out));
  replace_all(text, folder.path().string(), "OUT");
  return text;
}

TEST(Repeatable, FromRunToRunAndWithOneThreadOrTwo) {
  for (const auto& command : commands()) {
    const std::string once = run(command, "1");
    ASSERT_GT(once.size(), 200u);
    EXPECT_EQ(run(command, "2"), once) << command;
  }
}

}  // namespace rigfit::apps::faults_test
