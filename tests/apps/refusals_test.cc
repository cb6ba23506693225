// Command lines and campaigns that make no sense: each ends with its exit code and a message that
// says what is wrong and what would be right, within a second, and writes nothing.
#include <regex>

#include "apps/campaign/campaign.h"
#include "model/scene/read_scene.h"
#include "tests/apps/apps_test.h"
#include "tests/scenes.h"

namespace rigfit::apps::refusals_test {

const std::string kRig = std::string(kCableScene) + "damping_ratio = 0.005\n";
const char* const kHit = R"([[load]]
name = "hammer"
kind = "impact"
member = "cable"
position = 0.25
direction = [0.0, -1.0, 0.0]
peak = 100.0
duration = 0.002
[[sensor]]
name = "mid"
member = "cable"
position = 0.5
direction = [0.0, 1.0, 0.0]
quantity = "acceleration"
)";

const char* const kShaker = R"([[load]]
name = "shaker"
kind = "record"
member = "cable"
position = 0.25
direction = [0.0, -1.0, 0.0]
file = "FILE"
)";

/// The folder that the commands below name their files in.
struct Files {
  TemporaryFolder folder;
  Files() {
    folder.write("bare.toml", kRig);
    folder.write("beam.toml", model::scene_text(model::testing::vertical_beam(1, 2, 0.3, 10)));
    folder.write("scene.toml", kRig + kHit);
    folder.write("misspelt.toml", replaced(kRig, "GJ = 0.1", "G_J = 0.1"));
    folder.write("nodeless.toml", replaced(kRig, "[\"left\", ", "[\"lfet\", "));
    folder.write("modes.csv", "frequency_hz,plane\n7.36,in\n14.5,in\n21.8,in\n");
    folder.write("damped.csv", "frequency_hz,damping_ratio\n7.36,0.5\n14.5,1.7\n");
    folder.write("shaped.csv", "frequency_hz,shape:mdi\n7.36,1\n");
    folder.write("negative.csv", "frequency_hz\n-7.36\n");
    folder.write("ragged.csv", "frequency_hz,plane\n7.36,in,3\n");
    folder.write("sideways.csv", "frequency_hz,plane\n7.36,up\n");
    folder.write("blank.csv", "frequency_hz\n");
    folder.write("table.csv", "tension_N,load_N,deflection_mm\n100,10,1\n100,20,2\n100,30,3\n");
    folder.write("gaps.csv", "tension_N,EI_Nm2\n100,0.4\n-200,0.5\n");
    folder.write("stiffness.csv", "tension_N,EI_Nm2\n100,0.4\n200,0.5\n");
    folder.write("other.json", "{\"EA_N\": 3}");
    folder.write("fit.json", R"({"parameters": [{"name": "cable.EI", "value": 1, "std": 0.1}],
                    "correlation": [[1.0]]})");
    folder.write("words.csv", "nothing here\nbut words\n");
    folder.write("empty.csv", "");
    folder.write("bad.csv", "t,F\n0,1\n0.1,2\n0.2,oops\n0.3,3\n0.4,1\n");
    folder.write("halves.csv", "order,frequency_hz\n1.5,3\n");
    std::string frf = "Frequency (Hz),Real ((m/s^2)/N),Imag ((m/s^2)/N)\n";
    for (int k = 1; k < 200; ++k) frf += fmt::format("{},{},{}\n", k, 0.1 * k, 1.0 / k);
    folder.write("frf.csv", frf);
    std::string one = "t (s),a (m/s2)\n", two = "t (s),F (N),a (m/s2)\n", none = "a (m/s2)\n";
    for (int k = 0; k < 500; ++k) {
      const double t = k / 500.0;
      const std::string a = std::to_string(std::exp(-2 * t) * std::cos(40 * kPi * t));
      const std::string time = std::to_string(t);
      one += time + "," + a + "\n";
      two += time + ",0.5," + a + "\n";
      none += a + "\n";
    }
    const std::pair<const char*, const char*> forces[] = {
        {"forces", "t (s),F (N),G (N)\n0,1,2\n0.1,2,3\n0.2,3,4\n"},
        {"no_force", "t (s),a (m/s2)\n0,1\n0.1,2\n0.2,3\n"},
        {"missing", "t (s),F (N)\n0,1\n0.1,\n0.2,3\n0.3,3\n"},
        {"timeless", "F (N)\n1\n2\n3\n"}};
    for (const auto& [name, text] : forces) {
      folder.write(std::string(name) + ".csv", text);
      const std::string hit = kHit;
      folder.write(std::string(name) + "_scene.toml",
                   kRig + replaced(kShaker, "FILE", std::string(name) + ".csv") +
                       hit.substr(hit.find("[[sensor]]")));
    }
    folder.write("decay.csv", one);
    folder.write("two.csv", two);
    std::string uneven = "t (s),a (m/s2)\n", stiff = "tension_N,load_mm,deflection_mm\n";
    for (int k = 0; k < 100; ++k) {
      uneven +=
          std::to_string(k / 500.0 + (k % 2 == 0 ? 0 : 0.0015)) + ",1." + std::to_string(k) + "\n";
      stiff += "100," + std::to_string(0.5 * k) + "," + std::to_string(0.005 * k) + "\n";
    }
    folder.write("uneven.csv", uneven);
    folder.write("millimetres.csv", stiff);
    folder.write("norate.csv", none);
  }
};

