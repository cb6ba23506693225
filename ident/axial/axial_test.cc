#include "ident/axial/axial_test.h"

#include <fmt/format.h>
#include <gsl/gsl_cdf.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <random>
#include <stdexcept>

#include "ident/axial/rod_stiffness.h"
#include "ident/statistics/random_effects.h"
#include "ident/statistics/uncertainty.h"

namespace rigfit::ident {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

RodOnMass rod_of(const AxialSetup& setup, double omega_squared, double length) {
  return {omega_squared, setup.mass_kg.value, setup.mass_per_length_kg_m.value, length,
          setup.adapter_stiffness_N_m.value};
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
    require(setup.adapter_stiffness_N_m.value == 0 || setup.adapter_stiffness_N_m.value > k,
            fmt::format("{}: the adapter ({:.4g} N/m) is softer than cable and adapter together "
                        "({:.4g} N/m): check mass and adapter",
                        d.name, setup.adapter_stiffness_N_m.value, k));
  }
}

struct Pieces {  // what the result is worked out from, kept for the Monte Carlo
  std::vector<double> lengths, omega2;  // mean undamped omega^2 of each length
  std::vector<double> by_omega2;        // d ln kc / d ln omega^2
  std::vector<double> repeat_relative;  // relative std of EA_i from repeats
  RandomEffects pooled;
  double repeat_degrees = 0;
};

void budget_of(AxialTestResult& result, const AxialSetup& setup, const Pieces& pieces,
               double coverage, double repeat_variance_share_zeta) {
  double mass = 0, per_length = 0, adapter = 0, length_variance = 0, repeat_variance = 0;
  double frequency_sensitivity = 0, mean_frequency = 0, length_sensitivity = 0;
  for (std::size_t i = 0; i < pieces.lengths.size(); ++i) {
    const double L = pieces.lengths[i], W = pieces.omega2[i], w = pieces.pooled.weights[i];
    const auto s = rod_stiffness(rod_of(setup, W, L));
    const double EA = s.cable_N_m * L;
    mass += w * EA * s.by_mass / setup.mass_kg.value;
    const double m = setup.mass_per_length_kg_m.value;
    // By the rod's limit for a massless cable, where the relative derivative vanishes.
    per_length += m > 0 ? w * EA * s.by_mass_per_length / m : w * EA * W * L / (3 * s.cable_N_m);
    if (setup.adapter_stiffness_N_m.value > 0) {
      adapter += w * EA * s.by_adapter / setup.adapter_stiffness_N_m.value;
    }
    const double by_length = EA * (1 + s.by_length) / L;
    length_sensitivity += w * by_length;
    length_variance += std::pow(w * by_length * setup.length_std_m, 2);
    repeat_variance += std::pow(w * pieces.repeat_relative[i] * EA, 2);
    const double f = std::sqrt(W) / (2 * std::numbers::pi);
    mean_frequency += w * f;
    frequency_sensitivity += w * EA * s.by_omega_squared * 2 / f;
  }
  const auto add = [&](const char* source, const char* unit, double value, double std,
                       double sensitivity, double variance, char type, double degrees) {
    BudgetRow row;
    row.source = source, row.unit = unit, row.value = value, row.std = std;
    row.sensitivity = sensitivity, row.contribution_N = std::sqrt(variance);
    row.type = type, row.degrees_of_freedom = degrees;
    result.budget.push_back(row);
  };
  const double zeta_part = repeat_variance * repeat_variance_share_zeta;
  const double frequency_part = repeat_variance - zeta_part;
  add("frequency", "Hz", mean_frequency, std::sqrt(frequency_part) / frequency_sensitivity,
      frequency_sensitivity, frequency_part, 'A', pieces.repeat_degrees);
  const double zeta = result.damping_ratio.value;
  const double zeta_sensitivity = result.EA_N.value * 2 * zeta / (1 - zeta * zeta);
  add("damping ratio", "1", zeta,
      zeta_sensitivity != 0 ? std::sqrt(zeta_part) / std::abs(zeta_sensitivity) : 0,
      zeta_sensitivity, zeta_part, 'A', pieces.repeat_degrees);
  add("hung mass", "kg", setup.mass_kg.value, setup.mass_kg.std, mass,
      std::pow(mass * setup.mass_kg.std, 2), 'B', 0);
  add("cable mass per length", "kg/m", setup.mass_per_length_kg_m.value,
      setup.mass_per_length_kg_m.std, per_length,
      std::pow(per_length * setup.mass_per_length_kg_m.std, 2), 'B', 0);
  add("length", "m", result.reference_length_m, setup.length_std_m, length_sensitivity,
      length_variance, 'B', 0);
  add("adapter stiffness", "N/m", setup.adapter_stiffness_N_m.value,
      setup.adapter_stiffness_N_m.std, adapter,
      std::pow(adapter * setup.adapter_stiffness_N_m.std, 2), 'B', 0);
  double between = 0;
  for (double w : pieces.pooled.weights) between += w * w * pieces.pooled.between_variance;
  add("between lengths", "N", kNan, std::sqrt(pieces.pooled.between_variance), 1, between, 'A',
      static_cast<double>(pieces.lengths.size()) - 1);
  // Lengths that disagree: their mean's whole variance rests on their scatter (random_effects.h).
  const double scattering = pieces.pooled.degrees > 0 ? pieces.pooled.variance : 0;
  double total = 0, satterthwaite = 0;
  if (scattering > 0) satterthwaite = scattering * scattering / pieces.pooled.degrees;
  for (const auto& row : result.budget) {
    const double v = row.contribution_N * row.contribution_N;
    total += v;
    if (scattering == 0 && row.degrees_of_freedom > 0) {
      satterthwaite += v * v / row.degrees_of_freedom;
    }
  }
  for (auto& row : result.budget) {
    row.share = total > 0 ? row.contribution_N * row.contribution_N / total : 0;
  }
  std::stable_sort(result.budget.begin(), result.budget.end(),
                   [](const BudgetRow& a, const BudgetRow& b) { return a.share > b.share; });
  result.EA_N.std = std::sqrt(total);
  result.degrees_of_freedom =
      satterthwaite > 1e-9 * total * total ? total * total / satterthwaite : 0;
  // One factor by Welch and Satterthwaite falls short when a part known to two degrees of freedom
  // comes out small by chance; expanded uncertainties of what scatters and of the rest are added in
  // squares instead (R. Willink, Metrologia 44 (2007) 340).
  const double of_scatter = coverage_factor(coverage, pieces.pooled.degrees);
  const double of_rest = coverage_factor(coverage, 0);
  result.coverage_factor = coverage_factor(coverage, result.degrees_of_freedom);
  if (scattering > 0) {
    result.coverage_factor = std::sqrt(
        (of_scatter * of_scatter * scattering + of_rest * of_rest * (total - scattering)) / total);
  }
}

