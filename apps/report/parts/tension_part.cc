#include "apps/report/parts/parts.h"

namespace rigfit::apps {
namespace {

class TensionPart : public TestPart {
 public:
  explicit TensionPart(const CampaignTest& test) : TestPart(test, "tension") {}

  std::vector<ReportPart> show(ident::TestInputs&, ident::TestResult& result) override {
    const auto& found = std::get<ident::TensionCampaignResult>(result);
    tell(found.findings);
    const auto& r = found.tension;
    if (!r.solved) return {std::move(part_)};
    part_.json.update(describe::json_of(found));
    const std::string ends = ident::name_of(r.candidates.front().ends);
    add(part_.blocks, tension_blocks(test_.name, r));
    part_.brief = {test_.name + "-frequencies", test_.name + "-ends"};
    Answer tension =
        answer("tension", "Cable tension at mid-span",
               fmt::format("from {} frequencies, {} ends", r.candidates.front().modes.size(), ends),
               "N", r.tension_N,
               test_.recordings.empty() ? Origin::measured : test_.recordings.front().origin(),
               test_.tension_N);
    tension.low = r.tension_N.low, tension.high = r.tension_N.high;
    tension.determined = r.decided;
    add_answer(part_, std::move(tension));
    return {std::move(part_)};
  }
};

}  // namespace

TestPartPtr tension_part(const CampaignTest& test) { return std::make_unique<TensionPart>(test); }

}  // namespace rigfit::apps
