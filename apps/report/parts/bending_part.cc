#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "apps/campaign_file/bending_files.h"
#include "apps/report/drawing/html_text.h"
#include "apps/report/figures/figures.h"
#include "apps/report/parts/parts.h"
#include "apps/results/bending_json.h"
#include "signal/numerics/numbers.h"
#include "signal/recording/recording_error.h"

namespace rigfit::apps {
namespace {

std::string setup_words(const BendingTest& test) {
  const auto& options = test.campaign.test;
  if (!test.beam()) {
    return std::string(
               "A length of cable is clamped at both ends, pulled to a tension and pressed "
               "sideways at mid-span. From the slope of deflection over load follows its bending "
               "stiffness EI.") +
           (test.published() ? " Here the EI values themselves are published." : "");
  }
  const char* held =
      options.ends == ident::BeamEnds::cantilever ? "clamped at one end and loaded at the other"
      : options.ends == ident::BeamEnds::pinned   ? "laid on two supports and loaded between"
                                                  : "clamped at both ends and loaded between them";
  return fmt::format(
      "A beam is {}, {:g} m, without tension. From the slope of load over deflection in its "
      "elastic part follows EI = slope span³ / {:g}; shear is left out.",
      held, options.span_m.value, ident::beam_stiffness_factor(options.ends));
}

ReportTable law_table(const CampaignTest& test, const ident::StiffnessLaws& laws) {
  ReportTable table{test.name + "-laws",
                    "Laws for EI(T), the closest first.",
                    {{"law", {}, false},
                     {"formula (EI in N m², T in N)", {}, false},
                     {"rms deviation", Origin::modelled},
                     {"weight", Origin::modelled},
                     {"remark", {}, false}},
                    {},
                    {}};
  for (const auto& law : laws.laws) {
    table.rows.push_back(
        {name_of(law.kind), law.formula, shown(100 * law.rms_relative_error, 2) + " %",
         std::isfinite(law.akaike_weight) ? shown(law.akaike_weight, 2) : "", law.message});
  }
  return table;
}

class BendingPart : public TestPart {
 public:
  explicit BendingPart(const CampaignTest& test)
      : test_(test), kind_(test.as<BendingTest>()), bending_(kind_.campaign) {
    part_.id = test.name;
    part_.title = test.title;
    part_.json_key = "bending";
    part_.json["test"] = test.name;
    part_.json["span_m"] = bending_.test.span_m.value;
  }

  void read(const FileRead& file_read) override {
    part_.blocks.push_back(Paragraph{setup_words(kind_)});
    if (kind_.published()) {
      origins_.push_back(Origin::published);
    } else {
      read_recordings(file_read);
    }
  }

  void add_to(ident::CampaignInputs& inputs) override {
    index_ = inputs.bending.size();
    inputs.bending.push_back(std::move(bending_));
  }

  std::vector<ReportPart> show(ident::CampaignResult& campaign) override {
    const auto& result = campaign.bending[index_];
    bending_ = std::move(campaign.inputs.bending[index_]);
    part_.json.update(bending_json(bending_, result));
    part_.json["laws_decided"] = !kind_.beam() && result.curve.laws().decided;
    for (std::size_t i = 0; i < result.points.size(); ++i) {
      part_.json["tests"][i]["origin"] = word_of(origins_[result.points[i].source]);
    }
    tell_findings(result);
    if (!result.points.empty()) {
      if (!kind_.published()) {
        part_.blocks.push_back(
            load_deflection_plot(test_.name + "-load-deflection", bending_, origins_, result));
      }
      part_.blocks.push_back(points_table(result));
    }
    if (!kind_.beam()) show_laws(result);
    add_answers(result);
    part_.brief = {kind_.beam() ? test_.name + "-load-deflection" : test_.name + "-EI",
                   test_.name + "-results"};
    return {std::move(part_)};
  }