void monte_carlo(AxialTestResult& result, const AxialSetup& setup, const AxialOptions& options,
                 const Pieces& pieces) {
  std::mt19937_64 generator(options.seed);
  std::normal_distribution<double> normal;
  const auto student = [&](double degrees) {  // common factor of a component known to few degrees
    if (!(degrees > 0)) return 1.0;
    std::chi_squared_distribution<double> chi2(degrees);
    return std::sqrt(degrees / chi2(generator));
  };
  std::vector<double> values;
  values.reserve(static_cast<std::size_t>(options.draws));
  for (int d = 0; d < options.draws; ++d) {
    RodOnMass rod = rod_of(setup, 0, 0);
    rod.mass_kg += setup.mass_kg.std * normal(generator);
    rod.mass_per_length_kg_m += setup.mass_per_length_kg_m.std * normal(generator);
    if (rod.adapter_N_m > 0) rod.adapter_N_m += setup.adapter_stiffness_N_m.std * normal(generator);
    const double scatter = student(pieces.pooled.degrees);
    const double repeat = pieces.pooled.degrees > 0 ? scatter : student(pieces.repeat_degrees);
    const double between = scatter * std::sqrt(pieces.pooled.between_variance);
    double EA = 0;
    for (std::size_t i = 0; i < pieces.lengths.size(); ++i) {
      rod.length_m = pieces.lengths[i] + scatter * setup.length_std_m * normal(generator);
      rod.omega_squared = pieces.omega2[i] * (1 + repeat * pieces.repeat_relative[i] /
                                                      pieces.by_omega2[i] * normal(generator));
      EA += pieces.pooled.weights[i] *
            (rod_stiffness(rod).cable_N_m * rod.length_m + between * normal(generator));
    }
    if (std::isfinite(EA) && EA > 0) values.push_back(EA);
  }
  if (values.size() < 100) return;
  std::sort(values.begin(), values.end());
  double mean = 0, squares = 0;
  const double n = static_cast<double>(values.size());
  for (double v : values) mean += v / n;
  for (double v : values) squares += (v - mean) * (v - mean) / (n - 1);
  const auto at = [&](double p) {
    return values[static_cast<std::size_t>(std::clamp(p * n, 0.0, n - 1))];
  };
  result.draws = static_cast<int>(values.size());
  result.monte_carlo_EA_N = {mean, std::sqrt(squares)};
  result.monte_carlo_low_N = at(0.5 - 0.5 * options.coverage);
  result.monte_carlo_high_N = at(0.5 + 0.5 * options.coverage);
}

