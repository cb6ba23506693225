#include "ident/axial/axial_identification.h"

#include <fmt/format.h>
#include <gsl/gsl_cdf.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <stdexcept>

#include "ident/axial/axial_average.h"
#include "ident/axial/axial_bound.h"
#include "ident/axial/axial_judgement.h"
#include "ident/axial/axial_monte_carlo.h"
#include "ident/axial/rod_stiffness.h"
#include "ident/statistics/uncertainty.h"
#include "signal/estimation/groups.h"

namespace rigfit::ident {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

RodOnMass rod_of(const AxialSetup& setup, double omega_squared, double length) {
  return {omega_squared,
          setup.mass_kg.value,
          setup.mass_per_length_kg_m.value,
          length,
          setup.adapter_stiffness_N_m.value,
          setup.frame_stiffness_N_m.value};
}

double omega_squared(double damped_frequency_hz, double zeta) {
  const double wd = 2 * std::numbers::pi * damped_frequency_hz;
  return wd * wd / (1 - zeta * zeta);
}

// Variance of one record: what the repeats at one length show, which needs no trust in the fits and
// is Student's; of few repeats, what the fits say where that is more.
struct Repeatability {
  double variance = 0;
  double degrees = 0;  // 0: from the fits
};

Repeatability repeatability(const std::vector<std::vector<double>>& groups,
                            const std::vector<double>& stated) {
  double sum = 0, degrees = 0, mean_stated = 0;
  for (const auto& group : groups) {
    double mean = 0;
    for (double x : group) mean += x / static_cast<double>(group.size());
    for (double x : group) sum += (x - mean) * (x - mean);
    degrees += static_cast<double>(group.size()) - 1;
  }
  for (double v : stated) mean_stated += v / static_cast<double>(stated.size());
  constexpr double kEnough = 5;
  const double seen = degrees > 0 ? sum / degrees : 0;
  // Far below what the fits say are only repeats that are no repeats: copies, rounded values.
  if (seen > mean_stated || (degrees >= kEnough && seen > 0.2 * mean_stated)) {
    return {seen, degrees};
  }
  return {mean_stated, 0};
}

void require(bool good, const std::string& what) {
  if (!good) throw std::invalid_argument("axial test: " + what);
}

bool positive(double x) { return std::isfinite(x) && x > 0; }
bool not_negative(double x) { return std::isfinite(x) && x >= 0; }

void check(std::span<const AxialDecay> decays, const AxialSetup& setup) {
  require(!decays.empty(), "no decays");
  require(positive(setup.mass_kg.value) && not_negative(setup.mass_kg.std),
          "the hung mass must be positive, its uncertainty not negative");
  require(not_negative(setup.mass_per_length_kg_m.value) &&
              not_negative(setup.mass_per_length_kg_m.std),
          "the cable's mass per length must not be negative");
  require(not_negative(setup.length_std_m), "the length's uncertainty must not be negative");
  require(not_negative(setup.adapter_stiffness_N_m.value) &&
              not_negative(setup.adapter_stiffness_N_m.std),
          "the adapter's stiffness must not be negative (0: rigid)");
  require(
      not_negative(setup.frame_stiffness_N_m.value) && not_negative(setup.frame_stiffness_N_m.std),
      "the frame's stiffness must not be negative (0: rigid)");
  require(not_negative(setup.series_compliance_std_m_N.value_or(0)),
          "the compliance's uncertainty must not be negative");
  require(not_negative(setup.catalogue_EA_N), "the catalogue's EA must not be negative");
  for (const auto& d : decays) {
    require(positive(d.length_m), d.name + ": the length must be positive");
    require(positive(d.damped_frequency_hz.value) && not_negative(d.damped_frequency_hz.std),
            d.name + ": the frequency must be positive");
    require(std::isfinite(d.damping_ratio.value) && std::abs(d.damping_ratio.value) < 1 &&
                not_negative(d.damping_ratio.std),
            d.name + ": the damping ratio must lie below 1");
    const double k =
        setup.mass_kg.value * omega_squared(d.damped_frequency_hz.value, d.damping_ratio.value);
    double told = 0;  // compliance
    for (const auto& [what, stiffness] : {std::pair("adapter", setup.adapter_stiffness_N_m.value),
                                          std::pair("frame", setup.frame_stiffness_N_m.value)}) {
      require(stiffness == 0 || stiffness > k,
              fmt::format("{}: the {} ({:.4g} N/m) is softer than cable and {} together "
                          "({:.4g} N/m): check mass and {}",
                          d.name, what, stiffness, what, k, what));
      told += stiffness > 0 ? 1 / stiffness : 0;
    }
    require(told * k < 1, fmt::format("{}: adapter and frame are together softer ({:.4g} N/m) than "
                                      "what was measured ({:.4g} N/m): check mass and both",
                                      d.name, 1 / told, k));
  }
}

// What the result is worked out from, kept for budget and Monte Carlo.
struct Pieces {
  std::vector<AxialLengthData> lengths;
  std::vector<AxialCandidate> candidates;
  double repeat_degrees = 0;
  double zeta_share = 0;  // of the damping ratio in the variance of the records' ln omega^2
};

// EA with other inputs: the candidates' average with the weights kept.
double value_at(const Pieces& pieces, const AxialSetup& setup) {
  double sum = 0;
  for (const auto& c : pieces.candidates) {
    const auto fit = fit_axial(pieces.lengths, setup, c.fit.series, c.fit.between_std, c.fit.EA_N);
    sum += c.weight * (fit.converged ? fit.EA_N : kNan);
  }
  return sum;
}

double sensitivity(const Pieces& pieces, const AxialSetup& setup, signal::Estimate AxialSetup::*at,
                   double step) {
  AxialSetup up = setup, down = setup;
  (up.*at).value += step, (down.*at).value -= step;
  return (value_at(pieces, up) - value_at(pieces, down)) / (2 * step);
}

double sensitivity_to_lengths(Pieces pieces, const AxialSetup& setup, double step) {
  for (auto& one : pieces.lengths) one.length_m += step;
  const double up = value_at(pieces, setup);
  for (auto& one : pieces.lengths) one.length_m -= 2 * step;
  return (up - value_at(pieces, setup)) / (2 * step);
}

// Rows of the inputs, of the average of the candidates; what they differ by is a row of its own.
// All are brought to the standard uncertainty of the mixture.
void budget_of(AxialTestResult& result, const AxialSetup& setup, const Pieces& pieces) {
  std::map<std::string, double> variance;
  double between_models = 0;
  bool series = false;
  for (const auto& c : pieces.candidates) {
    for (const auto& part : c.fit.contributions) {
      variance[part.source] += c.weight * part.variance * c.fit.EA_N * c.fit.EA_N;
    }
    between_models += c.weight * std::pow(c.fit.EA_N - result.EA_N.value, 2);
    series = series || c.fit.series;
  }
  double total = between_models;
  for (const auto& [source, v] : variance) total += v;
  const double scale = total > 0 ? result.EA_N.std * result.EA_N.std / total : 0;
  const auto add = [&](const char* source, const char* unit, double value, double std, double by,
                       double raw, char type, double degrees) {
    BudgetRow row;
    row.source = source, row.unit = unit, row.value = value, row.std = std;
    row.sensitivity = by, row.contribution_N = std::sqrt(scale * raw);
    row.share = total > 0 ? raw / total : 0;
    row.type = type, row.degrees_of_freedom = degrees;
    result.budget.push_back(row);
  };
  double f = 0;
  for (const auto& one : pieces.lengths) {
    f += std::exp(0.5 * one.log_omega_squared) / (2 * std::numbers::pi * pieces.lengths.size());
  }
  const double by_f = 2 * result.EA_N.value / f;
  const double frequency = variance["frequency"] * (1 - pieces.zeta_share);
  add("frequency", "Hz", f, std::sqrt(frequency) / by_f, by_f, frequency, 'A',
      pieces.repeat_degrees);
  const double zeta = result.damping_ratio.value;
  const double by_zeta = result.EA_N.value * 2 * zeta / (1 - zeta * zeta);
  const double of_zeta = variance["frequency"] * pieces.zeta_share;
  add("damping ratio", "1", zeta, by_zeta != 0 ? std::sqrt(of_zeta) / std::abs(by_zeta) : 0,
      by_zeta, of_zeta, 'A', pieces.repeat_degrees);
  const auto input = [&](const char* source, const char* unit, signal::Estimate AxialSetup::*at,
                         double step) {
    add(source, unit, (setup.*at).value, (setup.*at).std,
        step > 0 ? sensitivity(pieces, setup, at, step) : 0, variance[source], 'B', 0);
  };
  const double mass = setup.mass_kg.value;
  input("hung mass", "kg", &AxialSetup::mass_kg, 1e-4 * mass);
  input("cable mass per length", "kg/m", &AxialSetup::mass_per_length_kg_m,
        1e-4 * std::max(setup.mass_per_length_kg_m.value, 1e-3 * mass));
  add("length", "m", result.reference_length_m, setup.length_std_m,
      sensitivity_to_lengths(pieces, setup, 1e-4 * result.lengths.front().length_m),
      variance["length"], 'B', 0);
  input("adapter stiffness", "N/m", &AxialSetup::adapter_stiffness_N_m,
        1e-4 * setup.adapter_stiffness_N_m.value);
  input("frame stiffness", "N/m", &AxialSetup::frame_stiffness_N_m,
        1e-4 * setup.frame_stiffness_N_m.value);
  if (series) {
    if (setup.series_compliance_std_m_N) {
      add("compliance in series", "m/N", 0, *setup.series_compliance_std_m_N,
          std::sqrt(variance["compliance in series"]) / *setup.series_compliance_std_m_N,
          variance["compliance in series"], 'B', 0);
    }
    const double v = variance["place of the compliance"];
    add("place of the compliance", "1", 0.5, 0.5, 2 * std::sqrt(v), v, 'B', 0);
    add("compliance or none", "N", kNan, std::sqrt(between_models), 1, between_models, 'B', 0);
  }
  const auto& best = pieces.candidates.front().fit;
  add("between lengths", "N", kNan, best.between_std * best.EA_N, 1, variance["between lengths"],
      'A', std::max(1.0, static_cast<double>(best.degrees)));
  std::stable_sort(result.budget.begin(), result.budget.end(),
                   [](const BudgetRow& a, const BudgetRow& b) { return a.share > b.share; });
}

void alternatives_of(AxialTestResult& result, const Pieces& pieces, double coverage) {
  for (const auto& c : pieces.candidates) {
    AxialAlternative a;
    a.name = c.fit.series ? "compliance in series" : "cable alone";
    if (c.fit.between_std > 0) a.name += ", lengths scatter";
    a.weight = c.weight;
    a.EA_N = {c.fit.EA_N, c.fit.EA_N * c.fit.EA_relative_std};
    AxialCandidate whole = c;
    whole.weight = 1;
    const std::span<const AxialCandidate> one(&whole, 1);
    a.EA_low_N = axial_quantile(one, 0.5 - 0.5 * coverage);
    a.EA_high_N = axial_quantile(one, 0.5 + 0.5 * coverage);
    a.series_compliance_m_N = {c.fit.compliance_m_N, c.fit.compliance_std_m_N};
    a.between_lengths_std_N = c.fit.between_std * c.fit.EA_N;
    a.chi2 = c.fit.chi2, a.degrees_of_freedom = c.fit.degrees;
    result.alternatives.push_back(a);
    // Of either kind the heaviest: candidates are in the order of their weights.
    if (!c.fit.series && !(result.plain_EA_N > 0)) result.plain_EA_N = c.fit.EA_N;
    if (c.fit.series && !std::isfinite(result.EA_without_series_N)) {
      result.EA_without_series_N = c.fit.EA_N;
      result.series_compliance_m_N = a.series_compliance_m_N;
    }
  }
}

// EA with its interval, from the mixture of the candidates.
void average(AxialTestResult& result, const AxialSetup& setup, const AxialOptions& options,
             const Pieces& pieces) {
  const auto& all = pieces.candidates;
  result.EA_N.value = axial_quantile(all, 0.5);
  const double one = 0.5 * std::erf(std::sqrt(0.5));
  result.EA_N.std = 0.5 * (axial_quantile(all, 0.5 + one) - axial_quantile(all, 0.5 - one));
  result.EA_low_N = axial_quantile(all, 0.5 - 0.5 * options.coverage);
  result.EA_high_N = axial_quantile(all, 0.5 + 0.5 * options.coverage);
  result.coverage_factor = result.EA_N.std > 0
                               ? (result.EA_high_N - result.EA_low_N) / (2 * result.EA_N.std)
                               : coverage_factor(options.coverage, 0);
  result.degrees_of_freedom = all.front().degrees;
  result.between_lengths_std_N = all.front().fit.between_std * all.front().fit.EA_N;
  alternatives_of(result, pieces, options.coverage);
  budget_of(result, setup, pieces);
  if (options.draws <= 0) return;
  const auto values = axial_monte_carlo(pieces.lengths, setup, all, pieces.repeat_degrees,
                                        options.draws, options.seed);
  if (values.size() < 100) return;
  const auto at = [&](double p) {
    const double n = static_cast<double>(values.size());
    return values[static_cast<std::size_t>(std::clamp(p * n, 0.0, n - 1))];
  };
  result.draws = static_cast<int>(values.size());
  result.monte_carlo_EA_N = {at(0.5), 0.5 * (at(0.5 + one) - at(0.5 - one))};
  result.monte_carlo_low_N = at(0.5 - 0.5 * options.coverage);
  result.monte_carlo_high_N = at(0.5 + 0.5 * options.coverage);
}

// c = 2 zeta sqrt(k M) at the mean length.
void damper_of(AxialTestResult& result, const AxialSetup& setup) {
  double s = 0;
  for (const double told : {setup.adapter_stiffness_N_m.value, setup.frame_stiffness_N_m.value}) {
    s += told > 0 ? 1 / told : 0;
  }
  for (const auto& a : result.alternatives) s += a.weight * a.series_compliance_m_N.value;
  const double own = result.reference_length_m / result.EA_N.value;
  const double k = 1 / std::max(own + s, 1e-6 * own);
  const double zeta = result.damping_ratio.value;
  const double by_zeta = 2 * std::sqrt(k * setup.mass_kg.value);
  const double c = by_zeta * zeta;
  // The chain's stiffness is that measured: it goes with the mass, and so c is proportional to it.
  // What the cable's part of it is known to adds nothing but is left in, as an upper limit.
  const double by_EA = 0.5 * c * k * own * result.EA_N.std / result.EA_N.value;
  const double by_mass = c * setup.mass_kg.std / setup.mass_kg.value;
  result.damping_Ns_m = {c, std::hypot(by_zeta * result.damping_ratio.std, by_EA, by_mass)};
}

}  // namespace

