// Poles of a set of FRFs over a range of model orders, without initial guesses: poly-reference
// least-squares complex frequency.
//
// Right matrix fraction H_o(w) = B_o(z) A(z)^-1 for every response o (a row of Ni), with real
// polynomials in z = exp(+i 2 pi (f - f_low) / f_period). The linearised error B_o - H_o A gives
// normal equations whose blocks are Toeplitz, so each FRF costs one FFT; eliminating every B_o
// leaves one reduced matrix M of (N + 1) Ni unknowns. With A_0 = I (the lowest coefficient, which
// pushes the poles that only follow noise into the unstable half plane) the equations of order n
// are the leading part of those of order N: one Cholesky factor serves all orders. Source:
// Guillaume, Verboven, Vanlanduit, Van der Auweraer, Peeters, A poly-reference implementation of
// the least-squares complex frequency-domain estimator, IMAC 2003; Cauberghe, Applied
// frequency-domain system identification, VUB 2004 (choice of the constraint).
#pragma once

#include "document/describe.h"
#include "signal/numerics/numbers.h"

namespace rigfit::signal {

struct LscfOptions {
  /// Highest order of A(z): order * Ni poles. Twice to six times the expected number of modes.
  int max_order = 60;
  /// Poles above this damping ratio describe the band, not a structure.
  double max_damping_ratio = 0.2;
  bool participation = false;  ///< find participation vectors as well
};

/// A pole of one order, window damping not removed.
struct StabilisationPole {
  int order = 0;
  Complex pole_rad_s;       ///< negative real part, positive imaginary part
  double frequency_hz = 0;  ///< undamped, |pole| / 2 pi
  double damping_ratio = 0;
  bool stable_frequency = false;
  bool stable_damping = false;  ///< both frequency and damping are stable
  /// Participation of the inputs, length 1; empty unless asked for.
  VectorXcd participation = {};

  static constexpr auto fields() {
    using T = StabilisationPole;
    return std::tuple{field("order", &T::order), field("frequency_hz", &T::frequency_hz),
                      field("damping_ratio", &T::damping_ratio),
                      field("stable_frequency", &T::stable_frequency),
                      field("stable_damping", &T::stable_damping)};
  }
};

struct LscfResult {
  std::vector<StabilisationPole> poles;  ///< by order, then frequency; within the band only
  int orders_solved = 0;  ///< below max_order when the lines do not determine more unknowns

  static constexpr auto fields() {
    using T = LscfResult;
    return std::tuple{field("highest_order", &T::orders_solved), field("poles", &T::poles)};
  }
};

/// `frequency_hz`: rising lines, uniform or not, of the band to be analysed. `H`: lines x (No Ni),
/// column `response * inputs + input`. `line_weight`: lines, factor on the error of every FRF (1 /
/// standard deviation up to a scale), empty: 1. `column_weight`: the same per column of H;
/// responses are weighted by the mean over their inputs. Throws std::invalid_argument on sizes that
/// do not fit.
[[nodiscard]] LscfResult lscf(const Ref<const VectorXd>& frequency_hz,
                              const Ref<const MatrixXcd>& H, Index inputs,
                              const VectorXd& line_weight = {}, const VectorXd& column_weight = {},
                              const LscfOptions& options = {});

}  // namespace rigfit::signal