struct Wrong {
  /// A line as run_line takes it; "@x" is a file of the folder.
  std::string command;
  int code;
  std::string says;
};

void expect_refused(const Files& files, const std::vector<Wrong>& all) {
  for (const Wrong& wrong : all) {
    SCOPED_TRACE(wrong.command);
    const std::regex file("@");
    const auto run = run_line(std::regex_replace(wrong.command, file, files.folder.at("")));
    EXPECT_EQ(run.exit_code, wrong.code) << run.out << run.err;
    EXPECT_THAT(run.err, HasSubstr(wrong.says));
    EXPECT_FALSE(std::filesystem::exists(files.folder.path() / "out"));
  }
}

TEST(Refusals, OfOptionsThatAreNoNumbersOrOutOfRange) {
  const Files files;
  expect_refused(
      files,
      {{"axial @decay.csv --mass nan --length 1", 2, "--mass: \"nan\" is no positive number"},
       {"axial @decay.csv --mass 2.2 --length 1 --mass-std inf", 2, "no number from zero up"},
       {"axial @decay.csv --mass 2,x --length 1", 2, "--mass-std: \"x\" is no number from zero up"},
       {"axial @decay.csv --mass 2 --length 1 --frame-stiffness soft", 2,
        "\"soft\" is no positive number or rigid"},
       {"bending @table.csv --span 1 --relative-std 2", 2, "2 is no number from 0 to 1"},
       {"decay @decay.csv --start nan", 2, "no finite number"},
       {"inspect @decay.csv --sample-rate 5Hz", 2, "\"5Hz\" is no positive number"},
       {"update @scene.toml --measured @modes.csv --model-std nan", 2, "no number from 0 to 1"},
       {"frf @two.csv --force F --exponential-window nan", 2, "no number from 0 to 1e+06"}});
}

TEST(Refusals, OfBands) {
  const Files files;
  expect_refused(files,
                 {{"update @scene.toml --measured @modes.csv --band 5 3", 2, "--band: must rise"},
                  {"modes @scene.toml --band 50 5", 2, "--band: must rise: two frequencies in Hz"},
                  {"modes @scene.toml --band 0 nan", 2, "no number from zero up"},
                  {"frf @two.csv --force F --band 5 3", 2, "--band: must rise"}});
}

TEST(Refusals, OfARecordingTooSlowForItsBandLeavesTheRestOfTheReport) {
  const Files files;
  std::string campaign = "title = \"rig\"\n";
  const auto add = [&](const char* name, const char* kind, const char* band, const char* length) {
    campaign += std::string("[[test]]\nname = \"") + name + "\"\nkind = " + kind +
                "\nband = " + band + "\n[[test.recording]]\nfiles = \"decay.csv\"\n" + length;
  };
  for (const bool slow : {false, true}) {
    const char* const band = slow ? "[300, 400]" : "[5, 100]";
    add(slow ? "slow" : "ring", "\"decay\"", band, "");
    add(slow ? "slow_drop" : "drop", "\"axial\"\nmass = 2.2", band, "length = 1.0\n");
  }
  const auto out = files.folder.path() / "out";
  const auto run = run_program(
      {"report", files.folder.write("campaign.toml", campaign), "--out", out.string(), "--quiet"});
  EXPECT_EQ(run.exit_code, 4) << run.err;
  const auto report = parsed(files.folder.read("out/report.json"));
  EXPECT_EQ(report["decays"].size(), 2u);
  EXPECT_EQ(report["axial"].size(), 2u);
  int told = 0;
  for (const auto& warning : report["warnings"]) {
    const std::string message = warning["message"];
    told += message.find("above half the sample rate, 250 Hz") != std::string::npos ? 1 : 0;
  }
  EXPECT_GE(told, 2);
}

