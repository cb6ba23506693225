#include "apps/report/parts/axial_part.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <stdexcept>

#include "apps/report/figures/decay_plots.h"
#include "apps/report/html_text.h"
#include "apps/report/parts/recording_blocks.h"
#include "ident/axial/axial_test.h"
#include "ident/statistics/in_parallel.h"
#include "signal/decay/decay_window.h"
#include "signal/recording/recording_error.h"

namespace rigfit::apps {
namespace {

struct Sample {
  AnalysedDecay decay;
  double length_m = 0;
};

class AxialAnalysis {
 public:
  AxialAnalysis(const CampaignTest& test, std::uint64_t seed) : test_(test), seed_(seed) {
    part().id = test.name;
    part().title = test.title;
    part().json_key = "axial";
    part().json["test"] = test.name;
  }

  AxialPart run(int threads) {
    const auto loaded = load_recordings(test_.recordings);
    for (const auto& entry : loaded) {
      part().inputs.insert(part().inputs.end(), entry.inputs.begin(), entry.inputs.end());
    }
    part().blocks.push_back(Paragraph{fmt::format(
        "A mass of {:g} kg hangs from a length of cable and is struck; the tension swings up and "
        "down. How fast gives the axial stiffness EA, how soon it dies away gives the damping.",
        test_.axial.mass_kg.value)});
    add_recordings(part(), test_, loaded);
    std::vector<Found> found(loaded.size());
    ident::in_parallel(loaded.size(), threads, [&](std::size_t i) {
      if (loaded[i].recording) found[i] = find_decays(loaded[i]);
    });
    for (std::size_t i = 0; i < found.size(); ++i) {
      if (!found[i].code.empty()) refuse(part(), found[i].code, found[i].why, loaded[i].file);
      std::move(found[i].samples.begin(), found[i].samples.end(), std::back_inserter(samples_));
    }
    solve();
    return std::move(result_);
  }

 private:
  ReportPart& part() { return result_.part; }

  /// What one recording holds.
  struct Found {
    std::vector<Sample> samples;
    std::string code, why;  ///< of a refusal; empty: none
  };

  [[nodiscard]] Found find_decays(const LoadedRecording& entry) const {
    const auto& recording = *entry.recording;
    const auto& group = test_.recordings[entry.group];
    if (recording.time_s.size() > 0 || !(recording.sample_rate_hz > 0)) {
      return {{},
              "not_uniform",
              recording.time_s.size() > 0 ? "its samples are not evenly spaced in time"
                                          : "gives no sample rate; add sample_rate_hz"};
    }
    const signal::Channel* channel = nullptr;
    try {
      if (!test_.channels.empty()) {
        channel = &recording.channel(test_.channels.front());
      } else if (recording.channels.size() == 1) {
        channel = &recording.channels.front();
      } else {
        return {{}, "channel", "holds several channels; name one with channel = \"...\""};
      }
    } catch (const signal::RecordingError& error) {
      return {{}, "channel", error.what()};
    }
    signal::DecayOptions options;
    if (test_.band_hz) {
      options.band_low_hz = test_.band_hz->first;
      options.band_high_hz = test_.band_hz->second;
    }
    options.choose_window = false;
    Found found;
    for (const auto& window : signal::find_decays(channel->samples)) {
      Sample sample;
      sample.length_m = *group.length_m;
      auto& decay = sample.decay;
      decay.file = entry.file;
      decay.channel = channel->name;
      decay.unit = channel->unit;
      decay.origin = group.origin();
      decay.rate_hz = recording.sample_rate_hz;
      decay.start_s = recording.start_time_s + static_cast<double>(window.start) / decay.rate_hz;
      decay.samples = channel->samples.segment(window.start, window.end - window.start);
      decay.result = signal::estimate_decay(decay.samples, decay.rate_hz, options);
      if (!decay.result.refusal_code.empty() || decay.result.modes.empty()) {
        found.why = decay.result.refusal;
        continue;
      }
      found.samples.push_back(std::move(sample));
    }
    if (found.samples.empty()) {
      found.code = "no_decay";
      if (found.why.empty()) found.why = "holds no decay";
    }
    return found;
  }

