#include "apps/report/figures/decay_overlay.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "ident/statistics/in_parallel.h"
#include "signal/spectra/fft.h"

namespace rigfit::apps {
namespace {

using Eigen::Index;
constexpr double kLongest_s = 10;  // of a simulated answer
constexpr double kAlike_s = 0.5;   // over which record and answer are brought together
constexpr double kFirst_s = 0.5;   // of the first moments

/// Where the model's answer starts in the record: the shift at which they are most alike over the
/// model's first `length` samples.
Index best_shift(const Eigen::VectorXd& record, const Eigen::VectorXd& model, Index length) {
  const Index n = std::min({length, record.size(), model.size()});
  Index best = 0;
  double most = -1;
  const Eigen::VectorXd head = model.head(n).array() - model.head(n).mean();
  for (Index shift = 0; shift + n <= record.size(); ++shift) {
    const auto part = record.segment(shift, n);
    // Where the model starts, the record moves most: alike in size as well as in shape.
    const double product = (part.array() - part.mean()).matrix().dot(head);
    if (product > most) most = product, best = shift;
  }
  return best;
}

/// Missing samples at the mean of the others.
Eigen::VectorXd filled(const Eigen::VectorXd& samples) {
  double sum = 0, count = 0;
  for (const double v : samples) {
    if (std::isfinite(v)) sum += v, ++count;
  }
  return samples.unaryExpr([&](double v) { return std::isfinite(v) ? v : sum / count; });
}

PlotSeries spectrum_of(const Eigen::Ref<const Eigen::VectorXd>& samples, double rate_hz,
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

/// As the answer number `k` of `count` is drawn: the last stands for the report, those before it
/// are broken lines.
PlotSeries series_of(const ReleaseAnswer& answer, std::size_t k, std::size_t count) {
  PlotSeries series;
  series.name = "rigfit model, " + answer.label;
  series.origin = Origin::modelled;
  if (k + 1 < count) {
    series.style = PlotSeries::Style::dashed;
    series.variant = k == 0 ? 2 : 1;
  }
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

std::vector<ReleaseAnswer> release_answers(const AnalysedDecay& decay,
                                           const signal::DecayOptions& options,
                                           const std::vector<ModelVersion>& versions, int threads) {
  const Eigen::VectorXd record = filled(decay.samples);
  std::vector<ReleaseAnswer> answers(versions.size());
  ident::in_parallel(versions.size(), threads, [&](std::size_t k) {
    const auto& version = versions[k];
    model::ResponseOptions response;
    response.sampling.rate_hz = decay.rate_hz;
    response.sampling.duration_s =
        std::min(kLongest_s, static_cast<double>(record.size()) / decay.rate_hz);
    ReleaseAnswer& answer = answers[k];
    answer.label = version.label;
    answer.response = model::simulate_response(version.scene, response);
    if (!answer.response.completed || answer.response.samples.rows() < 16) {
      answer.failure = "the model gives no answer: " + answer.response.reason;
    } else {
      const Eigen::VectorXd model = answer.response.samples.col(0);
      answer.start =
          best_shift(record, model, static_cast<Index>(std::lround(kAlike_s * decay.rate_hz)));
      // The same stretch of the motion as in the record: a large motion's frequency falls with it.
      const Index first = std::max<Index>(0, decay.result.start - answer.start);
      const Index last = std::min(model.size(), decay.result.end - answer.start);
      if (last - first < 16) {
        answer.failure = "the record was analysed where the model has ended";
      } else {
        signal::DecayOptions same = options;
        same.choose_window = same.trim_start = false;
        answer.found =
            signal::estimate_decay(model.segment(first, last - first), decay.rate_hz, same);
      }
    }
  });
  return answers;
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
  plot.title = "Answer in time, test and model";
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

  const Eigen::VectorXd record = filled(decay.samples);
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
          spectrum_of(record.segment(first, common), decay.rate_hz, high_hz, test));
    }
    spectra.series.push_back(spectrum_of(model.head(std::min(common, length)), decay.rate_hz,
                                         high_hz, series_of(answer, k, answers.size())));
  }
  if (first < 0) return {};
  Plot zoom = plot;
  zoom.id += "-first";
  zoom.title = "The first moments of it";
  zoom.caption = "The same, half a second from the start on.";
  keep_between(zoom, time(first) - 0.02, time(first) + kFirst_s);
  return {std::move(plot), std::move(zoom), std::move(spectra)};
}

const signal::DecayMode* same_oscillation(const signal::DecayMode& mode,
                                          const ReleaseAnswer& answer) {
  const auto off = [&](const signal::DecayMode& other) {
    return std::abs(std::log(other.frequency_hz.value / mode.frequency_hz.value));
  };
  const signal::DecayMode* nearest = nullptr;
  for (const auto& other : answer.found.modes) {
    if (off(other) < 0.15 && (!nearest || off(other) < off(*nearest))) nearest = &other;
  }
  return nearest;
}

}  // namespace rigfit::apps
