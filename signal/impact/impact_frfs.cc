#include "signal/impact/impact_frfs.h"

#include <gsl/gsl_cdf.h>

#include "signal/estimation/robust.h"
#include "signal/readers/uff58.h"
#include "signal/recording/add_note.h"
#include "signal/spectra/window.h"

namespace rigfit::signal {
namespace {

/// Mean of a block's force outside of its pulse: what zero is during the hit.
double level_beside(const FrfBlock& block, double otherwise) {
  const auto size = static_cast<Index>(block.force.size());
  const Index first = std::clamp<Index>(block.pulse_first, 0, size);
  const Index last = std::clamp<Index>(block.pulse_last + 1, first, size);
  const Map<const VectorXd> x(block.force.data(), size);
  const Index beside = first + size - last;
  if (beside < kFewestForNoise) return otherwise;
  return (x.head(first).sum() + x.tail(size - last).sum()) / static_cast<double>(beside);
}

double scatter(const Ref<const VectorXd>& x) {
  if (x.size() < kFewestForNoise) return 0;
  return std::sqrt((x.array() - x.mean()).square().sum() / static_cast<double>(x.size() - 1));
}

/// "(m/s^2)/N"; "?" for a unit that is not known, empty where neither is.
std::string ratio_of_units(const std::string& response, const std::string& force) {
  if (response.empty() && force.empty()) return "";
  const auto part = [](const std::string& unit) {
    if (unit.empty()) return std::string("?");
    return unit.find('/') == std::string::npos ? unit : "(" + unit + ")";
  };
  return part(response) + "/" + part(force);
}

/// By the units of both; unknown where they are no SI units of motion and force.
FrfForm form_of(const Channel& response, const Channel& force) {
  int form = 0;
  const std::string unit = ratio_of_units(response.unit, force.unit);
  while (form < static_cast<int>(FrfForm::unknown) && unit != unit_of(static_cast<FrfForm>(form))) {
    ++form;
  }
  return static_cast<FrfForm>(form);
}

class Analysis {
 public:
  Analysis(std::span<const Recording> recordings, const std::string& force,
           std::span<const std::string> responses, const ImpactTestOptions& options)
      : recordings_(recordings), options_(options) {
    if (recordings.empty()) return;
    force_ = recordings.front().channel_index(force);
    for (const std::string& name : responses) {
      test_.responses.push_back(recordings.front().channel_index(name));
    }
    for (const Recording& recording : recordings) {
      same_channel(recording, force, force_);
      for (std::size_t r = 0; r < responses.size(); ++r) {
        same_channel(recording, responses[r], test_.responses[r]);
      }
    }
  }

  ImpactTest run() {
    if (recordings_.empty()) return std::move(test_);
    test_.search = find_hits(recordings_, force_, test_.responses, options_.hits);
    test_.notes = test_.search.notes;
    for (Hit& hit : test_.search.hits) {
      if (hit.accepted) accepted_.push_back(&hit);
    }
    const FrfEstimate estimate = average_without_outliers();
    test_.amplitudes = std::ranges::none_of(
        accepted_, [](const Hit* hit) { return hit->has(HitFault::unresolved_pulse); });
    describe(estimate);
    if (estimate.H.rows() > 0) judge(estimate);
    return std::move(test_);
  }

 private:
  void same_channel(const Recording& recording, const std::string& name, Index index) const {
    if (recording.channel_index(name) == index) return;
    throw RecordingError({recording.path.string(), 0, 0, name, ""},
                         "is not the same column as in " + recordings_.front().path.string(),
                         "average only recordings with the same channels in the same order");
  }

  const Channel& channel(std::size_t recording, Index index) const {
    return recordings_[recording].channels[static_cast<std::size_t>(index)];
  }

  double decay_rate() const {
    if (options_.exponential_end_level > 0) {
      return decay_rate_for(options_.exponential_end_level, block_duration());
    }
    return options_.exponential_decay_rate_1_s;
  }

  FrfBlock block_of(const Hit& hit) const {
    const double rate = test_.search.sample_rate_hz;
    const auto length =
        static_cast<std::size_t>(std::min(hit.available, test_.search.block_samples));
    const Index width = hit.pulse_last - hit.pulse_first + 1;
    const Index quiet = std::max<Index>(0, hit.pulse_first - width - hit.block_first);
    FrfBlock block;
    const Channel& force = channel(hit.recording, force_);
    block.force = {force.samples.data() + hit.block_first, length};
    // A hammer's signal rings after the pulse, filters before it too.
    block.pulse_first = hit.pulse_first - hit.block_first - 3 * width;
    block.pulse_last = hit.pulse_last - hit.block_first + 10 * width;
    block.force_offset = level_beside(block, hit.offset);
    if (const double kept = kept_force(hit); kept > 0) {
      const auto samples = std::max(width, static_cast<Index>(std::ceil(kept * rate)));
      const auto earlier = static_cast<Index>(std::min(0.0, hit.second_hit_delay_s) * rate);
      block.force_first = std::max<Index>(0, hit.pulse_first - width - hit.block_first + earlier);
      block.force_last = hit.pulse_first - hit.block_first + samples;
      block.force_taper = std::max<Index>(1, samples / 2);
    }
    for (std::size_t r = 0; r < test_.responses.size(); ++r) {
      const VectorXd& y = channel(hit.recording, test_.responses[r]).samples;
      block.responses.push_back({y.data() + hit.block_first, length});
      block.response_offset.push_back(test_.search.response_rest[hit.recording][r]);
      block.response_noise_std.push_back(scatter(y.segment(hit.block_first, quiet)));
    }
    return block;
  }