TEST(Refusals, OfUpdate) {
  const Files files;
  const std::string modes = "update @scene.toml --out @out --measured @modes.csv ";
  const std::string table = "update @scene.toml --out @out --measured ";
  expect_refused(
      files,
      {{"update @scene.toml", 2, "nothing to fit to"},
       {"update @scene.toml @scene.toml --measured @modes.csv", 2, "with several scenes"},
       {modes + "--plane in out", 2, "--plane: one for all, or one for each file"},
       {modes + "--tension 100", 2, "--tension: one for each --frf"},
       {modes + "--free ''", 2, "a parameter without a name"},
       {modes + "--free x=cable.EI,,cable.EA", 2, "an empty name in \"cable.EI,,cable.EA\""},
       {modes + "--free cable.XX", 3, "no parameter \"cable.XX\"; use one of: cable.EI"},
       {modes + "--prior cable.EI", 2, "--prior: write NAME=VALUE,STD with a positive"},
       {modes + "--prior cable.EI=1,0", 2, "with a positive number at its end"},
       {modes + "--prior cable.EA=1,1", 2, "cable.EA is not among --free"},
       {modes + "--input cable.EI", 2, "--input: write TARGET=STD, TARGET=0.5%"},
       {modes + "--input cable.EI=-1", 2, "with a positive number at its end"},
       {modes + "--input =1", 2, "not \"=1\""},
       {modes + "--input cable.XX=1", 3, "no parameter \"cable.XX\""},
       {modes + "--hold-out", 2, "--hold-out needs several states"},
       {modes + "--axial @other.json", 3, "has no std"},
       {modes + "--stiffness @other.json", 3, "is no such result"},
       {modes + "--stiffness @gaps.csv", 3, "channel \"tension_N\": row 2 has no positive"},
       {modes + "--stiffness @stiffness.csv", 2, "--stiffness goes by tension: give"},
       {modes + "--column zz", 3, "has no column \"zz\""},
       {table + "@damped.csv", 3, "damped.csv:3: damping_ratio: 1.7 is no number from"},
       {table + "@shaped.csv", 3, "shaped.csv:1: shape:mdi: the scene has no such sensor"},
       {table + "@negative.csv", 3, "-7.36 is no positive number"},
       {table + "@ragged.csv", 3, "ragged.csv:2: has 3 values, the header 2"},
       {table + "@sideways.csv", 3, "\"up\" is none of any, in, out"},
       {table + "@blank.csv", 3, "blank.csv: holds no rows; give a header line"},
       {"update @scene.toml --frf @modes.csv", 3, "modes.csv"},
       {"update @scene.toml --decay @norate.csv", 2, "norate.csv gives no sample rate"},
       {"update @scene.toml --decay @two.csv", 2, "name the channel with --channel"},
       {"update @scene.toml --decay @decay.csv --band 300 400", 4, "above half the sample rate"}});
  // A fit that does not get on says so itself: what its solver logs is not for people.
  const auto path = [&](const char* name) { return (files.folder.path() / name).string(); };
  const auto run = run_program({"update", path("scene.toml"), "--measured", path("modes.csv"),
                                "--out", path("out"), "--prior", "cable.EI=0.5,1e-300"});
  EXPECT_EQ(run.exit_code, 5);
  EXPECT_THAT(run.err, HasSubstr("had not settled"));
  EXPECT_THAT(run.err, Not(HasSubstr("minimizer")));
}

TEST(Refusals, OfTensionsOfCables) {
  const Files files;
  const std::string cable = "tension --mass-per-length 1 ";
  expect_refused(
      files,
      {{cable + "--length 2", 2, "--frequencies"},
       {cable + "--length 2m --frequencies 3", 2, "--length"},
       {cable + "--length -2 --frequencies 3", 2, "length"},
       {cable + "--length 2 --frequencies 3 --EI -1", 2, "EI"},
       {cable + "--length 2 --frequencies 3 --order 3 1", 2, "orders 3 1"},
       {cable + "--length 2 --measured @none.csv", 3, "none.csv"},
       {cable + "--length 2 --measured @halves.csv", 3, "halves.csv:2"},
       // The first four modes of a cantilever: (1.8751^2, 4.6941^2, 7.8548^2, 10.9955^2) in ratio.
       {cable + "--length 1 --frequencies 3.516 22.034 61.697 120.902 --order 1 2 3 4", 4,
        "no tension fits the frequencies; tried with ends"}});
}