// 1/kc = L / EA + s over the lengths: a compliance that does not grow with length is not the
// cable's.
void series_line(AxialTestResult& result) {
  result.series_compliance_m_N = {kNan, kNan};
  result.EA_without_series_N = kNan;
  if (result.lengths.size() < 2) return;
  double sw = 0, sx = 0, sy = 0;
  for (const auto& l : result.lengths) {
    const double y = l.length_m / l.EA_N.value;
    const double w = 1 / std::pow(std::max(y * l.EA_N.std / l.EA_N.value, 1e-12 * y), 2);
    sw += w, sx += w * l.length_m, sy += w * y;
  }
  double sxx = 0, sxy = 0;
  const double mx = sx / sw, my = sy / sw;
  for (const auto& l : result.lengths) {
    const double y = l.length_m / l.EA_N.value;
    const double w = 1 / std::pow(std::max(y * l.EA_N.std / l.EA_N.value, 1e-12 * y), 2);
    sxx += w * (l.length_m - mx) * (l.length_m - mx), sxy += w * (l.length_m - mx) * (y - my);
  }
  const double slope = sxy / sxx, level = my - slope * mx;
  double chi2 = 0;
  for (const auto& l : result.lengths) {
    const double y = l.length_m / l.EA_N.value;
    const double std = std::max(y * l.EA_N.std / l.EA_N.value, 1e-12 * y);
    chi2 += std::pow((y - level - slope * l.length_m) / std, 2);
  }
  const double spare = static_cast<double>(result.lengths.size()) - 2;
  const double excess = spare > 0 ? std::max(1.0, chi2 / spare) : 1;
  result.series_compliance_m_N = {level, std::sqrt(excess * (1 / sw + mx * mx / sxx))};
  result.EA_without_series_N = slope > 0 ? 1 / slope : kNan;
}

