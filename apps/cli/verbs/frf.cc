// rigfit frf: hammer hits to averaged FRFs with coherence and error bars; and a hammer test as
// other verbs begin with one (ident/campaign/modal/modal_campaign.h).

#include "apps/cli/verbs/all.h"
#include "signal/writers/writers.h"

namespace rigfit::apps {
namespace {
using Eigen::Index;

struct FrfCommand {
  ImpactCommand impact;
  std::string out, csv;
};

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

/// One line a frequency: then, per response and point struck, real, imaginary, std of each,
/// coherence.
std::string csv_of(const signal::FrfSet& frfs) {
  signal::Recording table;
  table.time_s = frfs.frequency_hz;
  for (std::size_t r = 0; r < frfs.responses.size(); ++r) {
    for (std::size_t i = 0; i < frfs.inputs.size(); ++i) {
      const Index c = frfs.column(static_cast<Index>(r), static_cast<Index>(i));
      std::string name = frfs.responses[r].name;
      if (frfs.inputs.size() > 1) name += " by " + frfs.inputs[i].name;
      const auto add = [&](const char* what, const std::string& unit, const auto& column) {
        add_column(table, name + what, unit, column);
      };
      add(" real", frfs.unit, frfs.H.col(c).real());
      add(" imag", frfs.unit, frfs.H.col(c).imag());
      if (frfs.H_std.size() > 0) add(" std", frfs.unit, frfs.H_std.col(c));
      if (frfs.coherence.size() > 0) add(" coherence", "", frfs.coherence.col(c));
    }
  }
  return signal::csv_text(table, {}, 9, "frequency (Hz)");
}

void print(std::ostream& out, const ImpactRun& run) {
  const ident::HammerTest& hammer = run.test;
  for (std::size_t p = 0; p < hammer.tests.size(); ++p) {
    const signal::ImpactTest& test = hammer.tests[p];
    const signal::HitSearch& search = test.search;
    if (!run.places[p].name.empty()) out << "struck at " << run.places[p].name << '\n';
    describe::print(out, describe::table_of(search.hits));
    if (test.frfs.averages == 0) continue;
    out << fmt::format(
        "{} of {} hits averaged, blocks of {} samples ({:.4g} Hz a line), force usable to {:.4g} "
        "Hz\n",
        test.frfs.averages, search.hits.size(), search.block_samples,
        search.sample_rate_hz / static_cast<double>(search.block_samples), test.usable_hz);
  }
  for (const signal::DrivingPoint& driving : hammer.driving_points) {
    out << fmt::format("driving point {}: {}\n",
                       hammer.frfs.responses[static_cast<std::size_t>(driving.response)].name,
                       name_of(driving.check.verdict));
  }
  for (const signal::ReciprocityCheck& pair : hammer.reciprocity) {
    out << fmt::format("{}: FRFs both ways differ by {:.2g} % (noise {:.2g} %)\n",
                       fmt::join(pair.points, " and "), 100 * pair.difference,
                       100 * pair.from_noise);
  }
}

Json run(FrfCommand& options, VerbContext& context) {
  const ImpactRun run = run_impact_test(context, options.impact);
  if (context.at_hand) {
    context.at_hand->frfs = std::make_shared<signal::FrfSet>(run.test.frfs);
  }
  const ident::HammerTest& hammer = run.test;
  const signal::FrfSet& frfs = hammer.frfs;
  const bool roving = !options.impact.struck.empty();
  print(context.out, run);
  if (context.plots) {
    const auto band =
        options.impact.hammer.impact.hits.band_hz.value_or(std::pair(0.0, hammer.usable_hz));
    context.plots->add(hammer_plots({run.places, hammer, band.first, band.second}));
  }

  // Blocks are as long for all points; a point without hits has none.
  const auto measured = std::ranges::find_if(
      hammer.tests, [](const auto& test) { return !test.search.hits.empty(); });
  const signal::HitSearch& search = measured->search;
  Json result{{"hits", hits_json(run.places, hammer)},
              {"averages", frfs.averages},
              {"frequency_resolution_hz",
               search.sample_rate_hz / static_cast<double>(search.block_samples)},
              {"sample_rate_hz", search.sample_rate_hz},
              {"block_samples", search.block_samples},
              {"exponential_decay_rate_1_s", frfs.exponential_decay_rate_1_s},
              {"frf_form", name_of(frfs.form)},
              {"units", frfs.unit},
              {"amplitudes", frfs.averages > 0 && hammer.amplitudes},
              {"estimator", name_of(options.impact.hammer.impact.estimator)},
              {"force", hammer.force}};
  if (frfs.averages == 0) return result;
  result["usable_hz"] = hammer.usable_hz;
  if (roving) {
    result["struck"] = describe::json_list(frfs.inputs, [](auto& one) { return one.name; });
    result["driving_points"] = describe::json_list(hammer.driving_points, [&](auto& driving) {
      Json point = describe::json_of(driving.check);
      point["point"] = frfs.inputs[static_cast<std::size_t>(driving.input)].name;
      return point;
    });
    result["reciprocity"] = describe::json_of(hammer.reciprocity);
  } else if (!hammer.driving_points.empty()) {
    result["driving_point"] = describe::json_of(hammer.driving_points.front().check);
  }
  const auto uff = [&] { return signal::uff_text(frfs); };
  write_result(options.out, uff, "FRFs, coherence and error bars", "out", result, context);
  const auto csv = [&] { return csv_of(frfs); };
  write_result(options.csv, csv, "the same as a table", "csv", result, context);
  return result;
}

describe::Options options_of(FrfCommand& c) {
  describe::Options options{
      option("FILE", c.impact.files, "Recordings (CSV, LVM, UFF 58): continuous or one a hit")
          .once()
          .required()};
  for (auto& one : options_of(c.impact)) options.push_back(std::move(one));
  for (auto& one : options) one.is_required |= one.name == "--force";
  options.push_back(
      option("--out", c.out, "FRFs with coherence and error bars as UFF 58").writes());
  options.push_back(option("--csv", c.csv, "The same as a table").writes());
  return options;
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

Verb frf_verb() {
  return verb_of<FrfCommand>(
      "frf", "Hammer hits found and judged, averaged FRFs with coherence and error bars",
      "Example:\n  rigfit frf hits.csv --force hammer --response a1 a2 --out frf.uff --json -\n"
      "  rigfit frf p1.csv p2.csv --struck a1 a2 --force hammer --response a1 a2 --out frf.uff\n"
      "Exit code 4: no hit can be used; the hits and their reasons are given all the same.",
      run, true, true, []() -> Json {
        return describe::schema_of_keys(
            {{"hits", describe::schema_of<std::vector<signal::Hit>>()}});
      });
}

}  // namespace rigfit::apps