TEST(Refusals, OfWhatTheModelIsAskedFor) {
  const Files files;
  expect_refused(
      files,
      {{"respond @scene.toml --duration 0.001 --rate 100 --out @out", 2, "at least one sample"},
       {"respond @scene.toml --duration 1e6 --rate 1e6 --out @out", 2, "more than 50 million"},
       {"respond @forces_scene.toml --duration 1 --rate 9 --out @out", 3, "more than one channel"},
       {"respond @no_force_scene.toml --duration 1 --rate 9 --out @out", 3, "has no force channel"},
       {"respond @missing_scene.toml --duration 1 --rate 9 --out @out", 3, "has missing samples"},
       {"respond @timeless_scene.toml --duration 1 --rate 9 --out @out", 3,
        "a time column nor a rate"},
       {"respond @bare.toml --duration 1 --rate 100 --out @out", 3, "add a [[sensor]]"},
       {"bench @bare.toml --quick", 4, "no load"},
       {"modes @none.toml", 3, "none.toml"},
       // All mistakes in scenes: tests/model/scene/read_scene_test.cc.
       {"modes @misspelt.toml", 3,
        "misspelt.toml:17:1: member[0].G_J: this key is not known here; did you mean \"GJ\"?\n"},
       {"modes @nodeless.toml", 3,
        "nodeless.toml:12:9: member[0].nodes: there is no node \"lfet\"; did you mean \"left\"?\n"},
       {"modes @scene.toml --count 0", 2, "--count"},
       {"modes @scene.toml --band 1 5 --count 3", 2, "--count"},
       {"synthesize @scene.toml --out @out --rate 1e300", 2, "lower --rate"},
       {"synthesize @beam.toml --out @lab --bending-span 1", 3, "no cable"},
       {"predict @bare.toml --from @other.json", 3, "parameters"},
       {"predict @bare.toml --from @fit.json --input cable.EA", 2, "--input"},
       {"predict @bare.toml --from @fit.json --input cable.EA=0", 2, "--input"},
       {"predict @bare.toml --from @fit.json --input cable.EA=1 cable.EA=2", 2, "given twice"},
       {"predict $/jalali2021/scenes/beam.toml --from @fit.json", 4, "beam.EI_z"},
       {"plan @scene.toml --goal cable.EI", 2, "--goal"},
       {"plan @scene.toml --goal cable.EI=-5%", 2, "--goal"},
       {"plan @scene.toml --goal =5%", 2, "--goal"},
       {"plan @scene.toml --goal rope.EI=5%", 3, "rope.EI"},
       {"plan $/jalali2021/scenes/rig.toml --goal beam.EI_z=5% --length 1", 2, "one member"},
       {"report", 2, "campaign is required"},
       {"report @none.toml --out @out", 3, "none.toml"},
       {"report $/jalali2021/campaign.toml --out @decay.csv", 3, "decay.csv"},
       {"export @bare.toml", 2, "--calculix"},
       {"synthesize @bare.toml --out @out", 2, "nothing to test: give the scene a load"},
       {"synthesize @scene.toml --out @scene.toml", 3, "cannot write"},
       {"synthesize @bare.toml --out @out --bending-span 1 --stiffness @stiffness.csv", 2,
        "--stiffness: is given without --tension"},
       {"synthesize @bare.toml --out @out --bending-span 1 --stiffness @gaps.csv --tension 100", 3,
        "channel \"tension_N\": row 2 has no positive"},
       {"new @scene.toml", 3, "cannot write"}});
}