 private:
  void read_recordings(const FileRead& file_read) {
    auto loaded = load_recordings(test_.recordings, file_read);
    for (auto& entry : loaded) {
      part_.inputs.insert(part_.inputs.end(), entry.inputs.begin(), entry.inputs.end());
      if (entry.recording) drop_time_notes(*entry.recording);
    }
    add_recordings(part_, test_, loaded);
    const BendingColumns columns{
        kind_.tension_channel, kind_.load_channel, kind_.deflection_channel,
        "name it in the campaign, channels = {{ {} = \"...\" }}", kind_.beam()};
    for (const auto& entry : loaded) {
      if (!entry.recording) continue;
      std::vector<Warning> warnings;
      try {
        bending_.sources.push_back(bending_source(*entry.recording, columns, warnings));
      } catch (const signal::RecordingError& error) {
        refuse(part_, "channel", error.what(), entry.file);
        continue;
      }
      origins_.push_back(test_.recordings[entry.group].origin());
      for (auto& one : warnings) {
        part_.warnings.push_back(
            {std::move(one.code), std::move(one.message), std::move(one.where), false});
      }
    }
  }

  void tell_findings(const ident::BendingCampaignResult& result) {
    for (const auto& finding : result.findings) {
      part_.warnings.push_back({finding.code, finding.message, test_.name, false});
    }
    for (const auto& one : result.points) {
      if (!one.analysis) continue;
      const auto& file = bending_.sources[one.source].name;
      const std::string where =
          one.point.tension_N > 0 ? fmt::format("{} at {:.4g} N", file, one.point.tension_N) : file;
      for (const auto& finding : one.analysis->findings) {
        part_.warnings.push_back({finding.code, finding.message, where, finding.refuses});
      }
    }
  }

  [[nodiscard]] ReportTable points_table(const ident::BendingCampaignResult& result) const {
    const bool section = bending_.second_moment_m4.value > 0;
    ReportTable table;
    table.id = test_.name + "-results";
    table.caption = "EI with its standard uncertainty and 95 % interval.";
    table.columns = {{"recording", {}, false}, {"origin", {}, false}, {"tension, N", {}, true},
                     {"slope d/Q, µm/N"},      {"EI, N m²"},          {"95 % interval"},
                     {"hysteresis, N"},        {"modulus, GPa"},      {"remarks", {}, false}};
    for (const auto& one : result.points) {
      const Origin from = origins_[one.source];
      const auto* r = one.analysis ? &*one.analysis : nullptr;
      const auto& point = one.point;
      std::string said, modulus;
      for (const auto& finding : r ? r->findings : std::vector<ident::BendingFinding>()) {
        said += (said.empty() ? "" : "; ") + finding.message;
      }
      if (r && said.empty()) said = r->stiffness.reason;
      if (section && one.usable()) {
        const auto E = ident::bending_modulus(bending_, one);
        modulus = shown_estimate(1e-9 * E.value, 1e-9 * E.std);
      }
      Cell remarks(said);
      remarks.doubtful = !said.empty();
      table.rows.push_back(
          {short_name(bending_.sources[one.source].name), Cell(name_of(from), from),
           kind_.beam() ? ""
           : r          ? shown_estimate(r->tension_N.value, r->tension_N.std)
                        : shown(point.tension_N, 3),
           r ? shown_estimate(1e6 * r->compliance_m_N.value, 1e6 * r->compliance_m_N.std) : "",
           Cell(one.usable() ? shown_estimate(point.EI_Nm2, point.std) : "none", from),
           one.usable() && std::isfinite(point.low)
               ? shown_bound(point.low, point.std) + " to " + shown_bound(point.high, point.std)
               : std::string(),
           r && !kind_.beam() ? shown(r->hysteresis_N, 2) : "", modulus, std::move(remarks)});
    }
    return table;
  }

