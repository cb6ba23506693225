#include "ident/campaign/single_tests/bending_campaign.h"

#include <fmt/format.h>
#include <gsl/gsl_statistics_double.h>

#include "ident/bending/bending_equation.h"
#include "ident/statistics/uncertainty.h"
#include "ident/stiffness/stiffness_law.h"
#include "signal/estimation/robust.h"
#include "signal/recording/add_note.h"

namespace rigfit::ident {
namespace {

// A table of at most this many rows is split by tension; a longer one is a record of one test, in
// which a spike of the tension is no test of its own (a logger at 20 Hz writes as much in 20 s).
constexpr Index kLongestTable = 400;

/// Uncertainty of a test's EI that it shares with others of the same span and instruments, relative
/// to EI: root of the sum of squares.
double shared_relative_std(const BendingTestResult& test, const BendingTestOptions& options) {
  if (test.refused) return 0;
  const auto& EI = test.stiffness;
  const double span = options.span_m.value > 0 ? options.span_m.std / options.span_m.value : 0;
  const double shared =
      std::hypot(EI.log_sensitivity_span * span,
                 EI.log_sensitivity_compliance *
                     std::hypot(options.load_calibration_std, options.deflection_calibration_std),
                 EI.log_sensitivity_tension * options.tension_calibration_std);
  return std::isfinite(shared) ? shared : 0;
}

void add_values(const BendingSource& source, std::vector<BendingPoint>& points) {
  for (std::size_t i = 0; i < source.values.size(); ++i) {
    auto& one = points.emplace_back(BendingPoint{source.name, source.origin, i + 1});
    auto& point = one.point = source.values[i];
    if (std::isfinite(point.std) && !std::isfinite(point.low)) {
      const double half = coverage_factor(0.95, 0) * point.std;
      point.low = std::max(0.0, point.EI_Nm2 - half);
      point.high = point.EI_Nm2 + half;
    }
  }
}

void add_record(const BendingSource& source, const BendingCampaign& campaign,
                std::vector<BendingPoint>& points) {
  const auto& options = campaign.test;
  std::vector<BendingRecord> records;
  if (options.ends == BeamEnds::tensioned && source.record.load_N.size() <= kLongestTable) {
    records = split_by_tension(source.record);
  }
  if (records.empty()) records = {source.record};
  for (auto& record : records) {
    auto& one =
        points.emplace_back(BendingPoint{source.name, source.origin, {}, std::move(record)});
    const auto& result = one.analysis.emplace(analyse_bending_test(one.record, options));
    one.point = {.tension_N = result.tension_N.value,
                 .EI_Nm2 = kNaN,
                 .shared_relative_std = shared_relative_std(result, options),
                 .tension_std_N = result.tension_spread_N};
    if (result.refused) continue;
    const auto& EI = result.stiffness.EI_Nm2;
    one.point.EI_Nm2 = EI.value, one.point.std = EI.std;
    one.point.low = result.stiffness.low, one.point.high = result.stiffness.high;
    if (!one.beam()) continue;
    const auto &slope = result.compliance_m_N, I = campaign.section.second_moment();
    one.slope_N_m = {1 / slope.value, slope.std / slope.value / slope.value};
    if (!(I.value > 0 && EI.value > 0)) continue;
    const double modulus = EI.value / I.value;
    one.modulus_Pa = {modulus, modulus * std::hypot(EI.std / EI.value, I.std / I.value)};
  }
}

/// What no record shows of itself: inputs taken as exact, and what EI changes by where most.
void name_exact_inputs(const BendingTestOptions& options, BendingCampaignResult& result) {
  const bool tensioned = options.ends == BeamEnds::tensioned;
  double span = 0, clamps = 0, zero = 0;
  for (const auto& one : result.points) {
    if (!one.analysis || !one.usable()) continue;
    const auto& EI = one.analysis->stiffness;
    const double T = tensioned ? one.point.tension_N : 0, l = options.span_m.value;
    span = std::max(span, std::abs(EI.log_sensitivity_span) * 1e-3 / l);
    clamps = std::max(clamps, std::abs(EI.log_sensitivity_compliance) *
                                  clamp_compliance(one.point.EI_Nm2, T, l, options.ends) / 1000);
    if (T > 0) zero = std::max(zero, std::abs(EI.log_sensitivity_tension) * 0.1 / T);
  }
  std::string exact;
  const auto name = [&](bool is, const std::string& what) {
    if (is) exact += (exact.empty() ? "" : "; ") + what;
  };
  name(!(options.span_m.std > 0), fmt::format("span (1 mm: {:.2g} %)", 100 * span));
  name(clamps > 0 && !(options.clamp_stiffness_Nm_rad > 0),
       fmt::format("rigid clamps (EI is {:.2g} % higher where each turns with 1000 N m/rad, {:.2g} "
                   "% with 200: --clamp-stiffness)",
                   100 * clamps, 500 * clamps));
  name(!(options.load_calibration_std > 0 && options.deflection_calibration_std > 0),
       "calibration of load and deflection (1 %: 1 % or more)");
  name(tensioned && !(options.tension_zero_std_N > 0 || options.tension_calibration_std > 0),
       fmt::format("tension (0.1 N: {:.2g} %)", 100 * zero));
  if (!(span > 0) || exact.empty()) return;
  signal::add_note(
      result.findings, "taken_as_exact", "",
      "Give standard uncertainties of what is taken as exact (in brackets what it changes EI by): "
      "{}{}",
      exact, tensioned ? "" : "; shear is left out");
}

/// Lengths that hardly any bending test has, most often millimetres given as metres, or the
/// reverse; and deflections beyond small ones.
void suspect_lengths(const BendingCampaign& campaign, BendingCampaignResult& result) {
  double deflection = 0;
  for (const auto& one : result.points) {
    const auto values = signal::finite_values(one.record.deflection_m);
    if (values.empty()) continue;
    const auto [low, high] = std::ranges::minmax(values);
    deflection = std::max(deflection, high - low);
  }
  const double span = campaign.test.span_m.value;
  constexpr double kLongestSpan = 20;  // m: the shortest span of a bench, given in mm
  if (!(deflection > 0 && span > 0)) return;
  const double part = deflection / span;
  if (span < kLongestSpan && part < 0.5) {
    if (part < 0.1) return;
    signal::add_note(result.findings, "large_deflection", "",
                     "Deflect less: {:.0f} % of the span is much for the equation of small "
                     "deflections, whose error is about its square, {:.1g} %",
                     100 * part, 100 * part * part);
    return;
  }
  signal::add_note(result.findings, "length_suspected", "",
                   "Give the span in m, and the deflection's unit in its title or in a TOML file "
                   "beside the recording: {:.4g} m with deflections up to {:.4g} m is no bending "
                   "test; EI goes with about the cube of the span",
                   span, deflection);
}

void gather_specimens(BendingCampaignResult& result) {
  std::vector<double> EI, modulus;
  for (const auto& one : result.points) {
    if (!one.usable()) continue;
    EI.push_back(one.point.EI_Nm2);
    modulus.push_back(one.modulus_Pa.value);
  }
  if (EI.size() < 2) return;
  const double mean = gsl_stats_mean(EI.data(), 1, EI.size());
  result.specimens = {EI.size(), mean, gsl_stats_mean(modulus.data(), 1, modulus.size()),
                      gsl_stats_sd_m(EI.data(), 1, EI.size(), mean) / mean};
}

}  // namespace

Estimate BeamSection::second_moment() const {
  double moment = second_moment_m4;
  if (!rectangle_m.empty()) {
    moment = rectangle_m[0] * std::pow(rectangle_m[1], 3) / 12;
  } else if (diameter_m > 0) {
    moment = std::numbers::pi * std::pow(diameter_m, 4) / 64;
  }
  if (!(moment > 0)) return {};
  return {moment, relative_std * moment};
}

BendingCampaignResult analyse_bending_campaign(const BendingCampaign& campaign) {
  BendingCampaignResult result;
  result.assumed_relative_std = campaign.assumed_relative_std;
  for (const auto& source : campaign.sources) {
    source.values.empty() ? add_record(source, campaign, result.points)
                          : add_values(source, result.points);
  }
  std::stable_sort(result.points.begin(), result.points.end(), [](const auto& a, const auto& b) {
    const bool known = std::isfinite(a.point.tension_N);
    if (known != std::isfinite(b.point.tension_N)) return known;
    return a.point.tension_N < b.point.tension_N;
  });
  for (const auto& one : result.points) {
    if (!one.analysis) continue;
    for (Finding finding : one.analysis->findings) {
      finding.where = one.file;
      if (one.point.tension_N > 0)
        finding.where += fmt::format(" at {:.4g} N", one.point.tension_N);
      result.findings.push_back(std::move(finding));
    }
  }
  if (std::ranges::none_of(result.points,
                           [](const auto& p) { return p.usable() || p.refused(); })) {
    result.findings.push_back({"no_EI", "no test gives an EI", "", true});
  }
  name_exact_inputs(campaign.test, result);
  suspect_lengths(campaign, result);
  if (campaign.test.ends != BeamEnds::tensioned) {
    gather_specimens(result);
    return result;
  }
  std::vector<StiffnessPoint> points;
  for (const auto& one : result.points) {
    if (one.usable()) points.push_back(one.point);
  }
  StiffnessLawOptions options;
  options.assumed_relative_std = campaign.assumed_relative_std;
  if (campaign.strand) {
    result.bounds = options.bounds = stiffness_bounds(*campaign.strand);
    for (const auto& point : points) {
      if (point.EI_Nm2 >= result.bounds->EI_min_Nm2 && point.EI_Nm2 <= result.bounds->EI_max_Nm2) {
        continue;
      }
      signal::add_note(result.findings, "outside_bounds", "",
                       "Check span, units and the strand's wires: EI = {:.4g} N m2 at {:.4g} N "
                       "lies outside what the strand's geometry allows",
                       point.EI_Nm2, point.tension_N);
    }
  }
  result.curve = StiffnessCurve(std::move(points), options);
  return result;
}

}  // namespace rigfit::ident
