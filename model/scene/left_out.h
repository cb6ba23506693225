// An effect that a model leaves out, and the error that this causes.
#pragma once

#include <string>
#include <tuple>

#include "document/describe.h"

namespace rigfit::model {

/// One simplification of a model and its estimated error.
struct LeftOut {
  std::string what;           ///< such as "torsion"
  double relative_error = 0;  ///< estimated
  /// Quantity in error: "frequency" (of the modes that take part) or "response" (rms of the
  /// sensors' samples).
  std::string of = "frequency";

  static constexpr std::string_view title = "left out";
  static constexpr auto fields() {
    using T = LeftOut;
    return std::tuple{
        field("what", &T::what, "", "effect", "such as torsion"),
        field("relative_error", &T::relative_error, "", "error, about", "estimated", 2),
        field("of", &T::of, "", "in", "frequency or response")};
  }
};

}  // namespace rigfit::model
