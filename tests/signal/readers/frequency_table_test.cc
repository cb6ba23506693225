// Tables over frequency: FRFs are read as FRFs, spectra are no recordings over time.
#include "signal/readers/frequency_table.h"
#include "signal/readers/read_recording.h"
#include "tests/signal/readers/reading.h"
#include "tests/test.h"

namespace rigfit::signal::frequency_table_test {

/// Accelerance of one mode at 40 Hz, 1 % damping.
Complex accelerance(double f) {
  const Complex d(1600 - f * f, 2 * 0.01 * 40 * f);
  return -f * f / d;
}

std::string table(const std::string& titles, const std::function<std::string(double)>& line) {
  std::string text = titles;
  for (int k = 0; k < 200; ++k) text += fmt::format("{:.2f}", 0.5 * k) + line(0.5 * k) + '\n';
  return text;
}

FrfSet frfs(const std::string& text) {
  const auto found = frequency_table_in(text, "name of twenty letters.txt");  // on the heap
  if (!found) throw std::logic_error("no table over frequency");
  return frfs_of({*found});
}

TEST(FrfTables, AsAnalysersWriteThem) {
  const auto cartesian = [](double f) {
    return fmt::format("\t{:.8e}\t{:.8e}", accelerance(f).real(), accelerance(f).imag());
  };
  const auto polar = [](const char* format, double degrees) {
    return [=](double f) {
      const auto h = accelerance(f);
      return fmt::format(fmt::runtime(format), std::abs(h), std::arg(h) * degrees, 0.9);
    };
  };
  const double to_degrees = 180 / kPi;
  const std::string texts[] = {
      table("Units: Ratio\nFrequency\tReal\tImaginary\nHz\t(m/s^2)/N\t(m/s^2)/N\n", cartesian),
      table("freq [Hz]\tRe ((m/s^2)/N)\tIm ((m/s^2)/N)\n", cartesian),
      table("Frequency (Hz);Magnitude ((m/s^2)/N);Phase (deg);Coherence\n",
            polar(";{:.8e};{:.8f};{:.2f}", to_degrees)),
      table("* Freq(Hz);SPL ((m/s^2)/N);Phase (rad);Coherence\n",
            polar(";{:.8e};{:.8f};{:.2f}", 1))};
  for (const auto& text : texts) {
    const FrfSet set = frfs(text);
    EXPECT_EQ(set.form, FrfForm::accelerance) << text.substr(0, 60);
    ASSERT_EQ(set.H.cols(), 1);
    for (Index k = 0; k < set.H.rows(); ++k) {
      // Eight printed digits of each part.
      EXPECT_NEAR(std::abs(set.H(k, 0) - accelerance(set.frequency_hz[k])), 0, 1e-6);
    }
    EXPECT_THROW((void)read_csv(text, "frf.txt"), RecordingError);
  }
  EXPECT_EQ(frfs(texts[2]).coherence.rows(), 200);
  EXPECT_THROW(
      frfs(table("Frequency (Hz),Magnitude,Phase\n", [](double) { return std::string(",20,90"); })),
      RecordingError);
}

TEST(FrfTables, DecibelsAndSeveralResponses) {
  const FrfSet set = frfs(table("Frequency,Real A,Imag A,Real B,Imag B\n", [](double f) {
    return fmt::format(",{},{},{},{}", f, -f, 2 * f, -2 * f);
  }));
  ASSERT_EQ(set.responses.size(), 2u);
  EXPECT_EQ(set.responses[1].name, "b");
  EXPECT_EQ(set.H(3, 1), Complex(3, -3));
  const auto ones = [](double) { return std::string(",1,1"); };
  EXPECT_EQ(frfs(table("Frequency (Hz),Real,Imag (mm/N)\n", ones)).H(1, 0), Complex(1e-3, 1e-3));
  EXPECT_THROW(frfs(table("Frequency (Hz),Real (m/N),Imag (mm/N)\n", ones)), RecordingError);
  const FrfSet decibels = frfs(table("Frequency (Hz),Magnitude (dB),Phase (deg)\n",
                                     [](double) { return std::string(",20,90"); }));
  EXPECT_NEAR(std::abs(decibels.H(1, 0) - Complex(0, 10)), 0, 1e-12);
}

TEST(Spectra, AreNoRecordings) {
  for (const char* titles : {"Frequency (Hz),Amplitude\n", "f_Hz,PSD (g^2/Hz)\n",
                             "FFT (RMS)\nX,Y\n", "Hz,dB\n", "Spectrum of channel 1\n"}) {
    const std::string text =
        table(titles, [](double f) { return fmt::format(",{}", std::abs(accelerance(f))); });
    EXPECT_THAT(refusal_of([&] { return read_csv(text, "fft.csv"); }), HasSubstr("spectrum"))
        << titles;
    const auto found = frequency_table_in(text, "fft.csv");
    ASSERT_TRUE(found) << titles;
    EXPECT_THROW(static_cast<void>(frfs_of({*found})), RecordingError);
  }
  // Times stay times, whatever else is measured.
  EXPECT_EQ(read_csv("Time (s),Frequency (Hz)\n0,50\n0.1,50.1\n0.2,50.2\n", "a.csv").sample_rate_hz,
            10);
}

std::string column_of(const std::string& header) {
  std::string text = header;
  for (int k = 0; k < 200; ++k) text += fmt::format("{}\n", std::abs(accelerance(0.5 * k)));
  return text;
}

TEST(Spectra, WithoutFrequenciesAreNoRecordings) {
  for (const char* header : {"FFT magnitude\n", "Amplitude (dB)\n", "RMS\n", "Magnitude\n",
                             "Spectrum of channel 1\nvalue\n", "PSD (g^2/Hz)\n",
                             "Sample rate: 1000 Hz\nFFT magnitude\n"}) {
    const auto error = error_of([&] { return read_csv(column_of(header), "fft.csv"); });
    EXPECT_THAT(error.what(), HasSubstr("without a column of frequencies")) << header;
    EXPECT_THAT(error.remedy(), HasSubstr("--format csv")) << header;
    EXPECT_EQ(read_csv(column_of(header), "fft.csv", {.format = "csv"}).samples(), 200) << header;
  }
}

TEST(Spectra, TimeSignalsWithWordsOfTheirsStayRecordings) {
  // A rate or times beside the words; a force whose title only holds letters of them.
  for (const char* header : {"Sample rate: 1000 Hz, FFT lines: 400\nforce (N)\n",
                             "Sample rate: 1000 Hz\nRMS force (N)\n", "draft (m)\n", "terms\n"}) {
    EXPECT_EQ(read_csv(column_of(header), "a.csv").samples(), 200) << header;
  }
  EXPECT_EQ(read_csv("Time (s),RMS (g)\n0,1\n0.1,2\n0.2,1\n", "a.csv").sample_rate_hz, 10);
}

}  // namespace rigfit::signal::frequency_table_test
