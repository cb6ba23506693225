#include "apps/report/parts/parts.h"

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
    add(part_.blocks, axial_blocks(test_.name, inputs, result, origins_, &test_));
    part_.brief = {test_.name + "-EA", test_.name + "-lengths"};
    if (result.test) add_answers(*result.test, origins_[result.decays.front().recording]);
    return {std::move(part_)};
  }

 private:
  void take(LoadedRecording entry, const RecordingGroup& group) override {
    inputs_.recordings.push_back({entry.file, std::move(*entry.recording), *group.length_m});
  }

  void add_answers(const ident::AxialTestResult& r, Origin origin) {
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
