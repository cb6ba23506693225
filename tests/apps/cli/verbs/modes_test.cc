#include "tests/apps/apps_test.h"

namespace rigfit::apps::modes_test {

const std::string kCable = kCableScene + std::string("damping_ratio = 0.005\n");

TEST(ModesVerb, GivesTheCablesModes) {
  const TemporaryFolder folder;
  const Document json =
      document_of("modes {} --count 4 --shapes",
                  {folder.write("cable.toml", replaced(kCable, "12", "\"auto\""))});
  EXPECT_EQ(json["command"], "modes");
  ASSERT_EQ(json["modes"].size(), 4u);
  // Taut string of mass 0.16667 kg/m with EI: f = sqrt((T + EI k^2) / m) / (2 L), to the strain
  // T / EA = 9e-4 and the sag's and the accuracy's 1e-4.
  const double k = kPi / 2.4;
  const double f1 = k / (2 * kPi) * std::sqrt((200 + 0.5972 * k * k) / 0.16667);
  EXPECT_EQ(json["modes"][0]["plane"], "out");
  EXPECT_NEAR(json["modes"][0]["frequency_hz"].get<double>() / f1, 1, 1e-3);
  EXPECT_EQ(json["modes"][1]["plane"], "in");
  EXPECT_GT(json["modes"][1]["frequency_hz"], json["modes"][0]["frequency_hz"]);
  for (const auto& mode : json["modes"]) {
    EXPECT_EQ(mode["family"], "cable");
    EXPECT_NEAR(mode["damping_ratio"], 0.005, 1e-12);
    EXPECT_NEAR(mode["kinetic_energy"]["cable"], 1, 1e-9);
  }
  const auto& rest = json["equilibrium"]["members"][0];
  EXPECT_NEAR(rest["tension_N"], 200, 1e-6);
  // Parabola m g L^2 / (8 T), to its (sag / span)^2.
  EXPECT_NEAR(rest["sag_m"], 0.16667 * 9.80665 * 5.76 / 1600, 1e-4);
  EXPECT_EQ(json["modes"][0]["shape"][0]["displacement"].size(),
            rest["segments"].get<std::size_t>() + 1);
  EXPECT_LE(json["relative_error_estimate"].get<double>(), 1e-4);
  EXPECT_TRUE(json["complete"].get<bool>());
  EXPECT_EQ(json["modelled"]["left_out"][0]["what"], "torsion");
}

TEST(ModesVerb, ExampleOfTheHelpWorks) {
  const TemporaryFolder folder;
  const auto run =
      run_line("modes $/jalali2021/scenes/rig.toml --count 6 --json {}", {folder.at("modes.json")});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_EQ(parsed(folder.read("modes.json"))["modes"].size(), 6u);
  EXPECT_THAT(run.out, HasSubstr("Sturm"));
}

TEST(ModesVerb, OptionsOfTheModel) {
  const TemporaryFolder folder;
  const std::string cable = folder.write("cable.toml", replaced(kCable, "12", "30"));
  const auto empty = run_line("modes {} --band 1 2 --json -", {cable});
  EXPECT_EQ(empty.exit_code, 0) << empty.err;
  const auto json = parsed(empty.out);
  EXPECT_TRUE(json["modes"].empty());
  ASSERT_GE(json["warnings"].size(), 1u);
  EXPECT_EQ(json["warnings"][0]["code"], "no_modes");

  EXPECT_EQ(document_of("modes {} --torsion on --shapes",
                        {folder.write("twist.toml", kCable)})["modes"][0]["shape"][0]["twist"]
                .size(),
            12u);
}

}  // namespace rigfit::apps::modes_test
