// A test of a campaign on its way to the page: its recordings are read, the campaign is worked out
// (ident/campaign/campaign.h), and what came of the test is shown.
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "apps/campaign_file/campaign.h"
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

}  // namespace rigfit::apps
