// The options of a hammer test on the command line, shared by the verbs that begin with one, and
// its analysis (ident/campaign/modal/hammer_campaign.h).
#pragma once

#include <string>
#include <vector>

#include "apps/cli/verb.h"
#include "ident/campaign/modal/hammer_campaign.h"

namespace rigfit::apps {

struct ImpactCommand {
  std::vector<std::string> files;
  std::string force;
  std::vector<std::string> responses;  ///< empty: every other channel
  std::string driving_point;
  std::vector<std::string> struck;  ///< point struck in each file; empty: one point in all
  std::string estimator = "h1";
  std::string force_window = "by-noise";  ///< that, "off", "auto" or seconds
  double exponential_window = 0;          ///< 1/s
  double exponential_end_level = 0;       ///< 0..1; 0: not used
  std::vector<double> band;               ///< Hz, two or none
  double sample_rate_hz = 0;
  std::string sign = "auto";
  double trigger = 0, double_hit = 0, max_spectrum_drop_db = 0, ring_down_level = 0;
  double block_s = 0, pre_trigger_s = -1;
  int min_pulse_samples = 0;
  bool keep_outliers = false;
  bool frequencies_only = false;
  long error_smoothing_lines = 10;
  ImpactCommand();
};

/// Those of the test, without the files.
[[nodiscard]] describe::Options options_of(ImpactCommand& command);

struct ImpactRun {
  /// The points struck and the recordings of each; one without a name unless the hammer roves.
  std::vector<ident::StruckPlace> places;
  ident::HammerTest test;
};

/// Reads the files and analyses the test. Every finding becomes a warning. Throws UsageError for
/// options that make no sense, Refused when there is no hit at all; when all hits were rejected the
/// FRFs are empty and `context.refuse` has said why and what can be had.
[[nodiscard]] ImpactRun run_impact_test(VerbContext& context, const ImpactCommand& command);
/// The same of recordings at hand, `run.places`: fills `run.test`.
void run_impact_test(VerbContext& context, const ImpactCommand& command, ImpactRun& run);

/// `hits[]`, as `frf` gives them; each with the point `struck` when the hammer roves.
[[nodiscard]] Json hits_json(const ImpactRun& run);

}  // namespace rigfit::apps
