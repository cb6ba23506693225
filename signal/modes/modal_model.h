// Modal model: poles, shapes and residuals, as `modal` gives them and as UFF 55 is written.
//
// H(i w) = sum_r [ psi_r L_r^T / (i w - p_r) + conj ] (receptance) + lower / (i w)^2 + upper;
// p_r = -zeta_r w_r + i w_r sqrt(1 - zeta_r^2). FRFs measured under an exponential window shared by
// force and response are this at i w + decay rate. An FRF set of unknown form is treated as
// receptance: poles and MAC values are then right, while the units of shapes are unknown. Source:
// Heylen, Lammens, Sas, Modal Analysis Theory and Testing.
//
// MAC(a, b) = |a^H b|^2 / (a^H a b^H b), 1: proportional. MPC (modal phase collinearity), from the
// 2 x 2 scatter of the real and imaginary parts about 0: ((Sxx - Syy)^2 + 4 Sxy^2) / (Sxx + Syy)^2,
// 1: all components in phase or in opposition (a normal mode), 0: a shape that travels. Both do not
// depend on a complex scale of the shape. Source: Allemang, The modal assurance criterion, 2003;
// Pappa, Elliott, Schenk 1993.
#pragma once

#include "signal/spectra/frf_set.h"

namespace rigfit::signal {

/// MAC of two shapes; 0 when either is zero.
[[nodiscard]] double mac(const Ref<const VectorXcd>& a, const Ref<const VectorXcd>& b);

/// MAC of shapes in columns with each other: symmetric, ones on the diagonal.
[[nodiscard]] MatrixXd auto_mac(const Ref<const MatrixXcd>& shapes);

/// MPC of a shape, 0..1; 0 for a zero shape.
[[nodiscard]] double modal_phase_collinearity(const Ref<const VectorXcd>& shape);

/// A mode as identified from one measured point alone.
struct ModeAtPoint {
  MeasuredPoint point;    ///< excitation point or response, whichever varies
  Index order = 0;        ///< place in the file, from 0
  Estimate frequency_hz;  ///< window damping removed
  Estimate damping_ratio;
  double misfit = 0;  ///< rms misfit over rms FRF within the half bandwidth, own pole

  static constexpr auto fields() {
    using T = ModeAtPoint;
    return std::tuple{describe::part(&T::point), field("order", &T::order),
                      field("frequency_hz", &T::frequency_hz),
                      field("damping_ratio", &T::damping_ratio), field("misfit", &T::misfit)};
  }
};

/// Changes from hit to hit beyond noise (signal/modal/mode_hits.h).
struct BetweenHits {
  int hits = 0;                 ///< number of hits that show the mode alone; 0: unknown
  double frequency_std_hz = 0;  ///< standard deviation of one hit's frequency
  double damping_std = 0;
  bool beyond_noise = false;  ///< then values and uncertainties allow for the changes

  static constexpr auto fields() {
    using T = BetweenHits;
    return std::tuple{field("hits", &T::hits), field("frequency_std_hz", &T::frequency_std_hz),
                      field("damping_std", &T::damping_std),
                      field("beyond_noise", &T::beyond_noise)};
  }
};

/// A component of a shape with the standard deviations of its parts.
struct ShapeComponent {
  double re, im, std_re, std_im;

  static constexpr auto fields() {
    using T = ShapeComponent;
    return std::tuple{field("re", &T::re), field("im", &T::im), field("std_re", &T::std_re),
                      field("std_im", &T::std_im)};
  }
};

struct IdentifiedMode {
  Estimate frequency_hz;   ///< undamped natural frequency |p| / 2 pi, window damping removed
  Estimate damping_ratio;  ///< window damping removed
  double damping_ratio_with_window = 0;  ///< as found, before the removal
  Complex pole_rad_s;                    ///< corrected pole
  VectorXcd shape;                       ///< one per response
  MatrixXd shape_std;                    ///< responses x 2, of the real and imaginary parts
  VectorXcd participation;               ///< one per input
  double modal_phase_collinearity = 0;   ///< MPC, 0..1
  double reconstruction_error = 0;       ///< rms misfit over rms FRF near the mode
  /// Share of the orders of the stabilisation diagram, of local modes of the points, that show it.
  double presence = 0;
  /// Strength of the residues of all FRFs against noise: the root of the sum over FRFs of
  /// residue' covariance^-1 residue, over the value that a false mode reaches by chance.
  double significance = 0;
  /// The window's decay rate is more than half of the measured one: the corrected damping is a
  /// small difference of large numbers. Do not use it.
  bool damping_dominated_by_window = false;
  /// Source of the pole: "global" (maximum likelihood of all FRFs, with a misfit like noise) or
  /// "local" (mean over points of fits to the lines around it).
  std::string refinement = "global";
  /// Scatter of the frequency between points beyond the points' own errors (tau).
  double between_points_std_hz = 0;
  std::vector<ModeAtPoint> points;  ///< by measured point; empty for a single one
  BetweenHits between_hits;
  bool doubtful = false;
  std::string doubt;  ///< reason in words; empty when not doubtful

