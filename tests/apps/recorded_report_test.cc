// The report of a campaign with recordings, through the program: the virtual laboratory's whole
// campaign against its truth, and a campaign with recordings that are broken in every way.
#include "signal/readers/read_recording.h"
#include "signal/writers/writers.h"
#include "tests/apps/apps_test.h"
#include "tests/apps/json_schema.h"

namespace rigfit::apps::recorded_report_test {

namespace fs = std::filesystem;
const std::string kLaboratory = std::string(RIGFIT_TESTDATA) + "/virtual_laboratory";

struct LaboratoryReport : ReportOfACampaign<LaboratoryReport> {
  static constexpr const char* kCampaign = "virtual_laboratory/campaign.toml";
};

/// Whether a value lies within `k` standard uncertainties of the truth.
void expect_within(const Document& estimate, double truth, double k, const std::string& what) {
  const double value = estimate.at("value"), std = estimate.at("std");
  EXPECT_GT(std, 0) << what;
  EXPECT_LT(std::abs(value - truth), k * std) << what << " " << value << " +- " << std;
}

TEST_F(LaboratoryReport, GoesTheWholeWay) {
  ASSERT_EQ(run_.exit_code, 0) << run_.err;
  ASSERT_TRUE(document_.is_object());
  for (const char* key : {"bending", "axial", "recorded_modal", "modal", "fits", "scenes"}) {
    EXPECT_FALSE(document_[key].empty()) << key;
  }
  EXPECT_GT(document_["inputs"].size(), 80u);
}

TEST_F(LaboratoryReport, IsAsItsSchemaSays) {
  const Document schemas = parsed(run_line("help schema").out)["$defs"];
  const std::pair<const char*, const char*> lists[] = {
      {"axial", "axial"}, {"bending", "bending"}, {"fits", "update"}};
  for (const auto& [list, verb] : lists) {
    for (const auto& test : document_.at(list)) {
      EXPECT_THAT(schema_errors(test, schemas.at(verb)), ::testing::IsEmpty()) << list;
    }
  }
}

// Truth: testdata/virtual_laboratory/truth. Intervals are honest when the truth lies within three
// standard uncertainties (once in 370 for each value it would not, by chance; the data are fixed).
TEST_F(LaboratoryReport, FindsWhatIsTrueOfTheRig) {
  const auto& bending = named(document_["bending"], "test", "bending")["tests"];
  const double EI[] = {0.29, 0.5, 0.67397, 0.80746};  // at 25, 100, 200 and 300 N
  ASSERT_EQ(bending.size(), 4u);
  for (const auto& test : bending) {
    const double T = test["tension_N"];
    expect_within(test["EI_Nm2"], EI[T < 50 ? 0 : std::lround(T / 100)], 4, "EI");
  }
  const auto& axial = named(document_["axial"], "test", "axial");
  expect_within(axial["EA_N"], 205000, 3, "EA");
  for (const auto& parameter : named(document_["fits"], "name", "fit-beam")["parameters"]) {
    ASSERT_TRUE(parameter["reference"].is_number());
    expect_within(parameter, parameter["reference"], 3, parameter["name"]);
  }
}

// The rig's fit: what it can tell is true; that it cannot tell the mass at the tip, it says.
TEST_F(LaboratoryReport, FitsBeamAndCablesAndPredictsTheTensionHeldOut) {
  const auto& rig = named(document_["fits"], "name", "fit-rig");
  for (const auto& parameter : rig["parameters"]) {
    if (!parameter["reference"].is_number() || !parameter["identifiable"].get<bool>()) continue;
    expect_within(parameter, parameter["reference"], 3, parameter["name"]);
  }
  EXPECT_LT(rig["rms_relative_error"].get<double>(),
            0.1 * rig["rms_relative_error_before"].get<double>());
  EXPECT_LT(rig["rms_relative_error_held_out"].get<double>(),
            0.1 * rig["rms_relative_error_before"].get<double>());
}

// Records that no fit has seen: the fitted model's strongest oscillation is nearer in damping than
// the guess that the scene gives (0.005 against 0.012), and within 2 % in frequency: the strings'
// tensions were set within 1 %, the frequency of a large motion goes with its size.
TEST_F(LaboratoryReport, FittedModelPredictsTheStringsCut) {
  int compared = 0;
  for (const char* name : {"cable-release", "rig-release"}) {
    for (const auto& record : named(document_["decays"], "test", name)["records"]) {
      ASSERT_EQ(record["models"].size(), 2u);
      const double f = record["modes"][0]["frequency_hz"]["value"];
      const double damping = record["modes"][0]["damping_ratio"]["value"];
      const auto off = [&](const Document& model) {
        for (const auto& mode : model["modes"]) {
          if (std::abs(mode["frequency_hz"]["value"].get<double>() / f - 1) > 0.02) continue;
          return std::abs(mode["damping_ratio"]["value"].get<double>() / damping - 1);
        }
        return 1.0;
      };
      EXPECT_LT(off(record["models"][1]), 0.2) << record["file"];
      EXPECT_GT(off(record["models"][0]), off(record["models"][1])) << record["file"];
      ++compared;
    }
  }
  EXPECT_EQ(compared, 3);
}

constexpr const char* kBroken = R"(title = "Broken recordings"
[[scene]]
name = "beam"
file = "beam.toml"
[[test]]
name = "beam"
kind = "modal"
scene = "beam"
force = "force"
responses = ["beam 0.65 m"]
band = [1.0, 160.0]
force_window = 0.012
exponential_window = 0.05
[[test.recording]]
files = ["good-*.uff", "cut.uff", "absent-*.csv", "garbage.csv", "clipped.csv", "swapped.csv", "slow.csv", "gaps.csv"]
synthetic = true
[[test]]
name = "axial"
kind = "axial"
mass = 2.2
mass_std = 0.002
mass_per_length = 0.16667
length_std = 0.001
channel = "tension"
[[test.recording]]
files = ["axial-*.csv", "silent.csv"]
length = 1.0
synthetic = true
[[test]]
name = "lost"
kind = "modal"
scene = "beam"
force = "force"
[[test.recording]]
files = ["nothing-*.csv"]
)";

