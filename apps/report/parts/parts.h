// The parts of a report. A test of a campaign on its way to the page: its recordings are read, the
// campaign is worked out (ident/campaign/campaign.h), and what came of the test is shown.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "apps/campaign_file/campaign.h"
#include "apps/campaign_file/recording_group.h"
#include "apps/report/page/report_part.h"
#include "ident/campaign/campaign.h"

namespace rigfit::apps {

class TestPart {
 public:
  TestPart() = default;
  TestPart(const TestPart&) = delete;
  TestPart& operator=(const TestPart&) = delete;
  virtual ~TestPart() = default;

  /// Called after each recording that was read.
  using FileRead = std::function<void()>;
  /// Reads files; may run beside that of other tests.
  virtual void read(const FileRead& /*file_read*/) {}
  /// Hands over what was read; tests are added in the order of the campaign.
  virtual void add_to(ident::CampaignInputs& inputs) = 0;
  /// What is on the page; may run beside that of other tests. Called once, last.
  virtual std::vector<ReportPart> show(ident::CampaignResult& result) = 0;
};
using TestPartPtr = std::unique_ptr<TestPart>;

[[nodiscard]] TestPartPtr axial_part(const CampaignTest& test, int threads);
/// EI of a strand against its tension, or of a beam without tension.
[[nodiscard]] TestPartPtr bending_part(const CampaignTest& test);
/// Free decays; where a scene stands for the test, its answer by the same estimator.
[[nodiscard]] TestPartPtr decay_part(const Campaign& campaign, const CampaignTest& test);
/// Recordings of hits, FRFs and modes state by state; then the model's modes against them.
[[nodiscard]] TestPartPtr modal_test_part(const Campaign& campaign, const CampaignTest& test);
/// The tension of a cable from its frequencies.
[[nodiscard]] TestPartPtr tension_part(const CampaignTest& test);

/// What the first page shows besides the answers: the largest scene that a test names, to scale,
/// and all modes of the other parts against the model.
[[nodiscard]] ReportPart overview_part(const Campaign& campaign,
                                       const std::vector<ReportPart>& parts);
/// What the models were given: each value of each scene with how it is known.
[[nodiscard]] ReportPart scenes_part(const Campaign& campaign);
/// Costs of all parts. Times are of this machine and differ from run to run: they are on the page,
/// not in the document.
[[nodiscard]] ReportPart cost_part(const std::vector<ReportPart>& parts);

/// The unit of a scene's parameter as people write it, "N m²"; empty for a ratio.
[[nodiscard]] std::string parameter_unit(const model::Scene& scene, const std::string& name);

}  // namespace rigfit::apps