  /// Impulse of a hit: integral of the force over its pulse.
  double impulse_of(const Hit& hit) const {
    const VectorXd& force = channel(hit.recording, force_).samples;
    const Index count = hit.pulse_last - hit.pulse_first + 1;
    const double sum = force.segment(hit.pulse_first, count).sum();
    return (sum - static_cast<double>(count) * hit.offset) / test_.search.sample_rate_hz;
  }

  /// Force kept after the beginning of the pulse, s; 0: all of it.
  double kept_force(const Hit& hit) const {
    const double second = std::max(0.0, hit.second_hit_delay_s);
    return options_.force_window_s.value_or(second + 3 * hit.pulse_duration_s);
  }

  /// Scatter of the force just behind its window over the peak; 0: as later on. Three times the
  /// later one, a variance ratio of 9, is beyond the chance of 16 samples of noise.
  double force_behind(const Hit& hit) const {
    const FrfBlock block = block_of(hit);
    const auto size = static_cast<Index>(block.force.size());
    const Index from = block.force_last + block.force_taper;
    const Index count = std::max<Index>(16, 3 * (hit.pulse_last - hit.pulse_first + 1));
    if (block.force_last < 0 || from + count >= size) return 0;
    const Map<const VectorXd> x(block.force.data(), size);
    const double behind = scatter(x.segment(from, count));
    return behind > 3 * scatter(x.tail(size - from - count)) ? behind / std::abs(hit.peak) : 0;
  }

  /// Noise over force, powers, at the lines of the band.
  std::vector<double> noise_shares(const FrfEstimate& estimate) const {
    std::vector<double> shares{0};
    if (estimate.force_noise.size() == 0) return shares;
    const double low = options_.hits.band_hz ? options_.hits.band_hz->first : 0;
    const double high = options_.hits.band_hz ? options_.hits.band_hz->second : usable_hz();
    for (Index k = 1; k < estimate.frequency_hz.size(); ++k) {
      const double f = estimate.frequency_hz[k], measured = estimate.force_power[k];
      if (f < low || f > high || !(measured > 0)) continue;
      const double noise = std::min(estimate.force_noise[k], 0.75 * measured);
      shares.push_back(noise / (measured - noise));
    }
    return shares;
  }

  double usable_hz() const {
    double usable = 0.5 * test_.search.sample_rate_hz;
    for (const Hit* hit : accepted_) usable = std::min(usable, hit->usable_hz);
    return usable;
  }

  /// Lines of single hits that are kept: those modes are looked for in.
  Index lines_of_hits() const {
    const double high = options_.hits.band_hz ? options_.hits.band_hz->second : usable_hz();
    return static_cast<Index>(std::ceil(1.02 * high * block_duration())) + 10;
  }

  /// Incoherent power per degree of freedom without a hit over that with it, at most, of an
  /// outlier.
  double outlier_ratio(std::size_t hits, bool others_differ) const {
    const auto n = static_cast<double>(hits);
    const double chance = (others_differ ? 0.2 : 1) * 0.05;
    const double left = gsl_cdf_beta_Pinv(chance / n, 0.5 * (n - 2), 0.5);
    return std::min(0.5, left * (n - 1) / (n - 2));
  }

  /// Part of the responses' power that the noise before the hits has, mean over the responses.
  static double noise_share(std::span<const FrfBlock> blocks) {
    double sum = 0, count = 0;
    for (std::size_t r = 0; r < blocks.front().responses.size(); ++r) {
      double noise = 0, power = 0;
      for (const FrfBlock& block : blocks) {
        const auto& y = block.responses[r];
        const Map<const ArrayXd> values(y.data(), static_cast<Index>(y.size()));
        noise += std::pow(block.response_noise_std[r], 2) * static_cast<double>(y.size());
        power += (values - block.response_offset[r]).square().sum();
      }
      if (power > 0) sum += noise / power, ++count;
    }
    return count > 0 ? sum / count : 0;
  }