class BrokenRecordings : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_.write("campaign.toml", kBroken);
    copy("scenes/beam.toml", "beam.toml");
    for (int hit = 1; hit <= 4; ++hit) {
      copy("beam/rig/hammer-hit" + std::to_string(hit) + ".uff",
           "good-" + std::to_string(hit) + ".uff");
    }
    const std::string fifth = kLaboratory + "/beam/rig/hammer-hit5.uff";
    copy("beam/rig/hammer-hit5.uff", "cut.uff");
    fs::resize_file(folder_.at("cut.uff"), fs::file_size(fifth) / 2);
    folder_.write("garbage.csv", std::string("\x01\x02\x00 not a recording", 20));
    const auto recording = signal::read_recording(fifth);
    const auto changed = [&](const char* name, auto change) {
      signal::Recording copy = recording;
      change(copy);
      folder_.write(name, signal::csv_text(
                              copy, {{"Sampling Rate(Hz)", std::to_string(copy.sample_rate_hz)}}));
    };
    changed("clipped.csv", [](signal::Recording& r) {
      auto& y = r.channels[1].samples;
      const double rail = 0.3 * y.cwiseAbs().maxCoeff();
      y = y.cwiseMin(rail).cwiseMax(-rail);
    });
    changed("swapped.csv",
            [](signal::Recording& r) { std::swap(r.channels[0].name, r.channels[1].name); });
    changed("slow.csv", [](signal::Recording& r) { r.sample_rate_hz /= 2; });
    changed("gaps.csv",
            [](signal::Recording& r) { r.channels[1].samples.segment(200, 40).setConstant(kNaN); });
    copy("bench/axial/L1m-1.csv", "axial-1.csv");
    copy("bench/axial/L1m-2.csv", "axial-2.csv");
    auto silent = signal::read_recording(kLaboratory + "/bench/axial/L1m-3.csv");
    silent.channels[0].samples.setConstant(21.5);
    folder_.write("silent.csv", signal::csv_text(silent, {{"Sampling Rate(Hz)", "500"}}));
  }

  void copy(const std::string& from, const std::string& to) {
    fs::copy_file(kLaboratory + "/" + from, folder_.path() / to);
  }
  TemporaryFolder folder_;
};