  [[nodiscard]] std::vector<ShapeComponent> components() const {
    std::vector<ShapeComponent> all;
    for (Index o = 0; o < shape.size(); ++o) {
      all.push_back({shape[o].real(), shape[o].imag(), shape_std(o, 0), shape_std(o, 1)});
    }
    return all;
  }
  /// None where it is refused.
  [[nodiscard]] Estimate damping() const {
    return damping_dominated_by_window ? Estimate{kNaN, kNaN} : damping_ratio;
  }
  [[nodiscard]] bool from_hits() const { return between_hits.hits > 1; }
  /// What a person should know of it in a list.
  [[nodiscard]] std::string remark() const {
    return doubtful                      ? "uncertain: " + doubt
           : damping_dominated_by_window ? "damping refused: mostly the window's"
                                         : "";
  }

  static constexpr auto fields() {
    using T = IdentifiedMode;
    return std::tuple{
        field("frequency_hz", &T::frequency_hz, "Hz", "frequency", "undamped"),
        field("damping_ratio", &T::damping, "%", "damping", "null: refused"),
        field("damping_ratio_with_window", &T::damping_ratio_with_window),
        field("damping_refused", &T::damping_dominated_by_window),
        field("pole_rad_s", &T::pole_rad_s),
        field("shape", &T::components),
        field("participation", &T::participation),
        field("modal_phase_collinearity", &T::modal_phase_collinearity, "", "MPC", "0 to 1", 3),
        field("reconstruction_error", &T::reconstruction_error, "%", "misfit",
              "rms over that of the FRFs", 2),
        field("presence", &T::presence),
        field("significance", &T::significance),
        field("refinement", &T::refinement),
        field("between_points_std_hz", &T::between_points_std_hz),
        field("points", &T::points),
        field("between_hits", describe::where(&T::from_hits, &T::between_hits)),
        field("doubtful", &T::doubtful),
        field("doubt", &T::doubt),
        field("", &T::remark, "", "remark", "")};
  }
};

/// d (frequency, damping ratio) / d (Re p, Im p).
[[nodiscard]] inline Eigen::Matrix2d pole_jacobian(Complex pole) {
  const double x = pole.real(), y = pole.imag(), w = std::abs(pole);
  Eigen::Matrix2d J;
  J << x / (w * kTwoPi), y / (w * kTwoPi), -y * y / (w * w * w), x * y / (w * w * w);
  return J;
}

/// Gives a mode a pole, with frequency and damping ratios. `window`: decay rate of an exponential
/// window, 1/s.
inline void set_pole(IdentifiedMode& mode, Complex pole, double window) {
  const Complex measured = pole - window;
  mode.pole_rad_s = pole;
  mode.frequency_hz.value = std::abs(pole) / kTwoPi;
  mode.damping_ratio.value = -pole.real() / std::abs(pole);
  mode.damping_ratio_with_window = -measured.real() / std::abs(measured);
  mode.damping_dominated_by_window = window > -0.5 * measured.real();
}

struct ModalModel {
  std::vector<IdentifiedMode> modes;  ///< by rising frequency
  std::vector<MeasuredPoint> responses, inputs;
  MatrixXcd lower_residual, upper_residual;  ///< responses x inputs, receptance
  MatrixXd frf_error;  ///< responses x inputs: rms misfit over rms FRF in the band
  FrfForm fitted_form = FrfForm::unknown;
  double exponential_decay_rate_1_s = 0;  ///< removed from every pole
  /// Covariance of (f_1, zeta_1, f_2, zeta_2, ...), 2N x 2N, Hz and 1.
  MatrixXd pole_covariance;
  std::vector<Note> notes;

  static constexpr auto fields() {
    using T = ModalModel;
    return std::tuple{field("modes", &T::modes),
                      field("responses", &T::responses),
                      field("input_points", &T::inputs),
                      field("frf_form", &T::fitted_form),
                      field("exponential_decay_rate_1_s", &T::exponential_decay_rate_1_s),
                      field("frf_error", &T::frf_error),
                      field("pole_covariance", &T::pole_covariance),
                      field("lower_residual", &T::lower_residual),
                      field("upper_residual", &T::upper_residual)};
  }
};

}  // namespace rigfit::signal
