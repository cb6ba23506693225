#include <fmt/format.h>

#include <cmath>

#include "apps/report/drawing/html_text.h"
#include "apps/report/figures/figures.h"
#include "apps/report/parts/parts.h"
#include "apps/results/results_json.h"

namespace rigfit::apps {
namespace {

class AxialPart : public TestPartOf<ident::AxialInputs> {
 public:
  AxialPart(const CampaignTest& test, int threads)
      : TestPartOf(test, "axial", test.as<AxialTest>().inputs, &ident::CampaignInputs::axial) {
    inputs_.threads = threads;
  }

  std::vector<ReportPart> show(ident::CampaignResult& campaign) override {
    const auto& inputs = campaign.inputs.axial[index_];
    const auto& result = campaign.axial[index_];
    tell(result.findings);
    part_.json.update(axial_json(inputs, result));
    if (result.test) show_test(inputs, result);
    return {std::move(part_)};
  }

 private:
  void take(LoadedRecording entry, const RecordingGroup& group) override {
    inputs_.recordings.push_back({entry.file, std::move(*entry.recording), *group.length_m});
  }

  void show_test(const ident::AxialInputs& inputs, const ident::AxialCampaignResult& result) {
    const auto& r = *result.test;
    Origin origin = Origin::measured;
    for (const auto& d : result.decays) {
      if (!d.mode) continue;
      origin = origins_[d.recording];
      break;
    }
    std::optional<ReferenceValue> reference;
    if (test_.EA_N) {
      reference = {test_.reference_name,
                   test_.reference_name == "published" ? Origin::published : origin, *test_.EA_N};
    }
    const auto sheet = describe::sheet_of(r);
    auto& blocks = part_.blocks;
    blocks.push_back(axial_length_plot(test_.name + "-EA", r, origin, reference));
    blocks.push_back(described_table(test_.name + "-lengths",
                                     "EA, damping ratio and equivalent damper by length, with "
                                     "standard uncertainties.",
                                     describe::table_of(r.lengths), origin));
    blocks.push_back(described_table(test_.name + "-values",
                                     "Result of all lengths, with 95 % "
                                     "intervals.",
                                     sheet.lines, origin));
    blocks.push_back(described_table(test_.name + "-budget",
                                     "Where the uncertainty of EA comes from.",
                                     describe::table_of(r.budget)));
    for (auto& block : axial_decay_blocks(test_.name, inputs, result, origins_)) {
      blocks.push_back(std::move(block));
    }
    part_.brief = {test_.name + "-EA", test_.name + "-lengths"};

    const std::string how = fmt::format("axial test, {} at {}", counted(r.samples.size(), "record"),
                                        counted(r.lengths.size(), "length"));
    Answer EA = answer("EA", "Cable axial stiffness EA", how, "N", r.EA_N, origin, test_.EA_N);
    EA.low = r.EA_low_N, EA.high = r.EA_high_N;
    if (r.conditional) {
      EA.how += ": a lower bound, as one length cannot separate other compliance";
      if (!std::isfinite(EA.high)) EA.high = EA.std = Answer::kNone;
    }
    Answer damping = answer("damping_ratio", "Axial damping ratio ζ", how, "", r.damping_ratio,
                            origin, test_.damping_ratio);
    damping.low = r.damping_low, damping.high = r.damping_high;
    add_answer(part_, std::move(EA));
    add_answer(part_, std::move(damping));
  }
};

}  // namespace

TestPartPtr axial_part(const CampaignTest& test, int threads) {
  return std::make_unique<AxialPart>(test, threads);
}

}  // namespace rigfit::apps
