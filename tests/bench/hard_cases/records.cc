// Load-deflection records and points at the ends of what a fit can take: a million samples,
// outliers, noise alone, and laws of EI(T) through too few points.
#include <cmath>
#include <random>
#include <string>

#include "ident/bending/bending_analysis.h"
#include "ident/stiffness/stiffness_law.h"
#include "tests/bench/hard_cases/hard_case.h"

namespace rigfit::hard_cases {
namespace records_area {
namespace {

using namespace ident;

constexpr double kEI = 0.5972, kTension = 200, kSpan = 0.5;

BendingTestOptions span() {
  BendingTestOptions options{.span_m = {kSpan, 0}};
  return options;
}

/// Loading to 1 mm and back; noise of the load cell (N) and the LVDT (m).
BendingRecord record_of(Eigen::Index n, double load_noise, double deflection_noise,
                        std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  BendingRecord record;
  record.tension_N.setConstant(n, kTension);
  record.load_N.resize(n);
  record.deflection_m.resize(n);
  const double stiffness = 1 / midspan_compliance(kEI, kTension, kSpan);
  for (Eigen::Index i = 0; i < n; ++i) {
    const double share = 1 - std::abs(2.0 * static_cast<double>(i) / static_cast<double>(n) - 1);
    record.load_N[i] = stiffness * 1e-3 * share + load_noise * normal(random);
    record.deflection_m[i] = 1e-3 * share + deflection_noise * normal(random);
  }
  return record;
}

std::string reasons(const BendingTestResult& result) {
  std::string text;
  for (const auto& finding : result.findings) {
    if (finding.refused) text += finding.code + ": " + finding.message + "; ";
  }
  return text;
}

void add(Coverage& coverage, const BendingTestResult& result) {
  coverage.require(!result.refused, "refused: " + reasons(result));
  if (result.refused) return;
  const auto& EI = result.stiffness;
  coverage.add(EI.EI_Nm2.value, EI.EI_Nm2.std, EI.low, EI.high, kEI);
}

Outcome a_million_samples(bool) {
  std::mt19937_64 random(3);
  Worst worst;
  const auto result = analyse_bending_test(record_of(1'000'000, 0.01, 1e-6, random), span());
  worst.require(!result.refused, "refused: " + reasons(result));
  const double std = result.stiffness.EI_Nm2.std;
  worst.add(std::abs(result.stiffness.EI_Nm2.value - kEI) / std, 3);
  return worst.outcome("std");
}

/// One sample in twenty with an error of forty standard deviations of the load cell.
Outcome outliers(bool quick) {
  std::mt19937_64 random(4);
  std::uniform_real_distribution<double> uniform;
  Coverage coverage;
  for (int k = 0; k < (quick ? 20 : 100); ++k) {
    BendingRecord record = record_of(400, 0.01, 1e-6, random);
    for (double& load : record.load_N) {
      if (uniform(random) < 0.05) load += uniform(random) < 0.5 ? 0.4 : -0.4;
    }
    add(coverage, analyse_bending_test(record, span()));
  }
  return coverage.outcome();
}

/// Noise alone: no line goes through it.
Outcome only_noise(bool) {
  std::mt19937_64 random(9);
  std::normal_distribution<double> normal;
  int given = 0;
  std::string reason;
  for (int k = 0; k < 20; ++k) {
    BendingRecord record = record_of(200, 0, 0, random);
    for (double& load : record.load_N) load = 5 + 0.01 * normal(random);
    for (double& d : record.deflection_m) d = 1e-6 * normal(random);
    const auto result = analyse_bending_test(record, span());
    if (!result.refused) ++given;
    reason = reasons(result);
    if (reason.rfind("no_", 0) != 0) ++given;
  }
  return refusal(given == 0, reason, "no_");
}

/// Two points: laws with two parameters go through them, the saturating one is left out.
Outcome law_of_two_points(bool) {
  const auto laws =
      fit_stiffness_laws({{100, 0.5, 0.01, 0.48, 0.52}, {300, 0.8, 0.01, 0.78, 0.82}});
  Worst worst;
  for (const auto& law : laws.laws) {
    if (law.kind != LawKind::linear) continue;
    worst.add(std::abs(predict(law, 200).EI_Nm2 - 0.65), 1e-9);
    // (0.5 + 0.8) / 2, each known to 0.01
    worst.add(std::abs(predict(law, 200).std / (0.01 / std::sqrt(2.0)) - 1), 0.05);
  }
  worst.require(!laws.decided, "two points decide between laws");
  return worst.outcome();
}

}  // namespace
}  // namespace records_area

std::vector<HardCase> record_cases() {
  using namespace records_area;
  const std::string area = "records";
  return {
      {area, "a million samples", "EI within three std", a_million_samples},
      {area, "5 % outliers of 40 std", "95 % intervals hold the truth", outliers},
      {area, "noise alone, 20 records", "refused", only_noise},
      {area, "law of EI(T) through two points", "exact, its std; nothing decided",
       law_of_two_points},
  };
}

}  // namespace rigfit::hard_cases
