// A verb and the report of the same files give the same numbers, to the last digit.
#include "model/scene/read_scene.h"
#include "tests/apps/apps_test.h"
#include "tests/scenes.h"

namespace rigfit::apps::verb_and_report_test {

const std::string kLaboratory = RIGFIT_TESTDATA "/virtual_laboratory/";

/// All of `verb` stands in `part`; files may be named otherwise.
void expect_same(const Document& verb, const Document& part, const std::string& at) {
  if (verb.is_object()) {
    for (const auto& [key, value] : verb.items()) {
      if (key == "file") continue;
      ASSERT_TRUE(part.contains(key)) << at << "/" << key;
      expect_same(value, part[key], at + "/" + key);
    }
  } else if (verb.is_array()) {
    ASSERT_EQ(verb.size(), part.size()) << at;
    for (std::size_t i = 0; i < verb.size(); ++i) {
      expect_same(verb[i], part[i], at + "/" + std::to_string(i));
    }
  } else {
    EXPECT_EQ(verb.dump(), part.dump()) << at;
  }
}

struct VerbAndReport : ::testing::Test {
  static Document document(const std::string& line) {
    const auto run = run_line(line + " --quiet --json -");
    EXPECT_TRUE(run.exit_code == 0 || run.exit_code == 4) << line << "\n" << run.err;
    return parsed(run.out);
  }
  /// Runs both and compares these keys of the verb with the report's `part`, which is left there.
  void compare(const std::string& line, const std::string& test, const std::string& where,
               const std::vector<std::string>& keys) {
    SCOPED_TRACE(line);
    verb = document(line);
    folder.write("campaign.toml", "title = \"t\"\n[[test]]\nname = \"t\"\n" + test);
    report = document(
        fmt::format("report {0}/campaign.toml --out {0}/out --force", folder.path().string()));
    part = report.at(Document::json_pointer(where));
    for (const auto& key : keys) {
      ASSERT_EQ(verb.contains(key), part.contains(key)) << key;
      if (verb.contains(key)) expect_same(verb[key], part[key], key);
    }
  }
  TemporaryFolder folder;
  Document verb, report, part;
};

const std::string kStrand =
    "[strand]\nyoungs_modulus = 195e9\nwires = 133\nwire_diameter = 0.397e-3\ndiameter = 6.35e-3\n";
const std::vector<std::string> kBendingKeys{"tests",      "specimens", "laws",
                                            "law_choice", "curve",     "bounds"};

TEST_F(VerbAndReport, OfBendingTests) {
  compare(
      fmt::format("bending {0}25N.csv {0}100N.csv {0}200N.csv {0}300N.csv --span 0.5 --span-std "
                  "0.0005 --tension-zero-std 0.1 --load-calibration-std 0.002 --strand 195e9 133 "
                  "0.397e-3 6.35e-3",
                  kLaboratory + "bench/bending/T"),
      "kind = \"bending\"\nspan = 0.5\nspan_std = 0.0005\ntension_zero_std = 0.1\n"
      "load_calibration_std = 0.002\n[[test.recording]]\nfiles = [\"" +
          kLaboratory + "bench/bending/*.csv\"]\n" + kStrand,
      "/bending/0", kBendingKeys);
  EXPECT_EQ(verb["tests"].size(), 4U);
  EXPECT_GT(verb["tests"][0]["shared_relative_std"], 0.002);
  for (const char* text :
       {"tension_N,EI_Nm2\n25,0.2549\n100,0.4948\n200,0.5972\n300,0.8283\n",
        "tension_N,EI_Nm2,std\n25,0.2549,0.004\n100,0.4948,0.01\n200,0.5972,0.02\n"
        "250,0.74,0.02\n300,0.8283,0.02\n"}) {
    compare("bending " + folder.write("EI.csv", text) + " --strand 195e9 133 0.397e-3 6.35e-3",
            "kind = \"bending\"\nspan = 0.5\ntable = { file = \"EI.csv\", tension = "
            "\"tension_N\", EI = \"EI_Nm2\" }\n" +
                kStrand,
            "/bending/0", kBendingKeys);
  }
}

// Coupons on two supports: a toe of 0.25 mm, an elastic part, and a slope that breaks. The modulus
// is that of the cross-section; the second coupon is 5 % stiffer.
TEST_F(VerbAndReport, OfBeamsWithoutTension) {
  for (const double slope : {8.4, 8.82}) {
    std::string text = "displacement [mm];force [N]\n";
    for (int i = 0; i < 300; ++i) {
      const double d = 0.01 * i, x = std::max(0.0, d - 0.25);
      text += fmt::format("{:.4f};{:.4f}\n", d,
                          slope * (std::min(x, 2.0) + 0.3 * std::max(0.0, x - 2.0)));
    }
    folder.write(fmt::format("coupon{}.csv", slope), text);
  }
  compare(
      fmt::format("bending {0}8.4.csv {0}8.82.csv --span 0.1 --span-std 0.0002 --tension 0 --ends "
                  "pinned --rectangle 0.01 0.004 --section-std 0.01 --load-calibration-std 0.002",
                  folder.at("coupon")),
      "kind = \"bending\"\nspan = 0.1\nspan_std = 0.0002\ntension = 0\nends = \"pinned\"\n"
      "rectangle = [0.01, 0.004]\nsection_std = 0.01\nload_calibration_std = 0.002\n"
      "[[test.recording]]\nsynthetic = true\nfiles = [\"coupon*.csv\"]\n",
      "/bending/0", kBendingKeys);
  ASSERT_EQ(verb["tests"].size(), 2U);
  EXPECT_EQ(verb["tests"][0]["ends"], "pinned");
  // Four decimals of newtons are 1e-5 of the load.
  EXPECT_NEAR(verb["tests"][0]["stiffness_N_m"]["value"], 8400, 8.4);
  EXPECT_NEAR(verb["specimens"]["relative_scatter"], 0.05 / std::sqrt(2.0), 2e-3);
  EXPECT_EQ(part["tests"][0]["origin"], "synthetic");
}

TEST_F(VerbAndReport, OfAxialTests) {
  const std::string axial =
      "kind = \"axial\"\nmass = 2.2\nmass_per_length = 0.16667\n"
      "length_std = 0.001\nband = [20, 100]\n";
  std::string files, lengths, groups;
  for (const char* length : {"0.7", "1", "1.3"}) {
    for (const char* tap : {"1", "2"}) {
      files += fmt::format(" $/virtual_laboratory/bench/axial/L{}m-{}.csv", length, tap);
      lengths += fmt::format(" {}", length);
    }
    groups += fmt::format(
        "[[test.recording]]\nfiles = [\"{}bench/axial/L{}m-[12].csv\"]\n"
        "length = {}\n",
        kLaboratory, length, length);
  }
  const std::string options =
      " --mass 2.2 --mass-per-length 0.16667 --length-std 0.001 --band 20 100";
  const std::vector<std::string> keys{
      "EA_N",    "damping_ratio", "damping_Ns_m",          "coverage_factor_95",    "samples",
      "lengths", "budget",        "series_compliance_m_N", "between_lengths_std_N", "p_same_EA"};
  compare("axial" + files + options + " --length" + lengths, axial + groups, "/axial/0", keys);
  EXPECT_EQ(verb["samples"].size(), 6U);
  // One length alone is a bound, unless the frame is stated.
  std::vector<Document> one;
  for (const auto& [option, line] :
       {std::pair{"", ""},
        {" --frame-stiffness rigid", "frame_stiffness = \"rigid\"\n"},
        {" --frame-stiffness 5e6,5e5", "frame_stiffness = 5e6\nframe_stiffness_std = 5e5\n"}}) {
    compare(fmt::format("axial {0}1.csv {0}2.csv --length 1{1}{2}",
                        "$/virtual_laboratory/bench/axial/L1m-", options, option),
            axial + line + "[[test.recording]]\nfiles = [\"" + kLaboratory +
                "bench/axial/L1m-[12].csv\"]\nlength = 1\n",
            "/axial/0", {"EA_N"});
    one.push_back(verb);
  }
  constexpr double kEA = 205000;  // the laboratory's truth
  EXPECT_EQ(one[0]["EA_N"]["bound"], "lower");
  EXPECT_LT(one[0]["EA_N"]["low"].get<double>(), kEA);
  EXPECT_GT(one[0]["EA_N"]["high"].get<double>(), 4e6);
  EXPECT_GT(one[0]["EA_N"]["std"].get<double>(), 1e6);
  EXPECT_THAT(one[0]["warnings"].dump(), HasSubstr("\"one_length\""));
  for (const char* key : {"value", "high"}) {
    EXPECT_EQ(one[1]["EA_N"][key], one[0]["EA_if_rigid_N"][key]) << key;
  }
  EXPECT_FALSE(one[1]["EA_N"].contains("bound"));
  EXPECT_GT(one[2]["EA_N"]["value"], 1.04 * one[1]["EA_N"]["value"].get<double>());
}

TEST_F(VerbAndReport, OfDecays) {
  std::string text = "time (s),force (N)\n";
  for (int k = 0; k < 2000; ++k) {
    double y = 21.6 + 0.004 * std::sin(97.0 * k * k);
    for (const int tap : {100, 850}) {
      const double t = 2 * kPi * 20 * (k - tap) / 500.0;
      if (t > 0) y += std::exp(-0.02 * t) * std::sin(t);
    }
    text += fmt::format("{:.3f},{:.6f}\n", k / 500.0, y);
  }
  const auto file = folder.write("taps.csv", text);
  compare("decay " + file, "kind = \"decay\"\n[[test.recording]]\nfiles = [\"taps.csv\"]\n",
          "/decays/0/records/0", {"decays", "modes"});
  ASSERT_EQ(verb["decays"].size(), 2u);
  // delta = 2 pi zeta / sqrt(1 - zeta^2)
  const double zeta = verb["modes"][0]["damping_ratio"]["value"];
  EXPECT_NEAR(verb["modes"][0]["log_decrement"]["value"],
              2 * kPi * zeta / std::sqrt(1 - zeta * zeta), 1e-12);
  const auto each = document_of("decay {} --each", {file});
  ASSERT_EQ(each["pooled"].size(), 1u);
  EXPECT_EQ(each["pooled"][0]["decays"], 2);
}

TEST_F(VerbAndReport, OfTheTensionOfACable) {
  compare(
      "tension --length 20,0.002 --mass-per-length 5,0.005 --EI 200,10 --EA 2e7 --mass-of "
      "installed --plane out --frequency-std 0.004 --frequencies 2.501 5.007 7.525 10.06",
      "kind = \"tension\"\nlength = 20\nlength_std = 0.002\nmass_per_length = 5\n"
      "mass_per_length_std = 0.005\nEI = 200\nEI_std = 10\nEA = 2e7\nmass_of = \"installed\"\n"
      "plane = \"out\"\nfrequency_std = 0.004\nfrequencies = [2.501, 5.007, 7.525, 10.06]\n"
      "reference = { name = \"truth\", tension = 5e4 }\n",
      "/tension/0",
      {"tension_N", "tension_start_N", "tension_end_N", "EI_Nm2", "ends", "candidates", "modes",
       "formulas", "budget", "decided"});
  // The first page as well.
  const auto& answer = report["answers"][0];
  EXPECT_EQ(answer["value"].dump(), verb["tension_N"]["value"].dump());
  EXPECT_EQ(answer["low"].dump(), verb["tension_N"]["low"].dump());
  EXPECT_EQ(answer["reference"], 5e4);
}

const std::vector<std::string> kModalKeys{"modes", "band_hz", "frf_form", "misfit_over_error_bars"};

/// Their files may be named otherwise.
void expect_same_hits(const Document& verb, const Document& state) {
  const auto& hits = state["hits"];
  ASSERT_EQ(verb["hits"].size(), hits.size());
  for (std::size_t i = 0; i < hits.size(); ++i) {
    EXPECT_EQ(verb["hits"][i]["peak"], hits[i]["peak"]);
    EXPECT_EQ(verb["hits"][i]["reason"], hits[i]["reason"]);
  }
}

// Hits alone: FRFs and modes, without a scene to compare them with.
TEST_F(VerbAndReport, OfHitsWithoutAScene) {
  compare(fmt::format("modal {0}1.uff {0}2.uff {0}3.uff {0}4.uff {0}5.uff {0}6.uff --force force "
                      "--response accelerometer --band 2 50 --force-window 0.008 "
                      "--exponential-end-level 0.05",
                      kLaboratory + "cable-in-plane/rig/T100N-hammer-hit"),
          "kind = \"modal\"\nforce = \"force\"\nresponses = [\"accelerometer\"]\nband = [2, 50]\n"
          "force_window = 0.008\nexponential_window = 0.05\n[[test.recording]]\nfiles = [\"" +
              kLaboratory + "cable-in-plane/rig/T100N-hammer-hit*.uff\"]\n",
          "/recorded_modal/0/states/0", kModalKeys);
  EXPECT_GE(part["modes"].size(), 4u);
  EXPECT_FALSE(report.contains("modal"));
  expect_same_hits(verb, part);
}

TEST_F(VerbAndReport, OfARigStruckAtSeveralPoints) {
  auto scene = model::testing::paper_cable(200, 0.5972, 12);
  scene.members[0].damping_ratio = 0.005;
  for (const auto& [name, place] : {std::pair{"quarter", 0.25}, {"middle", 0.4}}) {
    scene.loads.push_back(model::testing::impact({"", "cable", place}, {0, -1, 0}, 5, 0.006, name));
  }
  for (const auto& [name, place] : {std::pair{"a", 0.5}, {"b", 0.33}}) {
    scene.sensors.push_back(
        model::testing::sensor("cable", place, model::Sensor::Quantity::acceleration));
    scene.sensors.back().name = name;
  }
  ASSERT_EQ(
      run_line("synthesize {} --out {} --seed 3 --rate 1024 --record 4 --hits 2 --double-hits 0",
               {folder.write("rig.toml", model::scene_text(scene)), folder.at("lab")})
          .exit_code,
      0);
  compare(
      fmt::format("modal {0}quarter-hit1.csv {0}quarter-hit2.csv {0}middle-hit1.csv "
                  "{0}middle-hit2.csv --force force --band 4 60 --struck quarter quarter middle "
                  "middle",
                  folder.at("lab/rig/")),
      "kind = \"modal\"\nscene = \"cable\"\nplanes = \"in\"\nforce = \"force\"\nband = [4, 60]\n"
      "[[test.recording]]\nfiles = \"lab/rig/quarter-hit*.csv\"\nload = \"quarter\"\n"
      "[[test.recording]]\nfiles = \"lab/rig/middle-hit*.csv\"\nload = \"middle\"\n"
      "[[scene]]\nname = \"cable\"\nfile = \"rig.toml\"\n",
      "/recorded_modal/0/states/0", {"modes"});
  EXPECT_EQ(verb["input_points"].size(), 2u);
  EXPECT_THAT(part["responses"], ElementsAre("a", "b"));
  EXPECT_GE(verb["modes"].size(), 5u);
  expect_same_hits(verb, part);
}

}  // namespace rigfit::apps::verb_and_report_test
