#include "tests/apps/apps_test.h"

namespace rigfit::apps::inspect_test {

struct Inspect : ::testing::Test {
  [[nodiscard]] Document inspected(const std::string& name) const {
    return document_of("inspect {}", {folder.at(name)});
  }
  TemporaryFolder folder;
};

/// 2 s at 500 Hz: a sine of 3.3 Hz, amplitude 2, cut at `top`; and its negative in millimetres.
std::string sine(double top) {
  std::string text = "Time (s);Load [kN];d (mm)\r\n";
  for (int k = 0; k < 1000; ++k) {
    const double x = std::min(top, 2 * std::sin(2 * kPi * 3.3 * k / 500.0));
    char line[80];
    std::snprintf(line, sizeof line, "%.3f;%.6f;%.6f\r\n", k / 500.0, x, -x);
    text += line;
  }
  for (char& c : text) {
    if (c == '.') c = ',';
  }
  return text;
}

TEST_F(Inspect, ReadsFilesThatAreNoText) {
  for (const std::string name : {"npy/f8.npy", "mat/plain.mat"}) {
    const Document document = document_of("inspect {}", {RIGFIT_FUZZ "/seeds/" + name});
    EXPECT_EQ(document["recordings"][0]["format"], name.substr(0, 3));
  }
}

TEST_F(Inspect, GivesRateChannelsAndClipping) {
  folder.write("a.csv", sine(1.5));
  const Document document = inspected("a.csv");
  const auto& recording = document["recordings"][0];
  EXPECT_EQ(recording["format"], "csv");
  EXPECT_EQ(recording["sample_rate_hz"], 500.0);
  EXPECT_EQ(recording["samples"], 1000);
  EXPECT_EQ(recording["duration_s"], 2.0);
  ASSERT_EQ(recording["channels"].size(), 2u);
  const auto load = recording["channels"][0];
  EXPECT_EQ(load["name"], "Load");
  EXPECT_EQ(load["unit"], "N");
  EXPECT_EQ(load["quantity"], "force");
  EXPECT_EQ(load["max"], 1500.0);
  // 1.5 of 2: above asin(0.75) = 0.848 of pi / 2 in 6.6 periods, seven tops: (pi - 2 * 0.848) / 2
  // pi = 0.230 of a period of 151.5 samples, 34 or 35 a top.
  EXPECT_NEAR(load["clipped_samples"], 7 * 34.9, 7);
  EXPECT_EQ(recording["channels"][1]["unit"], "m");
  EXPECT_THAT(document["warnings"].dump(), HasSubstr("\"clipped\""));
}

TEST_F(Inspect, FileBesideItNamesAndScales) {
  folder.write("b.csv", "t,CH1,CH2\n0,1,10\n0.1,2,20\n0.2,3,15\n0.3,2,10\n");
  folder.write(
      "b.toml",
      "[[channel]]\nsource = \"CH1\"\nname = \"hammer\"\nsensitivity = 2.0\n"
      "unit = \"mV\"\nsensitivity_unit = \"mV/N\"\n[[channel]]\nsource = \"#2\"\nunit = \"g\"\n"
      "direction = [0, -2, 0]\n");
  const Document document = inspected("b.csv");
  const auto channels = document["recordings"][0]["channels"];
  EXPECT_EQ(channels[0]["name"], "hammer");
  EXPECT_EQ(channels[0]["unit"], "N");
  EXPECT_DOUBLE_EQ(channels[0]["max"], 1.5);  // 3 mV over 2 mV/N
  EXPECT_DOUBLE_EQ(channels[1]["max"], 20 * 9.80665);
  EXPECT_EQ(document["inputs"].size(), 2u);
}

TEST_F(Inspect, WrongDescriptionsAreRefused) {
  folder.write("c.csv", "t,CH1\n0,1\n0.1,2\n0.2,3\n");
  for (const std::string text :
       {"[[channel]]\nsource = \"CH9\"\nname = \"x\"\n",
        // The file gives no unit: volts or millivolts?
        "[[channel]]\nsource = \"CH1\"\nsensitivity = 20\nsensitivity_unit = \"mV/N\"\n",
        "[[channel]]\nsource = \"CH1\"\nunit = \"blorp\"\n", "sample_rate = 5\n",
        "[[channel]]\nsource = \"CH1\"\nsensitivity = 0.0\nsensitivity_unit = \"mV/N\"\n",
        "sample_rate_hz = -1.0\n", "[[channel\n"}) {
    folder.write("c.toml", text);
    const auto run = run_line("inspect --json - {}", {folder.at("c.csv")});
    EXPECT_EQ(run.exit_code, 3) << text << run.err;
    EXPECT_THAT(run.err, HasSubstr("c."));
  }
}

TEST_F(Inspect, EmptyChannelGivesNullNotNan) {
  folder.write("d.csv", "t,a,b\n0,1,\n0.5,2,\n1,4,\n1.5,1,\n");
  const Document b = inspected("d.csv")["recordings"][0]["channels"][1];
  EXPECT_TRUE(b["min"].is_null());
  EXPECT_EQ(b["missing_samples"], 4);
}

std::string decay_csv(double f, double zeta, double rate, int samples, double noise, int quiet) {
  Normal normal(3);
  const double w = 2 * kPi * f, wd = w * std::sqrt(1 - zeta * zeta);
  std::string text = "time (s),force (N)\n";
  for (int j = 0; j < samples; ++j) {
    const double t = (j - quiet) / rate;
    const double y =
        21.6 + (j >= quiet ? std::exp(-zeta * w * t) * std::sin(wd * t) : 0.0) + noise * normal();
    text += std::to_string(j / rate) + "," + std::to_string(y) + "\n";
  }
  return text;
}

TEST(DecayVerb, GivesFrequencyAndDampingOfAFile) {
  TemporaryFolder folder;
  const auto file = folder.write("tap.csv", decay_csv(50, 0.017, 500, 800, 0.003, 200));
  const Document json = document_of("decay {} --channel force", {file});
  EXPECT_EQ(json["command"], "decay");
  EXPECT_EQ(json["inputs"].size(), 1u);
  ASSERT_EQ(json["modes"].size(), 1u);
  const auto& mode = json["modes"][0];
  const double f = mode["frequency_hz"]["value"], f_std = mode["frequency_hz"]["std"];
  const double z = mode["damping_ratio"]["value"], z_std = mode["damping_ratio"]["std"];
  EXPECT_NEAR(f, 50, 5 * f_std);
  EXPECT_NEAR(z, 0.017, 5 * z_std);
  EXPECT_LT(f_std, 0.05);
  // The ruler is a check: within a tenth.
  EXPECT_NEAR(mode["damping_ratio_log_decrement"], 0.017, 0.0017);
  EXPECT_GT(mode["r_squared"].get<double>(), 0.99);
  EXPECT_GE(json["window"]["start_s"].get<double>(), 0.399);
  EXPECT_TRUE(json.contains("frequency_drift_hz"));
  EXPECT_GE(json["amplitude_dependence"]["points"].size(), 2u);
  // Start and end are in the file's time.
  const auto given = document_of("decay {} --start 0.5 --end 0.9 --band 30 80", {file})["window"];
  EXPECT_NEAR(given["start_s"], 0.5, 1e-9);
  EXPECT_NEAR(given["end_s"], 0.9, 1e-9);
}

}  // namespace rigfit::apps::inspect_test
