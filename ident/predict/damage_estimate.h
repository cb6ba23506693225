// Damage of a zone of a pole or beam, as lost flexural rigidity, from a fit in which it was free.
//
//   d = 1 - EI_zone / (r EI_sound),   var d = (EI_zone / (r EI_sound))^2 var ln(EI_zone / EI_sound)
//
// r is EI_zone / EI_sound of an undamaged beam (not 1 with a taper). Damage is reported if d
// > 1.645 std, so that a sound pole is called damaged with a probability of 5 %. The smallest
// damage that is found with a probability of 95 % is then (1.645 + 1.645) std. Damage means lost
// stiffness, not strength.
//
// A softer soil lowers the same modes as a softer base: the correlation of the two in the fit shows
// whether the measurements separate them.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "ident/predict/scene_prediction.h"

namespace rigfit::ident {

struct DamageQuestion {
  std::string zone;             ///< parameter of the fit: EI of the zone
  std::string sound;            ///< parameter of the fit: EI of the sound part; empty: `sound_EI`
  signal::Estimate sound_EI{};  ///< used if the sound part is no parameter of the fit
  double sound_ratio = 1;       ///< r
};

struct DamageEstimate {
  signal::Estimate damage;        ///< d, 0: sound
  double low = 0, high = 0;       ///< 95 %
  double smallest_found = 0;      ///< with 95 % probability, at 5 % false calls
  bool called = false;            ///< d > 1.645 std
  std::vector<std::string> like;  ///< parameters that the data do not separate from it
  std::string statement;          ///< for a person

  static constexpr auto fields() {
    using T = DamageEstimate;
    return std::tuple{field("damage", describe::bounded(&T::damage, &T::low, &T::high)),
                      field("smallest_found", &T::smallest_found), field("called", &T::called),
                      field("not_told_apart_from", &T::like), field("statement", &T::statement)};
  }
};

/// Correlation above which another parameter counts as not separated.
inline constexpr double kNotToldApart = 0.95;

/// Throws std::invalid_argument for a parameter that the fit does not have.
[[nodiscard]] DamageEstimate damage_estimate(const FittedParameters& fitted,
                                             const DamageQuestion& question);

}  // namespace rigfit::ident
