// Tension of a cable, hanger or stay from its natural frequencies; no starting value is needed.
//
// The cable is a scene of one member (`cable_scene`) between ends that are pinned, clamped or held
// by equal rotational springs, and its modes are fitted by `update` (ident/update): orders and
// planes of the measured modes are part of the estimate; modes may be missing or false. Kinds of
// ends are candidates that are weighed by their evidence; the tension's interval is that of the
// mixture (ident/update/model_candidates.h):
//
//   p(T | data) = sum_e w_e p(T | data, e),   w_e = Z_e / sum Z
//
// The tension is the axial force at mid-span. Along the cable it changes with the height, T(s) =
// T_mid + w (y(s) - y_mid), w the weight per length (exact for a flexible cable; Irvine, Cable
// Structures, 1981, ch. 1).
#pragma once

#include "ident/update/problem/update_data.h"
#include "ident/update/problem/update_result.h"
#include "model/scene/scene.h"

namespace rigfit::ident {

/// `pinned_clamped`: pinned at the first (lower) end, clamped at the second.
enum class CableEnds { pinned, clamped, springs, pinned_clamped };
/// "compare", then the names of the kinds in their order.
inline constexpr std::array<const char*, 5> kCableEndsWords = {"compare", "pinned", "clamped",
                                                               "springs", "pinned-clamped"};
[[nodiscard]] inline const char* name_of(CableEnds ends) {
  return kCableEndsWords[1 + static_cast<std::size_t>(ends)];
}
/// The kinds of ends that a word names: "compare" for all, else one; empty for an unknown word.
[[nodiscard]] inline std::vector<CableEnds> cable_ends(const std::string& word) {
  std::vector<CableEnds> ends;
  for (const CableEnds one :
       {CableEnds::pinned, CableEnds::clamped, CableEnds::springs, CableEnds::pinned_clamped}) {
    if (word == "compare" || word == name_of(one)) ends.push_back(one);
  }
  return ends;
}

/// State of the cable to which a mass per length refers: as it hangs, or without tension. The two
/// differ by T / EA.
enum class MassReference { installed, unstretched };

struct CableDescription {
  Estimate length_m;         ///< chord between the ends, > 0
  Estimate mass_per_length;  ///< kg/m, > 0
  std::optional<MassReference> mass_reference = std::nullopt;
  std::optional<Estimate> EI_Nm2 = std::nullopt;  ///< none: fitted, L sqrt(T / EI) within 2..2000
  std::optional<Estimate> EA_N = std::nullopt;    ///< none: a strain of 0.001 within a factor of 2
  /// Inclination of the chord, 0 horizontal, 90 vertical.
  double inclination_deg = 0;
  double gravity = model::kStandardGravity;      ///< m/s^2
  std::vector<model::AttachedMass> masses = {};  ///< along the cable
  double masses_std = 0;         ///< std of the logarithm of a factor that all of them share
  double rate_relative_std = 0;  ///< std of the sample rate of the recordings, in all frequencies
};

struct TensionOptions {
  std::vector<CableEnds> ends = cable_ends("compare");
  AssignmentOptions assignment = {.ends_at_pairs = true};
};

struct TensionMode {
  int order = 0;  ///< among the modes of its plane, from 1; 0: paired with none
  model::ModePlane plane = model::ModePlane::in;
  double measured_hz = 0, measured_std_hz = 0;    ///< std NaN: not stated
  double model_hz = kNaN, relative_error = kNaN;  ///< NaN when paired with none