/// Scenes that read well and cannot rest: exit code 5, what gives way, and what to change.
TEST(Refusals, OfScenesThatCannotRest) {
  const auto limp = [](const std::string& tension) {
    return replaced(kCableScene, "tension = 200.0", tension);
  };
  // A post on a hinge falls over; a mast too slender for its own weight buckles.
  const auto post = [](bool hinged, double mass_per_length, bool weightless = false) {
    auto scene = model::testing::vertical_beam(0.75, 2.1, mass_per_length, 20);
    if (hinged) scene.nodes[0].support.kind = model::Support::Kind::pinned;
    if (weightless) scene.gravity.setZero();
    scene.members[0].EA = 1e6, scene.members[0].GJ = 0;
    return model::scene_text(scene);
  };
  auto twisting = model::testing::cable_beam_rig(200, 0.5972, 8);
  twisting.members[0].GJ = 0;
  struct Impossible {
    std::string scene, status, culprit, remedy;
  };
  const TemporaryFolder folder;
  for (const Impossible& one :
       {Impossible{"gravity = 0.0\n" + limp("unstretched_length = 3.0"), "slack", "cable \"cable\"",
                   "a shorter unstretched_length"},
        {replaced(limp("tension = 1e-6"), "EI = 0.5972\nGJ = 0.1", "EI = 0"), "slack",
         "cable \"cable\"", "a larger tension"},
        {model::scene_text(twisting), "mechanism", "\"beam\" can twist", "give it a GJ"},
        {post(true, 0.3), "buckled", "buckled", "brace it"},
        {post(false, 6), "buckled", "buckled", "brace it"},
        {post(true, 0.3, true), "mechanism", "\"beam\" can move",
         "give one of its nodes a support"}}) {
    const std::string scene = folder.write("rig.toml", one.scene);
    const auto run = run_line("modes {} --json -", {scene});
    EXPECT_EQ(run.exit_code, 5) << one.scene << run.err;
    EXPECT_THAT(run.err, HasSubstr(scene));
    EXPECT_THAT(run.err, HasSubstr(one.culprit));
    EXPECT_THAT(run.err, HasSubstr(one.remedy));
    const auto json = parsed(run.out);
    EXPECT_EQ(json["equilibrium"]["status"], one.status) << one.scene;
    EXPECT_TRUE(json["modes"].empty());
  }
}

TEST(Refusals, OfRecordings) {
  const Files files;
  expect_refused(
      files,
      {{"decay @norate.csv", 2, "gives no sample rate: say it with --sample-rate"},
       {"decay @decay.csv --start 5 --end 6", 2, "in the record, which lasts from 0 s to 1 s"},
       {"decay @decay.csv --start 0.5 --end 0.504", 4, "refused: "},
       {"axial @norate.csv --mass 2.2 --length 1", 2, "say it with --sample-rate"},
       {"axial @uneven.csv --mass 2 --length 1", 4, "samples are not evenly spaced in time"},
       {"decay @uneven.csv", 4, "Resample the recording first"},
       {"decay @two.csv", 2, "name the channel with --channel; there are: \"F\", \"a\""},
       {"bending @millimetres.csv --span 0.5", 3, "its unit is not one of force (\"m\")"},
       {"axial @decay.csv @two.csv --mass 2.2 --length 1 2 3", 2, "2 files and 3 lengths"},
       {"bending @table.csv", 2, "--span is needed for load-deflection records"},
       {"bending @table.csv --span 1 --tension zz", 3, "no such column; name it with --tension"},
       {"bending @gaps.csv", 3, "gaps.csv"},
       {"frf @two.csv --force F --response F", 2, "\"F\" is the force: it cannot be a response"},
       {"frf @two.csv --force F --force-window x", 2,
        "--force-window: \"x\" is no positive number or auto or off"},
       {"frf @two.csv --force F --struck a b", 2, "--struck names 2 points for 1 file"},
       {"frf @two.csv --force F --response a", 4, "nothing in \"F\" rises above the noise"},
       {"modal @decay.csv --force a", 4, "has no channel besides the force"},
       {"modal @decay.csv", 3, "no table of FRFs"},
       {"inspect @none.csv", 3, "cannot be opened: No such file"},
       {"inspect @bad.csv", 3, "bad.csv:4:5"},
       {"inspect @empty.csv", 3, "empty.csv"},
       {"inspect @", 3, "rigfit-test"},
       {"inspect", 2, "FILE"},
       {"inspect @two.csv @two.csv", 2, "is given twice"},
       {"decay", 2, "file is required"},
       {"decay @decay.csv --channel gyro", 3, "\"a\""},
       {"frf @two.csv", 2, "--force"},
       {"frf @two.csv --force F --driving-point F", 2, "not among"},
       {"frf @two.csv --force hammer", 3, "hammer"},
       {"modal @table.csv", 3, "table.csv"},
       {"modal @frf.csv --order 1", 2, "--order"},
       {"modal @frf.csv --band 5000 6000", 4, "0 usable lines"},
       {"modal @decay.csv --ambient --block 2", 2, "--block"}});
}

