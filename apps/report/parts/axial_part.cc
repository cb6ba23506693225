#include "apps/report/parts/parts.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "apps/describe/sheet.h"
#include "apps/report/drawing/html_text.h"
#include "apps/report/figures/figures.h"
#include "apps/results/axial_result.h"
#include "ident/statistics/uncertainty.h"

namespace rigfit::apps {
namespace {

class AxialPart : public TestPart {
 public:
  AxialPart(const CampaignTest& test, int threads)
      : test_(test), inputs_(test.as<AxialTest>().inputs) {
    part_.id = test.name;
    part_.title = test.title;
    part_.json_key = "axial";
    part_.json["test"] = test.name;
    inputs_.threads = threads;
  }

  void read(const FileRead& file_read) override {
    auto loaded = load_recordings(test_.recordings, file_read);
    for (const auto& entry : loaded) {
      part_.inputs.insert(part_.inputs.end(), entry.inputs.begin(), entry.inputs.end());
    }
    part_.blocks.push_back(Paragraph{fmt::format(
        "A mass of {:g} kg hangs from a length of cable and is struck; the tension swings up and "
        "down. How fast gives the axial stiffness EA, how soon it dies away gives the damping.",
        inputs_.setup.mass_kg.value)});
    add_recordings(part_, test_, loaded);
    for (auto& entry : loaded) {
      if (!entry.recording) continue;
      const auto& group = test_.recordings[entry.group];
      inputs_.recordings.push_back({entry.file, std::move(*entry.recording), *group.length_m});
      origins_.push_back(group.origin());
    }
  }

  void add_to(ident::CampaignInputs& inputs) override {
    index_ = inputs.axial.size();
    inputs.axial.push_back(std::move(inputs_));
  }

  std::vector<ReportPart> show(ident::CampaignResult& campaign) override {
    const auto& inputs = campaign.inputs.axial[index_];
    const auto& result = campaign.axial[index_];
    for (const auto& f : result.findings) {
      const std::string where = f.where.empty() ? test_.name : f.where;
      if (f.refused) {
        refuse(part_, f.code, f.message, where);
      } else {
        part_.warnings.push_back({f.code, f.message, where, false});
      }
    }
    part_.json.update(axial_json(inputs, result));
    if (result.test) {
      show_test(inputs, result);
    }
    return {std::move(part_)};
  }

 private:
  void show_test(const ident::AxialInputs& inputs, const ident::AxialCampaignResult& result) {
    const auto& r = *result.test;
    for (const auto& d : result.decays) {
      if (!d.mode) continue;
      origin_ = origins_[d.recording];
      break;
    }
    part_.blocks.push_back(axial_length_plot(test_.name + "-EA", r, origin_, reference_EA()));
    part_.blocks.push_back(length_table(r));
    part_.blocks.push_back(budget_table(r));
    if (!r.plausibility.empty()) {
      part_.blocks.push_back(Paragraph{r.plausibility, Paragraph::Kind::note});
    }
    for (auto& block : axial_decay_blocks(test_.name, inputs, result, origins_)) {
      part_.blocks.push_back(std::move(block));
    }
    describe(r);
  }

  [[nodiscard]] std::optional<ReferenceValue> reference_EA() const {
    if (!test_.EA_N) return std::nullopt;
    return ReferenceValue{test_.reference_name,
                          test_.reference_name == "published" ? Origin::published : origin_,
                          *test_.EA_N};
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
         Cell(r.conditional ? "≥ " + shown_bound(r.EA_low_N, r.EA_if_rigid_N.std)
                            : shown_estimate(r.EA_N.value, r.EA_N.std),
              origin_),
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

  void add_answer(const ident::AxialTestResult& r, const std::string& key, const char* quantity,
                  const char* unit, const signal::Estimate& value, signal::Interval interval,
                  const std::optional<double>& reference) {
    Answer answer;
    answer.key = test_.name + "/" + key;
    answer.quantity = quantity;
    answer.how = fmt::format("axial test, {} at {}", counted(r.samples.size(), "record"),
                             counted(r.lengths.size(), "length"));
    answer.unit = unit;
    answer.value = value.value;
    answer.std = value.std;
    answer.low = interval.low;
    answer.high = interval.high;
    if (r.conditional && answer.key.ends_with("/EA")) {
      answer.how += ": a lower bound, as one length cannot tell what else gives way";
      const double none = std::numeric_limits<double>::quiet_NaN();
      if (!std::isfinite(answer.high)) answer.high = answer.std = none;
    }
    answer.percent = answer.unit.empty();
    if (reference) {
      answer.reference = *reference;
      answer.reference_name = test_.reference_name;
    }
    answer.origin = origin_;
    answer.anchor = part_.id;
    part_.answers.push_back(std::move(answer));
  }

  void describe(const ident::AxialTestResult& r) {
    add_answer(r, "EA", "Cable axial stiffness EA", "N", r.EA_N, {r.EA_low_N, r.EA_high_N},
               test_.EA_N);
    add_answer(r, "damping_ratio", "Axial damping ratio ζ", "", r.damping_ratio,
               {r.damping_low, r.damping_high}, test_.damping_ratio);
    part_.brief = {test_.name + "-EA", test_.name + "-lengths"};
    std::string text = describe::interval_text(
        {r.EA_N.value, r.EA_N.std, r.EA_low_N, r.EA_high_N, r.conditional}, "N");
    if (test_.EA_N) {
      text += fmt::format("; {} {} ({})", test_.reference_name, shown(*test_.EA_N, 5),
                          shown_percent(r.EA_N.value / *test_.EA_N - 1));
    }
    part_.summary.push_back(
        {SummaryItem::Kind::result, "EA of the cable", text, origin_, part_.id});
    text = shown_estimate(100 * r.damping_ratio.value, 100 * r.damping_ratio.std) + " %";
    if (test_.damping_ratio) {
      text += fmt::format("; {} {} %", test_.reference_name, shown(100 * *test_.damping_ratio, 3));
    }
    part_.summary.push_back(
        {SummaryItem::Kind::result, "Axial damping ratio", text, origin_, part_.id});
  }

  const CampaignTest& test_;
  ident::AxialInputs inputs_;
  std::size_t index_ = 0;
  std::vector<Origin> origins_;  // origins of the recordings
  ReportPart part_;
  Origin origin_ = Origin::measured;
};

}  // namespace

std::unique_ptr<TestPart> axial_part(const CampaignTest& test, int threads) {
  return std::make_unique<AxialPart>(test, threads);
}

}  // namespace rigfit::apps
