#include "ident/axial/axial_identification.h"

#include <fmt/format.h>
#include <gsl/gsl_cdf.h>
#include <gsl/gsl_statistics_double.h>

#include "ident/statistics/root.h"
#include "ident/statistics/uncertainty.h"
#include "signal/estimation/groups.h"

namespace rigfit::ident {
namespace {

constexpr double kLengthStd = 1e-3;     // m, stands for one that is not given; never shown as one
constexpr double kSteelDensity = 7850;  // kg/m3
// A stranded rope has it over its metallic area (makers give 60 to 100 GPa for 7x19), and solid
// steel has it: no steel cable is stiffer for its mass, and no aluminium one.
constexpr double kRopeModulus = 80e9, kSolidModulus = 210e9;  // Pa
constexpr double kDetermined = 0.25;  // relative std from which on the slope says nothing of EA

void require(bool good, const std::string& what) {
  if (!good) throw std::invalid_argument("axial test: " + what);
}

bool positive(double x) { return std::isfinite(x) && x > 0; }
bool not_negative(double x) { return std::isfinite(x) && x >= 0; }
bool not_negative(const Estimate& x) { return not_negative(x.value) && not_negative(x.std); }

double omega_squared(const AxialDecay& d) {
  const double wd = kTwoPi * d.damped_frequency_hz.value;
  return wd * wd / (1 - d.damping_ratio.value * d.damping_ratio.value);
}

double told_compliance(const AxialSetup& setup) {
  double sum = 0;
  for (double k : {setup.adapter_stiffness_N_m.value, setup.frame_stiffness_N_m.value}) {
    sum += k > 0 ? 1 / k : 0;
  }
  return sum;
}

void check(std::span<const AxialDecay> decays, const AxialSetup& setup) {
  require(!decays.empty(), "no decays");
  require(positive(setup.mass_kg.value) && not_negative(setup.mass_kg.std),
          "the hung mass must be positive, its uncertainty not negative");
  require(not_negative(setup.mass_per_length_kg_m),
          "the cable's mass per length must not be negative");
  require(not_negative(setup.length_std_m.value_or(0)),
          "the length's uncertainty must not be negative");
  require(not_negative(setup.adapter_stiffness_N_m) && not_negative(setup.frame_stiffness_N_m),
          "the stiffness of adapter and frame must not be negative (0: rigid)");
  require(not_negative(setup.series_compliance_std_m_N.value_or(0)),
          "the compliance's uncertainty must not be negative");
  require(not_negative(setup.catalogue_EA_N), "the catalogue's EA must not be negative");
  for (const auto& d : decays) {
    require(positive(d.length_m), d.name + ": the length must be positive");
    require(positive(d.damped_frequency_hz.value) && not_negative(d.damped_frequency_hz.std),
            d.name + ": the frequency must be positive");
    require(std::abs(d.damping_ratio.value) < 1 && not_negative(d.damping_ratio.std),
            d.name + ": the damping ratio must lie below 1");
    const double k = setup.mass_kg.value * omega_squared(d);
    require(told_compliance(setup) * k < 1,
            fmt::format("{}: adapter and frame ({:.4g} N/m) are softer than the whole chain that "
                        "was measured ({:.4g} N/m): check the mass and both stiffnesses",
                        d.name, 1 / told_compliance(setup), k));
  }
}

// Variance of one record: what the repeats at one length show, which needs no trust in the fits and
// is Student's; of few repeats, what the fits say where that is more. Far below what the fits say
// are only repeats that are no repeats: copies, rounded values.
struct Repeatability {
  double variance = 0, degrees = 0;  // degrees 0: from the fits
};

// The records of a length.
struct Group {
  std::vector<double> log_W, zeta;
};

double mean_of(const std::vector<double>& x) { return gsl_stats_mean(x.data(), 1, x.size()); }

Repeatability repeatability(const std::map<double, Group>& groups,
                            std::vector<double> Group::*which, double stated) {
  double squares = 0, degrees = 0;
  for (const auto& [length, group] : groups) {
    const auto& x = group.*which;
    squares += gsl_stats_tss(x.data(), 1, x.size());
    degrees += static_cast<double>(x.size()) - 1;
  }
  const double seen = degrees > 0 ? squares / degrees : 0;
  if (seen > stated || (degrees >= 5 && seen > 0.2 * stated)) return {seen, degrees};
  return {stated, 0};
}

class Identification {
 public:
  explicit Identification(const AxialSetup& setup)
      : setup_(setup), length_std_(setup.length_std_m) {
    if (!length_std_) setup_.length_std_m = kLengthStd;  // for the weights
  }

  AxialTestResult run(std::span<const AxialDecay> decays) {
    gather(decays);
    fit();
    damper();
    judge();
    return std::move(result_);
  }