  void solve() {
    std::vector<ident::AxialDecay> decays;
    for (const auto& sample : samples_) {
      const auto& mode = sample.decay.result.modes.front();
      decays.push_back(
          {fmt::format("{} at {:.4g} s", short_name(sample.decay.file), sample.decay.start_s),
           sample.length_m, mode.damped_frequency_hz, mode.damping_ratio});
    }
    if (decays.empty()) {
      refuse(part(), "no_decay", "none of the recordings holds a decay that can be used",
             test_.name);
      return;
    }
    origin_ = samples_.front().decay.origin;
    ident::AxialOptions options;
    options.seed = seed_;
    ident::AxialTestResult r;
    try {
      r = ident::axial_test(decays, test_.axial, options);
    } catch (const std::invalid_argument& error) {
      refuse(part(), "axial", error.what(), test_.name);
      return;
    }
    for (const auto& note : r.notes) {
      part().warnings.push_back({note.code, note.message, test_.name + " " + note.where, false});
    }
    result_.EA_N = r.EA_N.value;
    part().blocks.push_back(length_plot(r));
    part().blocks.push_back(length_table(r));
    part().blocks.push_back(budget_table(r));
    if (r.draws > 0) {
      part().blocks.push_back(Paragraph{
          fmt::format("Checked by a Monte Carlo of {} draws: {} N, 95 % between {} and {} N.",
                      r.draws, shown_estimate(r.monte_carlo_EA_N.value, r.monte_carlo_EA_N.std),
                      shown(r.monte_carlo_low_N, 5), shown(r.monte_carlo_high_N, 5))});
    }
    if (!r.plausibility.empty()) {
      part().blocks.push_back(Paragraph{r.plausibility, Paragraph::Kind::note});
    }
    figures();
    describe(r);
  }

  void figures() {
    PlotGroup group{test_.name + "-decays", "Decays", {}};
    std::vector<AnalysedDecay> decays;
    double last = -1;
    for (const auto& sample : samples_) {
      if (sample.length_m == last) continue;  // the first of each length
      last = sample.length_m;
      decays.push_back(sample.decay);
      group.tabs.push_back(
          {fmt::format("{:g} m", last),
           {decay_plot(fmt::format("{}-decay-{:g}m", test_.name, last), sample.decay)}});
    }
    part().blocks.push_back(std::move(group));
    auto damping = damping_plot(test_.name + "-damping", decays);
    if (!damping.series.empty()) part().blocks.push_back(std::move(damping));
  }

  Plot length_plot(const ident::AxialTestResult& r) const {
    Plot plot;
    plot.id = test_.name + "-EA";
    plot.title = "EA by length";
    plot.caption =
        "EA does not depend on the length of cable that was tested. A trend would be a stiffness "
        "in "
        "series that nobody counted. The band is the result with its 95 % interval.";
    plot.x_label = "length, m";
    plot.y_label = "EA, kN";
    PlotSeries all, each, records;
    double low = r.lengths.front().length_m, high = low;
    each.name = "EA at each length, 95 %";
    each.origin = records.origin = origin_;
    each.style = records.style = PlotSeries::Style::points;
    records.name = "each record";
    records.variant = 1;
    for (const auto& sample : r.samples) {
      records.x.push_back(sample.length_m);
      records.y.push_back(1e-3 * sample.EA_N.value);
    }
    for (const auto& length : r.lengths) {
      low = std::min(low, length.length_m);
      high = std::max(high, length.length_m);
      each.x.push_back(length.length_m);
      each.y.push_back(1e-3 * length.EA_N.value);
      each.low.push_back(1e-3 * (length.EA_N.value - r.coverage_factor * length.EA_N.std));
      each.high.push_back(1e-3 * (length.EA_N.value + r.coverage_factor * length.EA_N.std));
    }
    const double margin = high > low ? 0.1 * (high - low) : 0.1 * high;
    all.name = "EA, all lengths";
    all.origin = Origin::modelled;
    all.x = {low - margin, high + margin};
    all.y.assign(2, 1e-3 * r.EA_N.value);
    all.low.assign(2, 1e-3 * r.EA_low_N);
    all.high.assign(2, 1e-3 * r.EA_high_N);
    plot.series = {std::move(all), std::move(records), std::move(each)};
    if (const auto at = test_.reference.find("EA"); at != test_.reference.end()) {
      PlotSeries reference;
      reference.name = test_.reference_name;
      reference.origin =
          test_.reference_name == "published" ? Origin::published : samples_.front().decay.origin;
      reference.style = PlotSeries::Style::dashed;
      reference.x = {low - margin, high + margin};
      reference.y.assign(2, 1e-3 * at->second);
      plot.series.push_back(std::move(reference));
    }
    return plot;
  }

  ReportTable length_table(const ident::AxialTestResult& r) const {
    ReportTable table;
    table.id = test_.name + "-lengths";
    table.caption =
        "EA, damping ratio and equivalent damper by length, with standard uncertainties.";
    table.columns = {{"length, m", {}, true},
                     {"records", {}, true},
                     {"EA, N", origin_},
                     {"damping ratio, %", origin_},
                     {"damper, N s/m", origin_}};
    for (const auto& length : r.lengths) {
      table.rows.push_back(
          {fmt::format("{:g}", length.length_m), fmt::format("{}", length.records),
           Cell(shown_estimate(length.EA_N.value, length.EA_N.std), origin_),
           Cell(shown_estimate(100 * length.damping_ratio.value, 100 * length.damping_ratio.std),
                origin_),
           shown(length.damping_Ns_m, 4)});
    }
    table.rows.push_back(
        {"all", fmt::format("{}", r.samples.size()),
         Cell(shown_estimate(r.EA_N.value, r.EA_N.std), origin_),
         Cell(shown_estimate(100 * r.damping_ratio.value, 100 * r.damping_ratio.std), origin_),
         shown_estimate(r.damping_Ns_m.value, r.damping_Ns_m.std)});
    return table;
  }