void judge(AxialTestResult& result, const AxialSetup& setup, const AxialOptions& options) {
  const auto note = [&](const char* code, std::string message) {
    result.notes.push_back({code, std::move(message), ""});
  };
  if (result.lengths.size() < 2) {
    note("one_length",
         "one length only: whether EA is the same for others, and whether something "
         "else gives way in series, cannot be seen");
  } else if (result.homogeneity_p < 0.05) {
    note("lengths_disagree",
         fmt::format(
             "EA differs between lengths by more than their uncertainties (Cochran's Q {:.3g}, "
             "p = {:.2g}): a scatter of {:.3g} N between lengths is in the uncertainty",
             result.cochran_Q, result.homogeneity_p, result.between_lengths_std_N));
  }
  const auto& s = result.series_compliance_m_N;
  if (std::isfinite(s.value) && std::abs(s.value) > 3 * s.std) {
    note(
        "series_compliance",
        s.value > 0
            ? fmt::format(
                  "the lengths show a compliance in series of {:.3g} m/N (std {:.2g}): grips, load "
                  "cell or frame give way; without it EA would be {:.4g} N",
                  s.value, s.std, result.EA_without_series_N)
            : fmt::format(
                  "stiffness falls faster with length than a cable's does (compliance in series "
                  "{:.3g} m/N, negative): lengths, or the adapter's stiffness, are wrong",
                  s.value));
  }
  result.catalogue_EA_N = setup.catalogue_EA_N > 0
                              ? setup.catalogue_EA_N
                              : setup.mass_per_length_kg_m.value / options.steel_density_kg_m3 *
                                    options.rope_modulus_Pa;
  if (!(result.catalogue_EA_N > 0)) return;
  result.share_of_catalogue = result.EA_N.value / result.catalogue_EA_N;
  std::string origin =
      setup.catalogue_EA_N > 0
          ? "the catalogue's"
          : fmt::format("what {:.0f} GPa on the metal of this mass per length gives",
                        options.rope_modulus_Pa / 1e9);
  result.plausibility =
      fmt::format("EA = {:.4g} kN is {:.0f} % of {:.4g} kN, {}", 1e-3 * result.EA_N.value,
                  100 * result.share_of_catalogue, 1e-3 * result.catalogue_EA_N, origin);
  if (result.share_of_catalogue < 0.5) {
    const double L = result.reference_length_m;
    const double missing = L / result.EA_N.value - L / result.catalogue_EA_N;
    result.plausibility += fmt::format(
        ": a strand this slack is seen at tensions far below its working load, or something in "
        "series "
        "gives way by {:.2g} µm/N",
        1e6 * missing);
    if (std::isfinite(s.value)) {
      result.plausibility += s.value + 2 * s.std < missing
                                 ? fmt::format(" (the lengths allow {:.2g} µm/N of it at most)",
                                               1e6 * std::max(0.0, s.value + 2 * s.std))
                                 : " (which the lengths do not rule out)";
    }
    note("below_catalogue", result.plausibility);
  } else if (result.share_of_catalogue > 1.3) {
    result.plausibility +=
        ": stiffer than a rope of that much steel; check mass, length and frequency";
    note("above_catalogue", result.plausibility);
  }
}

}  // namespace