  FrfEstimate average_without_outliers() {
    constexpr double kLeastIncoherence = 1e-3;  // share of the response power
    const FrfOptions frf{.estimator = options_.estimator,
                         .sample_rate_hz = test_.search.sample_rate_hz,
                         .block_samples = test_.search.block_samples,
                         .exponential_decay_rate_1_s = decay_rate(),
                         .by_hit_lines = lines_of_hits()};
    for (;;) {
      std::vector<FrfBlock> blocks;
      for (const Hit* hit : accepted_) blocks.push_back(block_of(*hit));
      if (blocks.empty()) return {};
      FrfEstimate estimate = average_frfs(blocks, frf);
      if (blocks.size() < 3) return estimate;
      Index worst = 0;
      const double without = estimate.incoherence_without.minCoeff(&worst);
      const double noise = noise_share(blocks);
      const bool others_differ = noise > 0 && without > 10 * noise;
      if (estimate.incoherence < kLeastIncoherence ||
          without >= outlier_ratio(blocks.size(), others_differ) * estimate.incoherence) {
        return estimate;
      }
      const auto outlier = accepted_.begin() + worst;
      (*outlier)->reject(HitFault::outlier,
                         fmt::format("outlier: without it the part of the response that the "
                                     "force does not explain falls from {:.2g} % to {:.2g} %",
                                     100 * estimate.incoherence, 100 * without));
      accepted_.erase(outlier);
    }
  }

  void describe(const FrfEstimate& estimate) {
    FrfSet& frfs = test_.frfs;
    frfs = estimate;
    frfs.sample_rate_hz = test_.search.sample_rate_hz;
    double pre_trigger = 0;
    frfs.hit_impulse.emplace_back();
    for (const Hit* hit : accepted_) {
      pre_trigger += static_cast<double>(hit->peak_sample - hit->block_first);
      frfs.hit_impulse.back().push_back(impulse_of(*hit));
    }
    frfs.pre_trigger_s = pre_trigger / std::max(1, frfs.averages) / test_.search.sample_rate_hz;
    const Channel& force = channel(0, force_);
    std::vector<FrfForm> forms;
    for (std::size_t r = 0; r < test_.responses.size(); ++r) {
      const Channel& response = channel(0, test_.responses[r]);
      frfs.responses.push_back(
          {response.name, static_cast<int>(r + 1), uff58_direction(response.direction)});
      forms.push_back(form_of(response, force));
    }
    frfs.inputs.push_back({force.name, 0, uff58_direction(force.direction)});
    set_form(forms, force);
    if (!test_.amplitudes) {
      frfs.form = FrfForm::unknown;
      frfs.unit.clear();
      add_note(frfs.notes, "unscaled", "",
               "Use frequencies and damping only: the hits' pulses are not resolved, so that "
               "amplitudes and phases have no meaning");
    }
  }

  void set_form(const std::vector<FrfForm>& forms, const Channel& force) {
    FrfSet& frfs = test_.frfs;
    if (forms.empty()) return;
    const auto unknown = std::ranges::find(forms, FrfForm::unknown);
    if (unknown != forms.end()) {
      const Channel& response =
          channel(0, test_.responses[static_cast<std::size_t>(unknown - forms.begin())]);
      frfs.unit = ratio_of_units(response.unit, force.unit);
      add_note(test_.notes, "frf_form", force.unit != "N" ? force.name : response.name,
               "State units and sensitivities beside the recording: force in \"{}\" and response "
               "in \"{}\" do not form a receptance, mobility or accelerance",
               force.unit.empty() ? "?" : force.unit, response.unit.empty() ? "?" : response.unit);
      return;
    }
    frfs.form = forms.front();
    if (std::ranges::count(forms, frfs.form) < std::ssize(forms)) {
      // One form for all: accelerances, to which the others are multiplied.
      for (std::size_t r = 0; r < forms.size(); ++r) {
        const int derivatives = static_cast<int>(forms[r]);
        if (frfs.H.rows() > 0) multiply_by_s(frfs, static_cast<Index>(r), 2 - derivatives);
      }
      frfs.form = FrfForm::accelerance;
      add_note(test_.notes, "frf_form", "",
               "responses of different quantities are all given as accelerances");
    }
    frfs.unit = unit_of(frfs.form);
  }