 private:
  void note(const char* code, std::string message) {
    result_.notes.push_back({code, std::move(message), ""});
  }

  void gather(std::span<const AxialDecay> decays) {
    std::map<double, Group> by_length;
    double stated = 0, stated_zeta = 0;  // variances of ln omega^2 and of zeta, of one record
    const double each = 1 / static_cast<double>(decays.size());
    for (const auto& d : decays) {
      const double zeta = d.damping_ratio.value, W = omega_squared(d);
      auto& group = by_length[d.length_m];
      group.log_W.push_back(std::log(W)), group.zeta.push_back(zeta);
      const auto rod = rod_of(setup_, W, d.length_m);
      const double std = 2 * std::hypot(d.damped_frequency_hz.std / d.damped_frequency_hz.value,
                                        zeta / (1 - zeta * zeta) * d.damping_ratio.std);
      const double EA = rod.cable_N_m * d.length_m;
      result_.samples.push_back({d.length_m,
                                 rod.series_N_m,
                                 rod.cable_N_m,
                                 {EA, EA * rod.by_omega_squared * std},
                                 damper_of(zeta, rod.series_N_m)});
      stated += each * std * std;
      stated_zeta += each * d.damping_ratio.std * d.damping_ratio.std;
    }
    const auto repeat = repeatability(by_length, &Group::log_W, stated);
    const auto repeat_zeta = repeatability(by_length, &Group::zeta, stated_zeta);
    repeat_degrees_ = repeat.degrees;
    std::vector<double> zeta, zeta_variance;
    for (const auto& [length, group] : by_length) {
      const double count = static_cast<double>(group.zeta.size());
      const double mean_log = mean_of(group.log_W), mean_zeta = mean_of(group.zeta);
      const double std = std::sqrt(repeat.variance / count);
      lengths_.push_back({length, mean_log, std});
      zeta.push_back(mean_zeta);
      zeta_variance.push_back(std::max(repeat_zeta.variance / count, 1e-24));
      const auto rod = rod_of(setup_, std::exp(mean_log), length);
      const double EA = rod.cable_N_m * length;
      const double of_length = (1 + rod.by_length) * length_std_.value_or(kNaN) / length;
      result_.lengths.push_back({length,
                                 static_cast<int>(group.zeta.size()),
                                 {EA, EA * std::hypot(rod.by_omega_squared * std, of_length)},
                                 {mean_zeta, std::sqrt(repeat_zeta.variance / count)},
                                 damper_of(mean_zeta, rod.series_N_m)});
      result_.reference_length_m += length / static_cast<double>(by_length.size());
    }
    const auto damping = signal::mean_over_groups(zeta, zeta_variance);
    const double std_zeta = std::sqrt(damping.variance);
    const double half = std_zeta * coverage_factor(0.95, damping.degrees > 0 ? damping.degrees
                                                                             : repeat_zeta.degrees);
    result_.damping_ratio = {{damping.mean, std_zeta}, {damping.mean - half, damping.mean + half}};
  }

  [[nodiscard]] double damper_of(double zeta, double k) const {
    return 2 * zeta * std::sqrt(k * setup_.mass_kg.value);
  }

  void fit() {
    const auto& known = setup_.series_compliance_std_m_N;
    const bool told = setup_.frame_stated || (known && *known == 0);
    bool series = known ? *known > 0 : !told && lengths_.size() > 1;
    AxialFit best = fit_axial(lengths_, setup_, series);
    const bool too_close =
        series && !known && !(best.converged && best.EA_relative_std < kDetermined);
    if (too_close) best = fit_axial(lengths_, setup_, series = false);
    result_.conditional = too_close || (!known && !told && !series);
    if (best.converged && best.degrees > 0 && !result_.conditional) {
      result_.homogeneity_p = gsl_cdf_chisq_Q(best.chi2, best.degrees);
      if (result_.homogeneity_p < 0.05) best = with_scatter(series);
    }
    require(best.converged, "no EA fits these frequencies: check mass and lengths");
    const auto U = expanded(best, 0.95);
    const double EA = best.EA_N;
    result_.EA_N = {{EA, EA * best.EA_relative_std},
                    {EA / (1 + U), U < 1 ? EA / (1 - U) : std::numeric_limits<double>::infinity()}};
    result_.coverage_factor = U / best.EA_relative_std;
    result_.between_lengths_std_N = EA * best.between_std;
    result_.series_compliance_m_N = series ? best.compliance_m_N : Estimate{};
    budget(best);
    if (lengths_.size() == 1) assembly();
    if (!length_std_) {
      result_.EA_N.std = result_.EA_N.low = result_.EA_N.high = result_.coverage_factor = kNaN;
    }
    if (result_.conditional) bound(EA / (1 + expanded(best, 0.9)));
  }

