// What identification of modes is asked and what it gives (modal_identification.h).
#pragma once

#include "signal/modes/modal_model.h"
#include "signal/poles/lscf.h"

namespace rigfit::signal {

struct ModalOptions {
  double low_hz = 0;   ///< band; lines at 0 Hz are never used
  double high_hz = 0;  ///< 0: to the last line
  LscfOptions lscf;
};

struct ModalResult {
  ModalModel model;
  LscfResult stabilisation;  ///< window not removed
  Eigen::MatrixXd auto_mac;  ///< modes x modes
  Eigen::Index lines_used = 0;
  double low_hz = 0, high_hz = 0;  ///< first and last line used
};

}  // namespace rigfit::signal
