#include "apps/report/decay_part.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "apps/report/decay_plots.h"
#include "apps/report/html_text.h"
#include "apps/report/model_overlay.h"
#include "apps/report/recording_blocks.h"
#include "model/response.h"
#include "signal/decay_window.h"
#include "signal/fft.h"
#include "signal/recording_error.h"

namespace rigfit::apps {
namespace {

using Eigen::Index;

Json estimate_json(const signal::Estimate& e) {
  return {{"value", std::isfinite(e.value) ? Json(e.value) : Json(nullptr)},
          {"std", std::isfinite(e.std) ? Json(e.std) : Json(nullptr)}};
}

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

PlotSeries spectrum_of(const Eigen::Ref<const Eigen::VectorXd>& samples, double rate_hz,
                       const std::string& name, Origin origin) {
  PlotSeries series;
  series.name = name;
  series.origin = origin;
  const Index n = samples.size();
  Eigen::VectorXd windowed(n);
  const double mean = samples.mean();
  for (Index i = 0; i < n; ++i) {  // Hann
    const double w =
        0.5 - 0.5 * std::cos(2 * M_PI * static_cast<double>(i) / static_cast<double>(n));
    windowed[i] = w * (samples[i] - mean);
  }
  const Index length = signal::good_fft_length(n);
  const Eigen::VectorXcd lines = signal::real_spectra(windowed, length).col(0);
  const Eigen::VectorXd frequency = signal::line_frequencies(length, rate_hz);
  for (Index k = 1; k < lines.size(); ++k) {
    series.x.push_back(frequency[k]);
    series.y.push_back(4 * std::abs(lines[k]) / static_cast<double>(n));
  }
  return series;
}

class DecayAnalysis {
 public:
  DecayAnalysis(const Campaign& campaign, const CampaignTest& test, const KnownValues& known)
      : campaign_(campaign), test_(test), known_(known) {
    part_.id = test.name;
    part_.title = test.title;
    part_.json_key = "decays";
    part_.json["test"] = test.name;
    table_.id = test.name + "-modes";
    table_.caption =
        "Oscillations found in each record, strongest first, with standard uncertainties; where a "
        "scene is given, what the same estimator finds in the model's answer.";
  }

  ReportPart run() {
    auto loaded = load_recordings(test_.recordings);
    for (const auto& entry : loaded) {
      part_.inputs.insert(part_.inputs.end(), entry.inputs.begin(), entry.inputs.end());
    }
    part_.blocks.push_back(Paragraph{
        "The rig is set free (a string is cut, or it is tapped) and rings. Damped oscillations are "
        "fitted to what it rings, without anybody's guess of frequency or window."});
    add_recordings(part_, test_, loaded);
    Json list = Json::array();
    for (const auto& entry : loaded) {
      if (entry.recording) analyse(entry, list);
    }
    part_.json["records"] = std::move(list);
    if (!table_.rows.empty()) part_.blocks.push_back(std::move(table_));
    if (!group_.tabs.empty()) {
      group_.id = test_.name + "-decays";
      group_.title = "Decays";
      part_.blocks.push_back(std::move(group_));
    }
    auto damping = damping_plot(test_.name + "-damping", decays_);
    if (!damping.series.empty()) part_.blocks.push_back(std::move(damping));
    part_.summary.push_back(
        {SummaryItem::Kind::result, test_.title,
         fmt::format("{} decays in {} recordings{}", decays_.size(), loaded.size(), best_),
         decays_.empty() ? std::optional<Origin>() : decays_.front().origin, part_.id});
    return std::move(part_);
  }

 private:
  void analyse(const LoadedRecording& entry, Json& list) {
    const auto& recording = *entry.recording;
    if (recording.time_s.size() > 0 || !(recording.sample_rate_hz > 0)) {
      refuse(part_, "not_uniform",
             recording.time_s.size() > 0 ? "its samples are not evenly spaced in time"
                                         : "gives no sample rate; add sample_rate_hz",
             entry.file);
      return;
    }
    std::vector<std::string> channels = test_.channels;
    if (channels.empty()) {
      for (const auto& channel : recording.channels) channels.push_back(channel.name);
    }
    PlotTab tab{short_name(entry.file), {}};
    for (const auto& name : channels) {
      const signal::Channel* channel = nullptr;
      try {
        channel = &recording.channel(name);
      } catch (const signal::RecordingError& error) {
        refuse(part_, "channel", error.what(), entry.file);
        continue;
      }
      analyse(entry, *channel, tab, list);
    }
    if (!tab.plots.empty()) group_.tabs.push_back(std::move(tab));
  }