  void show_laws(const ident::BendingCampaignResult& result) {
    const auto& laws = result.curve.laws();
    if (!laws.laws.empty()) {
      part_.blocks.push_back(
          stiffness_plot(test_.name + "-EI", stiffness_series(result, origins_), result));
      part_.blocks.push_back(
          Paragraph{"For the model: " + result.curve.sentence(), Paragraph::Kind::note});
      part_.blocks.push_back(law_table(test_, laws));
      if (!laws.decided) {
        part_.warnings.push_back({"law_not_decided", result.curve.sentence(), test_.name, false});
      }
    }
    if (const auto& bounds = result.bounds) {
      part_.blocks.push_back(
          Paragraph{fmt::format("Bounds from the strand's geometry: EImin = {} N m² (all wires "
                                "slip), EImax = {} N m² (none does).",
                                shown(bounds->EI_min_Nm2, 4), shown(bounds->EI_max_Nm2, 6))});
    }
  }

  /// EI of every point on the first page; of specimens the first one.
  void add_answers(const ident::BendingCampaignResult& result) {
    int found = 0;
    for (const auto& one : result.points) {
      if (!one.usable()) continue;
      const auto& point = one.point;
      const std::string file = short_name(bending_.sources[one.source].name);
      Answer EI;
      EI.key = fmt::format("{}/EI/{}", test_.name, ++found);
      EI.quantity = kind_.beam() ? fmt::format("Beam bending stiffness EI ({})", file)
                                 : fmt::format("Cable bending stiffness EI at {} N",
                                               shown(point.tension_N, 3));
      EI.how = kind_.published() ? "published"
               : kind_.beam()    ? "bending test without tension"
                                 : "bending test";
      EI.unit = "N m²";
      EI.value = point.EI_Nm2;
      EI.std = point.std;
      EI.low = point.low;
      EI.high = point.high;
      if (!kind_.beam() && one.analysis) {  // with what the tests share
        EI.std = one.analysis->stiffness.EI_Nm2.std;
        EI.low = one.analysis->stiffness.low;
        EI.high = one.analysis->stiffness.high;
      }
      EI.origin = origins_[one.source];
      EI.anchor = part_.id;
      EI.rank = kind_.beam() && found > 1 ? 1 : 0;
      const auto modulus = ident::bending_modulus(bending_, one);
      if (kind_.beam() && std::isfinite(modulus.value)) {
        Answer E = EI;
        E.key = fmt::format("{}/modulus/{}", test_.name, found);
        E.quantity = fmt::format("Beam bending modulus ({})", file);
        E.unit = "Pa";
        E.value = modulus.value;
        E.std = modulus.std;
        // The section's uncertainty widens the interval of EI.
        const auto& I = bending_.second_moment_m4;
        const double width = 1.959964 * I.std / I.value;
        E.low = modulus.value * (1 - std::hypot(1 - EI.low / EI.value, width));
        E.high = modulus.value * (1 + std::hypot(EI.high / EI.value - 1, width));
        part_.answers.push_back(std::move(E));
      }
      part_.summary.push_back(
          {SummaryItem::Kind::result,
           kind_.beam() ? "EI of the beam, " + file
                        : fmt::format("EI of the cable at {} N", shown(point.tension_N, 3)),
           value_words(EI) + " N m²", EI.origin, part_.id});
      part_.answers.push_back(std::move(EI));
    }
    const bool said = std::any_of(result.points.begin(), result.points.end(),
                                  [](const auto& one) { return one.refused(); });
    if (kind_.beam() && found == 0 && !said) {
      refuse(part_, "no_EI", "no test gives an EI", test_.name);
    }
    if (!result.specimens) return;
    const auto& all = *result.specimens;
    part_.blocks.push_back(Paragraph{
        fmt::format("{} specimens: EI {} N m² on average; standard deviation between them {} %.",
                    all.count, shown(all.EI_Nm2, 3), shown(100 * all.relative_scatter, 2)),
        Paragraph::Kind::note});
  }

  const CampaignTest& test_;
  const BendingTest& kind_;
  ident::BendingCampaign bending_;
  std::vector<Origin> origins_;  ///< origins of the sources
  std::size_t index_ = 0;
  ReportPart part_;
};

}  // namespace

std::unique_ptr<TestPart> bending_part(const CampaignTest& test) {
  return std::make_unique<BendingPart>(test);
}

}  // namespace rigfit::apps
