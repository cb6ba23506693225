#include "apps/campaign_file/bending_files.h"
#include "apps/report/parts/parts.h"
#include "signal/recording/recording.h"

namespace rigfit::apps {
namespace {

class BendingPart : public TestPart {
 public:
  explicit BendingPart(const CampaignTest& test)
      : TestPart(test, "bending"), kind_(test.as<BendingTest>()) {
    part_.json["span_m"] = kind_.test.span_m.value;
  }

  std::vector<ReportPart> show(ident::TestInputs& given, ident::TestResult& found) override {
    const auto& inputs = std::get<ident::BendingCampaign>(given);
    const auto& result = std::get<ident::BendingCampaignResult>(found);
    const auto& laws = result.curve.laws();
    part_.json.update(describe::json_of(result));
    part_.json["laws_decided"] = !kind_.beam() && laws.decided;
    tell(result.findings);
    for (std::size_t i = 0; i < result.points.size(); ++i) {
      part_.json["tests"][i]["origin"] = word_of(result.points[i].origin);
    }
    const std::string& name = test_.name;
    add(part_.blocks, bending_blocks(name, inputs, result));
    if (!kind_.beam() && !laws.laws.empty() && !laws.decided) {
      part_.warnings.push_back({"law_not_decided", result.curve.sentence(), name});
    }
    add_answers(inputs, result);
    part_.brief = {kind_.beam() ? name + "-load-deflection" : name + "-EI", name + "-results"};
    return {std::move(part_)};
  }

 private:
  void take(LoadedRecording entry, const RecordingGroup& group) override {
    const BendingColumns columns{kind_.channels, kind_.beam(),
                                 "name it in the campaign, channels = {{ {} = \"...\" }}"};
    try {
      auto source = bending_source(*entry.recording, columns, part_.warnings);
      source.origin = group.origin();
      std::get<ident::BendingCampaign>(inputs_).sources.push_back(std::move(source));
    } catch (const signal::RecordingError& error) {
      refuse(part_, "channel", error.what(), entry.file);
    }
  }

  /// EI of every point on the first page; of specimens the first one.
  void add_answers(const ident::BendingCampaign& inputs,
                   const ident::BendingCampaignResult& result) {
    int found = 0;
    for (const auto& one : result.points) {
      if (!one.usable()) continue;
      const auto& point = one.point;
      const std::string file = short_name(one.file);
      Answer EI = answer(fmt::format("EI/{}", ++found),
                         kind_.beam() ? fmt::format("Beam bending stiffness EI ({})", file)
                                      : fmt::format("Cable bending stiffness EI at {} N",
                                                    shown(point.tension_N, 3)),
                         kind_.published() ? "published"
                         : kind_.beam()    ? "bending test without tension"
                                           : "bending test",
                         "N m²", {point.EI_Nm2, point.std}, one.origin);
      EI.low = point.low;
      EI.high = point.high;
      EI.rank = kind_.beam() && found > 1 ? 1 : 0;
      const auto& modulus = one.modulus_Pa;
      if (kind_.beam() && std::isfinite(modulus.value)) {
        Answer E = EI;
        E.key = fmt::format("{}/modulus/{}", test_.name, found);
        E.quantity = fmt::format("Beam bending modulus ({})", file);
        E.unit = "Pa";
        E.value = modulus.value;
        E.std = modulus.std;
        // The section's uncertainty widens the interval of EI.
        const auto I = inputs.section.second_moment();
        const double width = ident::coverage_factor(0.95, 0) * I.std / I.value;
        E.low = modulus.value * (1 - std::hypot(1 - EI.low / EI.value, width));
        E.high = modulus.value * (1 + std::hypot(EI.high / EI.value - 1, width));
        add_answer(part_, std::move(E), false);
      }
      add_answer(part_, std::move(EI));
    }
  }

  const BendingTest& kind_;
};

}  // namespace

TestPartPtr bending_part(const CampaignTest& test) { return std::make_unique<BendingPart>(test); }

}  // namespace rigfit::apps
