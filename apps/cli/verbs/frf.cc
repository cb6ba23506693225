// rigfit frf: hammer hits to averaged FRFs with coherence and error bars.

#include "apps/cli/verbs/all.h"
#include "apps/describe/json_of.h"
#include "signal/writers/write_csv.h"
#include "signal/writers/write_uff.h"

namespace rigfit::apps {
namespace {
using Eigen::Index;

struct FrfCommand {
  ImpactCommand impact;
  std::string out, csv;
};

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
    context.plots->add(hammer_plots({&run.places, &hammer, frfs, band.first, band.second}));
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
