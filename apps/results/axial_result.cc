#include "apps/results/axial_result.h"

#include <fmt/format.h>
#include <fmt/ostream.h>

#include <cmath>

#include "apps/cli/digits.h"
#include "apps/cli/json_document.h"
#include "ident/statistics/probability_text.h"

namespace rigfit::apps {
namespace {

Json estimate(const signal::Estimate& e) { return json_estimate(e.value, e.std); }

Json samples_json(const ident::AxialInputs& inputs, const ident::AxialCampaignResult& result) {
  Json samples = Json::array();
  std::size_t k = 0;
  for (const auto& d : result.decays) {
    const auto& recording = inputs.recordings[d.recording];
    Json row{{"file", recording.name}, {"length_m", recording.length_m}, {"start_s", d.start_s}};
    if (!d.mode || !result.test) {
      row["refused"] = d.left_out.empty() ? "axial" : d.left_out;
      samples.push_back(std::move(row));
      continue;
    }
    const auto& mode = d.result.modes[*d.mode];
    const auto& a = result.test->samples[k++];
    row["damped_frequency_hz"] = estimate(mode.damped_frequency_hz);
    row["damping_ratio"] = estimate(mode.damping_ratio);
    row["r_squared"] = mode.r_squared;
    row["cycles"] = mode.cycles;
    row["stiffness_N_m"] = a.stiffness_N_m;
    row["cable_stiffness_N_m"] = a.cable_stiffness_N_m;
    row["EA_N"] = estimate(a.EA_N);
    row["damping_Ns_m"] = a.damping_Ns_m;
    samples.push_back(std::move(row));
  }
  return samples;
}

Json alternatives_json(const ident::AxialTestResult& r) {
  Json list = Json::array();
  for (const auto& a : r.alternatives) {
    Json EA = estimate(a.EA_N);
    EA["low"] = a.EA_low_N, EA["high"] = a.EA_high_N;
    list.push_back({{"name", a.name},
                    {"weight", a.weight},
                    {"EA_N", std::move(EA)},
                    {"series_compliance_m_N", estimate(a.series_compliance_m_N)},
                    {"between_lengths_std_N", a.between_lengths_std_N},
                    {"chi2", a.chi2},
                    {"degrees_of_freedom", a.degrees_of_freedom}});
  }
  return list;
}

Json lengths_json(const ident::AxialTestResult& r) {
  Json lengths = Json::array();
  for (const auto& l : r.lengths) {
    lengths.push_back({{"length_m", l.length_m},
                       {"records", l.records},
                       {"EA_N", estimate(l.EA_N)},
                       {"damping_ratio", estimate(l.damping_ratio)},
                       {"damping_Ns_m", l.damping_Ns_m}});
  }
  return lengths;
}

Json budget_json(const ident::AxialTestResult& r) {
  Json budget = Json::array();
  for (const auto& b : r.budget) {
    budget.push_back({{"source", b.source},
                      {"type", std::string(1, b.type)},
                      {"value", json_number(b.value)},
                      {"std", b.std},
                      {"unit", b.unit},
                      {"sensitivity_N_per_unit", b.sensitivity},
                      {"contribution_N", b.contribution_N},
                      {"share", b.share},
                      {"degrees_of_freedom",
                       b.degrees_of_freedom > 0 ? Json(b.degrees_of_freedom) : Json(nullptr)}});
  }
  return budget;
}

std::string rounded(const signal::Estimate& e, const char* unit = "") {
  return fmt::format("{}{}, std {}", value_digits(e.value, e.std), unit, std_digits(e.std));
}

}  // namespace

Json axial_json(const ident::AxialInputs& inputs, const ident::AxialCampaignResult& result) {
  Json out;
  if (!result.test) {
    out["samples"] = samples_json(inputs, result);
    return out;
  }
  const auto& r = *result.test;
  out["EA_N"] = estimate(r.EA_N);
  out["EA_N"]["low"] = r.EA_low_N, out["EA_N"]["high"] = json_number(r.EA_high_N);
  out["EA_N"]["conditional"] = r.conditional;
  if (r.conditional) {
    out["EA_N"]["bound"] = "lower";
    out["EA_if_rigid_N"] = estimate(r.EA_if_rigid_N);
    out["EA_if_rigid_N"]["low"] = r.EA_if_rigid_low_N;
    out["EA_if_rigid_N"]["high"] = r.EA_if_rigid_high_N;
  }
  if (r.assembly_stiffness_N_m.value > 0) {
    out["assembly_stiffness_N_m"] = estimate(r.assembly_stiffness_N_m);
  }
  out["damping_ratio"] = estimate(r.damping_ratio);
  out["damping_ratio"]["low"] = r.damping_low, out["damping_ratio"]["high"] = r.damping_high;
  out["damping_Ns_m"] = estimate(r.damping_Ns_m);
  out["damping_Ns_m"]["length_m"] = r.reference_length_m;
  out["coverage_factor_95"] = r.coverage_factor;
  out["alternatives"] = alternatives_json(r);
  out["samples"] = samples_json(inputs, result);
  out["lengths"] = lengths_json(r);
  out["budget"] = budget_json(r);
  out["between_lengths"] = {{"std_N", r.between_lengths_std_N},
                            {"cochran_Q", r.cochran_Q},
                            {"p_same_EA", r.homogeneity_p}};
  out["monte_carlo"] = {{"draws", r.draws},
                        {"EA_N", estimate(r.monte_carlo_EA_N)},
                        {"low", r.monte_carlo_low_N},
                        {"high", r.monte_carlo_high_N}};
  out["series_compliance_m_N"] = estimate(r.series_compliance_m_N);
  out["EA_without_series_N"] = json_number(r.EA_without_series_N);
  out["between_lengths_std_N"] = r.between_lengths_std_N;
  out["p_same_EA"] = r.homogeneity_p;
  out["plausibility"] = {
      {"catalogue_EA_N", r.catalogue_EA_N > 0 ? Json(r.catalogue_EA_N) : Json(nullptr)},
      {"share", r.catalogue_EA_N > 0 ? Json(r.share_of_catalogue) : Json(nullptr)},
      {"sentence", r.plausibility}};
  return out;
}

std::string axial_EA_text(const ident::AxialTestResult& r) {
  if (!r.conditional) {
    return fmt::format("{} ({} to {} with 95 %)", rounded(r.EA_N, " N"),
                       value_digits(r.EA_low_N, r.EA_N.std), value_digits(r.EA_high_N, r.EA_N.std));
  }
  const auto& rigid = r.EA_if_rigid_N;
  return fmt::format("{} N or more (95 %), {}; {} if nothing but the cable gives way",
                     value_digits(r.EA_low_N, rigid.std),
                     std::isfinite(r.EA_high_N)
                         ? fmt::format("at most {:.3g} N (solid metal of this mass)", r.EA_high_N)
                         : "no upper bound",
                     rounded(rigid, " N"));
}

void print_axial(std::ostream& out, const ident::AxialTestResult& r) {
  if (r.assembly_stiffness_N_m.value > 0) {
    fmt::print(out, "stiffness     {} of the whole chain at {:.4g} m\n",
               rounded(r.assembly_stiffness_N_m, " N/m"), r.reference_length_m);
  }
  fmt::print(out, "EA            {}\n", axial_EA_text(r));
  fmt::print(out, "damping ratio {} ({} to {} with 95 %)\n", rounded(r.damping_ratio),
             value_digits(r.damping_low, r.damping_ratio.std),
             value_digits(r.damping_high, r.damping_ratio.std));
  fmt::print(out, "damper        {} (at {:.4g} m)\n\n", rounded(r.damping_Ns_m, " Ns/m"),
             r.reference_length_m);
  fmt::print(out, "{:>9} {:>8} {:>22} {:>22} {:>12}\n", "length m", "records", "EA N, cable alone",
             "damping ratio", "damper Ns/m");
  for (const auto& l : r.lengths) {
    fmt::print(out, "{:>9.4g} {:>8} {:>22} {:>22} {:>12.4g}\n", l.length_m, l.records,
               rounded(l.EA_N), rounded(l.damping_ratio), l.damping_Ns_m);
  }
  if (r.lengths.size() > 1) {
    fmt::print(out, "the same EA, with the cable alone: {}\n", ident::p_text(r.homogeneity_p));
  }
  if (r.alternatives.size() > 1) {
    fmt::print(out, "\n{:<40} {:>8} {:>22} {:>24}\n", "what gives way", "weight", "EA N",
               "compliance m/N");
    for (const auto& a : r.alternatives) {
      const auto& s = a.series_compliance_m_N;
      fmt::print(out, "{:<40} {:>8.2g} {:>22} {:>24}\n", a.name, a.weight, rounded(a.EA_N),
                 s.std > 0 ? fmt::format("{:.2g}, std {:.1g}", s.value, s.std) : std::string("-"));
    }
  }
  fmt::print(out, "\n{:<24} {:>14} {:>16} {:>8}\n", "uncertainty of EA from", "std",
             "contribution N", "share %");
  for (const auto& b : r.budget) {
    fmt::print(
        out, "{:<24} {:>14} {:>16.2g} {:>8.1f}\n", b.source,
        fmt::format("{:.2g}{}{}", b.std, b.unit == "1" ? "" : " ", b.unit == "1" ? "" : b.unit),
        b.contribution_N, 100 * b.share);
  }
  if (r.draws > 0) {
    const double std = r.monte_carlo_EA_N.std;
    fmt::print(out, "Monte Carlo by closed forms, {} draws{}: {} ({} to {} with 95 %)\n", r.draws,
               r.conditional ? ", if nothing else gives way" : "",
               rounded(r.monte_carlo_EA_N, " N"), value_digits(r.monte_carlo_low_N, std),
               value_digits(r.monte_carlo_high_N, std));
  }
  if (!r.plausibility.empty()) fmt::print(out, "\n{}\n", r.plausibility);
}

}  // namespace rigfit::apps
