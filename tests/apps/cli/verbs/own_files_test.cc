// From files of one's own to values: FRFs as text to modes, recordings to a campaign that runs.
#include "tests/apps/apps_test.h"

namespace rigfit::apps::own_files_test {

TEST(OwnFiles, FrfsAsTextGiveModes) {
  // Two modes at 40 and 90 Hz, 1 % damping, seen at two points; eight digits.
  const TemporaryFolder folder;
  std::vector<std::string> points;
  for (const int point : {0, 1}) {
    std::string text = "Frequency\tReal\tImaginary\nHz\t(m/s^2)/N\t(m/s^2)/N\n";
    for (int k = 0; k <= 1000; ++k) {
      const double f = 10 + 0.1 * k;
      Complex h = 0;
      for (const int mode : {0, 1}) {
        const double f0 = mode == 0 ? 40 : 90, shape = mode == 0 ? 1 : (point == 0 ? 1 : -0.5);
        h += -shape * f * f / Complex(f0 * f0 - f * f, 2 * 0.01 * f0 * f);
      }
      text += fmt::format("{:.2f}\t{:.8e}\t{:.8e}\n", f, h.real(), h.imag());
    }
    points.push_back(folder.write(fmt::format("point{}.txt", point), text));
  }
  EXPECT_THAT(run_line("inspect {}", {points[0]}).err, HasSubstr("rigfit modal takes FRFs"));
  const auto modes = document_of("modal {} {}", points)["modes"];
  ASSERT_EQ(modes.size(), 2u);
  EXPECT_NEAR(modes[0]["frequency_hz"]["value"], 40, 1e-3);
  EXPECT_NEAR(modes[1]["frequency_hz"]["value"], 90, 1e-3);
  EXPECT_NEAR(modes[1]["damping_ratio"]["value"], 0.01, 1e-5);
  const auto fft = folder.write("fft.csv", "Frequency (Hz),Amplitude\n0,1\n1,2\n2,1\n");
  EXPECT_EQ(run_line("decay {} --channel Amplitude", {fft}).exit_code, 3);
}

// One channels.toml for recordings of different channels: silent where each has its own, said where
// a name is misspelt or nothing fits.
TEST(OwnFiles, AFolderDescribesDifferentRecordings) {
  const TemporaryFolder folder;
  folder.write("channels.toml",
               "[[channel]]\nsource = \"force 1\"\nunit = \"N\"\n"
               "[[channel]]\nsource = \"wire gauge\"\nunit = \"mm\"\n");
  const auto warning_of = [&](const std::string& channel) {
    std::string text = "time [s];" + channel + "\n";
    const bool two = channel.find(';') != std::string::npos;
    for (int k = 0; k < 200; ++k) {
      text += fmt::format("{:.3f};{:.3f}{}\n", 1e-3 * k, std::sin(0.1 * k), two ? ";1.5" : "");
    }
    const auto document = document_of("inspect {}", {folder.write("a.csv", text)});
    for (const auto& warning : document["warnings"]) {
      if (warning["code"] == "described_channel_absent")
        return warning["message"].get<std::string>();
    }
    return std::string();
  };
  EXPECT_EQ(warning_of("force 1"), "");
  EXPECT_EQ(warning_of("force 1;wire gauge"), "");
  EXPECT_THAT(warning_of("force 1;wire guage [mm]"), HasSubstr("did you mean \"wire guage\""));
  EXPECT_THAT(warning_of("temperature"), HasSubstr("does not have"));
}

// A logger's names say nothing: the hammer is the channel of short pulses to one side, also where
// one file holds several hits.
TEST(OwnFiles, HammerIsFoundByItsPulses) {
  const TemporaryFolder folder;
  Normal noise(6);
  for (const int hits : {1, 4}) {
    std::string text = "t;CH1 [g];CH2 [N]\n";
    const double omega = 2 * kPi * 25, zeta = 0.02, step = 1e-5;
    double place = 0, speed = 0;
    for (int k = 0; k < 800000; ++k) {
      const double since = std::fmod(step * k - 0.1, 1.9);
      const bool hits_now = step * k > 0.1 && step * k < 0.1 + 1.9 * hits && since < 0.008;
      const double force = hits_now ? std::sin(kPi * since / 0.008) : 0;
      const double motion = force - 2 * zeta * omega * speed - omega * omega * place;
      speed += motion * step;
      place += speed * step;
      if (k % 100 == 0) {
        text += fmt::format("{:.3f};{:.6f};{:.6f}\n", step * k, motion + 1e-3 * noise(),
                            force + 1e-3 * noise());
      }
    }
    const std::string file = folder.write(fmt::format("data{}/hits.csv", hits), text);
    const std::string rig = (folder.path() / fmt::format("rig{}", hits)).string();
    const auto made = run_line("new {} --from {}", {rig, file});
    ASSERT_EQ(made.exit_code, 0) << made.err;
    EXPECT_THAT(made.out, HasSubstr("pulses of a hammer on channel CH2"));
    const auto report = run_line("report {}/campaign.toml --out {}/report", {rig, rig});
    EXPECT_THAT(report.exit_code, ::testing::AnyOf(0, 4)) << report.err;
    const auto test = parsed(folder.read(fmt::format("rig{}/report/report.json", hits)))
                          .at("recorded_modal")
                          .at(0);
    const auto& mode = test.at("states").at(0).at("modes").at(0);
    EXPECT_NEAR(mode.at("frequency_hz").at("value"), 25, 0.05);
  }
}

// A testing machine's export: titles of the machine's language, decimal commas, toe and yield.
TEST(OwnFiles, BendingMachineWithoutTension) {
  const TemporaryFolder folder;
  constexpr double kStiffness = 8.4;  // N/mm
  std::string text = "Datum;07.05.2024\n\nPrüfzeit;Standardweg;Standardkraft\ns;mm;N\n";
  for (int i = 0; i < 300; ++i) {
    const double d = 0.01 * i, x = std::max(0.0, d - 0.25);
    const double load = kStiffness * (std::min(x, 2.0) + 0.3 * std::max(0.0, x - 2.0));
    std::string line = fmt::format("{:.2f};{:.4f};{:.4f}\n", 0.1 * i, d, load);
    std::replace(line.begin(), line.end(), '.', ',');
    text += line;
  }
  const auto file = folder.write("Probe 1.csv", text);
  const auto test = document_of(
      "bending {} --tension 0 --ends pinned --span 0.1 --rectangle 0.01 0.004", {file})["tests"][0];
  EXPECT_EQ(test["ends"], "pinned");
  EXPECT_EQ(test["tension_N"], 0);
  // Four decimals of newtons: 1e-5 of the load; the break of the elastic part is left out.
  EXPECT_NEAR(test["stiffness_N_m"]["value"], 1e3 * kStiffness, 1e-3 * 8400);
  const double EI = 1e3 * kStiffness * 1e-3 / 48, I = 0.01 * std::pow(0.004, 3) / 12;
  EXPECT_NEAR(test["EI_Nm2"]["value"], EI, 1e-3 * EI);
  EXPECT_NEAR(test["modulus_Pa"]["value"], EI / I, 1e-3 * EI / I);

  const auto without = run_line("bending {} --span 0.1", {file});
  EXPECT_EQ(without.exit_code, 3);
  EXPECT_THAT(without.err, HasSubstr("--tension 0"));
  const std::string start = "new {} --from {} --quiet";
  const auto campaign = run_line(start, {folder.at("c"), file});
  EXPECT_EQ(campaign.exit_code, 2);
  EXPECT_THAT(campaign.err, HasSubstr("--span"));
  ASSERT_EQ(run_line(start + " --span 0.1", {folder.at("c"), file}).exit_code, 0);
  EXPECT_THAT(folder.read("c/campaign.toml"), HasSubstr("tension = 0"));
  const auto report =
      document_of("report {} --out {}", {folder.at("c/campaign.toml"), folder.at("out")});
  EXPECT_EQ(report["bending"][0]["tests"][0]["ends"], "clamped");
  EXPECT_EQ(run_line("bending {} --span 0.1 --ends pinned", {file}).exit_code, 2);

  // Dead weights in grams: 0.5 N/mm.
  std::string weights = "mass (g);deflection (mm)\n";
  for (int i = 0; i < 8; ++i)
    weights += fmt::format("{};{:.4f}\n", 50 * i, i * 0.05 * 9.80665 / 0.5);
  const auto dead = document_of("bending {} --tension 0 --ends cantilever --span 0.3",
                                {folder.write("weights.csv", weights)});
  EXPECT_NEAR(dead["tests"][0]["stiffness_N_m"]["value"], 500, 0.1);
}

}  // namespace rigfit::apps::own_files_test
