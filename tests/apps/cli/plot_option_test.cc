// --plot: what each verb draws is written, whole and well-formed; what cannot be written is refused
// before anything is computed.
#include "apps/cli/plots/plot_option.h"

#include <sys/stat.h>

#include <pugixml.hpp>
#include <regex>
#include <thread>

#include "tests/apps/apps_test.h"
#include "tests/temporary_folder.h"
#include "tests/test.h"

namespace rigfit::apps::plot_option_test {

using Words = std::vector<std::string>;

const std::string kLab = RIGFIT_TESTDATA "/virtual_laboratory/";
const std::string kScene = RIGFIT_TESTDATA "/jalali2021/scenes/cable.toml";

/// What is wrong with an XML text: an element that is not closed in order, a bare "&".
std::string xml_error(const std::string& text) {
  if (std::regex_search(text, std::regex("&(?![^; ]{1,6};)"))) return "bare &";
  const auto read = pugi::xml_document().load_buffer(text.data(), text.size());
  return read ? "" : read.description();
}

struct PlotOption : ::testing::Test {
  /// The SVG that a verb draws.
  std::string svg(Words words, int exit_code = 0) {
    words.insert(words.end(), {"--plot", folder.at("f.svg"), "--quiet"});
    const auto run = run_program(words);
    EXPECT_EQ(run.exit_code, exit_code) << run.err;
    std::string text = folder.read("f.svg");
    EXPECT_EQ(xml_error(text), "") << words.front();
    EXPECT_THAT(text, Not(HasSubstr("nan"))) << words.front();
    return text;
  }
  TemporaryFolder folder;
};

TEST_F(PlotOption, RecordsAreDrawnWithTheirQualityMarks) {
  std::string csv = "time (s),force (N)\n";
  for (int i = 0; i < 400; ++i) {
    const double y = 10 * std::sin(0.1 * i);
    csv += std::to_string(0.01 * i) + "," + std::to_string(std::min(y, 7.0)) + "\n";
  }
  const std::string text = svg({"inspect", folder.write("cut.csv", csv)});
  EXPECT_THAT(text, HasSubstr("cut.csv: force"));
  EXPECT_THAT(text, HasSubstr(">clipped ("));
}

TEST_F(PlotOption, ModesAreDrawnWithSupportsAndNodes) {
  const std::string text = svg({"modes", kScene, "--count", "4"});
  EXPECT_EQ(count(text, "stroke-width=\"2.6\""), 4u) << "four moved cables";
  EXPECT_GE(count(text, "class=\"support\""), 8u) << "two ends in four panels";
  EXPECT_GT(count(text, "frame node"), 0u);
}

TEST_F(PlotOption, EveryVerbDrawsWhatItFound) {
  using Said = std::pair<Words, Words>;
  for (const auto& [words, shown] :
       {Said{{"decay", kLab + "bench/axial/L1m-1.csv", "--channel", "tension", "--band", "20",
              "100"},
             {">record<", ">fit<", ">residual<"}},
        Said{{"bending", kLab + "bench/bending/T100N.csv", kLab + "bench/bending/T200N.csv",
              "--span", "0.3"},
             {"load, N", "EI, N m²"}},
        Said{{"tension", "--frequencies", "7.0", "14.0", "21.1", "--length", "2.4,0.001",
              "--mass-per-length", "0.16667,0.0001", "--frequency-std", "0.02", "--ends", "pinned"},
             {"mode number", ">measured<"}},
        Said{{"respond", RIGFIT_TESTDATA "/scenes/cable-hit.toml", "--duration", "0.5", "--rate",
              "1000", "--out", folder.at("r.csv")},
             {"Response: ", "Spectra"}}}) {
    const std::string text = svg(words);
    for (const auto& one : shown) EXPECT_THAT(text, HasSubstr(one)) << words.front();
  }
}

TEST_F(PlotOption, HitsAndFrfsAreOneLinkedPage) {
  const std::string rig = kLab + "beam/rig/hammer-hit";
  const auto run = run_line(
      "modal {}1.uff {}2.uff {}3.uff --force force --force-window 0.012 --exponential-window 0.05 "
      "--band 1 160 --plot {} --json {} --quiet",
      {rig, rig, rig, folder.at("f.html"), folder.at("f.json")});
  ASSERT_TRUE(run.exit_code == 0 || run.exit_code == 4) << run.err;  // 4: a window's damping
  const std::string page = folder.read("f.html");
  EXPECT_THAT(page, HasSubstr("double hit"));
  EXPECT_EQ(count(page, "data-link=\"test-frf\""), 4u)
      << "magnitude, phase, coherence, stabilisation";
  EXPECT_THAT(page, Not(HasSubstr("src=\"http")));
}

TEST_F(PlotOption, APictureIsMadeWhereAProgramForItIs) {
  const auto run = run_line("modes $/jalali2021/scenes/cable.toml --count 2 --plot {} --quiet",
                            {folder.at("f.png")});
  if (find_chromium().empty()) {
    EXPECT_EQ(run.exit_code, 2);
    EXPECT_THAT(run.err, HasSubstr("Chromium"));
    return;
  }
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_TRUE(folder.read("f.png").starts_with("\x89PNG"));
}

TEST_F(PlotOption, WhatCannotBeWrittenIsRefusedFirst) {
  const auto refused = [&](const std::string& file, int exit_code) {
    const auto run = run_line("modes $/jalali2021/scenes/cable.toml --plot {}", {file});
    EXPECT_EQ(run.exit_code, exit_code) << file;
    EXPECT_EQ(run.out, "") << file;
    return run.err;
  };
  EXPECT_THAT(refused(folder.at("f.pdf"), 2), HasSubstr(".html"));
  EXPECT_THAT(refused(folder.at("f"), 2), HasSubstr(".svg"));
  EXPECT_THAT(refused(folder.at("none/f.svg"), 3), HasSubstr("there is no folder"));
  std::filesystem::create_directory(folder.path() / "d.svg");
  EXPECT_THAT(refused(folder.at("d.svg"), 3), HasSubstr("cannot write"));
  std::filesystem::create_symlink("circle.svg", folder.path() / "circle.svg");
  EXPECT_THAT(refused(folder.at("circle.svg"), 3), HasSubstr("symbolic links"));
}

namespace fs = std::filesystem;

TEST(OutputFile, ReplacesWholeAndLeavesNothingElse) {
  const testing::TemporaryFolder temporary;
  const fs::path& folder = temporary.path();
  make_output_folder(folder / "a" / "b");
  const fs::path path = folder / "a" / "b" / "x.json";
  write_whole_file(path, "old");
  write_whole_file(path, "new");
  EXPECT_EQ(temporary.read("a/b/x.json"), "new");
  EXPECT_EQ(std::distance(fs::directory_iterator(path.parent_path()), {}), 1);
  EXPECT_THROW(make_output_folder(path), OutputError);
  EXPECT_THROW(write_whole_file(folder / "none" / "x", "y"), OutputError);
  EXPECT_THROW(write_whole_file(folder, "y"), OutputError);
}

// A link stays one, and its target gets the content; a pipe is written into.
TEST(OutputFile, LinksAndPipesStayWhatTheyAre) {
  const testing::TemporaryFolder temporary;
  const fs::path& folder = temporary.path();
  fs::create_directories(folder / "to");
  fs::create_symlink("to/there.json", folder / "link");
  fs::create_symlink("link", folder / "again");
  write_whole_file(folder / "again", "content");
  EXPECT_TRUE(fs::is_symlink(folder / "link") && fs::is_symlink(folder / "again"));
  EXPECT_EQ(temporary.read("to/there.json"), "content");
  fs::create_symlink("circle", folder / "circle");
  EXPECT_THROW(write_whole_file(folder / "circle", "content"), OutputError);

  const fs::path pipe = folder / "pipe";
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  std::string received;
  std::thread reader([&] {
    std::ifstream in(pipe);
    received.assign(std::istreambuf_iterator<char>(in), {});
  });
  write_whole_file(pipe, std::string(200000, 'x'));  // more than a pipe holds
  reader.join();
  EXPECT_EQ(received, std::string(200000, 'x'));
  EXPECT_TRUE(fs::is_fifo(pipe));
}

}  // namespace rigfit::apps::plot_option_test