TEST(Refusals, OfCampaignsWithRecordingsAndFits) {
  const Files files;
  files.folder.write("cable.toml", kRig + kHit);
  const auto campaign = testing::content_of(RIGFIT_FUZZ "/seeds/campaign/hits_and_fit.toml");
  EXPECT_NO_THROW(static_cast<void>(read_campaign(files.folder.write("campaign.toml", campaign))));
  struct Mistake {
    std::string from, to, says;
  };
  const std::vector<Mistake> all{
      {"[5, 100]", "[100, 5]", "test[0].band: must rise"},
      {"exponential_window = 0.05", "exponential_window = 5",
       "test[0].exponential_window: 5 is no number from 1e-12 to 0.999"},
      {"direction = [0, 0, 1]", "direction = [0, 0, 0]", "test[0].direction: is zero"},
      {"a = \"mid\"", "a = \"mdi\"",
       "test[0].sensors.a: there is no sensor of the scene \"mdi\"; did"},
      {"files = [\"two.csv\"]", "files = []", "test[0].recording[0].files: is empty"},
      {"sensitivity = 2.27", "sensitivity = 0", "channel[0].sensitivity: is zero"},
      {"\"mV/N\"", "\"mV\"", "sensitivity_unit: is not a quotient of two units"},
      {"sensitivity = 2.27", "sensitivity = 2.27\nscale = 2", "scale: stands beside a sensitivity"},
      {"sensitivity = 2.27", "sensitivity = 2.27\nunit = \"N\"",
       "unit: does not fit a sensitivity in mV/N"},
      {"unit = \"g\"", "unit = \"furlong\"", "\"furlong\" is no unit we know; write it like"},
      {"scale = 0.1", "scale = 0", "channel[1].scale: is zero"},
      {"[0, 1, 0]", "[0, 0, 0]", "channel[1].direction: is zero"},
      {"tension = 200\n", "", "test[0].tension_of: is given although there is no tension"},
      {"tension_of = \"cable.tension\"\n", "", "tension_of: is missing although the test goes"},
      {"[[test]]\nname = \"ring\"", "[[test.recording]]\nfiles = \"x\"\n[[test]]\nname = \"ring\"",
       "test[0].recording: some recordings have a tension and some have none"},
      {"kind = \"decay\"", "kind = \"decay\"\nload = \"hamer\"",
       "test[1].load: there is no load of the scene \"hamer\"; did you mean \"hammer\""},
      {"length = 1.0\n", "", "test[2].recording: a recording of an axial test has no length"},
      {"span = 1.0", "span = 1.0\ntable = { file = \"gaps.csv\" }",
       "test[3].table: is given beside recordings; keep one"},
      {"span = 1.0", "span = 1.0\nends = \"pinned\"", "without tension"},
      {"span = 1.0", "span = 1.0\ntension = 20", "is not 0"},
      {"span = 1.0", "span = 1.0\ntension = 0\ndiameter = 0.01\nrectangle = [1, 1]", "keep one"},
      {"frequencies = [2.5, 5.0]\n", "", "frequencies"},
      {"tests = \"hits\"", "tests = []", "fit[0].tests: is empty"},
      {"tests = \"hits\"", "tests = \"ring\"",
       "fit[0].tests: there is no modal test with a scene \"ring\""},
      {"predicts = \"ring\"", "predicts = \"hits\"", "no decay test with a scene \"hits\""},
      {"high = 2.0", "high = 0.05", "fit[0].parameter[0].high: is not above low"},
      {"prior_std = 0.1\n", "", "fit[0].parameter[0].prior: is given without prior_std"},
      {"name = \"cable.EI\"", "name = \"cable.EJ\"", "no parameter \"cable.EJ\"; did you mean"},
      {"[[fit.parameter]]", "[[fit.unknown]]", "fit[0].parameter: is missing"},
  };
  for (const Mistake& mistake : all) {
    SCOPED_TRACE(mistake.from + " -> " + mistake.to);
    const std::string text = replaced(campaign, mistake.from, mistake.to);
    const std::string out = (files.folder.path() / "out").string();
    const auto run =
        run_program({"report", files.folder.write("campaign.toml", text), "--out", out});
    EXPECT_EQ(run.exit_code, 3) << run.err;
    EXPECT_THAT(run.err, HasSubstr("campaign.toml:"));
    EXPECT_THAT(run.err, HasSubstr(mistake.says));
    EXPECT_FALSE(std::filesystem::exists(out));
  }
}

}  // namespace rigfit::apps::refusals_test
