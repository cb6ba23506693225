// Damage of a zone of a pole or beam, as lost flexural rigidity, from a fit in which it was free.
//
//   d = 1 - EI_zone / (r EI_sound),   var d = (EI_zone / (r EI_sound))^2 var ln(EI_zone / EI_sound)
//
// r is the ratio that a sound zone has (of a taper). Damage is called where d > 1.645 std: a sound
// pole is called damaged with a probability of 5 %. The smallest damage that is then found with a
// probability of 95 % is (1.645 + 1.645) std. It is a statement about stiffness, not about
// strength.
//
// Soil and damage: a softer soil lowers the same modes as a softer base. Their correlation in the
// fit says whether the measurements tell them apart.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "ident/predict/scene_prediction.h"

namespace rigfit::ident {

struct DamageQuestion {
  std::string zone;             ///< parameter of the fit: EI of the zone
  std::string sound;            ///< the same of the sound part; empty: `sound_EI`
  signal::Estimate sound_EI{};  ///< where no parameter of the fit stands for it
  double sound_ratio = 1;       ///< r
};

struct DamageEstimate {
  signal::Estimate damage;        ///< d, 0: sound
  double low = 0, high = 0;       ///< 95 %
  double smallest_found = 0;      ///< with 95 % probability, at 5 % false calls
  bool called = false;            ///< d > 1.645 std
  std::vector<std::string> like;  ///< parameters that the measurements do not tell apart from it
  std::string statement;          ///< for a person
};

/// Correlation beyond which another parameter counts as not told apart.
inline constexpr double kNotToldApart = 0.95;

/// Throws std::invalid_argument for a parameter that the fit does not have.
[[nodiscard]] DamageEstimate damage_estimate(const FittedParameters& fitted,
                                             const DamageQuestion& question);

}  // namespace rigfit::ident
