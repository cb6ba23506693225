#include "tests/apps/apps_test.h"

namespace rigfit::apps::new_test {

TEST(New, WritesACampaignThatRunsAndNeverOverwrites) {
  const TemporaryFolder folder;
  const std::string rig = folder.at("rig");
  EXPECT_EQ(document_of("new {}", {rig})["files"].size(), 4u);
  const auto report = run_line("report {}/campaign.toml", {rig});
  EXPECT_EQ(report.exit_code, 0) << report.err;
  EXPECT_THAT(folder.read("rig/report/report.html"), HasSubstr("Example: a cable in a test rig"));
  const auto again = run_line("new {}", {rig});
  EXPECT_EQ(again.exit_code, 2);
  EXPECT_THAT(again.err, HasSubstr("exists already"));
  EXPECT_EQ(run_line("new").exit_code, 2);
}

// A folder as it comes: a static table of two forces, a swing in volts, a picture. Nothing is
// written there; what is not used is said; the campaign runs.
TEST(New, AFolderOfMixedFiles) {
  const TemporaryFolder folder;
  std::string table = "Nr;Vorspannkraft [N];Querkraft [N];Weg [mm]\n";
  for (int k = 1; k <= 12; ++k) {
    std::string line = fmt::format("{};{:.2f};{:.3f};{:.5f}\n", k, 100 + 0.03 * (k % 3), 0.5 * k,
                                   0.5 * k / 3.0 + 1e-5 * (k % 2));
    std::replace(line.begin(), line.end(), '.', ',');
    table += line;
  }
  const std::string file = folder.write("data/table.csv", table);
  std::string swing = "Einheit;V\nZeit;CH1;CH2\n";
  for (int k = 0; k < 2000; ++k) {
    const double t = 1e-3 * k, x = std::exp(-3 * t) * std::sin(2 * kPi * 25 * t);
    swing += fmt::format("{:.3f};{:.6f};{:.6f}\n", t, 0.1 * x + 1e-4 * std::sin(97.0 * k * k), x);
  }
  folder.write("data/swing.csv", swing);
  folder.write("data/photo.jpg", "\xFF\xD8\xFF...");
  const std::string data = folder.at("data"), rig = folder.at("rig");
  const auto run =
      run_line("new {} --from {} --span 1 --sensitivity 'CH1=100 mV/g' --json -", {rig, data});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(parsed(run.out)["files"], ElementsAre(rig + "/campaign.toml"));
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(data), {}), 3);
  EXPECT_THAT(run.err, HasSubstr("photo.jpg"));
  const std::string text = folder.read("rig/campaign.toml");
  EXPECT_THAT(text, HasSubstr("tension = \"Vorspannkraft\", load = \"Querkraft\""));
  EXPECT_THAT(text, HasSubstr("sensitivity_unit = \"mV/g\""));
  const auto report = run_line("report {}/campaign.toml --json -", {rig});
  EXPECT_THAT(report.exit_code, ::testing::AnyOf(0, 4)) << report.err;
  EXPECT_TRUE(std::filesystem::exists(rig + "/report/report.html"));
  const auto test = parsed(report.out)["bending"][0]["tests"][0];
  EXPECT_NEAR(test["tension_N"], 100, 0.1);
  // The same table by the verb, whose columns it finds.
  EXPECT_EQ(document_of("bending {} --span 1", {file})["tests"][0]["EI_Nm2"], test["EI_Nm2"]);
  EXPECT_THAT(run_line("inspect {}", {file}).err, HasSubstr("rigfit bending"));

  for (const auto& [options, message] :
       {std::pair{"--from {}/swing.csv --span 1", "--span belongs to none of these tests"},
        {"--example --mass 2", "--mass: is given without --from"},
        {"--from {}/swing.csv --kind tension", "give the length"}}) {
    std::vector<std::string> values{rig + "2"};
    if (std::string(options).starts_with("--from")) values.push_back(data);
    const auto refused = run_line(std::string("new {} ") + options, values);
    EXPECT_EQ(refused.exit_code, 2);
    EXPECT_THAT(refused.err, HasSubstr(message));
  }
  EXPECT_FALSE(std::filesystem::exists(rig + "2"));
  const auto tension =
      run_line("new {} --from {}/swing.csv --kind tension --length 2.4 --mass-per-length 0.167",
               {rig + "3", data});
  EXPECT_EQ(tension.exit_code, 0) << tension.err;
  EXPECT_THAT(folder.read("rig3/campaign.toml"), HasSubstr("length = 2.4"));
  EXPECT_EQ(run_line("new {} --from {}/photo.jpg", {rig + "4", data}).exit_code, 3);
  // Load over extension may be of a beam that was bent or of a cable that was pulled: it is said.
  const std::string pull = folder.write(
      "pull.csv", "Load (N);Extension (mm)\n0,0;0,000\n100,0;1,333\n200,0;2,667\n300,0;4,000\n");
  const auto bent = run_line("new {} --from {} --span 2", {rig + "5", pull});
  EXPECT_EQ(bent.exit_code, 0) << bent.err;
  EXPECT_THAT(bent.out, HasSubstr("EA is the slope times the length"));
}

// 300 s of one mode under white noise (1.3 Hz, 2 %: 49 decay times), of which no part decays.
TEST(New, AmbientMotionIsNoDecay) {
  const TemporaryFolder folder;
  std::mt19937 engine(1);
  std::string text = "t [s],a [m/s2]\n";
  const std::complex<double> step = std::exp(2 * kPi * 1.3 / 20 * std::complex(-0.02, 1.0));
  std::complex<double> z = 0;
  for (int k = 0; k < 6000; ++k) {
    z = step * z + (engine() / 4294967296.0 - 0.5);
    text += fmt::format("{:.2f},{:.5f}\n", 0.05 * k, z.imag());
  }
  const auto run = run_line("new {} --from {}", {folder.at("rig"), folder.write("wind.csv", text)});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(folder.read("rig/campaign.toml"), HasSubstr("ambient = true"));
}

}  // namespace rigfit::apps::new_test
