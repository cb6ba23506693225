#include <bit>
#include <cstdint>

#include "signal/readers/read_recording.h"
#include "signal/readers/uff58.h"
#include "signal/writers/writers.h"
#include "tests/fuzz/mutations.h"
#include "tests/signal/readers/reading.h"
#include "tests/test.h"

namespace rigfit::signal::uff_test {

Recording made_recording(double rate, Index n) {
  Normal normal(7);
  Recording r{.sample_rate_hz = rate, .start_time_s = -0.0123456789};
  for (const auto& [name, unit, quantity] :
       {std::tuple{"hammer at the right cable's quarter span", "N", Quantity::force},
        std::tuple{"mid-span, \u00FCber", "m/s^2", Quantity::acceleration},
        std::tuple{"plain", "", Quantity::unknown}}) {
    Channel c{.name = name,
              .unit = unit,
              .quantity = quantity,
              .direction = {0, -1, 0},
              .nominal_range = 22.5};
    c.samples.resize(n);
    for (auto& x : c.samples) x = normal() * 1e-3;
    r.channels.push_back(c);
  }
  return r;
}

FrfSet made_frfs() {
  Normal normal(8);
  FrfSet f{.responses = {{"beam 0.45 m", 3, 1}, {"left cable", 7, -2}},
           .inputs = {{"hammer", 5, 3}},
           .form = FrfForm::accelerance,
           .unit = "(m/s^2)/N",
           .averages = 5};
  f.force_noise_span_s = 0.05;
  f.sample_rate_relative_std = 3e-4;
  f.sample_rate_hz = 2048.0;
  f.exponential_decay_rate_1_s = 3.0 / 7.0;
  f.frequency_hz = VectorXd::LinSpaced(33, 0.0, 32 * 1.25);
  f.H.resize(33, 2);
  f.coherence.resize(33, 2);
  f.H_std.resize(33, 2);
  for (Index k = 0; k < f.H.size(); ++k) {
    f.H(k) = {normal(), normal()};
    f.coherence(k) = 1 / (1 + std::abs(normal()));
    f.H_std(k) = std::abs(normal());
  }
  return f;
}

TEST(Uff, ATextThatBreaksOffInsideANumberIsRefused) {
  for (const auto& [name, text] : seeds_of("uff")) {
    if (!name.ends_with("ascii_single.uff")) continue;
    const std::string cut = text.substr(0, text.find_last_of("eE"));
    EXPECT_THAT(refusal_of([&] { return read_uff(cut, "x"); }), HasSubstr("breaks off"));
  }
}

TEST(Uff, RecordingsComeBackWithinTheirDigits) {
  // Exactly, also at a rate that six printed digits of its step do not give; samples to half a unit
  // of the 24th binary digit of 4e-3.
  for (const double rate : {51234.56789, 2048.0}) {
    const Recording out = made_recording(rate, 1001);
    const std::string text = uff_text(out, "synthetic");
    EXPECT_THAT(text, HasSubstr("synthetic"));
    const Recording in = read_uff(text, "x.uff");
    EXPECT_EQ(in.format, "uff58-binary");
    EXPECT_EQ(in.sample_rate_hz, out.sample_rate_hz);
    ASSERT_EQ(in.channels.size(), out.channels.size());
    for (std::size_t k = 0; k < in.channels.size(); ++k) {
      EXPECT_EQ(in.channels[k].name, out.channels[k].name);
      EXPECT_EQ(in.channels[k].unit, out.channels[k].unit);
      EXPECT_EQ(in.channels[k].quantity, out.channels[k].quantity);
      EXPECT_EQ(in.channels[k].direction, out.channels[k].direction);
      EXPECT_EQ(in.channels[k].nominal_range, out.channels[k].nominal_range);
      EXPECT_TRUE(MatricesNear(in.channels[k].samples, out.channels[k].samples,
                               4e-3 * std::ldexp(1.0, -24)));
    }
  }
}

TEST(Uff, UnevenTimesAndMissingSamplesComeBack) {
  Recording out = made_recording(100, 50);
  out.time_s = VectorXd::LinSpaced(50, 0, 0.49);
  for (Index k = 25; k < 50; ++k) out.time_s[k] += 1.0 / 3.0;
  out.channels[1].samples[4] = kNaN;
  const Recording in = read_uff(uff_text(out), "x.uff");
  EXPECT_TRUE(MatricesNear(in.time_s, out.time_s, 0));
  EXPECT_EQ(in.channels[1].missing_samples, 1);
  EXPECT_TRUE(std::isnan(in.channels[1].samples[4]));
}

TEST(Uff, FrfsComeBackWithErrorBarsAndWindow) {
  const FrfSet out = made_frfs();
  const FrfSet in = read_uff_frfs(uff_text(out), "x.uff");
  EXPECT_TRUE(MatricesNear(in.H.real(), out.H.real(), 0));
  EXPECT_TRUE(MatricesNear(in.H.imag(), out.H.imag(), 0));
  EXPECT_TRUE(MatricesNear(in.coherence, out.coherence, 0));
  EXPECT_TRUE(MatricesNear(in.H_std, out.H_std, 0));
  EXPECT_TRUE(MatricesNear(in.frequency_hz, out.frequency_hz, 0));
  EXPECT_EQ(in.form, FrfForm::accelerance);
  EXPECT_EQ(in.unit, "(m/s^2)/N");
  EXPECT_EQ(in.averages, 5);
  EXPECT_EQ(in.force_noise_span_s, 0.05);
  EXPECT_EQ(in.sample_rate_relative_std, 3e-4);
  EXPECT_EQ(in.exponential_decay_rate_1_s, out.exponential_decay_rate_1_s);
  ASSERT_EQ(in.responses.size(), 2u);
  EXPECT_EQ(in.responses[1].name, "left cable");
  EXPECT_EQ(in.responses[1].node, 7);
  EXPECT_EQ(in.responses[1].direction, -2);
  EXPECT_EQ(in.inputs[0].name, "hammer");
}

TEST(Uff, LinesHaveTheFormatsColumns) {
  const std::string text = uff_text(made_frfs());
  std::istringstream stream(text);
  std::vector<std::string> lines;
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  EXPECT_EQ(lines[0], "    -1");
  EXPECT_EQ(lines[1],
            "    58b     1     2          11         528     0     0           0           0");
  for (std::size_t k = 2; k <= 7; ++k) EXPECT_EQ(lines[k].size(), 80u) << k << lines[k];
  EXPECT_EQ(lines[7],
            "    4         0    0         0 beam 0.45          3   1 hammer             5   3");
  EXPECT_EQ(lines[8], "         6        33         1 0.000000e+00 1.250000e+00 0.000000e+00");
  EXPECT_EQ(lines[10], "        12    0    0    0 Accelerance          m/s^2               ");
  EXPECT_EQ(lines[11], "        13    0    0    0 Force                N                   ");
}

/// A dataset as others write it: single precision, either byte order, CRLF.
std::string foreign_binary(bool big, int count, const std::string& tail) {
  std::string out = "    -1\r\n    58b" + std::string(big ? "     2" : "     1") +
                    "     2          11          " + std::to_string(4 * count) +
                    "     0     0           0           0\r\n";
  out += "NONE\r\nNONE\r\nNONE\r\nNONE\r\nNONE\r\n";
  out += "    1         0    0         0 NONE              12  -3 NONE               0   0\r\n";
  char form[81];
  std::snprintf(form, sizeof form, "%10d%10d%10d%13.5E%13.5E%13.5E\r\n", 2, count, 1, 0.0, 1e-3,
                0.0);
  out += form;
  out += "        17    0    0    0 Time                 s                   \r\n";
  out += "        12    0    0    0 Acc                  g                   \r\n";
  out += "         0    0    0    0 NONE                 NONE                \r\n";
  out += "         0    0    0    0 NONE                 NONE                \r\n";
  for (int k = 0; k < count; ++k) {
    auto bits = std::bit_cast<std::uint32_t>(0.5f * static_cast<float>(k));
    for (int b = 0; b < 4; ++b) {
      out += static_cast<char>(bits >> (big ? 24 - 8 * b : 8 * b) & 0xFF);
    }
  }
  return out + tail;
}

// Readers tell how far they are, and what is thrown there ends the reading.
TEST(Uff, ReadingIsToldDatasetByDataset) {
  const std::string file = RIGFIT_TESTDATA "/virtual_laboratory/beam/rig/hammer-hit1.uff";
  std::vector<std::size_t> told;
  const Recording read =
      read_recording(file, {.done_with = [&](std::size_t bytes) { told.push_back(bytes); }});
  ASSERT_GE(told.size(), read.channels.size());
  EXPECT_TRUE(std::ranges::is_sorted(told));
  EXPECT_LE(told.back(), std::filesystem::file_size(file));
  EXPECT_GT(told.back(), std::filesystem::file_size(file) / 2);
  const auto stop = [](std::size_t) { throw std::runtime_error("stopped"); };
  EXPECT_THROW(static_cast<void>(read_recording(file, {.done_with = stop})), std::runtime_error);
}

TEST(Uff, BothByteOrdersReadAlike) {
  for (const bool big : {false, true}) {
    const Recording r = read_uff(foreign_binary(big, 40, "    -1\r\n"), "x.uff");
    EXPECT_EQ(r.sample_rate_hz, 1000);
    ASSERT_EQ(r.samples(), 40);
    for (int k = 0; k < 40; ++k) EXPECT_DOUBLE_EQ(r.channels[0].samples[k], 0.5 * k * 9.80665);
    EXPECT_EQ(r.channels[0].name, "Acc");
    EXPECT_EQ(r.channels[0].direction, (std::array<double, 3>{0, 0, -1}));
  }
}

TEST(Uff, TruncatedAndWrongFilesSayWhere) {
  const auto message = [](const std::string& text) {
    return refusal_of([&] { return read_uff(text, "x.uff"); });
  };
  std::string text = foreign_binary(false, 40, "");
  text.resize(text.size() - 9);
  EXPECT_THAT(message(text), HasSubstr("x.uff:9:19"));
  // Cut at the end of a dataset.
  const std::string whole = uff_text(made_recording(100, 9));
  EXPECT_THAT(message(whole.substr(0, whole.find("    -1\n", 10) + 7)), HasSubstr("and holds 1"));
  std::string ascii = seeds_of("uff").front().bytes;
  ascii[ascii.find('.', ascii.find("Time")) + 1] = 'x';
  EXPECT_THAT(message(ascii), AllOf(HasSubstr("not a number"), HasSubstr("x.uff:14:")));
  EXPECT_THAT(message("    -1\n    15\n    -1\n"), HasSubstr("holds no dataset 58"));
}

TEST(Uff, WritesModesAtPoints) {
  ModalModel modes{.responses = {{"a", 4, 2}, {"b", 4, -1}, {"c", 9, 3}}, .inputs = {{"h", 9, 3}}};
  IdentifiedMode mode{
      .frequency_hz = {10, 0.01}, .damping_ratio = {0.01, 0.001}, .pole_rad_s = {-0.6283, 62.83}};
  mode.shape.resize(3);
  mode.shape << Complex(1, 0.5), Complex(-2, 0), Complex(3, 1);
  mode.participation = VectorXcd::Constant(1, Complex(0, 2));
  modes.modes = {mode};
  const std::string text = uff_text(modes, {{4, {0, 0.5, 0}}, {9, {1, 0, 0}}});
  EXPECT_THAT(text, HasSubstr("         4         0         0         0  0.00000e+00"
                              "  5.00000e-01  0.00000e+00\n"));
  // Node 4: x is minus b, y is a; node 9: z is c.
  EXPECT_THAT(text, HasSubstr("         4\n  2.00000e+00 -0.00000e+00  1.00000e+00"
                              "  5.00000e-01  0.00000e+00  0.00000e+00\n"));
  EXPECT_THAT(text, HasSubstr("         9\n"));
  // Eigenvalue, then no modal A.
  EXPECT_THAT(text, HasSubstr(" -6.28300e-01  6.28300e+01  0.00000e+00  0.00000e+00"));
}

}  // namespace rigfit::signal::uff_test
