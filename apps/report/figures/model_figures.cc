#include "apps/report/figures/figures.h"

#include "model/scene/sensor_quantity.h"
#include "signal/spectra/fft.h"

namespace rigfit::apps {
namespace {

using Eigen::Index;

PlotSeries amplitude_spectrum(const Eigen::Ref<const Eigen::VectorXd>& samples, double rate_hz,
                              PlotSeries series) {
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
  for (Index k = 1; k < lines.size(); ++k) {
    series.add(frequency[k], 4 * std::abs(lines[k]) / static_cast<double>(n));
  }
  return series;
}

}  // namespace

std::vector<Plot> response_plots(const std::string& id, const model::Scene& scene,
                                 const model::ResponseResult& response) {
  std::vector<Plot> plots, spectra;
  for (Index s = 0; s < response.samples.cols(); ++s) {
    const auto k = static_cast<std::size_t>(s);
    const auto& quantity = model::described(scene.sensors[k].quantity);
    const std::string unit = unit_words(quantity.unit);
    Plot plot{
        fmt::format("{}-{}", id, s + 1), "Response: " + response.sensors[k],
        response.nonlinear ? "Computed with its large motion." : "Linear about the equilibrium.",
        "time, s", fmt::format("{}, {}", quantity.name, unit)};
    plot.link = id;
    PlotSeries series{response.sensors[k]};
    for (Index i = 0; i < response.samples.rows(); ++i) {
      series.add(static_cast<double>(i) / response.rate_hz, response.samples(i, s));
    }
    plot.add(std::move(series));
    plots.push_back(std::move(plot));
    auto same = std::ranges::find(spectra, "amplitude, " + unit, &Plot::y_label);
    if (same == spectra.end()) {
      spectra.push_back({fmt::format("{}-spectrum-{}", id, spectra.size() + 1), "Spectra",
                         "Amplitudes by frequency over the whole time, Hann window.",
                         "frequency, Hz", "amplitude, " + unit, false, true});
      same = spectra.end() - 1;
    }
    same->series.push_back(amplitude_spectrum(
        response.samples.col(s), response.rate_hz,
        {response.sensors[k], Origin::modelled, static_cast<int>(same->series.size())}));
  }
  std::move(spectra.begin(), spectra.end(), std::back_inserter(plots));
  return plots;
}

Plot release_plot(const std::string& id, const ident::ChannelDecays& decay) {
  const auto& answers = decay.answers;
  constexpr double kBefore_s = 0.02, kFirst_s = 0.5;
  const bool large =
      std::ranges::any_of(answers, [](const auto& answer) { return answer.response.nonlinear; });
  const std::string unit = unit_words(decay.unit);
  Plot plot{id + "-model", "First half second, test and model",
            fmt::format("The record and the model's response to the same release or tap, {}; only "
                        "the model's time was shifted, to where both agree best. Nothing was "
                        "fitted to this record.",
                        large ? "computed with its large motion" : "linear"),
            "time, s", fmt::format("{}, {}", decay.channel, unit)};
  Index first = -1;
  const auto add = [&](PlotSeries series, const auto& samples, Index start) {
    const double t0 = static_cast<double>(first) / decay.sample_rate_hz;
    for (Index i = 0; i < samples.size() && start + i < decay.samples.size(); ++i) {
      const double t = static_cast<double>(start + i) / decay.sample_rate_hz;
      if (t >= t0 - kBefore_s && t <= t0 + kFirst_s) series.add(decay.start_time_s + t, samples[i]);
    }
    plot.add(std::move(series));
  };
  for (std::size_t k = 0; k < answers.size(); ++k) {
    const auto& answer = answers[k];
    if (!answer.failure.empty()) continue;
    // The last stands for the report, those before it are broken lines.
    const PlotSeries series{
        "rigfit model, " + answer.label, Origin::modelled, static_cast<int>(answers.size() - k),
        k + 1 < answers.size() ? PlotSeries::Style::dashed : PlotSeries::Style::line};
    if (first < 0) {
      first = answer.start;
      add({"test", decay.origin}, decay.samples, 0);
    }
    add(series, answer.response.samples.col(0), answer.start);
  }
  return plot;
}

std::vector<Plot> recording_plots(const std::string& id, const signal::Recording& recording,
                                  const std::vector<signal::ChannelQuality>& quality) {
  constexpr std::size_t kMostClipped = 1000;  // points drawn of clipped samples
  std::vector<Plot> plots;
  if (!(recording.sample_rate_hz > 0) && recording.time_s.size() == 0) return plots;
  for (std::size_t k = 0; k < recording.channels.size(); ++k) {
    const auto& channel = recording.channels[k];
    const auto& found = quality[k];
    Plot plot{fmt::format("{}-{}", id, k + 1),
              fmt::format("{}: {}", short_name(recording.path.string()), channel.name),
              found.findings.empty() ? "Nothing was found wrong with this channel." : "Found:",
              "time, s", fmt::format("{}, {}", channel.name, unit_words(channel.unit))};
    plot.link = id;
    PlotSeries record{"record", Origin::measured};
    for (Index i = 0; i < channel.samples.size(); ++i) {
      record.add(recording.time_at(i), channel.samples[i]);
    }
    plot.add(std::move(record));
    PlotSeries clipped{fmt::format("clipped ({} samples)", found.clipped_samples), Origin::modelled,
                       1, PlotSeries::Style::points};
    for (Index i = 0; found.clipped_samples > 0 && i < channel.samples.size(); ++i) {
      const double y = channel.samples[i];
      const bool at_end = y == found.max || y == found.min;
      if (at_end && clipped.x.size() < kMostClipped) clipped.add(recording.time_at(i), y);
    }
    plot.add(std::move(clipped));
    for (const auto& finding : found.findings) {
      plot.caption += fmt::format(" {}: {}.", finding.code, finding.message);
      if (finding.first < 0 || finding.first >= channel.samples.size()) continue;
      std::string word = finding.code;
      std::replace(word.begin(), word.end(), '_', ' ');
      plot.marks.push_back({recording.time_at(finding.first), word, true});
    }
    std::ranges::sort(plot.marks, {}, &PlotMark::x);
    plots.push_back(std::move(plot));
  }
  return plots;
}

}  // namespace rigfit::apps