  void analyse(const LoadedRecording& entry, const signal::Channel& channel, PlotTab& tab,
               Json& list) {
    const auto& recording = *entry.recording;
    const auto& group = test_.recordings[entry.group];
    AnalysedDecay decay;
    decay.file = entry.file;
    decay.channel = channel.name;
    decay.unit = channel.unit;
    decay.origin = group.origin();
    decay.rate_hz = recording.sample_rate_hz;
    decay.start_s = recording.start_time_s;
    decay.samples = channel.samples;
    decay.result = signal::estimate_decay(decay.samples, decay.rate_hz, options(decay.rate_hz));
    const std::string where = entry.file + ": " + channel.name;
    for (const auto& note : decay.result.notes) {
      part_.warnings.push_back({note.code, note.message, where, false});
    }
    if (!decay.result.refusal_code.empty() || decay.result.modes.empty()) {
      refuse(part_, decay.result.refusal_code.empty() ? "no_decay" : decay.result.refusal_code,
             decay.result.refusal.empty() ? "holds no decay" : decay.result.refusal, where);
      return;
    }
    const std::string id = fmt::format("{}-{}", test_.name, decays_.size() + 1);
    tab.plots.push_back(decay_plot(id, decay));
    Json json{{"file", entry.file},
              {"channel", channel.name},
              {"origin", word_of(decay.origin)},
              {"tension_N", group.tension_N ? Json(*group.tension_N) : Json(nullptr)},
              {"modes", modes_json(decay.result)},
              {"law", name_of(decay.result.envelope.law)},
              {"frequency_drift_hz", estimate_json(decay.result.envelope.frequency_drift_hz)}};
    std::optional<signal::DecayResult> model;
    if (test_.scene) model = overlay(decay, group, channel.name, id, tab, json);
    list_modes(decay, group, model);
    list.push_back(std::move(json));
    decays_.push_back(std::move(decay));
  }

  [[nodiscard]] signal::DecayOptions options(double rate_hz) const {
    signal::DecayOptions options;
    if (test_.band_hz) {
      options.band_low_hz = test_.band_hz->first;
      options.band_high_hz = std::min(test_.band_hz->second, 0.5 * rate_hz);
    }
    return options;
  }

  static Json modes_json(const signal::DecayResult& result) {
    Json modes = Json::array();
    for (const auto& mode : result.modes) {
      modes.push_back({{"frequency_hz", estimate_json(mode.frequency_hz)},
                       {"damping_ratio", estimate_json(mode.damping_ratio)},
                       {"amplitude", mode.amplitude},
                       {"cycles", mode.cycles},
                       {"r_squared", mode.r_squared}});
    }
    return modes;
  }

  /// The model's answer over the record; what the estimator finds in it.
  std::optional<signal::DecayResult> overlay(const AnalysedDecay& decay,
                                             const RecordingGroup& group,
                                             const std::string& channel, const std::string& id,
                                             PlotTab& tab, Json& json) {
    model::Scene scene = scene_at(campaign_, test_, known_, group.tension_N);
    const auto other = test_.hammer.sensors.find(channel);
    const std::string& name = other == test_.hammer.sensors.end() ? channel : other->second;
    std::erase_if(scene.sensors, [&](const auto& sensor) { return sensor.name != name; });
    std::erase_if(scene.loads, [&](const auto& load) { return load.name != test_.hammer.load; });
    if (scene.sensors.empty() || scene.loads.empty()) return std::nullopt;
    model::ResponseOptions response;
    response.sampling.rate_hz = decay.rate_hz;
    response.sampling.duration_s =
        std::min(10.0, static_cast<double>(decay.samples.size()) / decay.rate_hz);
    const auto answer = model::simulate_response(scene, response);
    const std::string what = fmt::format("{}: {}", test_.title, short_name(decay.file));
    if (!answer.completed || answer.samples.rows() < 16) {
      refuse(part_, "no_model", "the model gives no answer: " + answer.reason, what);
      return std::nullopt;
    }
    part_.costs.push_back(response_cost(what, answer));
    const Eigen::VectorXd model = answer.samples.col(0);
    Eigen::VectorXd record = decay.samples;
    double sum = 0, count = 0;
    for (const double v : record) {
      if (std::isfinite(v)) sum += v, ++count;
    }
    record = record.unaryExpr([&](double v) { return std::isfinite(v) ? v : sum / count; });
    const auto second = static_cast<Index>(std::lround(0.5 * decay.rate_hz));
    const Index shift = best_shift(record, model, second);
    const auto time = [&](Index i) {
      return decay.start_s + static_cast<double>(i) / decay.rate_hz;
    };
    Plot plot;
    plot.id = id + "-model";
    plot.title = "Answer in time, test and model";
    plot.caption = fmt::format(
        "The record and the model's answer to the same release or tap, {}; the model is moved "
        "along "
        "the time axis to where both are most alike, nothing else. Nothing was fitted to it.",
        answer.nonlinear ? "computed with its large motion" : "linear");
    plot.x_label = "time, s";
    plot.y_label = fmt::format("{}, {}", channel, unit_words(decay.unit));
    PlotSeries test, ours;
    test.name = "test";
    test.origin = decay.origin;
    for (Index i = 0; i < record.size(); ++i) {
      test.x.push_back(time(i));
      test.y.push_back(decay.samples[i]);
    }
    ours.name = "rigfit model";
    ours.origin = Origin::modelled;
    for (Index i = 0; i < model.size() && shift + i < record.size(); ++i) {
      ours.x.push_back(time(shift + i));
      ours.y.push_back(model[i]);
    }
    plot.series = {test, ours};
    Plot zoom = plot;
    zoom.id += "-first";
    zoom.title = "The first moments of it";
    zoom.caption = "The same, half a second from the start on.";
    for (auto& series : zoom.series) {
      PlotSeries cut = series;
      cut.x.clear();
      cut.y.clear();
      for (std::size_t i = 0; i < series.x.size(); ++i) {
        if (series.x[i] < time(shift) - 0.02 || series.x[i] > time(shift) + 0.5) continue;
        cut.x.push_back(series.x[i]);
        cut.y.push_back(series.y[i]);
      }
      series = std::move(cut);
    }
    Plot spectra;
    spectra.id = id + "-spectrum";
    spectra.title = "Spectra, test and model";
    spectra.caption = "Amplitudes by frequency of both, over the same time after the start.";
    spectra.x_label = "frequency, Hz";
    spectra.y_label = fmt::format("amplitude, {}", unit_words(decay.unit));
    spectra.log_y = true;
    const Index common = std::min(record.size() - shift, model.size());
    spectra.series.push_back(
        spectrum_of(record.segment(shift, common), decay.rate_hz, "test", decay.origin));
    spectra.series.push_back(
        spectrum_of(model.head(common), decay.rate_hz, "rigfit model", Origin::modelled));
    tab.plots.push_back(std::move(plot));
    tab.plots.push_back(std::move(zoom));
    tab.plots.push_back(std::move(spectra));
    auto found = signal::estimate_decay(model, decay.rate_hz, options(decay.rate_hz));
    json["model"] = {{"solver", name_of(answer.solver)},
                     {"nonlinear", answer.nonlinear},
                     {"frequency_shift", answer.frequency_shift},
                     {"modes", modes_json(found)}};
    if (found.modes.empty()) return std::nullopt;
    return found;
  }

