#include "ident/axial/axial_judgement.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "ident/statistics/probability_text.h"

namespace rigfit::ident {
namespace {

void add(AxialTestResult& result, const char* code, std::string message) {
  result.notes.push_back({code, std::move(message), ""});
}

double weight_of(const AxialTestResult& result, bool series, bool scatter) {
  double sum = 0;
  for (const auto& a : result.alternatives) {
    const bool has_series = a.name.starts_with("compliance");
    if ((series && has_series) || (scatter && a.between_lengths_std_N > 0)) sum += a.weight;
  }
  return sum;
}

void judge_lengths(AxialTestResult& result) {
  // What another 10 % of the chain's compliance would make of EA.
  const double L = result.reference_length_m, EA = result.EA_N.value;
  if (result.conditional) {
    const bool one = result.lengths.size() < 2;
    add(result, one ? "one_length" : "lengths_too_close",
        fmt::format("{}: what else gives way in series with the cable (grips, load cell, adapter, "
                    "frame) cannot be told from it, so that EA is known from below only: {:.4g} N "
                    "or more; {:.2g} m/N of compliance elsewhere would make EA 10 % higher. Test "
                    "{}, or state the frame's stiffness (or that it is rigid)",
                    one ? "one length only" : "the lengths lie too close together", result.EA_low_N,
                    0.1 / 1.1 * L / EA, one ? "a second length" : "lengths further apart"));
    return;
  }
  if (result.lengths.size() < 2) return;
  if (result.homogeneity_p < 0.05 && weight_of(result, false, true) > 0.5) {
    add(result, "lengths_disagree",
        fmt::format("EA differs between lengths by more than their uncertainties (Cochran's Q "
                    "{:.3g}, {}) and not along a line: a scatter of {:.2g} N between lengths is in "
                    "the uncertainty",
                    result.cochran_Q, p_text(result.homogeneity_p), result.between_lengths_std_N));
  }
  const auto& s = result.series_compliance_m_N;
  if (weight_of(result, true, false) < 0.95 || !(std::abs(s.value) > 2 * s.std)) return;
  const double plain = result.plain_EA_N > 0 ? result.plain_EA_N / EA - 1 : 0;
  add(result, "series_compliance",
      s.value > 0
          ? fmt::format(
                "the lengths show a compliance in series of {:.2g} m/N (std {:.1g}): grips, "
                "load cell, adapter or frame give way. EA is taken from the slope of 1/k "
                "over length; with the cable alone it would come out {:+.2g} %",
                s.value, s.std, 100 * plain)
          : fmt::format("stiffness falls faster with length than a cable's does (compliance in "
                        "series {:.2g} m/N, std {:.1g}, negative): all lengths are measured too "
                        "long, or the adapter is stiffer than told. EA is taken from the slope of "
                        "1/k over length, which neither changes; with the cable alone it would "
                        "come out {:+.2g} %",
                        s.value, s.std, 100 * plain));
}

void judge_inputs(AxialTestResult& result, const AxialSetup& setup) {
  if (setup.mass_per_length_kg_m.value == 0) {
    add(result, "massless_cable",
        "no mass per length: a third of the cable's mass is missing from the oscillating mass, and "
        "EA comes out low");
  }
  std::string exact;
  const auto name = [&](bool is, const char* what) {
    if (is) exact += (exact.empty() ? "" : ", ") + std::string(what);
  };
  name(setup.mass_kg.std == 0, "hung mass");
  name(setup.length_std_m == 0, "lengths");
  name(setup.mass_per_length_kg_m.value > 0 && setup.mass_per_length_kg_m.std == 0,
       "mass per length");
  name(setup.adapter_stiffness_N_m.value > 0 && setup.adapter_stiffness_N_m.std == 0,
       "adapter stiffness");
  name(setup.frame_stiffness_N_m.value > 0 && setup.frame_stiffness_N_m.std == 0,
       "frame stiffness");
  if (exact.empty()) return;
  add(result, "exact_inputs",
      "taken as exact, as no standard uncertainty is given: " + exact +
          "; the uncertainty of EA leaves them out");
}

void judge_size(AxialTestResult& result, const AxialSetup& setup, const AxialOptions& options) {
  result.catalogue_EA_N = setup.catalogue_EA_N > 0
                              ? setup.catalogue_EA_N
                              : setup.mass_per_length_kg_m.value / options.steel_density_kg_m3 *
                                    options.rope_modulus_Pa;
  if (!(result.catalogue_EA_N > 0)) return;
  result.share_of_catalogue = result.EA_N.value / result.catalogue_EA_N;
  const std::string origin =
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
        "series gives way by {:.2g} µm/N",
        1e6 * missing);
    const auto& s = result.series_compliance_m_N;
    if (std::isfinite(s.value)) {
      result.plausibility += s.value + 2 * s.std < missing
                                 ? fmt::format(" (the lengths allow {:.2g} µm/N of it at most)",
                                               1e6 * std::max(0.0, s.value + 2 * s.std))
                                 : " (which the lengths do not rule out)";
    }
    add(result, "below_catalogue", result.plausibility);
  } else if (result.share_of_catalogue > 1.3) {
    result.plausibility +=
        ": stiffer than a rope of that much steel; check mass, length and frequency";
    add(result, "above_catalogue", result.plausibility);
  }
}

}  // namespace

void judge_axial(AxialTestResult& result, const AxialSetup& setup, const AxialOptions& options) {
  judge_lengths(result);
  judge_inputs(result, setup);
  judge_size(result, setup, options);
}

}  // namespace rigfit::ident
