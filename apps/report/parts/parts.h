// The parts of a report. A test of a campaign on its way to the page: its recordings are read, the
// campaign is worked out (ident/campaign/campaign.h), and what came of the test is shown.
#pragma once

#include "apps/campaign/campaign.h"
#include "apps/campaign_file/recordings.h"
#include "apps/report/figures/figures.h"
#include "apps/results/results_json.h"
#include "ident/campaign/campaign.h"

namespace rigfit::apps {

class TestPart {
 public:
  /// `json_key`: the list of the document that gets the test's results.
  TestPart(const CampaignTest& test, const char* json_key);
  TestPart(const TestPart&) = delete;
  TestPart& operator=(const TestPart&) = delete;
  virtual ~TestPart() = default;

  /// Reads files, with a call of `file_read` after each; may run beside that of other tests. What
  /// cannot be used is refused in its place.
  void read(const std::function<void()>& file_read);
  /// Hands over what was read.
  ident::TestInputs inputs() { return std::move(inputs_); }
  /// What is on the page, of those inputs and their result; may run beside that of other tests.
  /// Called once, last.
  virtual std::vector<ReportPart> show(ident::TestInputs& inputs, ident::TestResult& result) = 0;

 protected:
  virtual void take(LoadedRecording entry, const RecordingGroup& group);
  void tell(std::vector<ident::Finding> findings);
  /// `name`: the key within the test; `unit`: empty for a ratio in percent; `reference`: as known
  /// otherwise.
  [[nodiscard]] Answer answer(const std::string& name, std::string quantity, std::string how,
                              std::string unit, const ident::BoundedEstimate& value, Origin origin,
                              std::optional<double> reference = std::nullopt) const;

  const CampaignTest& test_;
  ident::TestInputs inputs_;  ///< those of the campaign, then with the recordings
  std::size_t files_ = 0;     ///< recordings that the campaign names
  ReportPart part_;
};

/// The part of a test of any kind, worked out on `threads` threads.
[[nodiscard]] std::unique_ptr<TestPart> test_part(const Campaign& campaign,
                                                  const CampaignTest& test, int threads);
/// Modes of a scene against a test, tension by tension: natural modes, measured frequencies paired
/// with modelled ones, published models beside them. `states`: of the model, by rising tension.
[[nodiscard]] ReportPart model_part(const Campaign& campaign, const CampaignTest& test,
                                    const std::vector<ident::ModalState>& states);

/// A fit of the campaign: what was fitted to which tests, what came out with which uncertainty,
/// errors before, after and of states held out, FRFs laid over the test.
[[nodiscard]] ReportPart fit_part(const Campaign& campaign, const CampaignFit& fit,
                                  const ident::CampaignFitOutcome& answer);

/// What the first page shows besides the answers: the largest scene, to scale,
/// and all modes of the other parts against the model.
[[nodiscard]] ReportPart overview_part(const Campaign& campaign,
                                       const std::vector<ReportPart>& parts);
/// What the models were given: each value of each scene with how it is known.
[[nodiscard]] ReportPart scenes_part(const Campaign& campaign);

// What parts have in common

/// Puts a refusal on the part: it ends the run with exit code 4.
void refuse(ReportPart& part, const std::string& code, const std::string& message,
            const std::string& where);

/// With a line in the summary where `told`: value, interval and reference.
void add_answer(ReportPart& part, Answer answer, bool told = true);

/// "0.82 %"; a dash where there is none.
[[nodiscard]] std::string percent_words(double ratio);
/// A label as a part of a file's name: "200 N" -> "200N".
[[nodiscard]] std::string file_word(std::string label);
/// "200 N"; empty for the only state of a test.
[[nodiscard]] std::string label_of(std::optional<double> tension_N);

}  // namespace rigfit::apps
