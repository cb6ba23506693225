// An effect that a model leaves out, and the error that this causes.
#pragma once

#include <string>

namespace rigfit::model {

/// One simplification of a model and its estimated error.
struct LeftOut {
  std::string what;           ///< such as "torsion"
  double relative_error = 0;  ///< estimated
  /// Quantity in error: "frequency" (of the modes that take part) or "response" (rms of the
  /// sensors' samples).
  std::string of = "frequency";
};

}  // namespace rigfit::model
