// A cable as described, what is asked of its frequencies and what they give (cable_tension.h).
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "ident/update/problem/update_data.h"
#include "ident/update/problem/update_result.h"
#include "model/scene/scene.h"
#include "signal/numerics/estimate.h"

namespace rigfit::ident {

enum class CableEnds { pinned, clamped, springs };
[[nodiscard]] const char* name_of(CableEnds ends);

/// What a mass per length is of: of the cable as it hangs, or of the cable without tension. The two
/// differ by T / EA.
enum class MassReference { installed, unstretched };

struct CableDescription {
  signal::Estimate length_m;         ///< chord between the ends, > 0
  signal::Estimate mass_per_length;  ///< kg/m, > 0
  std::optional<MassReference> mass_reference = std::nullopt;
  std::optional<signal::Estimate> EI_Nm2 =
      std::nullopt;  ///< none: fitted, L sqrt(T / EI) within 2..2000
  std::optional<signal::Estimate> EA_N =
      std::nullopt;                              ///< none: a strain of 0.001 within a factor of 2
  double inclination_deg = 0;                    ///< of the chord, 0 horizontal, 90 vertical
  double gravity = model::kStandardGravity;      ///< m/s^2
  std::vector<model::AttachedMass> masses = {};  ///< along the cable
};

struct TensionOptions {
  std::vector<CableEnds> ends = {CableEnds::pinned, CableEnds::clamped, CableEnds::springs};
  double missed = 0.1;       ///< probability that the test misses a mode of its plane in its band
  double false_mode = 0.05;  ///< probability that a measured mode is none of the cable's
  double leaked = 0.1;       ///< probability that a mode of the other plane shows up
};

struct TensionMode {
  int order = 0;  ///< among the modes of its plane, from 1; 0: paired with none
  model::ModePlane plane = model::ModePlane::in;
  double measured_hz = 0, measured_std_hz = 0;  ///< std NaN: not stated
  double model_hz = 0, relative_error = 0;      ///< NaN when paired with none
};

/// One kind of ends.
struct TensionCandidate {
  CableEnds ends = CableEnds::pinned;
  bool solved = false;
  std::string message;             ///< why not, or what the fit warns of
  signal::Estimate tension_N;      ///< at mid-span
  double low = 0, high = 0;        ///< 95 %
  signal::Estimate EI_Nm2;         ///< std 0: given as exact
  signal::Estimate spring_Nm_rad;  ///< of each end; value NaN unless `springs`
  UpdateFit fit;
  double weight = 0;               ///< probability among the candidates
  std::vector<TensionMode> modes;  ///< by measured mode
  int missed = 0;                  ///< modelled modes that the test should have seen
  double weight_of_orders = 1;     ///< probability of these orders, given these ends
  std::vector<UpdateBudgetTerm> budget;
};

struct TensionFormulas {
  double string_N = 0, pinned_beam_N = 0, clamped_beam_N = 0, zui_N = 0;  ///< NaN: does not apply
};

struct TensionResult {
  bool solved = false;
  std::string message;  ///< why not
  /// At mid-span, over all candidates; without what lies more than half the interval's width
  /// outside of it (less than 5 % of the probability: other orders, other ends).
  signal::Estimate tension_N;
  double low = 0, high = 0;       ///< 95 % of the mixture
  double start_N = 0, end_N = 0;  ///< at the first (lower) and at the second end
  signal::Estimate EI_Nm2;
  double sag_m = 0;
  double irvine_parameter = 0;   ///< (w L / T)^2 L EA / (T Le), of the heaviest candidate
  double bending_parameter = 0;  ///< L sqrt(T / EI)
  bool decided =
      true;  ///< answers with one and the same order of the modes have 90 % of the weight
  bool EA_assumed = false;              ///< no EA given, and the sag matters
  bool EI_assumed = false;              ///< no EI given, and fewer than three modes to tell it
  bool mass_reference_matters = false;  ///< not said, and the answers differ
  bool large_sag = false;               ///< no equilibrium of the segment model: closed forms alone
  std::vector<TensionCandidate> candidates;  ///< heaviest first
  TensionFormulas formulas;                  ///< from the lowest mode of the heaviest candidate
  /// Of tension_N, the squares add up: "frequencies", "model", "EI", "end springs", "assignment",
  /// "ends", "length", "mass per length", "EA".
  std::vector<UpdateBudgetTerm> budget;
};

}  // namespace rigfit::ident
