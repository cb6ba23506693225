// Why a person should not rely on an identified mode, or on the error bars of all: each reason with
// its figure.
#pragma once

#include <Eigen/Core>

#include "signal/modal/modal_band.h"
#include "signal/modal/modal_identification.h"

namespace rigfit::signal {

/// Correlation of the weighted misfit at neighbouring lines, less what the noise model expects;
/// noted when it is beyond chance and large enough to matter for the error bars. `misfit`: lines x
/// FRFs.
void check_misfit(ModalResult& result, const Eigen::Ref<const Eigen::MatrixXcd>& misfit);

/// Fills `doubtful` and `doubt` of every mode; what the record's length costs the residues is
/// noted.
void judge_modes(ModalResult& result, const ModalBand& band);

}  // namespace rigfit::signal
