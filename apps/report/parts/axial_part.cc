#include "apps/report/parts/parts.h"

namespace rigfit::apps {
namespace {

class AxialPart : public TestPart {
 public:
  AxialPart(const CampaignTest& test, int threads) : TestPart(test, "axial") {
    std::get<ident::AxialInputs>(inputs_).threads = threads;
  }

  std::vector<ReportPart> show(ident::TestInputs&, ident::TestResult& found) override {
    const auto& result = std::get<ident::AxialCampaignResult>(found);
    tell(result.findings);
    part_.json.update(axial_json(result));
    add(part_.blocks, axial_blocks(test_.name, result, &test_));
    part_.brief = {test_.name + "-EA", test_.name + "-lengths"};
    if (result.test) add_answers(*result.test, result.decays.front().origin);
    return {std::move(part_)};
  }

 private:
  void add_answers(const ident::AxialTestResult& r, Origin origin) {
    const std::string how = fmt::format("axial test, {} at {}", counted(r.samples.size(), "record"),
                                        counted(r.lengths.size(), "length"));
    Answer EA = answer("EA", "Cable axial stiffness EA", how, "N", r.EA_N, origin, test_.EA_N);
    EA.low = r.EA_N.low, EA.high = r.EA_N.high;
    if (r.conditional) {
      EA.how += ": a lower bound, as one length cannot separate other compliance";
      if (!std::isfinite(EA.high)) EA.high = EA.std = Answer::kNone;
    }
    Answer damping = answer("damping_ratio", "Axial damping ratio ζ", how, "", r.damping_ratio,
                            origin, test_.damping_ratio);
    damping.low = r.damping_ratio.low, damping.high = r.damping_ratio.high;
    add_answer(part_, std::move(EA));
    add_answer(part_, std::move(damping));
  }
};

}  // namespace

TestPartPtr axial_part(const CampaignTest& test, int threads) {
  return std::make_unique<AxialPart>(test, threads);
}

}  // namespace rigfit::apps
