// Mode shapes of other programs (UFF 55) as what a scene is fitted to.
#include "apps/campaign_file/measured_modes.h"

#include "apps/campaign/campaign.h"
#include "apps/results/text_table.h"
#include "model/linear/modal_analysis.h"
#include "model/scene/read_scene.h"
#include "signal/recording/recording.h"
#include "signal/writers/writers.h"
#include "tests/apps/apps_test.h"
#include "tests/scenes.h"

namespace rigfit::apps::measured_modes_test {

/// A standing cantilever of 12 segments with sensors at some of their joints.
std::string beam(double EI, double tip_mass) {
  auto scene = model::testing::vertical_beam(0.75, EI, 0.3, 12);
  scene.nodes[1].mass = tip_mass;
  scene.members[0].EI[1] = 200;
  scene.members[0].damping_ratio = 0.01;
  constexpr auto kMoves = model::Sensor::Quantity::acceleration;
  scene.sensors = {{"low", {"", "beam", 0.25}, {1, 0, 0}, kMoves},
                   {"middle", {"", "beam", 0.5}, {-1, 0, 0}, kMoves},
                   {"tip", {"tip", "", 0}, {1, 0, 0}, kMoves}};
  return model::scene_text(scene);
}

/// Modes at every node of the chain, three directions each.
std::string model_mode_file(const model::ModalAnalysis& analysis) {
  signal::ModalModel modes;
  std::vector<signal::NodePosition> positions;
  const auto& members = analysis.equilibrium.members;
  for (const auto& member : members) {
    for (Index i = 0; i < member.positions.cols(); ++i) {
      const int node = static_cast<int>(positions.size()) + 1;
      positions.push_back(
          {node, {member.positions(0, i), member.positions(1, i), member.positions(2, i)}});
      for (int direction = 1; direction <= 3; ++direction) {
        modes.responses.push_back({member.member, node, direction});
      }
    }
  }
  for (const auto& natural : analysis.modes) {
    signal::IdentifiedMode mode;
    mode.frequency_hz = {natural.frequency_hz, 0};
    mode.damping_ratio = {natural.damping_ratio, 0};
    const double omega = 2 * kPi * natural.frequency_hz;
    const double zeta = natural.damping_ratio;
    mode.pole_rad_s = {-zeta * omega, omega * std::sqrt(std::max(0.0, 1 - zeta * zeta))};
    mode.shape.resize(static_cast<Index>(modes.responses.size()));
    Index row = 0;
    for (const auto& shape : natural.shape) {
      for (Index i = 0; i < shape.displacement.cols(); ++i) {
        for (int k = 0; k < 3 && row < mode.shape.size(); ++k) {
          mode.shape[row++] = shape.displacement(k, i);
        }
      }
    }
    if (row < mode.shape.size()) continue;
    modes.modes.push_back(std::move(mode));
  }
  return signal::uff_text(modes, positions);
}

std::string mode_shapes(const std::string& scene_file) {
  return model_mode_file(model::analyse_modes(model::read_scene(scene_file), {.count = 8}));
}

TEST(MeasuredModes, ShapesOfAUniversalFileFitAScene) {
  const TemporaryFolder folder;
  const auto truth = folder.write("truth.toml", beam(2.1, 0.02));
  const auto start = folder.write("start.toml", beam(3.5, 0.03));
  const auto file = folder.write("modes.uff", mode_shapes(truth));
  const Document json = document_of(
      "update {} --measured {} --free beam.EI_z tip.mass beam.damping_ratio --band 1 200 --plane "
      "in --starts 1 --out {}",
      {start, file, folder.at("o.toml")});
  // Frequencies and shapes carry six digits: 0.5e-5, twice that in EI; the mass, a tenth of the
  // beam's, moves frequencies by a fifth of what EI does and less.
  EXPECT_NEAR(json["parameters"][0]["value"], 2.1, 5e-5 * 2.1);
  EXPECT_NEAR(json["parameters"][1]["value"], 0.02, 2e-3 * 0.02);
  EXPECT_NEAR(json["parameters"][2]["value"], 0.01, 1e-4 * 0.01);
  int in_plane = 0;
  for (const auto& pair : json["pairs"]) {
    if (!pair.contains("mac") || pair["mac"].is_null()) continue;
    EXPECT_GT(pair["mac"].get<double>(), 1 - 1e-6);
    ++in_plane;
  }
  EXPECT_GE(in_plane, 4);
}

TEST(MeasuredModes, PredictionsAreHeldAgainstAUniversalFile) {
  const TemporaryFolder folder;
  const auto truth = folder.write("truth.toml", beam(2.1, 0.02));
  const auto file = folder.write("modes.uff", mode_shapes(truth));
  const auto fit = folder.write("fit.json", fit_json("beam.EI_z", 2.1, 0.02));
  const Document json = document_of("predict {} --from {} --count 8 --measured {} --plane in",
                                    {folder.write("start.toml", beam(3.5, 0.02)), fit, file});
  ASSERT_EQ(json["measured"].size(), 8u);  // the file's
  int paired = 0;
  for (const auto& row : json["measured"]) {
    if (row["mode"].is_null()) continue;
    ++paired;
    EXPECT_LT(std::abs(row["relative_error"].get<double>()), 1e-5) << row;  // six digits
  }
  EXPECT_GE(paired, 4);
}

/// A cable whose EI goes by a table of tensions.
std::string cable(double tension, double EI, double mass_per_length) {
  auto scene = model::testing::paper_cable(tension, EI, 12);
  for (auto& node : scene.nodes) node.support.kind = model::Support::Kind::clamped;
  scene.nodes[1].position.x() = 1.2;
  scene.members[0].mass_per_length = mass_per_length;
  scene.members[0].GJ = 0;
  return model::scene_text(scene);
}

TEST(MeasuredModes, UniversalFilesHaveATensionOfTheirOwn) {
  const TemporaryFolder folder;
  const auto file =
      folder.write("modes.uff", mode_shapes(folder.write("truth.toml", cable(150, 0.5, 0.2))));
  const auto scene = folder.write("start.toml", cable(100, 0.9, 0.25));
  const auto table =
      folder.write("ei.csv", "tension_N,EI_Nm2,std\n100,0.5,0.001\n150,0.5,0.001\n200,0.5,0.001\n");
  const auto run = [&](const std::string& more) {
    return run_line(
        "update {} --measured {} --free cable.mass_per_length --plane any --stiffness {} "
        "--starts 1 --out {} --json - " +
            more,
        {scene, file, table, folder.at("o.toml")});
  };
  const auto fitted = run("--tension 150");
  ASSERT_TRUE(fitted.exit_code == 0 || fitted.exit_code == 4) << fitted.err;
  // Six digits of the frequencies; EI by its law within the table's 0.2 %, of which a frequency of
  // this cable has less than a third and the mass twice that.
  EXPECT_NEAR(Document::parse(fitted.out)["parameters"][0]["value"].get<double>(), 0.2, 0.0004);
  EXPECT_EQ(run("").exit_code, 2);
  EXPECT_EQ(run("--tension 150 160").exit_code, 2);
}

TEST(MeasuredModes, ATensionTestOfACampaignTakesAUniversalFile) {
  const TemporaryFolder folder;
  folder.write("modes.uff", mode_shapes(folder.write("truth.toml", cable(150, 0.5, 0.2))));
  const auto campaign = read_campaign(
      folder.write("c.toml",
                   "title = \"t\"\n[[test]]\nname = \"t\"\nkind = \"tension\"\nlength = 1.2\n"
                   "mass_per_length = 0.2\nmeasured = \"modes.uff\"\n"));
  EXPECT_EQ(campaign.tests.at(0).as<TensionTest>().modes.size(), 8u);
}

TEST(MeasuredModes, NodesElsewhereAreSaid) {
  const TemporaryFolder folder;
  const auto scene_file = folder.write("scene.toml", beam(2.1, 0.02));
  const auto scene = model::read_scene(scene_file);
  // Three nodes in a frame of their own, without coordinates.
  std::string text = "    -1\n    55\n";
  for (int k = 0; k < 5; ++k) text += "NONE\n";
  text +=
      "         1         2         2         8         2         3\n"
      "         2         4         0         1\n"
      "  2.30000E+00  1.00000E+00  1.00000E-02  0.00000E+00\n"
      "        11\n  0.00000E+00  1.00000E-01  0.00000E+00\n"
      "        12\n  0.00000E+00  4.00000E-01  0.00000E+00\n"
      "        13\n  0.00000E+00  1.00000E+00  0.00000E+00\n"
      "    -1\n";
  const auto file = folder.write("modes.uff", text);
  std::ostream nothing(nullptr);
  VerbContext context(nothing);
  context.silent = true;
  const auto plain = measured_modes(file, "", {}, scene, context);
  ASSERT_EQ(plain.size(), 1u);
  EXPECT_EQ(plain[0].shape.size(), 0);
  ASSERT_EQ(context.notes().size(), 1u);
  EXPECT_THAT(context.notes()[0].message, HasSubstr("sensor low at"));

  EXPECT_EQ(plain[0].damping_ratio.value, 0.01);
  const std::string update = "update {} --measured {}";
  EXPECT_EQ(run_line(update + " --column test_Hz", {scene_file, file}).exit_code, 2);
  EXPECT_EQ(run_line(update + " --band 50 60", {scene_file, file}).exit_code, 2);
  const auto cut = folder.write("cut.uff", text.substr(0, text.find("4.00000E-01")));
  const auto broken = run_line(update, {scene_file, cut});
  EXPECT_EQ(broken.exit_code, 3);
  EXPECT_THAT(broken.err, HasSubstr("cut.uff:14"));
}

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

}  // namespace rigfit::apps::measured_modes_test
