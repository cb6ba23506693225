#include "apps/report/parts/axial_part.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "apps/cli/axial_result.h"
#include "apps/report/figures/decay_plots.h"
#include "apps/report/html_text.h"
#include "apps/report/parts/recording_blocks.h"
#include "ident/statistics/uncertainty.h"

namespace rigfit::apps {
namespace {

class AxialAnalysis {
 public:
  AxialAnalysis(const CampaignTest& test, std::uint64_t seed) : test_(test) {
    part().id = test.name;
    part().title = test.title;
    part().json_key = "axial";
    part().json["test"] = test.name;
    inputs_.options.seed = seed;
  }

  AxialPart run(int threads) {
    auto loaded = load_recordings(test_.recordings);
    for (const auto& entry : loaded) {
      part().inputs.insert(part().inputs.end(), entry.inputs.begin(), entry.inputs.end());
    }
    part().blocks.push_back(Paragraph{fmt::format(
        "A mass of {:g} kg hangs from a length of cable and is struck; the tension swings up and "
        "down. How fast gives the axial stiffness EA, how soon it dies away gives the damping.",
        test_.axial.mass_kg.value)});
    add_recordings(part(), test_, loaded);
    inputs_.setup = test_.axial;
    inputs_.threads = threads;
    if (!test_.channels.empty()) inputs_.channel = test_.channels.front();
    if (test_.band_hz) {
      inputs_.band_low_hz = test_.band_hz->first, inputs_.band_high_hz = test_.band_hz->second;
    }
    for (auto& entry : loaded) {
      if (!entry.recording) continue;
      const auto& group = test_.recordings[entry.group];
      inputs_.recordings.push_back({entry.file, std::move(*entry.recording), *group.length_m});
      origins_.push_back(group.origin());
    }
    result_ = ident::axial_campaign(inputs_);
    for (const auto& f : result_.findings) {
      const std::string where = f.where.empty() ? test_.name : f.where;
      if (f.refused) {
        refuse(part(), f.code, f.message, where);
      } else {
        part().warnings.push_back({f.code, f.message, where, false});
      }
    }
    part().json.update(axial_json(inputs_, result_));
    if (result_.test) {
      part().json["catalogue"] = part().json["plausibility"];
      part().json["plausibility"] = result_.test->plausibility;
    }
    if (result_.test) show(*result_.test);
    return std::move(part_);
  }

 private:
  ReportPart& part() { return part_.part; }

  void show(const ident::AxialTestResult& r) {
    for (const auto& d : result_.decays) {
      if (!d.mode) continue;
      origin_ = origins_[d.recording];
      break;
    }
    part_.known = ident::knowledge_of(r);
    part().blocks.push_back(length_plot(r));
    part().blocks.push_back(length_table(r));
    if (r.alternatives.size() > 1) part().blocks.push_back(alternatives_table(r));
    part().blocks.push_back(budget_table(r));
    if (r.draws > 0) {
      part().blocks.push_back(Paragraph{
          fmt::format("Checked by a Monte Carlo of {} draws on closed forms: {} N, 95 % between {} "
                      "and {} N.",
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
    for (const auto& d : result_.decays) {
      const auto& recording = inputs_.recordings[d.recording];
      if (!d.mode || recording.length_m == last) continue;  // the first of each length
      last = recording.length_m;
      decays.push_back({recording.name, d.channel, d.unit, origins_[d.recording], d.rate_hz,
                        d.samples_start_s, d.samples, d.result});
      group.tabs.push_back(
          {fmt::format("{:g} m", last),
           {decay_plot(fmt::format("{}-decay-{:g}m", test_.name, last), decays.back())}});
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
        "EA at each length as if the cable alone gave way. EA does not depend on the length of "
        "cable that was tested; a trend is a compliance in series (frame, adapter), which the "
        "result leaves out. The band is the result with its 95 % interval.";
    plot.x_label = "length, m";
    plot.y_label = "EA, kN";
    PlotSeries all, each, records;
    double low = r.lengths.front().length_m, high = low;
    const double k95 = ident::coverage_factor(0.95, 0);
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
      each.low.push_back(1e-3 * (length.EA_N.value - k95 * length.EA_N.std));
      each.high.push_back(1e-3 * (length.EA_N.value + k95 * length.EA_N.std));
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
      reference.origin = test_.reference_name == "published" ? Origin::published : origin_;
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

  ReportTable alternatives_table(const ident::AxialTestResult& r) const {
    ReportTable table;
    table.id = test_.name + "-alternatives";
    table.caption =
        "What may explain the lengths, weighed by likelihood; the result is the weighted average.";
    table.columns = {{"what gives way", {}, false},
                     {"weight", {}, true},
                     {"EA, N", origin_},
                     {"compliance in series, µm/N", {}, true}};
    for (const auto& a : r.alternatives) {
      const auto& s = a.series_compliance_m_N;
      Cell weight(fmt::format("{:.2g}", a.weight));
      weight.shade = a.weight;
      table.rows.push_back(
          {a.name, weight, Cell(shown_estimate(a.EA_N.value, a.EA_N.std), origin_),
           s.std > 0 ? shown_estimate(1e6 * s.value, 1e6 * s.std) : std::string("–")});
    }
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
    for (const auto& note : r.notes) {
      for (const char* code :
           {"one_length", "lengths_too_close", "lengths_disagree", "series_compliance"}) {
        if (note.code != code) continue;
        part().summary.push_back(
            {SummaryItem::Kind::distrust, "EA by length", note.message, origin_, part().id});
      }
    }
    if (r.catalogue_EA_N > 0 && (r.share_of_catalogue < 0.5 || r.share_of_catalogue > 1.5)) {
      part().summary.push_back(
          {SummaryItem::Kind::distrust, "Size of EA", r.plausibility, origin_, part().id});
    }
  }

  const CampaignTest& test_;
  ident::AxialInputs inputs_;
  std::vector<Origin> origins_;  // of the recordings
  ident::AxialCampaignResult result_;
  AxialPart part_;
  Origin origin_ = Origin::measured;
};

}  // namespace

AxialPart axial_part(const CampaignTest& test, std::uint64_t seed, int threads) {
  return AxialAnalysis(test, seed).run(threads);
}

}  // namespace rigfit::apps
