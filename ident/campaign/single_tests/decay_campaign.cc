#include "ident/campaign/single_tests/decay_campaign.h"

#include <fmt/format.h>

#include <iterator>

#include "ident/statistics/in_parallel.h"
#include "signal/estimation/groups.h"
#include "signal/impact/impact_hits.h"
#include "signal/recording/recording.h"

namespace rigfit::ident {
namespace {

Index sample_at(const signal::Recording& recording, double time_s, bool up) {
  const double j = (time_s - recording.start_time_s) * recording.sample_rate_hz;
  const auto n = static_cast<double>(recording.samples());
  // Times as printed are rounded: a millionth of a sample past one is that one.
  return static_cast<Index>(
      std::clamp(up ? std::ceil(j - 1e-6) : std::floor(j + 1e-6) + 1, 0.0, n));
}

/// Pools a quantity of modes of several decays; returns its scatter between them.
double pool(const std::vector<const signal::DecayMode*>& modes,
            Estimate signal::DecayMode::*quantity, BoundedEstimate& mean) {
  std::vector<double> values, variances;
  for (const auto* mode : modes) {
    values.push_back((mode->*quantity).value);
    variances.push_back((mode->*quantity).std * (mode->*quantity).std);
  }
  const signal::GroupMean effects = signal::mean_over_groups(values, variances);
  const double std = std::sqrt(effects.variance);
  const double half = signal::coverage_factor(0.95, effects.degrees) * std;
  mean = {{effects.mean, std}, {effects.mean - half, effects.mean + half}};
  return std::sqrt(effects.between_variance);
}

std::vector<PooledMode> pooled(const ChannelDecays& channel) {
  std::vector<PooledMode> all;
  for (const auto& mode : channel.result.modes) {
    std::vector<const signal::DecayMode*> modes;
    for (const auto& decay : channel.decays) {
      const auto* same = decay.fitted ? same_mode(mode, *decay.result, 0.05) : nullptr;
      if (same && same->frequency_hz.std > 0 && same->damping_ratio.std > 0) modes.push_back(same);
    }
    if (modes.empty()) continue;
    PooledMode& one = all.emplace_back();
    one.decays = modes.size();
    one.frequency_scatter_hz = pool(modes, &signal::DecayMode::frequency_hz, one.frequency_hz);
    one.damping_ratio_scatter = pool(modes, &signal::DecayMode::damping_ratio, one.damping_ratio);
    one.damping_ratio.low = std::max(0.0, one.damping_ratio.low);
  }
  return all;
}

/// The uncertainty of the rate, common to all frequencies of a recording.
void widen_by_rate(double relative_std, ChannelDecays& found) {
  const auto widen = [&](signal::DecayResult& decay) {
    for (auto& mode : decay.modes) {
      add_rate_uncertainty(relative_std, mode.frequency_hz, &mode.frequency_interval_95_hz);
      add_rate_uncertainty(relative_std, mode.damped_frequency_hz);
    }
  };
  widen(found.result);
  for (auto& decay : found.decays) {
    if (decay.result) widen(*decay.result);
  }
  for (auto& mode : found.pooled) {
    add_rate_uncertainty(relative_std, mode.frequency_hz, &mode.frequency_hz);
  }
}

/// The decays of a channel between two samples.
ChannelDecays channel_decays(const TestRecording& recorded, const signal::Channel& channel,
                             const DecayTestOptions& options, Index from, Index to,
                             std::vector<Finding>& findings) {
  signal::DecayOptions decay = options.decay;
  if (options.start_s) decay.choose_window = decay.trim_start = false;
  ChannelDecays found{estimated_decay(recorded, channel, from, to, decay)};
  const std::string where = recorded.name + ": " + channel.name;
  const auto& strongest = found.result;
  add_notes(strongest.notes, findings, where);
  if (!strongest.refusal_code.empty()) {
    findings.push_back({strongest.refusal_code, strongest.refusal, where, true});
  }
  decay.choose_window = false;
  for (std::size_t k = 0; k < strongest.decays.size(); ++k) {
    const auto& window = strongest.decays[k];
    auto& one = found.decays.emplace_back(
        FoundDecay{found.time_s(window.start), found.time_s(window.end - 1), false, {}});
    if (k == strongest.fitted_decay) {
      one = {found.start_s, found.end_s, strongest.refusal_code.empty(), {}};
      if (options.each) one.result = strongest;
    } else if (options.each) {
      const auto own =
          estimated_decay(recorded, channel, from + window.start, from + window.end, decay);
      const auto& result = one.result.emplace(own.result);
      const std::string at = fmt::format("{} at {:.6g} s", where, one.start_s);
      one.fitted = result.refusal_code.empty();
      if (one.fitted) {
        one.start_s = own.start_s, one.end_s = own.end_s;
      } else {
        findings.push_back({result.refusal_code, "this decay is left out: " + result.refusal, at});
      }
      add_notes(result.notes, findings, at);
    }
  }
  if (options.each) found.pooled = pooled(found);
  if (const double rate_std = recorded.recording.sample_rate_relative_std; rate_std > 0) {
    if (!strongest.modes.empty()) {
      tell_rate(rate_std, strongest.modes.front().frequency_hz, where, findings);
    }
    widen_by_rate(rate_std, found);
  }
  return found;
}

// Over which record and answer are brought together: some cycles, over which a model whose
// frequency is a few per cent off stays in step.
constexpr double kAlike_s = 0.5;

/// Where the model's answer starts in the record: the shift at which they are most alike over the
/// model's first `length` samples.
Index best_shift(const VectorXd& record, const VectorXd& model, Index length) {
  const Index n = std::min({length, record.size(), model.size()});
  Index best = 0;
  double most = -1;
  const VectorXd head = model.head(n).array() - model.head(n).mean();
  for (Index shift = 0; shift + n <= record.size(); ++shift) {
    const auto part = record.segment(shift, n);
    // Where the model starts, the record moves most: alike in size as well as in shape.
    const double product = (part.array() - part.mean()).matrix().dot(head);
    if (product > most) most = product, best = shift;
  }
  return best;
}

}  // namespace

RecordedDecay estimated_decay(const TestRecording& recorded, const signal::Channel& channel,
                              Index from, Index to, signal::DecayOptions options) {
  const double rate = recorded.recording.sample_rate_hz;
  options.start_time_s = recorded.recording.start_time_s + static_cast<double>(from) / rate;
  RecordedDecay decay{recorded.name,   channel.name, channel.unit,
                      recorded.origin, rate,         options.start_time_s};
  decay.samples = channel.samples.segment(from, to - from);
  if (recorded.recording.late.size() > 0) {
    options.late = recorded.recording.late.segment(from, to - from);
  }
  decay.result = signal::estimate_decay(decay.samples, rate, options);
  decay.start_s = decay.time_s(decay.result.start),
  decay.end_s = decay.time_s(decay.result.end - 1);
  return decay;
}

DecayTest run_decay_test(const TestRecording& given, const DecayTestOptions& options) {
  DecayTest test;
  const std::optional<TestRecording> placed = placed_evenly(given);
  const TestRecording& recorded = placed ? *placed : given;
  const auto& recording = recorded.recording;
  if (auto refused = not_uniform(recording, recorded.name)) {
    test.findings.push_back(std::move(*refused));
    return test;
  }
  const Index from = options.start_s ? sample_at(recording, *options.start_s, true) : 0;
  const Index to =
      options.end_s ? sample_at(recording, *options.end_s, false) : recording.samples();
  if (from >= to || std::isnan(options.start_s.value_or(0)) ||
      std::isnan(options.end_s.value_or(0))) {
    throw std::invalid_argument(
        fmt::format("give a start and a later end in the record, which lasts from {} s to {} s",
                    recording.start_time_s, recording.start_time_s + recording.duration_s()));
  }
  auto names = options.channels;
  if (names.empty())
    std::ranges::transform(recording.channels, std::back_inserter(names), &signal::Channel::name);
  for (const auto& name : names) {
    try {
      test.channels.push_back(
          channel_decays(recorded, recording.channel(name), options, from, to, test.findings));
    } catch (const signal::RecordingError& error) {
      test.findings.push_back({"channel", error.what(), recorded.name + ": " + name, true});
    }
  }
  return test;
}

std::vector<ReleaseAnswer> release_answers(const ChannelDecays& decays,
                                           const signal::DecayOptions& options,
                                           const std::vector<ModelVersion>& versions, int threads) {
  // Missing samples lie on the mean.
  const auto samples = decays.samples.array();
  const double count = static_cast<double>(samples.isFinite().count());
  const VectorXd record =
      samples.isFinite().select(samples, samples.isFinite().select(samples, 0).sum() / count);
  const double rate = decays.sample_rate_hz;
  // As long as the decay is, or until its strongest mode has died away.
  const auto& mode = decays.result.modes.front();
  double lasts = static_cast<double>(decays.result.end - decays.result.start) / rate;
  if (mode.damping_ratio.value > 0) {
    lasts = std::min(lasts, -std::log(signal::kRungDown) /
                                (kTwoPi * mode.frequency_hz.value * mode.damping_ratio.value));
  }
  model::ResponseOptions response;
  response.sampling.rate_hz = rate;
  response.sampling.duration_s = kAlike_s + lasts;
  std::vector<ReleaseAnswer> answers(versions.size());
  in_parallel(versions.size(), threads, [&](std::size_t k) {
    ReleaseAnswer& answer = answers[k];
    answer.label = versions[k].label;
    answer.response = model::simulate_response(versions[k].scene, response);
    if (!answer.response.completed || answer.response.samples.rows() < 16) {
      answer.failure = "the model gives no answer: " + answer.response.reason;
      return;
    }
    const VectorXd model = answer.response.samples.col(0);
    answer.start = best_shift(record, model, static_cast<Index>(std::lround(kAlike_s * rate)));
    // The same stretch of the motion as in the record: a large motion's frequency falls with it.
    const Index first = std::max<Index>(0, decays.result.start - answer.start);
    const Index last = std::min(model.size(), decays.result.end - answer.start);
    if (last - first < 16) {
      answer.failure = "the record was analysed where the model has ended";
      return;
    }
    signal::DecayOptions same = options;
    same.choose_window = same.trim_start = false;
    answer.found = signal::estimate_decay(model.segment(first, last - first), rate, same);
  });
  return answers;
}

const signal::DecayMode* same_mode(const signal::DecayMode& mode, const signal::DecayResult& other,
                                   double within) {
  const auto off = [&](const signal::DecayMode& one) {
    return std::abs(std::log(one.frequency_hz.value / mode.frequency_hz.value));
  };
  const auto nearest = std::ranges::min_element(other.modes, {}, off);
  return nearest != other.modes.end() && off(*nearest) < within ? &*nearest : nullptr;
}

}  // namespace rigfit::ident
