// Whether a fitted mode is one, alone, and a mode at all: what its residual says.
#pragma once

#include <Eigen/Core>
#include <complex>

#include "signal/decay/decay_result.h"
#include "signal/sinusoids/decay_search.h"

namespace rigfit::signal {

/// Whether what one damped sinusoid leaves has a line beside it that noise would not show.
[[nodiscard]] bool leaves_company(const LineSpectrum& residual, std::complex<double> pole,
                                  double false_alarm);

/// Whether coloured noise passes for a mode: `alone`, what the other modes leave, is as well
/// predicted by an autoregression of the residual's own order. (Likelihood ratio, four unknowns,
/// over all cells of the search.)
void doubt_of(DecayMode& mode, const Eigen::VectorXd& alone, const Eigen::VectorXd& residual,
              Eigen::Index order, double false_alarm);

}  // namespace rigfit::signal
