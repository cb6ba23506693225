#include "ident/statistics/probability_text.h"

#include <fmt/format.h>

#include <cmath>

namespace rigfit::ident {
namespace {
constexpr double kLeast = 1e-6;
}

std::string probability_text(double p) {
  if (std::isnan(p)) return "-";
  return p < kLeast ? "below 1e-6" : fmt::format("{:.2g}", p);
}

std::string p_text(double p) { return (p < kLeast ? "p " : "p = ") + probability_text(p); }

}  // namespace rigfit::ident