TEST_F(BrokenRecordings, AreNamedInTheirPlaceAndTheRestGoesOn) {
  const TemporaryFolder out;
  const auto run = run_line("report {} --out {} --threads 2",
                            {folder_.at("campaign.toml"), out.path().string()});
  EXPECT_EQ(run.exit_code, 4) << run.err;
  const Document document = parsed(out.read("report.json"));
  // The good hits give the beam's modes all the same.
  const auto& beam = named(document.at("recorded_modal"), "test", "beam");
  ASSERT_EQ(beam["states"].size(), 1u);
  EXPECT_GE(beam["states"][0]["modes"].size(), 2u);
  EXPECT_GE(beam["states"][0]["averages"].get<int>(), 2);
  EXPECT_TRUE(named(document.at("axial"), "test", "axial")["EA_N"]["value"].is_number());
  // Every bad one is refused, or its hit rejected, with a reason that names it.
  std::string said;
  for (const char* level : {"warnings", "notes"}) {
    for (const auto& one : document[level]) {
      said += one["where"].get<std::string>() + ": " + one["message"].get<std::string>() + "\n";
    }
  }
  for (const char* name : {"cut.uff", "absent-*.csv", "garbage.csv", "swapped.csv", "slow.csv",
                           "silent.csv", "nothing-*.csv"}) {
    EXPECT_THAT(said, HasSubstr(name));
    EXPECT_THAT(run.err, HasSubstr(name));
  }
  std::set<std::string> rejected;
  for (const auto& hit : beam["states"][0]["hits"]) {
    if (!hit["accepted"].get<bool>()) {
      rejected.insert(fs::path(hit["file"].get<std::string>()).filename().string());
    }
  }
  EXPECT_TRUE(rejected.contains("clipped.csv"));
  EXPECT_TRUE(rejected.contains("gaps.csv"));
  // The page says so too, and stands.
  const std::string page = out.read("report.html");
  EXPECT_TRUE(page.ends_with("</html>\n"));
  EXPECT_THAT(page, HasSubstr("garbage.csv"));
  EXPECT_THAT(page, HasSubstr("Refused"));
}

// A release that the model itself answered: its record is found at the model's frequencies and
// damping by the same estimator, moved in time or not.
TEST(DecayTest, ModelOverItsOwnRecordAgrees) {
  const TemporaryFolder folder;
  ASSERT_EQ(run_line("respond $/scenes/cable-release.toml --duration 4 --rate 500 --out {} --quiet",
                     {folder.at("release.csv")})
                .exit_code,
            0);
  const std::string campaign = folder.write("campaign.toml", R"(title = "Release"
[[scene]]
name = "cable"
file = ")" RIGFIT_TESTDATA R"(/scenes/cable-release.toml"
[[test]]
name = "release"
kind = "decay"
scene = "cable"
[[test.recording]]
files = ["release.csv"]
synthetic = true
)");
  const auto decays = document_of("report {} --out {}", {campaign, folder.at("out")}).at("decays");
  ASSERT_EQ(decays.size(), 1u);
  const auto& first = decays[0]["records"][0];
  ASSERT_EQ(first["models"].size(), 1u);
  const auto& answer = first["models"][0];
  EXPECT_EQ(answer["version"], "as given");
  EXPECT_TRUE(answer["nonlinear"].get<bool>());
  const double modelled = answer["modes"][0]["frequency_hz"]["value"];
  // The record has seven digits and the same samples: the same estimate to about 1e-6.
  EXPECT_NEAR(first["modes"][0]["frequency_hz"]["value"], modelled, 1e-4 * modelled);
}

}  // namespace rigfit::apps::recorded_report_test
