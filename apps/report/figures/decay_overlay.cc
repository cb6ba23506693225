#include "apps/report/figures/figures.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "signal/spectra/fft.h"

namespace rigfit::apps {
namespace {

using Eigen::Index;
constexpr double kFirst_s = 0.5;  // length of the first moments

/// As the answer number `k` of `count` is drawn: the last stands for the report, those before it
/// are broken lines.
PlotSeries series_of(const ReleaseAnswer& answer, std::size_t k, std::size_t count) {
  PlotSeries series;
  series.name = "rigfit model, " + answer.label;
  series.origin = Origin::modelled;
  series.variant = static_cast<int>(count - k);
  if (k + 1 < count) series.style = PlotSeries::Style::dashed;
  return series;
}

void keep_between(Plot& plot, double from, double to) {
  for (auto& series : plot.series) {
    PlotSeries cut = series;
    cut.x.clear();
    cut.y.clear();
    for (std::size_t i = 0; i < series.x.size(); ++i) {
      if (series.x[i] < from || series.x[i] > to) continue;
      cut.x.push_back(series.x[i]);
      cut.y.push_back(series.y[i]);
    }
    series = std::move(cut);
  }
}

}  // namespace

PlotSeries amplitude_spectrum(const Eigen::Ref<const Eigen::VectorXd>& samples, double rate_hz,
                              double high_hz, PlotSeries series) {
  const Index n = samples.size();
  Eigen::VectorXd windowed(n);
  const double mean = samples.mean();
  for (Index i = 0; i < n; ++i) {  // Hann
    const double phase = 2 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(n);
    windowed[i] = (0.5 - 0.5 * std::cos(phase)) * (samples[i] - mean);
  }
  const Index length = signal::good_fft_length(n);
  const Eigen::VectorXcd lines = signal::real_spectra(windowed, length).col(0);
  const Eigen::VectorXd frequency = signal::line_frequencies(length, rate_hz);
  for (Index k = 1; k < lines.size() && (high_hz <= 0 || frequency[k] <= high_hz); ++k) {
    series.x.push_back(frequency[k]);
    series.y.push_back(4 * std::abs(lines[k]) / static_cast<double>(n));
  }
  return series;
}

std::vector<Plot> release_plots(const std::string& id, const AnalysedDecay& decay,
                                const std::vector<ReleaseAnswer>& answers, double high_hz) {
  const auto time = [&](Index i) { return decay.start_s + static_cast<double>(i) / decay.rate_hz; };
  PlotSeries test;
  test.name = "test";
  test.origin = decay.origin;
  const bool large = std::any_of(answers.begin(), answers.end(),
                                 [](const auto& answer) { return answer.response.nonlinear; });
  Plot plot;
  plot.id = id + "-model";
  plot.title = "First half second, test and model";
  plot.caption = fmt::format(
      "The record and the model's answer to the same release or tap, {}; the model is moved along "
      "the time axis to where both are most alike, nothing else. Nothing was fitted to this "
      "record.",
      large ? "computed with its large motion" : "linear");
  plot.x_label = "time, s";
  plot.y_label = fmt::format("{}, {}", decay.channel, unit_words(decay.unit));
  Plot spectra = plot;
  spectra.id = id + "-spectrum";
  spectra.title = "Spectra, test and model";
  spectra.caption = "Amplitudes by frequency of both, over the same time after the start.";
  spectra.x_label = "frequency, Hz";
  spectra.y_label = fmt::format("amplitude, {}", unit_words(decay.unit));
  spectra.log_y = true;

  const Eigen::VectorXd record = ident::filled(decay.samples);
  plot.series.push_back(test);
  for (Index i = 0; i < record.size(); ++i) {
    plot.series.back().x.push_back(time(i));
    plot.series.back().y.push_back(decay.samples[i]);
  }
  Index first = -1, common = 0;
  for (std::size_t k = 0; k < answers.size(); ++k) {
    const auto& answer = answers[k];
    if (!answer.failure.empty()) continue;
    PlotSeries ours = series_of(answer, k, answers.size());
    const auto model = answer.response.samples.col(0);
    for (Index i = 0; i < model.size() && answer.start + i < record.size(); ++i) {
      ours.x.push_back(time(answer.start + i));
      ours.y.push_back(model[i]);
    }
    plot.series.push_back(std::move(ours));
    const Index length = std::min(record.size() - answer.start, model.size());
    if (first < 0) {
      first = answer.start;
      common = length;
      spectra.series.push_back(
          amplitude_spectrum(record.segment(first, common), decay.rate_hz, high_hz, test));
    }
    spectra.series.push_back(amplitude_spectrum(model.head(std::min(common, length)), decay.rate_hz,
                                                high_hz, series_of(answer, k, answers.size())));
  }
  if (first < 0) return {};
  keep_between(plot, time(first) - 0.02, time(first) + kFirst_s);
  return {std::move(plot), std::move(spectra)};
}

}  // namespace rigfit::apps