  // The least scatter for which chi-squared is its expectation.
  AxialFit with_scatter(bool series) const {
    const auto at = [&](double log_tau) {
      return fit_axial(lengths_, setup_, series, std::exp(log_tau));
    };
    return at(root_between(std::log(1e-9), 0.5, 1e-4, [&](double log_tau) {
      const AxialFit fit = at(log_tau);
      return fit.chi2 - fit.degrees;
    }));
  }

  // Half the interval of ln EA.
  [[nodiscard]] double expanded(const AxialFit& fit, double coverage) const {
    double scattering = fit.budget[0].share, degrees = repeat_degrees_;
    if (fit.between_std > 0) {
      scattering += fit.budget[1].share, degrees = std::max(1, fit.degrees);
    }
    return fit.EA_relative_std *
           std::hypot(coverage_factor(coverage, degrees) * std::sqrt(scattering),
                      coverage_factor(coverage, 0) * std::sqrt(std::max(0.0, 1 - scattering)));
  }

  void budget(const AxialFit& fit) {
    result_.budget = fit.budget;
    auto &frequency = result_.budget[0], &between = result_.budget[1], &length = result_.budget[2];
    frequency.type = between.type = 'A';
    frequency.degrees_of_freedom = repeat_degrees_, between.degrees_of_freedom = fit.degrees;
    if (!length_std_) {
      by_lengths_ = length.contribution_N;
      length.std = length.contribution_N = length.share = kNaN;
    }
    if (!(fit.between_std > 0)) result_.budget.erase(result_.budget.begin() + 1);
    std::stable_sort(result_.budget.begin(), result_.budget.end(),
                     [](const BudgetRow& a, const BudgetRow& b) {
                       return std::isfinite(b.share) && !(a.share <= b.share);
                     });
  }

  // k = W (M + moving part of the cable's mass): a third under a rigid frame, all of it under a
  // soft one, none above a soft adapter; rectangular where nothing is told.
  void assembly() {
    const auto& one = lengths_.front();
    const double W = std::exp(one.log_omega_squared), third = one.length_m / 3;
    const double k = rod_of(setup_, W, one.length_m).series_N_m;
    const double place =
        result_.conditional ? third * setup_.mass_per_length_kg_m.value / std::sqrt(3.0) : 0;
    const double rate = 2 * k * setup_.rate_relative_std;
    result_.assembly_stiffness_N_m = {
        k, std::hypot(std::hypot(k * one.log_omega_squared_std, W * place, rate),
                      W * setup_.mass_kg.std, W * third * setup_.mass_per_length_kg_m.std)};
  }

  void bound(double low) {
    auto& r = result_;
    r.EA_if_rigid_N = r.EA_N;
    const double solid = setup_.mass_per_length_kg_m.value / kSteelDensity * kSolidModulus;
    const double most = std::max({solid, setup_.catalogue_EA_N, solid > 0 ? r.EA_N.value : 0});
    const double own = r.EA_N.value * (r.EA_N.value / low - 1) / coverage_factor(0.9, 0);
    r.EA_N.low = low, r.EA_N.one_sided = true;
    r.EA_N.high = most > 0 ? most : std::numeric_limits<double>::infinity();
    r.EA_N.std = (r.EA_N.high - low) / std::sqrt(12.0);
    r.coverage_factor = std::sqrt(3.0);  // half the width over the std
    if (!std::isfinite(r.EA_N.std)) return;
    const double share = std::max(0.0, 1 - std::pow(own / r.EA_N.std, 2));
    for (auto& row : r.budget) row.share *= 1 - share;
    r.budget.insert(r.budget.begin(),
                    {"what else gives way, not told", "N", kNaN, r.EA_N.std * std::sqrt(share), 1,
                     r.EA_N.std * std::sqrt(share), share, 0, 'B'});
  }

  // c = 2 zeta sqrt(k M) at the mean length. The chain's stiffness is that measured: it goes with
  // the mass, and so c is proportional to it. What the cable's part of it is known to adds nothing
  // but is left in, as an upper limit.
  void damper() {
    const double own = result_.reference_length_m / result_.EA_N.value;
    const double s = std::isfinite(result_.series_compliance_m_N.value)
                         ? result_.series_compliance_m_N.value
                         : 0;
    const double k = 1 / std::max(own + told_compliance(setup_) + s, 0.1 * own);
    const double zeta = result_.damping_ratio.value, c = damper_of(zeta, k);
    const double by_EA = result_.conditional || !std::isfinite(result_.EA_N.std)
                             ? 0
                             : 0.5 * k * own * result_.EA_N.std / result_.EA_N.value;
    result_.damping_Ns_m = {c, std::hypot(damper_of(1, k) * result_.damping_ratio.std, c * by_EA,
                                          c * setup_.mass_kg.std / setup_.mass_kg.value)};
  }