  void list_modes(const AnalysedDecay& decay, const RecordingGroup& group,
                  const std::optional<signal::DecayResult>& model) {
    if (table_.columns.empty()) {
      table_.columns = {{"record", {}, false},        {"channel", {}, false},
                        {"taken at", {}, false},      {"frequency, Hz", decay.origin},
                        {"damping, %", decay.origin}, {"R²", decay.origin},
                        {"cycles", decay.origin}};
      if (test_.scene) {
        table_.columns.insert(table_.columns.end(), {{"model, Hz", Origin::modelled},
                                                     {"error", Origin::modelled},
                                                     {"model damping, %", Origin::modelled}});
      }
    }
    bool first = true;
    for (const auto& mode : decay.result.modes) {
      std::vector<Cell> row{
          first ? short_name(decay.file) : "",
          first ? decay.channel : "",
          first && group.tension_N ? fmt::format("{:g} N", *group.tension_N) : "",
          Cell(shown_estimate(mode.frequency_hz.value, mode.frequency_hz.std), decay.origin),
          Cell(shown_estimate(100 * mode.damping_ratio.value, 100 * mode.damping_ratio.std),
               decay.origin),
          shown(mode.r_squared, 4),
          shown(mode.cycles, 3)};
      if (test_.scene) {
        const signal::DecayMode* nearest = nullptr;
        if (model) {
          for (const auto& other : model->modes) {
            const auto off = [&](const signal::DecayMode& m) {
              return std::abs(std::log(m.frequency_hz.value / mode.frequency_hz.value));
            };
            if (off(other) < 0.15 && (!nearest || off(other) < off(*nearest))) nearest = &other;
          }
        }
        row.emplace_back(nearest ? shown(nearest->frequency_hz.value, 5) : "–");
        row.emplace_back(
            nearest ? shown_percent(nearest->frequency_hz.value / mode.frequency_hz.value - 1)
                    : "–");
        row.emplace_back(nearest ? shown(100 * nearest->damping_ratio.value, 3) : "–");
        if (nearest && first && best_.empty()) {
          best_ = fmt::format("; strongest {} Hz, model {} Hz", shown(mode.frequency_hz.value, 5),
                              shown(nearest->frequency_hz.value, 5));
        }
      }
      table_.rows.push_back(std::move(row));
      first = false;
    }
  }

  const Campaign& campaign_;
  const CampaignTest& test_;
  const KnownValues& known_;
  ReportPart part_;
  ReportTable table_;
  PlotGroup group_;
  std::vector<AnalysedDecay> decays_;
  std::string best_;
};

}  // namespace

ReportPart decay_part(const Campaign& campaign, const CampaignTest& test,
                      const KnownValues& known) {
  return DecayAnalysis(campaign, test, known).run();
}

}  // namespace rigfit::apps