AxialTestResult axial_test(std::span<const AxialDecay> decays, const AxialSetup& setup,
                           const AxialOptions& options) {
  check(decays, setup);
  AxialTestResult result;
  result.series_compliance_m_N = {kNan, kNan};
  result.EA_without_series_N = kNan;
  Pieces pieces;
  std::map<double, std::vector<std::size_t>> by_length;
  std::vector<double> stated_log, stated_zeta;  // variances of ln omega^2 and of zeta, each record
  std::vector<double> log_omega2;
  for (std::size_t i = 0; i < decays.size(); ++i) {
    const auto& d = decays[i];
    by_length[d.length_m].push_back(i);
    const double zeta = d.damping_ratio.value;
    const double W = omega_squared(d.damped_frequency_hz.value, zeta);
    const auto s = rod_stiffness(rod_of(setup, W, d.length_m));
    log_omega2.push_back(std::log(W));
    const double by_f = 2 * d.damped_frequency_hz.std / d.damped_frequency_hz.value;
    const double by_zeta = 2 * zeta / (1 - zeta * zeta) * d.damping_ratio.std;
    stated_log.push_back(by_f * by_f + by_zeta * by_zeta);
    stated_zeta.push_back(d.damping_ratio.std * d.damping_ratio.std);
    if (stated_log.back() > 0) {
      pieces.zeta_share +=
          by_zeta * by_zeta / stated_log.back() / static_cast<double>(decays.size());
    }
    AxialSample sample;
    sample.name = d.name, sample.length_m = d.length_m;
    sample.stiffness_N_m = s.series_N_m, sample.cable_stiffness_N_m = s.cable_N_m;
    const double EA = s.cable_N_m * d.length_m;
    sample.EA_N = {EA, EA * s.by_omega_squared * std::sqrt(stated_log.back())};
    sample.damping_ratio = d.damping_ratio;
    sample.damping_Ns_m = 2 * zeta * std::sqrt(s.series_N_m * setup.mass_kg.value);
    result.samples.push_back(std::move(sample));
  }
  std::vector<std::vector<double>> log_groups, zeta_groups;
  for (const auto& [length, members] : by_length) {
    log_groups.emplace_back(), zeta_groups.emplace_back();
    for (std::size_t i : members) {
      log_groups.back().push_back(log_omega2[i]);
      zeta_groups.back().push_back(decays[i].damping_ratio.value);
    }
  }
  const auto repeat = repeatability(log_groups, stated_log);
  const auto repeat_zeta = repeatability(zeta_groups, stated_zeta);
  pieces.repeat_degrees = repeat.degrees;

  std::vector<double> EA, EA_variance, zeta, zeta_variance;
  std::size_t g = 0;
  for (const auto& [length, members] : by_length) {
    const double count = static_cast<double>(members.size());
    double mean_log = 0, mean_zeta = 0;
    for (double x : log_groups[g]) mean_log += x / count;
    for (double x : zeta_groups[g]) mean_zeta += x / count;
    ++g;
    const auto rod = rod_stiffness(rod_of(setup, std::exp(mean_log), length));
    const double std = std::sqrt(repeat.variance / count);
    AxialLength l;
    l.length_m = length, l.records = static_cast<int>(members.size());
    l.EA_N.value = rod.cable_N_m * length;
    l.EA_N.std = l.EA_N.value * std::hypot(rod.by_omega_squared * std,
                                           (1 + rod.by_length) * setup.length_std_m / length);
    l.damping_ratio = {mean_zeta, std::sqrt(repeat_zeta.variance / count)};
    l.damping_Ns_m = 2 * mean_zeta * std::sqrt(rod.series_N_m * setup.mass_kg.value);
    pieces.lengths.push_back({length, mean_log, std});
    EA.push_back(l.EA_N.value);
    EA_variance.push_back(std::max(l.EA_N.std * l.EA_N.std, 1e-24 * l.EA_N.value * l.EA_N.value));
    zeta.push_back(mean_zeta);
    zeta_variance.push_back(std::max(repeat_zeta.variance / count, 1e-24));
    result.lengths.push_back(l);
    result.reference_length_m += length / static_cast<double>(by_length.size());
  }
  result.cochran_Q = signal::mean_over_groups(EA, EA_variance).cochran_Q;
  if (EA.size() > 1) {
    result.homogeneity_p = gsl_cdf_chisq_Q(result.cochran_Q, static_cast<double>(EA.size()) - 1);
  }
  const auto damping = signal::mean_over_groups(zeta, zeta_variance);
  result.damping_ratio = {damping.mean, std::sqrt(damping.variance)};
  const double zeta_degrees = damping.degrees > 0 ? damping.degrees : repeat_zeta.degrees;
  const double zeta_factor = coverage_factor(options.coverage, zeta_degrees);
  result.damping_low = damping.mean - zeta_factor * result.damping_ratio.std;
  result.damping_high = damping.mean + zeta_factor * result.damping_ratio.std;

  bool too_close = false;
  pieces.candidates =
      axial_candidates(pieces.lengths, setup, pieces.repeat_degrees, options.coverage, too_close);
  require(!pieces.candidates.empty(), "no EA fits these frequencies: check mass and lengths");
  result.conditional = !setup.series_compliance_std_m_N && !setup.frame_stated &&
                       (result.lengths.size() < 2 || too_close);
  average(result, setup, options, pieces);
  damper_of(result, setup);
  if (pieces.lengths.size() == 1) {
    result.assembly_stiffness_N_m = assembly_stiffness(pieces.lengths.front(), setup);
  }
  if (result.conditional) {
    bound_axial(axial_quantile(pieces.candidates, 1 - options.coverage), setup, options, result);
  }
  judge_axial(result, setup, options);
  return result;
}

}  // namespace rigfit::ident