  static constexpr std::string_view title = "modes";
  static constexpr auto fields() {
    using namespace describe;
    using T = TensionMode;
    constexpr auto paired = [](const T& m) { return m.order > 0; };
    return std::tuple{field("order", where(paired, &T::order), "", "order",
                            "among the modes of its plane, from 1"),
                      field("plane", where(paired, &T::plane), "", "plane", "in or out"),
                      field("measured_hz", &T::measured_hz, "Hz", "measured", ""),
                      field("measured_std_hz", &T::measured_std_hz, "Hz", "", "as stated"),
                      field("model_hz", &T::model_hz, "Hz", "model", ""),
                      field("relative_error", &T::relative_error, "%", "error",
                            "model over measured, less 1", 2)};
  }
};

/// Contribution of a source to the std of the tension.
struct TensionBudgetRow {
  std::string source;
  double std_N = 0;

  static constexpr std::string_view title = "where the uncertainty of the tension comes from";
  static bool shown(const TensionBudgetRow& row) { return row.std_N > 0; }
  static constexpr auto fields() {
    using T = TensionBudgetRow;
    return std::tuple{field("source", &T::source, "", "source", "input or data"),
                      field("std_N", &T::std_N, "N", "contribution", "the squares add up", 2)};
  }
};

/// Result for one kind of ends.
struct TensionCandidate {
  CableEnds ends = CableEnds::pinned;
  bool solved = false;
  std::string message;        ///< why it is not solved, or a warning of the fit
  BoundedEstimate tension_N;  ///< at mid-span
  Estimate EI_Nm2;            ///< std 0: given as exact
  Estimate spring_Nm_rad;     ///< rotational spring at each end; value NaN unless `springs`
  UpdateFit fit;
  double weight = 0;               ///< probability among the candidates
  std::vector<TensionMode> modes;  ///< by measured mode
  int missed = 0;                  ///< modelled modes that the test should have seen

  static constexpr std::string_view title = "kinds of ends";
  static constexpr auto fields() {
    using namespace describe;
    using T = TensionCandidate;
    constexpr auto solved = [](const T& c) { return c.solved; };
    return std::tuple{
        field("ends", &T::ends, "", "ends", "pinned, clamped, springs or pinned-clamped"),
        field("solved", &T::solved, "", "", "false: see message"),
        field("weight", &T::weight, "%", "weight", "probability among the candidates", 3),
        field("tension_N", where(solved, &T::tension_N), "N", "tension", "at mid-span"),
        field("EI_Nm2", where(solved, &T::EI_Nm2), "N m2", "EI", "flexural rigidity"),
        field("spring_Nm_rad",
              where([](const T& c) { return c.solved && c.ends == CableEnds::springs; },
                    &T::spring_Nm_rad),
              "N m/rad", "springs", "of each end"),
        field("chi2", where(solved, [](const T& c) { return c.fit.chi2; }), "", "chi2", "misfit",
              3),
        field("degrees_of_freedom",
              where(solved, [](const T& c) { return c.fit.degrees_of_freedom; }), "", "dof",
              "of the misfit", 3),
        field("p_value", where(solved, [](const T& c) { return c.fit.p_value; }), "", "p",
              "chance of such a misfit", 2),
        field("model_std", where(solved, [](const T& c) { return c.fit.model_std; }), "", "",
              "relative in frequency, found from the misfit"),
        field("missed_modes", where(solved, &T::missed), "", "", "that the test should have seen"),
        field("modes", where(solved, &T::modes), "", "", "with these ends"),
        field("message", where([](const T& c) { return !c.message.empty(); }, &T::message), "",
              "remark", "why it is not solved, or what to know")};
  }
};

struct TensionFormulas {
  double string_N = 0, pinned_beam_N = 0, zui_N = 0;  ///< NaN: does not apply

