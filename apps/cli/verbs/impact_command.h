// The options of a hammer test on the command line, shared by the verbs that begin with one, and
// its analysis (ident/campaign/modal/hammer_campaign.h).
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "apps/cli/at_hand.h"
#include "apps/cli/plots/plot_option.h"
#include "apps/cli/verb.h"
#include "apps/report/figures/figures.h"
#include "ident/campaign/modal/hammer_campaign.h"
#include "signal/modal/modal_identification.h"

namespace rigfit::apps {

struct ImpactCommand {
  std::vector<std::string> files;
  ident::HammerTestOptions hammer;
  std::vector<std::string> struck;  ///< point struck in each file; empty: one point in all
  std::string estimator = "h1";
  std::string force_window = "by-noise";  ///< that, "off", "auto" or seconds
  std::vector<double> band;               ///< Hz, two or none
  double sample_rate_hz = 0;
  double trigger_percent = 100 * signal::HitOptions().trigger;
};

/// Those of the test, without the files.
[[nodiscard]] describe::Options options_of(ImpactCommand& command);

struct ImpactRun {
  /// The points struck and the recordings of each; one without a name unless the hammer roves.
  std::vector<ident::StruckPlace> places;
  ident::HammerTest test;

  ImpactRun() = default;
  ImpactRun(const ImpactRun&) = delete;
  ImpactRun& operator=(const ImpactRun&) = delete;
  ~ImpactRun();

  // Where samples are lent (apps/cli/at_hand.h): who owns them, and how they are given back.
  std::vector<std::shared_ptr<const signal::Recording>> lenders;
  void (*give_back)(signal::Recording&) = nullptr;
};

/// Reads the files and analyses the test. Every finding becomes a warning. Throws UsageError for
/// options that make no sense, Refused when there is no hit at all; when all hits were rejected the
/// FRFs are empty and `context.refuse` has said why and what can be had.
[[nodiscard]] std::shared_ptr<const ImpactRun> run_impact_test(VerbContext& context,
                                                               const ImpactCommand& command);

/// The options of `modal`, which begins with a hammer test where it is given recordings of hits.
struct ModalCommand {
  std::vector<std::string> files;
  ImpactCommand impact;
  int order = signal::LscfOptions().max_order;
  double max_damping = signal::LscfOptions().max_damping_ratio;
  int averages = 0;  ///< behind the coherence of FRFs from a file; 0: as the file says
  std::string out, synthesis;
  bool all = false;                     ///< print uncertain modes as well
  bool ambient = false;                 ///< motion under unknown forces: no FRFs, no hits
  std::vector<std::string> references;  ///< stay in place in all set-ups of ambient motion
  std::vector<std::string> of_hits;     ///< options given that mean nothing for FRFs from a file
};
[[nodiscard]] describe::Options options_of(ModalCommand& command);
/// `modal --ambient`: `command.files` are a set-up each, joined by references.
[[nodiscard]] Json ambient_result(const ModalCommand& command, VerbContext& context);

/// Hits, FRFs and, where there are any, modes with their MAC.
void draw_hammer_test(PlotSheet& sheet, const HammerFigures& figures);

/// `hits[]`, as `frf` gives them; each with the point `struck` when the hammer roves.
[[nodiscard]] Json hits_json(const ImpactRun& run);

}  // namespace rigfit::apps
