// One virtual test of a rig with a damaged foot: coupled in-plane frequencies with noise, a fit of
// the beam's EI in the zone, the damage and the bare beam's first mode.
#pragma once

#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "ident/predict/damage_estimate.h"
#include "ident/update/model_update.h"
#include "tests/normal.h"
#include "tests/scenes.h"

namespace rigfit::reference {

struct DamageStudy {
  double loss = 0.3;
  double foot_Nm_rad = std::numeric_limits<double>::infinity();
  bool foot_free = false;  ///< the fit does not know the foot's spring
  int modes = 8;
  double relative_std = 1e-3;
};

struct DamageOutcome {
  bool converged = false;
  ident::DamageEstimate damage;
  double bare_hz = 0, bare_std_hz = 0;  ///< first mode of the bare beam, predicted
};

inline double first_in_plane_hz(const model::testing::DamagedRig& rig) {
  model::ModesOptions options{.count = 1, .plane = model::ModePlane::in};
  options.shapes = options.damped = options.error_estimate = false;
  return model::analyse_modes(model::testing::damaged_rig(rig), options).modes.front().frequency_hz;
}

inline DamageOutcome damage_outcome(const DamageStudy& study, std::uint64_t seed) {
  rigfit::testing::Normal normal(seed);
  model::ModesOptions options{.count = study.modes, .plane = model::ModePlane::in};
  options.shapes = options.damped = options.error_estimate = false;
  ident::UpdateState state{.name = "rig"};
  for (const auto& mode :
       model::analyse_modes(model::testing::damaged_rig({study.loss, true, study.foot_Nm_rad}),
                            options)
           .modes) {
    state.measured.push_back({{mode.frequency_hz * (1 + study.relative_std * normal()),
                               study.relative_std * mode.frequency_hz},
                              {std::nan(""), std::nan("")},
                              model::ModePlane::in});
  }
  state.scene = model::testing::damaged_rig({0, true, study.foot_free ? 200 : study.foot_Nm_rad});
  std::vector<ident::FreeParameter> free{{"base.EI_z"}};
  if (study.foot_free) free.push_back({"foot.rotational_z"});
  ident::UpdateOptions update{.starts = 1};
  update.segment_uncertainty = false;  // the truth has the same segments
  const auto fit = ident::update_model({state}, free, update);
  DamageOutcome outcome;
  if (fit.status != ident::UpdateStatus::converged) return outcome;
  const auto fitted = ident::fitted_parameters(fit, free);
  if (fitted.parameters.empty() || fitted.parameters[0].name != "base.EI_z") return outcome;
  outcome.damage = ident::damage_estimate(fitted, {"base.EI_z", "", {2.1, 0}, 1});
  const auto prediction = ident::predict_modes(
      model::testing::damaged_rig({0, false, study.foot_Nm_rad}), fitted, {.count = 1});
  if (prediction.modes.empty()) return outcome;
  outcome.bare_hz = prediction.modes[0].frequency_hz.value;
  outcome.bare_std_hz = prediction.modes[0].frequency_hz.std;
  outcome.converged = true;
  return outcome;
}

}  // namespace rigfit::reference