  static constexpr auto fields() {
    using T = TensionFormulas;
    return std::tuple{
        field("string_N", &T::string_N, "N", "string formula", "from the lowest mode"),
        field("pinned_beam_N", &T::pinned_beam_N, "N", "pinned beam", "from the lowest mode"),
        field("zui_N", &T::zui_N, "N", "Zui's formula", "clamped ends, first mode")};
  }
};

struct TensionResult {
  bool solved = false;
  std::string message;  ///< why not
  /// Tension at mid-span, over the answers of all candidates (update/model_candidates.h).
  BoundedEstimate tension_N;
  double start_N = 0, end_N = 0;  ///< at the first (lower) and at the second end
  Estimate EI_Nm2;
  double sag_m = 0;
  double irvine_parameter = 0;   ///< (w L / T)^2 L EA / (T Le), of the heaviest candidate
  double bending_parameter = 0;  ///< L sqrt(T / EI)
  /// The best candidate's frequencies are off by 2 % rms, or one by 5 %, or by more than a model's
  /// error of 0.5 % explains with a chance of 1e-6: the measured structure is not such a cable.
  bool ruled_out = false;
  bool decided =
      true;  ///< answers with one and the same order of the modes have 90 % of the weight
  bool mass_reference_matters = false;       ///< it is not stated, and the answers differ
  std::vector<TensionCandidate> candidates;  ///< heaviest first
  TensionFormulas formulas;                  ///< from the lowest mode of the heaviest candidate
  /// Budget of tension_N; the squares add up: "frequencies", "EI", "EA", "EA (assumed)", "end
  /// springs", "length", "mass per length", "attached masses", "sample rate", "assignment", "ends".
  std::vector<TensionBudgetRow> budget;

  static constexpr auto fields() {
    using namespace describe;
    using T = TensionResult;
    return std::tuple{
        field("tension_N", &T::tension_N, "N", "tension at mid-span", "over all candidates"),
        field("tension_start_N", &T::start_N, "N", "at the first end", "tension", 5),
        field("tension_end_N", &T::end_N, "N", "at the second end", "tension", 5),
        field("sag_m", &T::sag_m, "m", "sag", "of the cable at rest", 3),
        field("EI_Nm2", &T::EI_Nm2, "N m2", "EI", "flexural rigidity"),
        field(
            "ends", [](const T& r) { return r.candidates.front().ends; }, "", "ends",
            "of the heaviest candidate"),
        field("irvine_parameter", &T::irvine_parameter, "", "", "of the heaviest candidate"),
        field("bending_parameter", &T::bending_parameter, "", "", "L sqrt(T / EI)"),
        field("ruled_out", &T::ruled_out, "", "", "what was measured is no such cable"),
        field("decided", &T::decided, "", "", "one order of the modes has 90 % of the weight"),
        field("candidates", &T::candidates, "", "candidates", "heaviest first"),
        field(
            "modes", [](const T& r) { return r.candidates.front().modes; }, "", "modes",
            "of the heaviest candidate, by measured mode"),
        field("formulas", &T::formulas, "", "formulas", "closed forms, for comparison"),
        field("budget", &T::budget, "", "budget", "contributions to the std of the tension")};
  }
};

/// Nodes "start" and "end", member "cable" of "auto" segments; springs start at 10 EI / length.
[[nodiscard]] model::Scene cable_scene(const CableDescription& cable, CableEnds ends,
                                       double tension_N, double EI_Nm2);

/// Tension of the scene's member, its horizontal component but for steep cables, over that at
/// mid-span.
[[nodiscard]] double scene_tension_factor(const CableDescription& cable);

/// Modes found in several recordings or channels as one list by rising frequency: modes that agree
/// within three standard uncertainties are merged into their weighted mean, whose uncertainty is at
/// least that from their scatter. Modes without an uncertainty, or of different planes, stay apart.
[[nodiscard]] std::vector<MeasuredMode> merged_modes(std::vector<MeasuredMode> modes);

/// Throws std::invalid_argument for invalid numbers, or without any mode.
void check_cable(const CableDescription& cable, const std::vector<MeasuredMode>& modes);

/// Throws like check_cable.
[[nodiscard]] TensionResult identify_tension(const CableDescription& cable,
                                             const std::vector<MeasuredMode>& modes,
                                             const TensionOptions& options = {});

}  // namespace rigfit::ident