AxialTestResult axial_test(std::span<const AxialDecay> decays, const AxialSetup& setup,
                           const AxialOptions& options) {
  check(decays, setup);
  AxialTestResult result;
  Pieces pieces;
  std::map<double, std::vector<std::size_t>> by_length;
  std::vector<double> stated_log, stated_zeta;  // variances of ln EA and of zeta, each record
  std::vector<double> log_omega2;
  double zeta_share = 0;
  for (std::size_t i = 0; i < decays.size(); ++i) {
    const auto& d = decays[i];
    by_length[d.length_m].push_back(i);
    const double zeta = d.damping_ratio.value;
    const double W = omega_squared(d.damped_frequency_hz.value, zeta);
    const auto s = rod_stiffness(rod_of(setup, W, d.length_m));
    log_omega2.push_back(std::log(W));
    AxialSample sample;
    sample.name = d.name, sample.length_m = d.length_m;
    sample.stiffness_N_m = s.series_N_m, sample.cable_stiffness_N_m = s.cable_N_m;
    const double amplify = s.by_omega_squared;
    const double by_f = amplify * 2 * d.damped_frequency_hz.std / d.damped_frequency_hz.value;
    const double by_zeta = amplify * 2 * zeta / (1 - zeta * zeta) * d.damping_ratio.std;
    stated_log.push_back(by_f * by_f + by_zeta * by_zeta);
    stated_zeta.push_back(d.damping_ratio.std * d.damping_ratio.std);
    if (stated_log.back() > 0) {
      zeta_share += by_zeta * by_zeta / stated_log.back() / static_cast<double>(decays.size());
    }
    sample.EA_N = {s.cable_N_m * d.length_m,
                   s.cable_N_m * d.length_m * std::sqrt(stated_log.back())};
    sample.damping_ratio = d.damping_ratio;
    sample.damping_Ns_m = 2 * zeta * std::sqrt(s.series_N_m * setup.mass_kg.value);
    result.samples.push_back(std::move(sample));
  }
  std::vector<std::vector<double>> log_groups, zeta_groups;
  for (const auto& [length, members] : by_length) {
    log_groups.emplace_back(), zeta_groups.emplace_back();
    for (std::size_t i : members) {
      log_groups.back().push_back(std::log(result.samples[i].EA_N.value));
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
    AxialLength l;
    l.length_m = length, l.records = static_cast<int>(members.size());
    l.EA_N.value = std::exp(mean_log);
    double mean_log_omega2 = 0;
    for (std::size_t i : members) mean_log_omega2 += log_omega2[i] / count;
    const double W = std::exp(mean_log_omega2);
    const auto rod = rod_stiffness(rod_of(setup, W, length));
    const double relative = std::sqrt(repeat.variance / count);
    const double by_length_std = l.EA_N.value / length * (1 + rod.by_length) * setup.length_std_m;
    l.EA_N.std = std::hypot(relative * l.EA_N.value, by_length_std);
    l.damping_ratio = {mean_zeta, std::sqrt(repeat_zeta.variance / count)};
    l.damping_Ns_m = 2 * mean_zeta * std::sqrt(rod.series_N_m * setup.mass_kg.value);
    pieces.lengths.push_back(length);
    pieces.omega2.push_back(W);
    pieces.by_omega2.push_back(rod.by_omega_squared);
    pieces.repeat_relative.push_back(relative);
    EA.push_back(l.EA_N.value);
    // Where neither records nor lengths have any uncertainty, equal weights.
    EA_variance.push_back(std::max(l.EA_N.std * l.EA_N.std, 1e-24 * l.EA_N.value * l.EA_N.value));
    zeta.push_back(mean_zeta);
    zeta_variance.push_back(std::max(repeat_zeta.variance / count, 1e-24));
    result.lengths.push_back(l);
    result.reference_length_m += length / static_cast<double>(by_length.size());
  }
  pieces.pooled = pool_groups(EA, EA_variance);
  const auto damping = pool_groups(zeta, zeta_variance);
  const double between_degrees = static_cast<double>(EA.size()) - 1;
  result.EA_N.value = pieces.pooled.mean;
  result.between_lengths_std_N = std::sqrt(pieces.pooled.between_variance);
  result.cochran_Q = pieces.pooled.cochran_Q;
  if (EA.size() > 1)
    result.homogeneity_p = gsl_cdf_chisq_Q(pieces.pooled.cochran_Q, between_degrees);

  result.damping_ratio = {damping.mean, std::sqrt(damping.variance)};
  const double zeta_degrees = damping.degrees > 0 ? damping.degrees : repeat_zeta.degrees;
  const double zeta_factor = coverage_factor(options.coverage, zeta_degrees);
  result.damping_low = damping.mean - zeta_factor * result.damping_ratio.std;
  result.damping_high = damping.mean + zeta_factor * result.damping_ratio.std;

  budget_of(result, setup, pieces, options.coverage, zeta_share);
  result.EA_low_N = result.EA_N.value - result.coverage_factor * result.EA_N.std;
  result.EA_high_N = result.EA_N.value + result.coverage_factor * result.EA_N.std;

  // Damper of the mean length: c = 2 zeta sqrt(k M).
  const double kc = result.EA_N.value / result.reference_length_m;
  const double adapter = setup.adapter_stiffness_N_m.value;
  const double k = adapter > 0 ? 1 / (1 / kc + 1 / adapter) : kc;
  const double c = 2 * damping.mean * std::sqrt(k * setup.mass_kg.value);
  const double by_EA = 0.5 * c * (k / kc) * result.EA_N.std / result.EA_N.value;
  const double by_mass = 0.5 * c * setup.mass_kg.std / setup.mass_kg.value;
  const double by_zeta = damping.mean != 0
                             ? c * result.damping_ratio.std / damping.mean
                             : 2 * std::sqrt(k * setup.mass_kg.value) * result.damping_ratio.std;
  // EA itself is proportional to the mass: its share of EA's uncertainty goes with the mass's own.
  double mass_share = 0;
  for (const auto& row : result.budget) {
    if (row.source == "hung mass") mass_share = row.share;
  }
  const double together = by_EA * std::sqrt(mass_share) + by_mass;
  result.damping_Ns_m = {
      c, std::sqrt(by_zeta * by_zeta + by_EA * by_EA * (1 - mass_share) + together * together)};
  if (options.draws > 0) monte_carlo(result, setup, options, pieces);
  series_line(result);
  judge(result, setup, options);
  return result;
}

}  // namespace rigfit::ident
