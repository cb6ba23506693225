// A hammer test on the command line, shared by the verbs that begin with one: its options and its
// analysis (ident/campaign/modal/modal_campaign.h).

#include "apps/cli/verbs/all.h"

namespace rigfit::apps {
namespace {

/// The recordings by the place struck, in the order of the files.
std::vector<signal::StruckPoint> read_places(VerbContext& context, const ImpactCommand& command) {
  std::vector<signal::StruckPoint> places;
  for (std::size_t f = 0; f < command.files.size(); ++f) {
    const std::string name = command.struck.empty() ? "" : command.struck[f];
    auto place = std::ranges::find(places, name, &signal::StruckPoint::name);
    if (place == places.end()) place = places.insert(places.end(), {name, {}});
    place->recordings.push_back(load_recording(command.files[f], context));
  }
  return places;
}

}  // namespace

describe::Options options_of(ImpactCommand& c) {
  auto& impact = c.hammer.impact;
  auto& hits = impact.hits;
  auto window = option("--force-window", impact.force_window_s,
                       "Seconds of force kept from the pulse's start, auto (three pulse lengths; "
                       "default) or off")
                    .positive()
                    .one_of({"auto", "off"})
                    .type("S|auto|off");
  window.set = [&impact](const Json& given) {
    if (given == "auto") return impact.force_window_s.reset();
    impact.force_window_s = given == "off" ? 0 : given.get<double>();
  };
  return {
      option("--force", c.hammer.force, "Force channel: name or #k"),
      option("--response", c.hammer.responses, "Response channels [every other]"),
      option("--driving-point", c.hammer.driving_point, "The response at the point struck")
          .excludes("--struck"),
      option("--struck", c.struck,
             "Point struck in each file, one a file (roving hammer): a response's name where it "
             "was struck, else any name"),
      choice("--estimator", impact.estimator, {"h1", "h2", "hv"},
             "h1: noise on responses, h2: on force, hv: both"),
      std::move(window),
      option("--exponential-window", impact.exponential_decay_rate_1_s,
             "Decay rate of a window on force and responses, 1/s; its damping is carried along and "
             "taken off the poles again")
          .within(0.0, 1e6),
      option("--exponential-end-level", impact.exponential_end_level,
             "The same, given as its level at the end of the block")
          .within(1e-12, 1.0)
          .excludes("--exponential-window"),
      option("--band", hits.band_hz, "Band in which the force spectrum is asked for"),
      option("--block", hits.block_s, "Seconds analysed a hit [what uses most of the recordings]")
          .positive(),
      option("--frequencies-only", hits.accept_unresolved,
             "Keep hits whose pulse is not resolved; the FRFs then have no scale")};
}

ImpactRun run_impact_test(VerbContext& context, const ImpactCommand& command) {
  if (!command.struck.empty() && command.struck.size() != command.files.size()) {
    throw UsageError(fmt::format("--struck names {} points for {} files: one a file",
                                 command.struck.size(), command.files.size()));
  }
  ImpactRun run{read_places(context, command), {}};
  run.test = ident::analyse_hammer_test(run.places, command.hammer);
  for (auto& finding : run.test.findings) {
    if (finding.code == "no_hit" || finding.code == "no_response") {
      throw Refused(finding.where + ": " + finding.message, finding.code);
    }
    if (finding.code == "pulse_not_resolved") {
      finding.message += "; --frequencies-only keeps frequencies and damping without amplitudes";
    }
  }
  context.tell(run.test.findings);
  const std::size_t hits = run.test.hits(), accepted = run.test.accepted_hits();
  if (0 < accepted && accepted < hits) {
    context.warn("hits_rejected",
                 fmt::format("{} of {} hits rejected; see hits[].reason", hits - accepted, hits));
  }
  return run;
}

}  // namespace rigfit::apps