  void judge(const FrfEstimate& estimate) {
    test_.usable_hz = usable_hz();
    for (Index c = 0; c < test_.frfs.H.cols(); ++c) {
      if (!test_.frfs.H.col(c).isZero(0)) continue;
      add_note(test_.notes, "dead_frf", test_.frfs.responses[static_cast<std::size_t>(c)].name,
               "Check the sensor: its signal does not change, and the FRF is zero throughout");
    }
    double end_level = 0, hidden = 0, behind = 0;
    for (const Hit* hit : accepted_) {
      behind = std::max(behind, force_behind(*hit));
      test_.force_window_s += kept_force(*hit) / test_.frfs.averages;
      end_level = std::max(end_level, hit->end_level);
      hidden = std::max(hidden, hit->smallest_second_hit);
    }
    judge_force_noise(estimate);
    // Over three pulses and more that is an error of H of 0.1 % and more.
    if (behind > 1e-3) {
      add_note(test_.notes, "force_window", "",
               "Take a longer --force-window, or off, if the hammer goes on to push behind it, "
               "where the force still swings by {:.2g} % of its peak: what is cut off looks like a "
               "mode; a ringing sensor is cut off rightly",
               100 * behind);
    }
    const double left = end_level * std::exp(-decay_rate() * block_duration());
    // What is cut off at the end of a block, R / (s - p) exp(p T) exp(i w t) of a mode, T from the
    // hit to the end and t from the block's beginning to the hit, is smooth over lines as well.
    if (left > 1e-3 && left > 3 * test_.search.rest_level) {
      for (const Hit* hit : accepted_) {
        const auto before = static_cast<double>(hit->peak_sample - hit->block_first);
        test_.frfs.force_noise_span_s =
            std::max(test_.frfs.force_noise_span_s, before / test_.search.sample_rate_hz);
      }
    }
    if (left > kRungDown && left > 3 * test_.search.rest_level) {
      add_note(test_.notes, "ring_down_truncated", "",
               "Wait longer between hits, or use an exponential window: responses are still at "
               "{:.2g} % of their largest value at the end of the block",
               100 * left);
    }
    if (hidden > 0.05) {
      add_note(test_.notes, "double_hit_hidden", "",
               "Reduce the noise on the force: double hits smaller than {:.2g} % of the peak "
               "cannot be detected in it",
               100 * hidden);
    }
    if (test_.frfs.averages <= 2) {
      test_.notes.push_back(
          {"few_hits",
           test_.frfs.averages == 2
               ? "Average more hits: error bars from two are themselves uncertain by half or more"
           : estimate.H_std.size() > 0
               ? "Average several hits: one has no coherence, and its error bars come from the "
                 "noise before it"
               : "Average several hits: one has neither coherence nor error bars",
           ""});
    }
  }

  void judge_force_noise(const FrfEstimate& estimate) {
    const std::vector<double> shares = noise_shares(estimate);
    test_.force_noise_left = *std::ranges::max_element(shares);
    if (test_.force_window_s > 0) {
      const Map<const ArrayXd> of_hit(shares.data(), std::ssize(shares));
      test_.frfs.force_noise_std = std::sqrt(0.5 * of_hit.mean() / test_.frfs.averages);
    }
    // From an error of 0.1 % of H on.
    if (test_.force_window_s > 0 && test_.force_noise_left > 1e-6) {
      test_.frfs.force_noise_span_s = force_noise_span();
    }
    if (estimate.force_noise.size() == 0) {
      add_note(test_.notes, "force_noise", "",
               "Record longer beside the hits: too few samples there to measure the noise on the "
               "force, for which H1 is not corrected");
    }
    // What is subtracted is known to some 10 %; beyond a tenth of the force's power that is 1 %.
    if (test_.force_noise_left > 0.1) {
      const double left = test_.force_noise_left;
      add_note(test_.notes, "force_noise", "",
               "Use {}: noise has up to {} of the force's power in the band{}",
               test_.force_window_s > 0 ? "a harder tip, a narrower band or a shorter force window"
                                        : "a force window",
               left >= 3 ? "three times or more" : fmt::format("{:.2g} %", 100 * left),
               options_.estimator == FrfEstimator::h1
                   ? ", and H1 is corrected by its mean power only"
                   : "");
    }
  }

  /// From a hit's peak to where its force window has faded out, the longest of all hits.
  double force_noise_span() const {
    Index longest = 0;
    for (const Hit* hit : accepted_) {
      const FrfBlock block = block_of(*hit);
      const Index peak = hit->peak_sample - hit->block_first;
      longest = std::max({longest, block.force_last + block.force_taper - peak,
                          peak - std::max<Index>(0, block.force_first - block.force_taper)});
    }
    return static_cast<double>(longest) / test_.search.sample_rate_hz;
  }

  double block_duration() const {
    return static_cast<double>(test_.search.block_samples) / test_.search.sample_rate_hz;
  }

  std::span<const Recording> recordings_;
  const ImpactTestOptions& options_;
  Index force_ = 0;
  ImpactTest test_;
  std::vector<Hit*> accepted_;  ///< of `test_.search`
};

}  // namespace

ImpactTest analyse_impact_test(std::span<const Recording> recordings, const std::string& force,
                               std::span<const std::string> responses,
                               const ImpactTestOptions& options) {
  return Analysis(recordings, force, responses, options).run();
}

}  // namespace rigfit::signal
