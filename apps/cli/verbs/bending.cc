// rigfit bending: EI at each tension from load-deflection records, and laws for EI over tension.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>

#include "apps/campaign_file/bending_files.h"
#include "apps/cli/plots/verb_figures.h"
#include "apps/cli/verbs/all.h"
#include "apps/describe/sheet.h"
#include "apps/results/bending_json.h"
#include "ident/campaign/single_tests/beam_section.h"
#include "ident/campaign/single_tests/bending_campaign.h"

namespace rigfit::apps {
namespace {

struct BendingCommand {
  std::vector<std::string> files;
  BendingColumns columns;
  ident::BendingCampaign campaign;  ///< its sources, read
  double span = 0, span_std = 0;
  std::vector<double> strand;  ///< E, elements, element diameter, strand diameter
  std::optional<double> EA, mass_per_length;
  /// "clamped", "pinned", "cantilever" without tension (columns.tension "0"); empty: clamped.
  std::string ends;
  // Cross-section of a beam without tension: one of them, or none; m, m4.
  std::vector<double> rectangle;  ///< width, height
  double diameter = 0, second_moment = 0;
  double section_std = 0;  ///< relative standard uncertainty of the second moment
};

// What the records cannot show of themselves: said where the intervals leave it out.
void print_tension_cell(std::ostream& out, const ident::BendingTestOptions& options,
                        const ident::BendingCampaignResult& result) {
  if (options.tension_zero_std_N > 0 || options.tension_calibration_std > 0) return;
  const ident::BendingPoint* worst = nullptr;
  double most = 0;
  for (const auto& test : result.points) {
    if (!test.analysis || test.refused()) continue;
    const double by_newton =
        std::abs(test.analysis->stiffness.log_sensitivity_tension) / test.analysis->tension_N.value;
    if (by_newton > most) most = by_newton, worst = &test;
  }
  if (worst == nullptr) return;
  out << fmt::format(
      "Not in the intervals: the tension cell itself. 0.1 N of its zero move EI by up to {:.2f} % "
      "(at {:.4g} N): --tension-zero-std.\n",
      10 * most, worst->analysis->tension_N.value);
}

/// Ends and section of a beam without tension.
void take_beam(BendingCommand& command) {
  auto& campaign = command.campaign;
  command.columns.without_tension = command.columns.tension == "0";
  const bool section =
      !command.rectangle.empty() || command.diameter > 0 || command.second_moment > 0;
  if (!command.columns.without_tension) {
    if (!command.ends.empty() || section) {
      throw UsageError("--ends and a cross-section belong to a beam without tension: --tension 0");
    }
    return;
  }
  campaign.test.ends = command.ends == "pinned"       ? ident::BeamEnds::pinned
                       : command.ends == "cantilever" ? ident::BeamEnds::cantilever
                                                      : ident::BeamEnds::clamped;
  ident::BeamSection shape{{}, command.diameter, command.second_moment, command.section_std};
  if (!command.rectangle.empty()) {
    shape.rectangle_m = {command.rectangle[0], command.rectangle[1]};
  }
  campaign.second_moment_m4 = ident::second_moment(shape);
}

void read_source(const std::string& file, BendingCommand& command, VerbContext& context) {
  std::vector<Warning> warnings;
  auto source = bending_source(load_bending_file(file, context), command.columns, warnings);
  if (source.values.empty() && !(command.span > 0)) {
    throw UsageError(
        "--span is needed for load-deflection records: the clear length between the clamps in "
        "metres");
  }
  for (auto& warning : warnings) {
    context.warn(std::move(warning.code), std::move(warning.message), std::move(warning.where));
  }
  command.campaign.sources.push_back(std::move(source));
}

Json run(BendingCommand command, VerbContext& context) {
  auto& campaign = command.campaign;
  campaign.test.span_m = {command.span, command.span_std};
  take_beam(command);  // before files are read
  for (const auto& file : command.files) read_source(file, command, context);
  if (!command.strand.empty()) {
    campaign.strand = {command.strand[0], static_cast<int>(command.strand[1]), command.strand[2],
                       command.strand[3]};
  }
  const auto found = ident::analyse_bending_campaign(campaign);
  for (const auto& one : found.points) {
    if (!one.analysis) continue;
    const auto& file = campaign.sources[one.source].name;
    const std::string where = std::isfinite(one.point.tension_N) && one.point.tension_N > 0
                                  ? fmt::format("{} at {:.4g} N", file, one.point.tension_N)
                                  : file;
    for (const auto& finding : one.analysis->findings) {
      if (finding.refuses) {
        context.refuse(finding.code, finding.message, where);
      } else {
        context.warn(finding.code, finding.message, where);
      }
    }
  }
  for (const auto& finding : found.findings) context.warn(finding.code, finding.message);
  if (context.plots) draw_bending(*context.plots, campaign, found);
  const bool beams = campaign.test.ends != ident::BeamEnds::tensioned;
  auto& out = context.out;
  describe::print(out, describe::table_of(bending_rows(campaign, found)));
  if (found.specimens) describe::print(out, describe::sheet_of(*found.specimens));
  if (!beams) print_tension_cell(out, campaign.test, found);
  if (found.bounds) describe::print(out, describe::sheet_of(*found.bounds));
  if (const auto& laws = found.curve.laws().laws; !laws.empty()) {
    describe::print(out, describe::table_of(laws));
    out << "For a model: " << found.curve.sentence() << '\n';
  }
  Json result = bending_json(campaign, found);
  if (command.EA && command.mass_per_length) {
    result["equivalent_cylinders"] = Json::array();
    for (const auto& point : found.curve.points()) {
      const auto bar =
          ident::equivalent_cylinder(point.EI_Nm2, *command.EA, *command.mass_per_length);
      result["equivalent_cylinders"].push_back({{"tension_N", point.tension_N},
                                                {"youngs_modulus_Pa", bar.youngs_modulus_Pa},
                                                {"diameter_m", bar.diameter_m},
                                                {"density_kg_m3", bar.density_kg_m3}});
    }
  }
  const bool none = std::none_of(found.points.begin(), found.points.end(),
                                 [](const auto& one) { return one.usable(); });
  if ((beams ? none : found.curve.empty()) && context.exit_code == ExitCode::done) {
    context.refuse("no_EI", "no test gives an EI");
  }
  return result;
}

describe::Options options_of(BendingCommand& c) {
  using describe::option;
  return {option("FILE", c.files,
                 "Records or tables with tension, load and deflection, or tables of tension and EI "
                 "(with std, or low and high)")
              .required()
              .file(),
          option("--span", c.span,
                 "Clear length between the clamps or supports (cantilever: to the load)", "m")
              .positive(),
          option("--span-std", c.span_std, "Standard uncertainty of the span", "m").from_zero(),
          option("--tension", c.columns.tension,
                 "Name of the tension column; 0: there is no tension (a beam, by dead weights or a "
                 "testing machine)"),
          option("--ends", c.ends,
                 "Of a beam without tension: clamped (default) or pinned, loaded at mid-span; "
                 "cantilever, loaded at its end")
              .one_of({"clamped", "pinned", "cantilever"}),
          option("--rectangle", c.rectangle,
                 "Its cross-section: width and height (along the load), m: gives the modulus")
              .count(2)
              .positive(),
          option("--diameter", c.diameter, "Its diameter when round and solid", "m")
              .positive()
              .excludes("--rectangle"),
          option("--second-moment", c.second_moment,
                 "Its second moment of area about the axis of bending", "m4")
              .positive()
              .excludes("--rectangle")
              .excludes("--diameter"),
          option("--section-std", c.section_std,
                 "Relative standard uncertainty of the second moment (three times that of a "
                 "height, four times that of a diameter)")
              .within(0.0, 1.0),
          option("--load", c.columns.load, "Name of the load column"),
          option("--deflection", c.columns.deflection, "Name of the deflection column"),
          option("--load-calibration", c.campaign.test.load_calibration_std,
                 "Relative standard uncertainty of the load cell's calibration")
              .within(0.0, 1.0),
          option("--deflection-calibration", c.campaign.test.deflection_calibration_std,
                 "Relative standard uncertainty of the deflection sensor's calibration")
              .within(0.0, 1.0),
          option("--tension-zero-std", c.campaign.test.tension_zero_std_N,
                 "Standard uncertainty of the tension cell's zero, N (offset and drift)")
              .from_zero(),
          option("--clamp-stiffness", c.campaign.test.clamp_stiffness_Nm_rad,
                 "Clamps may turn, each with this rotational stiffness or a larger one, N m/rad: "
                 "the standard uncertainty of their flexibility is 1 over it (default: rigid)")
              .positive(),
          option("--tension-calibration", c.campaign.test.tension_calibration_std,
                 "Relative standard uncertainty of the tension cell's calibration")
              .within(0.0, 1.0),
          option("--strand", c.strand,
                 "Young's modulus (Pa), number of wires, wire diameter (m), strand diameter (m): "
                 "bounds on EI")
              .count(4)
              .positive(),
          option("--relative-std", c.campaign.assumed_relative_std,
                 "Relative standard uncertainty of EI values that come without one")
              .within(0.0, 1.0),
          option("--EA", c.EA,
                 "Axial rigidity, N: with --mass-per-length, the equivalent solid cylinder at each "
                 "tension")
              .positive(),
          option("--mass-per-length", c.mass_per_length, "Of the cable", "kg/m").positive()};
}

}  // namespace

Verb bending_verb() {
  Verb verb = verb_of<BendingCommand>(
      "bending", "EI at each tension from load-deflection records or tables; laws for EI(tension)",
      "Example:\n  printf 'tension_N,EI_Nm2\\n25,0.2549\\n100,0.4948\\n200,0.5972\\n300,0.8283\\n' "
      "> "
      "ei.csv\n  rigfit bending ei.csv --strand 195e9 133 0.397e-3 6.35e-3 --json ei.json",
      [](const BendingCommand& c, VerbContext& context) { return run(c, context); });
  verb.draws = true;
  verb.reads = true;
  return verb;
}

}  // namespace rigfit::apps