  void judge() {
    if (!length_std_) {
      note("length_std",
           fmt::format("Give the standard uncertainty of the lengths (--length-std): without it "
                       "that of EA is not known; 1 mm of each length changes EA by {:.2g} N",
                       by_lengths_));
    }
    judge_lengths();
    judge_inputs();
    judge_size();
  }

  void judge_lengths() {
    const auto& r = result_;
    if (r.conditional) {
      const bool one = r.lengths.size() < 2;
      note(one ? "one_length" : "lengths_too_close",
           fmt::format("Test {}, or state the frame's stiffness (or that it is rigid): {} from {}, "
                       "so that EA is known from below only, {:.4g} N or more; {:.2g} m/N of "
                       "compliance elsewhere makes EA 10 % higher",
                       one ? "a second length" : "lengths further apart",
                       "grips, load cell, adapter and frame cannot be told",
                       one ? "one length" : "lengths this close together", r.EA_N.low,
                       0.1 / 1.1 * r.reference_length_m / r.EA_N.value));
      return;
    }
    if (r.between_lengths_std_N > 0) {
      note(
          "lengths_disagree",
          fmt::format("Measure the lengths and clamp them again: EA differs between lengths by "
                      "more than their uncertainties ({}); a scatter of {:.2g} N between lengths "
                      "is in the uncertainty",
                      "probability " + probability_text(r.homogeneity_p), r.between_lengths_std_N));
    }
    const auto& s = r.series_compliance_m_N;
    if (!(std::abs(s.value) > 2 * s.std) || r.lengths.size() < 2) return;
    note("series_compliance",
         s.value > 0
             ? fmt::format(
                   "Stiffen grips, load cell, adapter or frame: they add {:.2g} m/N in series "
                   "(std {:.1g}), {:.2g} % of the chain's compliance; EA, from the slope of "
                   "1/k over length, leaves it out",
                   s.value, s.std, 100 * s.value / (s.value + r.reference_length_m / r.EA_N.value))
             : fmt::format("Check how the lengths are measured: stiffness falls faster with length "
                           "than a cable's does (compliance in series {:.2g} m/N, std {:.1g}); a "
                           "length added to all of them does not change EA",
                           s.value, s.std));
  }

  void judge_inputs() {
    if (setup_.mass_per_length_kg_m.value == 0) {
      note("massless_cable",
           "Give the mass per length (--mass-per-length): a third of the cable's mass is missing "
           "from the oscillating mass, and EA comes out low by that share");
    }
    std::string exact;
    for (const auto& row : result_.budget) {
      if (row.type == 'A' || row.std != 0 || row.source == "sample rate") continue;
      exact += fmt::format("{}{} ({:.2g} N for 0.1 %)", exact.empty() ? "" : ", ", row.source,
                           std::abs(1e-3 * row.value * row.sensitivity));
    }
    if (exact.empty()) return;
    note("taken_as_exact",
         "Give standard uncertainties of what is taken as exact (in brackets what it changes EA "
         "by): " +
             exact);
  }

  void judge_size() {
    auto& r = result_;
    r.catalogue_EA_N = setup_.catalogue_EA_N > 0
                           ? setup_.catalogue_EA_N
                           : setup_.mass_per_length_kg_m.value / kSteelDensity * kRopeModulus;
    if (!(r.catalogue_EA_N > 0)) return;
    r.share_of_catalogue = r.EA_N.value / r.catalogue_EA_N;
    const std::string size =
        fmt::format("EA = {:.4g} kN is {:.0f} % of {:.4g} kN, {}", 1e-3 * r.EA_N.value,
                    100 * r.share_of_catalogue, 1e-3 * r.catalogue_EA_N,
                    setup_.catalogue_EA_N > 0
                        ? "the catalogue's"
                        : fmt::format("what {:.0f} GPa on the metal of this mass per length gives",
                                      kRopeModulus / 1e9));
    if (r.share_of_catalogue < 0.5) {
      note("below_catalogue",
           fmt::format("Check the strand's tension, the grips and the frame: {}; a strand this "
                       "slack, or {:.2g} µm/N of compliance elsewhere, explains it",
                       size,
                       1e6 * r.reference_length_m * (1 / r.EA_N.value - 1 / r.catalogue_EA_N)));
    } else if (r.share_of_catalogue > 1.3) {
      note("above_catalogue", "Check mass, length and frequency: " + size);
    }
  }

  AxialSetup setup_;
  std::optional<double> length_std_;  // as given
  AxialTestResult result_;
  std::vector<AxialLengthData> lengths_;
  double repeat_degrees_ = 0, by_lengths_ = 0;
};

}  // namespace

AxialTestResult identify_axial(std::span<const AxialDecay> decays, const AxialSetup& setup) {
  check(decays, setup);
  return Identification(setup).run(decays);
}

}  // namespace rigfit::ident