  ReportTable budget_table(const ident::AxialTestResult& r) const {
    ReportTable table;
    table.id = test_.name + "-budget";
    table.caption =
        "Where the uncertainty of EA comes from (type A: from scatter, B: from what is known of "
        "instruments).";
    table.columns = {{"source", {}, false},
                     {"type", {}, false},
                     {"value", {}, true},
                     {"standard uncertainty", {}, true},
                     {"contribution to EA, N", {}, true},
                     {"share, %", {}, true}};
    for (const auto& row : r.budget) {
      const std::string unit = row.unit == "1" ? "" : " " + row.unit;
      Cell share(fmt::format("{:.1f}", 100 * row.share));
      share.shade = std::clamp(row.share, 0.0, 1.0);
      table.rows.push_back({row.source, std::string(1, row.type),
                            std::isfinite(row.value) ? shown(row.value, 5) + unit : std::string(),
                            shown(row.std, 2) + unit, shown(row.contribution_N, 3), share});
    }
    return table;
  }

  void describe(const ident::AxialTestResult& r) {
    const auto estimate = [](const signal::Estimate& e) {
      return Json{{"value", e.value}, {"std", e.std}};
    };
    auto& json = part().json;
    json["EA_N"] = estimate(r.EA_N);
    json["EA_N"]["low"] = r.EA_low_N;
    json["EA_N"]["high"] = r.EA_high_N;
    json["damping_ratio"] = estimate(r.damping_ratio);
    json["damping_Ns_m"] = estimate(r.damping_Ns_m);
    json["damping_Ns_m"]["length_m"] = r.reference_length_m;
    Json lengths = Json::array(), budget = Json::array(), samples = Json::array();
    for (const auto& length : r.lengths) {
      lengths.push_back({{"length_m", length.length_m},
                         {"records", length.records},
                         {"EA_N", estimate(length.EA_N)},
                         {"damping_ratio", estimate(length.damping_ratio)}});
    }
    for (const auto& row : r.budget) {
      budget.push_back({{"source", row.source},
                        {"std", row.std},
                        {"unit", row.unit},
                        {"contribution_N", row.contribution_N},
                        {"share", row.share}});
    }
    for (std::size_t i = 0; i < r.samples.size(); ++i) {
      const auto& mode = samples_[i].decay.result.modes.front();
      samples.push_back({{"file", samples_[i].decay.file},
                         {"length_m", r.samples[i].length_m},
                         {"damped_frequency_hz", estimate(mode.damped_frequency_hz)},
                         {"damping_ratio", estimate(mode.damping_ratio)},
                         {"EA_N", estimate(r.samples[i].EA_N)}});
    }
    json["lengths"] = std::move(lengths);
    json["budget"] = std::move(budget);
    json["samples"] = std::move(samples);
    json["between_lengths_std_N"] = r.between_lengths_std_N;
    json["p_same_EA"] = r.homogeneity_p;
    json["plausibility"] = r.plausibility;

    std::string text =
        fmt::format("{} N (95 %: {} to {})", shown_estimate(r.EA_N.value, r.EA_N.std),
                    shown(r.EA_low_N, 5), shown(r.EA_high_N, 5));
    const auto& reference = test_.reference;
    if (const auto at = reference.find("EA"); at != reference.end()) {
      text += fmt::format("; {} {} ({})", test_.reference_name, shown(at->second, 5),
                          shown_percent(r.EA_N.value / at->second - 1));
    }
    part().summary.push_back(
        {SummaryItem::Kind::result, "EA of the cable", text, origin_, part().id});
    text = shown_estimate(100 * r.damping_ratio.value, 100 * r.damping_ratio.std) + " %";
    if (const auto at = reference.find("damping_ratio"); at != reference.end()) {
      text += fmt::format("; {} {} %", test_.reference_name, shown(100 * at->second, 3));
    }
    part().summary.push_back(
        {SummaryItem::Kind::result, "Axial damping ratio", text, origin_, part().id});
    if (r.homogeneity_p < 0.05 && r.lengths.size() > 1) {
      part().summary.push_back(
          {SummaryItem::Kind::distrust, "EA by length",
           fmt::format(
               "the lengths disagree (chance {:.1g}): something besides the cable gives way, "
               "or a length is wrong",
               r.homogeneity_p),
           origin_, part().id});
    }
    if (r.catalogue_EA_N > 0 && (r.share_of_catalogue < 0.5 || r.share_of_catalogue > 1.5)) {
      part().summary.push_back(
          {SummaryItem::Kind::distrust, "Size of EA", r.plausibility, origin_, part().id});
    }
  }

  const CampaignTest& test_;
  std::uint64_t seed_;
  AxialPart result_;
  std::vector<Sample> samples_;
  Origin origin_ = Origin::measured;
};

}  // namespace

AxialPart axial_part(const CampaignTest& test, std::uint64_t seed, int threads) {
  return AxialAnalysis(test, seed).run(threads);
}

}  // namespace rigfit::apps
