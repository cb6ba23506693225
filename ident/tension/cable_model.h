// A cable's frequencies as a function of its tension, EI and end springs: the closed forms of
// cable_frequencies.h, times a correction for what they leave out.
//
// The closed forms hold for a shallow parabola of constant tension. The correction of a mode is
//
//   c = (f_segments(cable) / f_segments(straight)) / (f_closed(cable) / f_closed(straight))
//
// with segment models of the cable as it hangs, with its masses, and of the same cable straight and
// without them: the error of the segments cancels to first order. The correction changes slowly
// with the tension, so that one at the estimate, repeated until it stays, is exact there. Where the
// masses M_j at x_j differ from the given ones by a factor a, order n changes by Rayleigh's
// quotient:
//
//   f^2 ~ 1 / (1 + a s_n),   s_n = sum_j 2 M_j sin^2(n pi x_j) / (m L)
#pragma once

#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "ident/tension/cable_frequencies.h"
#include "ident/tension/tension_result.h"
#include "model/scene/scene.h"

namespace rigfit::ident {

/// ln c in the order of CableFrequencies; beyond the end the last.
struct CableCorrection {
  std::vector<double> in, out;
};

/// Tension, EI and springs of a cable, and factors on its length, mass per length, EA, EI and
/// springs (EI_Nm2 and spring_Nm_rad contain theirs).
struct CableState {
  double tension_N = 0, EI_Nm2 = 0, spring_Nm_rad = 0;
  double length = 1, mass = 1, EA = 1, EI = 1, spring = 1;
  double attached = 1;        ///< factor on the attached masses
  double rate = 1;            ///< factor on the sample rate of the recordings
  bool first_pinned = false;  ///< whatever the spring
};

/// What is not known of a cable is flat in its logarithm over a range: an equal mixture of so many
/// normal densities, each with half the distance of their centres as its std (flat to 1.4 %).
struct LogRange {
  double low, high;
  int count;
  [[nodiscard]] double step() const { return std::log(high / low) / count; }
  [[nodiscard]] double centre(int k) const { return low * std::exp((k + 0.5) * step()); }
};
inline constexpr LogRange kRangeOfX{2, 2000, 8};   ///< L sqrt(T / EI) where EI is not given
inline constexpr LogRange kRangeOfQ{0.03, 30, 5};  ///< springs k = q EI (x + 4) / L

/// EI and springs of a cable but for their factors.
struct CableShape {
  double x = 1;  ///< L sqrt(T / EI); not used where EI is given
  double q = 0;  ///< k L / (EI (x + 4)): 0 pinned, infinity clamped
  bool first_pinned = false;
};
[[nodiscard]] CableState state_of(const CableDescription& cable, const CableShape& shape,
                                  double tension_N);

/// Something that is known of a cable with an uncertainty.
struct CableInput {
  std::size_t index = 0;  ///< index in kCableInputs
  double std = 0;         ///< std of the input's logarithm
  double CableState::*factor = nullptr;
  bool measured = true;  ///< false: one normal density of a LogRange
};
inline constexpr std::array<const char*, 8> kCableInputs = {
    "length",          "mass per length", "EA", "EA (assumed)",
    "attached masses", "sample rate",     "EI", "end springs"};
[[nodiscard]] std::vector<CableInput> uncertain_inputs(const CableDescription& cable, bool springs);

class CableModel {
 public:
  explicit CableModel(const CableDescription& cable, CableCorrection correction = {});

  /// As cable_frequencies, the correction applied.
  [[nodiscard]] CableFrequencies frequencies(const CableState& state, int count, double limit_hz,
                                             CableRoots* near = nullptr) const;
  [[nodiscard]] const CableDescription& cable() const { return cable_; }
  [[nodiscard]] const CableCorrection& correction() const { return correction_; }
  [[nodiscard]] double axial_rigidity(double tension_N) const;
  /// (w L / T)^2 EA L / (T Le), w the weight per length across the chord.
  [[nodiscard]] double lambda_squared(double tension_N) const;
  [[nodiscard]] double weight_across() const;  ///< N/m
  /// Whether sag, change of tension along the cable, or masses change a frequency by 1e-5 or more.
  [[nodiscard]] bool needs_correction(double tension_N) const;

 private:
  [[nodiscard]] SaggingBeam beam(const CableState& state, bool sags) const;
  [[nodiscard]] double lambda_squared(const CableState& state) const;
  friend CableCorrection segment_correction(const CableModel& model, CableEnds ends,
                                            const CableState& state, int count, std::string& why);
  CableDescription cable_;
  CableCorrection correction_;
};

/// The correction at a state for the first `count` modes of each plane; empty with the reason in
/// `why` where the cable has no equilibrium.
[[nodiscard]] CableCorrection segment_correction(const CableModel& model, CableEnds ends,
                                                 const CableState& state, int count,
                                                 std::string& why);

/// The cable as a scene, its ends as asked for; springs start at 10 EI / length.
[[nodiscard]] model::Scene cable_scene(const CableDescription& cable, CableEnds ends,
                                       double tension_N, double EI_Nm2);

}  // namespace rigfit::ident
