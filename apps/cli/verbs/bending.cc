// rigfit bending: EI at each tension from load-deflection records, and laws for EI over tension.
#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>

#include "apps/campaign_file/recording_description.h"
#include "apps/cli/json_document.h"
#include "apps/cli/number_checks.h"
#include "apps/cli/verbs/all.h"
#include "ident/bending/bending_test.h"
#include "ident/bending/stiffness_law.h"
#include "ident/bending/strand.h"
#include "signal/numerics/numbers.h"
#include "signal/readers/csv/read_csv.h"
#include "signal/readers/mapped_file.h"
#include "signal/readers/read_recording.h"
#include "signal/recording/recording_error.h"

namespace rigfit::apps {
namespace {

using signal::kNaN;

struct BendingCommand {
  std::vector<std::string> files;
  double span = 0, span_std = 0;
  std::string tension, load, deflection;
  double load_calibration = 0, deflection_calibration = 0, tension_calibration = 0;
  double tension_zero_std = 0;
  std::vector<double> strand;  // E, elements, element diameter, strand diameter
  double relative_std = 0;
  std::optional<double> EA, mass_per_length;
};

struct Test {
  std::string file;
  std::size_t line = 0;  // of a table of results, 1-based row; 0: from a record
  ident::StiffnessPoint point;
  std::optional<ident::BendingTestResult> analysis;
};

std::string lower(std::string text) {
  for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return text;
}

// The column a person means: by the name given, else by one of the usual beginnings.
const signal::Channel* find(const std::vector<signal::Channel>& columns, const std::string& asked,
                            const std::vector<std::string>& beginnings) {
  for (const auto& column : columns) {
    if (!asked.empty() && lower(column.name) == lower(asked)) return &column;
  }
  if (!asked.empty()) return nullptr;
  for (const auto& beginning : beginnings) {
    for (const auto& column : columns) {
      if (lower(column.name).starts_with(beginning)) return &column;
    }
  }
  return nullptr;
}

[[noreturn]] void missing(const std::string& file, const std::string& what,
                          const std::string& asked, const std::string& option,
                          const std::vector<signal::Channel>& columns) {
  std::string names;
  for (const auto& column : columns) names += (names.empty() ? "" : ", ") + column.name;
  throw signal::RecordingError({.file = file, .channel = asked.empty() ? what : asked, .value = ""},
                               "no such column",
                               fmt::format("name it with {}; there are: {}", option, names));
}

std::vector<signal::Channel> load_columns(const std::string& file, VerbContext& context) {
  context.input(file);
  const auto beside = std::filesystem::path(file).replace_extension(".toml");
  if (!std::filesystem::exists(beside)) {
    const signal::MappedFile mapped(file);
    if (signal::format_of(mapped.bytes()) == signal::RecordingFormat::csv) {
      auto table = signal::read_table(mapped.bytes(), file);
      for (const auto& note : table.notes) context.warn(note.code, note.message, note.where);
      return std::move(table.columns);
    }
  }
  return load_recording(file, context).channels;
}

// A published table: EI already worked out, with or without its interval.
bool take_results(const std::string& file, const std::vector<signal::Channel>& columns,
                  const BendingCommand& options, std::vector<Test>& tests) {
  const auto* EI = find(columns, "", {"ei"});
  if (EI == nullptr) return false;
  const auto* tension = find(columns, options.tension, {"tension"});
  if (tension == nullptr) missing(file, "tension", options.tension, "--tension", columns);
  const auto* std = find(columns, "", {"std", "uncertainty"});
  const auto* low = find(columns, "", {"low"});
  const auto* high = find(columns, "", {"high"});
  for (Eigen::Index i = 0; i < EI->samples.size(); ++i) {
    const auto at = [&](const signal::Channel* column) {
      return column == nullptr ? kNaN : column->samples[i];
    };
    Test test{.file = file, .line = static_cast<std::size_t>(i) + 1, .point = {}, .analysis = {}};
    test.point = {at(tension), at(EI), at(std), at(low), at(high)};
    if (std::isfinite(test.point.std) && !std::isfinite(test.point.low)) {
      test.point.low = std::max(0.0, test.point.EI_Nm2 - 1.959964 * test.point.std);
      test.point.high = test.point.EI_Nm2 + 1.959964 * test.point.std;
    }
    if (!(test.point.tension_N > 0) || !(test.point.EI_Nm2 > 0)) {
      throw signal::RecordingError(
          {.file = file,
           .channel = test.point.tension_N > 0 ? EI->name : tension->name,
           .value = fmt::format(
               "{}", test.point.tension_N > 0 ? test.point.EI_Nm2 : test.point.tension_N)},
          fmt::format("row {} has no positive number", i + 1), "mend or remove the row");
    }
    tests.push_back(std::move(test));
  }
  return true;
}

void take_record(const std::string& file, const std::vector<signal::Channel>& columns,
                 const BendingCommand& options, VerbContext& context, std::vector<Test>& tests) {
  const auto* tension = find(columns, options.tension, {"tension", "preload"});
  const auto* load = find(columns, options.load, {"load", "force", "q"});
  const auto* deflection =
      find(columns, options.deflection, {"deflection", "displacement", "lvdt", "d"});
  if (tension == nullptr) missing(file, "tension", options.tension, "--tension", columns);
  if (load == nullptr) missing(file, "load", options.load, "--load", columns);
  if (deflection == nullptr) {
    missing(file, "deflection", options.deflection, "--deflection", columns);
  }
  if (!(options.span > 0)) {
    throw UsageError(
        "--span is needed for load-deflection records: the clear length between the "
        "clamps in metres");
  }
  for (const auto& [column, si] : {std::pair{tension, "N"}, {load, "N"}, {deflection, "m"}}) {
    if (column->unit.empty()) {
      context.warn("unit_unknown", fmt::format("no unit given, taken as {}", si),
                   file + ": " + column->name);
    } else if (column->unit != si) {
      throw signal::RecordingError(
          {.file = file, .channel = column->name, .value = column->unit},
          fmt::format("its unit is not one of {}", si == std::string("N") ? "force" : "length"),
          "name the right column with --tension, --load, --deflection, or "
          "give its unit in a TOML file beside the recording");
    }
  }
  const ident::BendingRecord all{tension->samples, load->samples, deflection->samples};
  // A few hundred rows are a table written by hand, often of several tensions.
  const bool table = all.load_N.size() <= 400;
  const auto records = table ? ident::split_by_tension(all) : std::vector{all};
  ident::BendingTestOptions test_options;
  test_options.span_m = {options.span, options.span_std};
  test_options.load_calibration_std = options.load_calibration;
  test_options.deflection_calibration_std = options.deflection_calibration;
  test_options.tension_calibration_std = options.tension_calibration;
  test_options.tension_zero_std_N = options.tension_zero_std;
  for (const auto& record : records.empty() ? std::vector{all} : records) {
    Test test{.file = file, .line = 0, .point = {}, .analysis = {}};
    test.analysis = ident::analyse_bending_test(record, test_options);
    const auto& result = *test.analysis;
    test.point = {result.tension_N.value, result.stiffness.EI_Nm2.value,
                  result.stiffness.EI_Nm2.std, result.stiffness.low, result.stiffness.high};
    const std::string where = std::isfinite(result.tension_N.value)
                                  ? fmt::format("{} at {:.4g} N", file, result.tension_N.value)
                                  : file;
    for (const auto& finding : result.findings) {
      if (finding.refuses) {
        context.refuse(finding.code, finding.message, where);
      } else {
        context.warn(finding.code, finding.message, where);
      }
    }
    tests.push_back(std::move(test));
  }
}

Json test_json(const Test& test) {
  const auto& point = test.point;
  const bool refused = test.analysis && test.analysis->refused;
  const auto number = [](double x) { return std::isfinite(x) ? Json(x) : Json(nullptr); };
  Json json{{"file", test.file},
            {"tension_N", number(point.tension_N)},
            {"EI_Nm2",
             {{"value", refused ? Json(nullptr) : number(point.EI_Nm2)},
              {"std", refused ? Json(nullptr) : number(point.std)},
              {"low", refused ? Json(nullptr) : number(point.low)},
              {"high", refused ? Json(nullptr) : number(point.high)}}},
            {"refused", refused}};
  if (test.line > 0) json["row"] = test.line;
  if (!test.analysis) return json;
  const auto& result = *test.analysis;
  json["tension_range_N"] = {number(result.tension_low_N), number(result.tension_high_N)};
  json["compliance_m_N"] = json_estimate(result.compliance_m_N.value, result.compliance_m_N.std);
  json["degrees_of_freedom"] = result.degrees_of_freedom;
  json["lambda"] = number(result.stiffness.lambda);
  json["ratio"] = number(result.stiffness.ratio);
  json["log_sensitivity"] = {{"compliance", number(result.stiffness.log_sensitivity_compliance)},
                             {"tension", number(result.stiffness.log_sensitivity_tension)},
                             {"span", number(result.stiffness.log_sensitivity_span)}};
  json["hysteresis_N"] = result.hysteresis_N;
  json["friction"] = {{"probability", result.friction_probability},
                      {"travel_m", result.friction_travel_m},
                      {"load_N", result.friction_load_N},
                      {"relative_std_of_slope", result.relative_std_friction},
                      {"relative_correction_of_slope", result.relative_friction_correction}};
  json["strokes"] = Json::array();
  for (const auto& stroke : result.strokes) {
    json["strokes"].push_back(
        {{"loading", stroke.loading},
         {"samples", {stroke.first, stroke.last}},
         {"used", {stroke.used_first, stroke.used_last}},
         {"stiffness_N_m", json_estimate(stroke.stiffness_N_m.value, stroke.stiffness_N_m.std)},
         {"offset_N", stroke.offset_N},
         {"residual_rms_N", stroke.residual_rms_N},
         {"curvature", stroke.curvature},
         {"load_drops", stroke.load_drops}});
  }
  json["findings"] = Json::array();
  for (const auto& finding : result.findings) {
    json["findings"].push_back(
        {{"code", finding.code}, {"message", finding.message}, {"refuses", finding.refuses}});
  }
  return json;
}

Json law_json(const ident::FittedLaw& law, const std::vector<double>& tensions) {
  Json parameters = Json::array();
  for (const auto& p : law.parameters) {
    Json one{{"name", p.name}, {"value", p.value}, {"std", p.std}, {"unit", p.unit}};
    if (p.fixed) one["fixed"] = true;
    parameters.push_back(std::move(one));
  }
  Json covariance = Json::array();
  for (Eigen::Index i = 0; i < law.covariance.rows(); ++i) {
    Json row = Json::array();
    for (Eigen::Index j = 0; j < law.covariance.cols(); ++j) row.push_back(law.covariance(i, j));
    covariance.push_back(std::move(row));
  }
  Json json{{"law", ident::name_of(law.kind)},
            {"formula", law.formula},
            {"parameters", std::move(parameters)},
            {"covariance", std::move(covariance)},
            {"aicc", law.aicc},
            {"akaike_weight", law.akaike_weight},
            {"chi_squared", law.chi_squared},
            {"degrees_of_freedom", law.degrees_of_freedom},
            {"rms_relative_error", law.rms_relative_error},
            {"converged", law.converged}};
  if (!law.message.empty()) json["message"] = law.message;
  json["predictions"] = Json::array();
  for (double tension : tensions) {
    const auto at = ident::predict(law, tension);
    json["predictions"].push_back({{"tension_N", tension},
                                   {"EI_Nm2", at.EI_Nm2},
                                   {"low", at.low},
                                   {"high", at.high},
                                   {"test_low", at.test_low},
                                   {"test_high", at.test_high}});
  }
  return json;
}

void print_tests(std::ostream& out, const std::vector<Test>& tests) {
  out << fmt::format("{:>10} {:>10} {:>10}  {:<22}  {}\n", "tension, N", "EI, N m2", "std",
                     "95 % interval", "from");
  for (const auto& test : tests) {
    const auto& p = test.point;
    if (test.analysis && test.analysis->refused) {
      out << fmt::format("{:>10.5g} {:>10} {:>10}  {:<22}  {}\n", p.tension_N, "refused", "", "",
                         test.file);
      continue;
    }
    const bool interval = std::isfinite(p.low) && std::isfinite(p.high);
    out << fmt::format("{:>10.5g} {:>10.4g} {:>10}  {:<22}  {}\n", p.tension_N, p.EI_Nm2,
                       std::isfinite(p.std) ? fmt::format("{:.2g}", p.std) : "-",
                       interval ? fmt::format("{:.4g} .. {:.4g}", p.low, p.high) : "-", test.file);
  }
}

// What the records cannot show of themselves: said where the intervals leave it out.
void print_tension_cell(std::ostream& out, const std::vector<Test>& tests,
                        const BendingCommand& options) {
  if (options.tension_zero_std > 0 || options.tension_calibration > 0) return;
  const Test* worst = nullptr;
  double most = 0;
  for (const auto& test : tests) {
    if (!test.analysis || test.analysis->refused) continue;
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

// Relative uncertainty of a test's EI that it shares with the others: span and calibrations, root
// of squares.
double shared_std(const Test& test, const BendingCommand& options) {
  if (!test.analysis || test.analysis->refused) return 0;
  const auto& s = test.analysis->stiffness;
  const double span = options.span > 0 ? options.span_std / options.span : 0;
  return std::sqrt(
      std::pow(s.log_sensitivity_span * span, 2) +
      std::pow(s.log_sensitivity_compliance, 2) *
          (std::pow(options.load_calibration, 2) + std::pow(options.deflection_calibration, 2)) +
      std::pow(s.log_sensitivity_tension * options.tension_calibration, 2));
}

Json run_bending(VerbContext& context, const BendingCommand& options) {
  std::vector<Test> tests;
  for (const auto& file : options.files) {
    const auto columns = load_columns(file, context);
    if (!take_results(file, columns, options, tests)) {
      take_record(file, columns, options, context, tests);
    }
  }
  std::stable_sort(tests.begin(), tests.end(), [](const Test& a, const Test& b) {
    return a.point.tension_N < b.point.tension_N;
  });
  print_tests(context.out, tests);
  print_tension_cell(context.out, tests, options);

  Json result;
  result["tests"] = Json::array();
  std::vector<ident::StiffnessPoint> points;
  double common = 0;
  for (const auto& test : tests) common = std::max(common, shared_std(test, options));
  for (const auto& test : tests) {
    result["tests"].push_back(test_json(test));
    const bool refused = test.analysis && test.analysis->refused;
    if (refused || !(test.point.EI_Nm2 > 0)) continue;
    ident::StiffnessPoint point = test.point;
    const double own_share = shared_std(test, options);
    if (own_share > 0 && std::isfinite(point.std)) {
      // The law's weights are what the tests do not share.
      const double shared = std::min(0.999 * point.std, own_share * point.EI_Nm2);
      const double factor = std::sqrt(1 - std::pow(shared / point.std, 2));
      point.low = point.EI_Nm2 - factor * (point.EI_Nm2 - point.low);
      point.high = point.EI_Nm2 + factor * (point.high - point.EI_Nm2);
    }
    points.push_back(point);
  }

  ident::StiffnessLawOptions law_options;
  law_options.common_relative_std = common;
  law_options.assumed_relative_std = options.relative_std;
  Json bounds = nullptr;
  if (!options.strand.empty()) {
    const ident::StrandGeometry geometry{options.strand[0], static_cast<int>(options.strand[1]),
                                         options.strand[2], options.strand[3]};
    law_options.bounds = ident::stiffness_bounds(geometry);
    bounds = {{"EI_min_Nm2", law_options.bounds->EI_min_Nm2},
              {"EI_max_Nm2", law_options.bounds->EI_max_Nm2}};
    context.out << fmt::format("strand: EI between {:.4g} (free slip) and {:.4g} N m2 (no slip)\n",
                               law_options.bounds->EI_min_Nm2, law_options.bounds->EI_max_Nm2);
    for (const auto& point : points) {
      if (point.EI_Nm2 < law_options.bounds->EI_min_Nm2 ||
          point.EI_Nm2 > law_options.bounds->EI_max_Nm2) {
        context.warn("outside_bounds",
                     fmt::format("EI = {:.4g} N m2 at {:.4g} N lies outside what the strand's "
                                 "geometry allows",
                                 point.EI_Nm2, point.tension_N));
      }
    }
  }
  result["laws"] = Json::array();
  if (points.size() >= 2) {
    const auto laws = ident::fit_stiffness_laws(points, law_options);
    std::vector<double> tensions;
    for (const auto& point : points) tensions.push_back(point.tension_N);
    context.out << fmt::format("{:<12} {:>9} {:>8}  {}\n", "law", "rms", "AICc", "formula");
    for (const auto& law : laws.laws) {
      result["laws"].push_back(law_json(law, tensions));
      context.out << fmt::format(
          "{:<12} {:>7.2f} % {:>8}  {}\n", ident::name_of(law.kind), 100 * law.rms_relative_error,
          std::isfinite(law.aicc) ? fmt::format("{:.2f}", law.aicc) : "-", law.formula);
    }
    result["law_choice"] = {{"decided", laws.decided}, {"sentence", laws.sentence}};
    context.out << laws.sentence << '\n';
  }
  result["bounds"] = std::move(bounds);
  if (options.EA && options.mass_per_length) {
    result["equivalent_cylinders"] = Json::array();
    for (const auto& point : points) {
      const auto bar =
          ident::equivalent_cylinder(point.EI_Nm2, *options.EA, *options.mass_per_length);
      result["equivalent_cylinders"].push_back({{"tension_N", point.tension_N},
                                                {"youngs_modulus_Pa", bar.youngs_modulus_Pa},
                                                {"diameter_m", bar.diameter_m},
                                                {"density_kg_m3", bar.density_kg_m3}});
    }
  }
  if (points.empty()) context.exit_code = ExitCode::refused;
  return result;
}

}  // namespace

void add_bending(CLI::App& program, Verbs& verbs) {
  const auto options = std::make_shared<BendingCommand>();
  CLI::App* verb = program.add_subcommand(
      "bending", "EI at each tension from load-deflection records or tables; laws for EI(tension)");
  verb->add_option("FILE", options->files,
                   "Records or tables with tension, load and deflection, or tables of tension and "
                   "EI (with std, or low and high)")
      ->required()
      ->check(CLI::ExistingFile);
  verb->add_option("--span", options->span, "Clear length between the clamps, m")
      ->check(positive_number());
  verb->add_option("--span-std", options->span_std, "Its standard uncertainty, m")
      ->check(not_negative_number());
  verb->add_option("--tension", options->tension, "Name of the tension column");
  verb->add_option("--load", options->load, "Name of the load column");
  verb->add_option("--deflection", options->deflection, "Name of the deflection column");
  verb->add_option("--load-calibration", options->load_calibration,
                   "Relative standard uncertainty of the load cell's calibration")
      ->check(number_within(0.0, 1.0));
  verb->add_option("--deflection-calibration", options->deflection_calibration,
                   "The same of the deflection sensor")
      ->check(number_within(0.0, 1.0));
  verb->add_option("--tension-zero-std", options->tension_zero_std,
                   "Standard uncertainty of the tension cell's zero, N (offset and drift)")
      ->check(not_negative_number());
  verb->add_option("--tension-calibration", options->tension_calibration,
                   "The same of the tension cell")
      ->check(number_within(0.0, 1.0));
  verb->add_option("--strand", options->strand,
                   "Young's modulus (Pa), number of wires, wire diameter (m), strand diameter (m): "
                   "bounds on EI")
      ->expected(4)
      ->check(positive_number());
  verb->add_option("--relative-std", options->relative_std,
                   "Relative standard uncertainty of EI values that come without one")
      ->check(number_within(0.0, 1.0));
  verb->add_option("--EA", options->EA,
                   "Axial rigidity, N: with --mass-per-length, the equivalent "
                   "solid cylinder at each tension")
      ->check(positive_number());
  verb->add_option("--mass-per-length", options->mass_per_length, "kg/m")->check(positive_number());
  verb->footer(
      "Example:\n  printf 'tension_N,EI_Nm2\\n25,0.2549\\n100,0.4948\\n200,0.5972\\n300,0.8283\\n' "
      "> "
      "ei.csv\n  rigfit bending ei.csv --strand 195e9 133 0.397e-3 6.35e-3 --json ei.json");
  verbs.push_back(
      {verb, [options](VerbContext& context) { return run_bending(context, *options); }});
}

}  // namespace rigfit::apps
