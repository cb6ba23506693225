#include "signal/readers/files/frf_unit.h"

#include <string_view>

#include "signal/recording/units.h"

namespace rigfit::signal {

FrfForm frf_form_of(Quantity response) {
  switch (response) {
    case Quantity::displacement:
      return FrfForm::receptance;
    case Quantity::velocity:
      return FrfForm::mobility;
    case Quantity::acceleration:
      return FrfForm::accelerance;
    default:
      return FrfForm::unknown;
  }
}

std::optional<FrfUnit> parse_frf_unit(const std::string& text) {
  for (std::size_t at = text.rfind('/'); at != std::string::npos && at > 0;
       at = text.rfind('/', at - 1)) {
    const auto over = parse_unit(std::string_view(text).substr(0, at));
    const auto under = parse_unit(std::string_view(text).substr(at + 1));
    if (over && under && under->quantity == Quantity::force) {
      return FrfUnit{over->factor / under->factor, frf_form_of(over->quantity),
                     "(" + over->si + ")/" + under->si};
    }
  }
  return std::nullopt;
}

}  // namespace rigfit::signal
