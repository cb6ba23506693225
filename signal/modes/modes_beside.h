// Modes that lie just beside a band, from the lines there, and what they add to its lines.
//
// Residual terms s^(n-2) and s^n are the first two of a series in (frequency / distance)^2: a
// resonance within a quarter of the band's width beyond its end leaves a part that the fit takes
// for a change of the last mode inside (0.5 % of its damping where the distance of both is 17 %).
// Such modes are fitted to the lines around the end of the band; in the band each then is
// s^n / (s - p) and s^n / (s - conj p) with free complex factors, p held. An error dp of p enters
// as dp / |s - p| of what the mode adds.
// A fit that does not converge beside such poles is made without them. Source: Ewins, Modal
// Testing, 2nd ed., sec. 4.5 (residuals, pseudo-modes).
#pragma once

#include <Eigen/Core>

#include "signal/modes/modal_band.h"
#include "signal/modes/modal_result.h"

namespace rigfit::signal {

/// Poles (window removed) of the modes that the lines of `frfs` within a quarter of the width of
/// `band` beyond its ends show. Empty where there are fewer than 16 such lines.
[[nodiscard]] Eigen::VectorXcd poles_beside(const FrfSet& frfs, const ModalBand& band,
                                            const ModalOptions& options);

/// Sets `band.lines.background` to the orthonormal columns `background` and what `band.beside` adds
/// to them and the residual terms, as far as it is more than 1 part in 1000.
void set_background(const Eigen::Ref<const Eigen::MatrixXcd>& background, ModalBand& band);

}  // namespace rigfit::signal
