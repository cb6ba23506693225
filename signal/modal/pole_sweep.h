// Which candidates are modes: common poles fitted block after block, the weakest taken out that
//   - noise explains: F below a chance of 1e-3 in the band,
//   - groups see at different places: fewer than 2/3 of those that see it have their own pole
//   within
//     its half bandwidth,
//   - overlaps another and leaves less than 6 times fewer squares than one pole less that differs
//     between groups,
//   - overlaps a stronger one of the same shape (three FRFs or more).
// The last three need three groups. What hits or points that differ make of one mode is thus not
// two; nothing else in the search knows of non-linearity, drift or a roving mass.
#pragma once

#include <Eigen/Core>
#include <complex>
#include <vector>

#include "signal/modal/modal_data.h"
#include "signal/modal/pole_fit.h"

namespace rigfit::signal {

/// A mode with each group's own pole, the others of its block held at the common ones.
struct GroupPoles {
  Eigen::VectorXcd pole;         ///< groups
  Eigen::VectorXd variance;      ///< of Re p and Im p, each
  std::vector<bool> sees, near;  ///< stands out of the group's noise; and lies at the common pole
  Eigen::VectorXcd residues;     ///< columns: of each group's own pole
  double size = 0, left = 0;   ///< weighted squares on its peak: own resonance, what the fits leave
  std::vector<double> misfit;  ///< groups: root of left / all there, on its peak
};

/// Pole `r` of a common fit.
[[nodiscard]] GroupPoles poles_by_group(const ModalData& data, const PoleWindow& window,
                                        const PoleFit& common, Eigen::Index r);

/// How many times fewer independent FRFs a group has than FRFs: columns measured at once share the
/// noise of their force. C^2 / C_eff = |R|_F^2, R the correlation of what the fit leaves, less what
/// chance gives.
[[nodiscard]] double shared_noise(const ModalData& data, const PoleWindow& window,
                                  const PoleFit& common);

/// Fewest groups near a pole, of those that see it.
inline constexpr double kShare = 2.0 / 3;

/// The modes among `poles`, fitted.
[[nodiscard]] Eigen::VectorXcd sweep_poles(const ModalData& data, Eigen::VectorXcd poles,
                                           double max_damping);

/// Data less all modes, each group with its own poles where it sees them near the common ones.
[[nodiscard]] Eigen::MatrixXcd residual_of(const ModalData& data, const Eigen::VectorXcd& poles);

}  // namespace rigfit::signal
