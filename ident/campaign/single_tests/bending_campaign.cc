#include "ident/campaign/single_tests/bending_campaign.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "ident/bending/bending_equation.h"
#include "ident/statistics/uncertainty.h"
#include "ident/stiffness/stiffness_law.h"
#include "signal/numerics/numbers.h"

namespace rigfit::ident {
namespace {

void add_values(const BendingSource& source, std::size_t index, std::vector<BendingPoint>& points) {
  for (std::size_t i = 0; i < source.values.size(); ++i) {
    BendingPoint one{.source = index, .row = i + 1, .record = {}, .analysis = {}, .point = {}};
    one.point = source.values[i];
    auto& point = one.point;
    if (std::isfinite(point.std) && !std::isfinite(point.low)) {
      const double half = coverage_factor(0.95, 0) * point.std;
      point.low = std::max(0.0, point.EI_Nm2 - half);
      point.high = point.EI_Nm2 + half;
    }
    points.push_back(std::move(one));
  }
}

void add_record(const BendingSource& source, std::size_t index, const BendingTestOptions& options,
                std::vector<BendingPoint>& points) {
  std::vector<BendingRecord> records;
  if (options.ends == BeamEnds::tensioned && source.record.load_N.size() <= kLongestBendingTable) {
    records = split_by_tension(source.record);
  }
  if (records.empty()) records = {source.record};
  for (auto& record : records) {
    BendingPoint one{
        .source = index, .row = 0, .record = std::move(record), .analysis = {}, .point = {}};
    one.analysis = analyse_bending_test(one.record, options);
    const auto& result = *one.analysis;
    const auto& EI = result.stiffness;
    one.point = {result.tension_N.value,
                 EI.EI_Nm2.value,
                 EI.EI_Nm2.std,
                 EI.low,
                 EI.high,
                 shared_relative_std(result, options),
                 result.tension_spread_N};
    points.push_back(std::move(one));
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
  result.findings.push_back({"taken_as_exact",
                             "Give standard uncertainties of what is taken as exact (in brackets "
                             "what it changes EI by): " +
                                 exact + (tensioned ? "" : "; shear is left out"),
                             "", false});
}

/// Lengths that hardly any bending test has: most often millimetres given as metres, or the
/// reverse.
void suspect_lengths(const BendingCampaign& campaign, BendingCampaignResult& result) {
  double deflection = 0;
  for (const auto& one : result.points) {
    if (!one.analysis) continue;
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (const double d : one.record.deflection_m) {
      if (std::isfinite(d)) low = std::min(low, d), high = std::max(high, d);
    }
    if (high > low) deflection = std::max(deflection, high - low);
  }
  const double span = campaign.test.span_m.value;
  if (!(deflection > 0 && span > 0)) return;
  constexpr double kLongestSpan = 20;        // m, of a bench
  constexpr double kLeastDeflection = 1e-6;  // relative to the span
  if (span > kLongestSpan || deflection < kLeastDeflection * span) {
    result.findings.push_back(
        {"length_suspected",
         fmt::format("Give the span in m: {:.4g} m with deflections up to {:.3g} mm is no bending "
                     "test (as mm: {:.4g} m); EI goes with about the cube of the span",
                     span, 1e3 * deflection, 1e-3 * span),
         "", false});
  } else if (deflection > 0.5 * span) {
    result.findings.push_back(
        {"length_suspected",
         fmt::format("Give the unit of the deflection in the title or in a TOML file beside the "
                     "recording: {:.3g} m on a span of {:.3g} m may be millimetres",
                     deflection, span),
         "", false});
  } else if (deflection > 0.1 * span) {
    result.findings.push_back(
        {"large_deflection",
         fmt::format("Deflect less: {:.0f} % of the span is much for the equation of small "
                     "deflections, whose error is about its square, {:.1g} %",
                     100 * deflection / span, 100 * deflection * deflection / span / span),
         "", false});
  }
}

void gather_specimens(const BendingCampaign& campaign, BendingCampaignResult& result) {
  BeamSpecimens all;
  double squares = 0;
  all.modulus_Pa = 0;
  for (const auto& one : result.points) {
    if (!one.usable()) continue;
    ++all.count;
    all.EI_Nm2 += one.point.EI_Nm2;
    all.modulus_Pa += bending_modulus(campaign, one).value;
  }
  if (all.count < 2) return;
  const auto count = static_cast<double>(all.count);
  all.EI_Nm2 /= count, all.modulus_Pa /= count;
  for (const auto& one : result.points) {
    if (one.usable()) squares += std::pow(one.point.EI_Nm2 / all.EI_Nm2 - 1, 2);
  }
  all.relative_scatter = std::sqrt(squares / (count - 1));
  result.specimens = all;
}

}  // namespace

signal::Estimate bending_modulus(const BendingCampaign& campaign, const BendingPoint& point) {
  const auto& I = campaign.second_moment_m4;
  if (!(I.value > 0) || !point.usable() || !(point.point.EI_Nm2 > 0)) return {};
  const double modulus = point.point.EI_Nm2 / I.value;
  return {modulus, modulus * std::hypot(point.point.std / point.point.EI_Nm2,
                                        std::isfinite(I.std) ? I.std / I.value : 0)};
}

double shared_relative_std(const BendingTestResult& test, const BendingTestOptions& options) {
  if (test.refused) return 0;
  const auto& EI = test.stiffness;
  const double span = options.span_m.value > 0 ? options.span_m.std / options.span_m.value : 0;
  const double shared =
      std::sqrt(std::pow(EI.log_sensitivity_span * span, 2) +
                std::pow(EI.log_sensitivity_compliance, 2) *
                    (std::pow(options.load_calibration_std, 2) +
                     std::pow(options.deflection_calibration_std, 2)) +
                std::pow(EI.log_sensitivity_tension * options.tension_calibration_std, 2));
  return std::isfinite(shared) ? shared : 0;
}

BendingCampaignResult analyse_bending_campaign(const BendingCampaign& campaign) {
  BendingCampaignResult result;
  for (std::size_t k = 0; k < campaign.sources.size(); ++k) {
    const auto& source = campaign.sources[k];
    if (source.values.empty()) {
      add_record(source, k, campaign.test, result.points);
    } else {
      add_values(source, k, result.points);
    }
  }
  std::stable_sort(result.points.begin(), result.points.end(), [](const auto& a, const auto& b) {
    const bool known = std::isfinite(a.point.tension_N);
    if (known != std::isfinite(b.point.tension_N)) return known;
    return a.point.tension_N < b.point.tension_N;
  });
  for (const auto& one : result.points) {
    if (!one.analysis) continue;
    const auto& file = campaign.sources[one.source].name;
    for (Finding finding : one.analysis->findings) {
      finding.where =
          one.point.tension_N > 0 ? fmt::format("{} at {:.4g} N", file, one.point.tension_N) : file;
      result.findings.push_back(std::move(finding));
    }
  }
  name_exact_inputs(campaign.test, result);
  suspect_lengths(campaign, result);
  if (campaign.test.ends != BeamEnds::tensioned) {
    gather_specimens(campaign, result);
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
      result.findings.push_back(
          {"outside_bounds",
           fmt::format("Check span, units and the strand's wires: EI = {:.4g} N m2 at {:.4g} N "
                       "lies outside what the strand's geometry allows",
                       point.EI_Nm2, point.tension_N),
           "", false});
    }
  }
  result.curve = StiffnessCurve(std::move(points), options);
  return result;
}

std::vector<BendingRow> bending_rows(const BendingCampaign& campaign,
                                     const BendingCampaignResult& result) {
  std::vector<BendingRow> rows;
  for (const auto& one : result.points) {
    const auto& point = one.point;
    BendingRow row;
    row.file = campaign.sources[one.source].name;
    if (one.row > 0) row.row = one.row;
    row.refused = one.refused();
    row.tension_N = point.tension_N;
    row.EI_Nm2 = row.refused
                     ? describe::Bounded{signal::kNaN, signal::kNaN, signal::kNaN, signal::kNaN}
                     : describe::Bounded{point.EI_Nm2, point.std, point.low, point.high};
    row.stiffness_N_m = row.modulus_Pa = {signal::kNaN, signal::kNaN};
    row.shared_relative_std = point.shared_relative_std;
    row.tension_spread_N = point.tension_std_N;
    if (one.analysis) {
      const auto& analysis = *one.analysis;
      row.hysteresis_N = analysis.hysteresis_N;
      if (analysis.ends != BeamEnds::tensioned) {
        row.ends = name_of(analysis.ends);
        const auto& slope = analysis.compliance_m_N;
        if (!row.refused) {
          row.stiffness_N_m = {1 / slope.value, slope.std / slope.value / slope.value};
        }
        row.modulus_Pa = bending_modulus(campaign, one);
      }
    }
    rows.push_back(std::move(row));
  }
  return rows;
}

}  // namespace rigfit::ident
