// What `update` takes as known, with its uncertainty: readings, lengths, masses, and what the tests
// before gave (EI over tension, EA).
#pragma once

#include <string>
#include <vector>

#include "apps/campaign_file/update_data.h"
#include "ident/update/model_update.h"
#include "ident/update/problem/update_data.h"
#include "model/scene/scene.h"

namespace rigfit::apps {

/// Inputs of `--input`, one a text: "TARGET[,-TARGET...]=STD", STD a number or, with "%", relative
/// to the first target's value; "@each" at its end: independent in every state. TARGET is a scene
/// parameter, or `tension`: that of all cables, as a load cell reads it, with the EI that the
/// stiffness table gives there. Then a stiffness table's points, where it has their std, each by
/// itself, and a common part that all share. Throws UsageError, model::SceneError.
[[nodiscard]] std::vector<ident::UncertainInput> uncertain_inputs(
    const std::vector<std::string>& texts, double stiffness_common_std, const UpdateStates& states);

/// Inputs of `--aim`, one a text: "LOAD=METRES,DEGREES", how exactly a load of the scene struck
/// where and along what the scene says: its place along the member, and its direction to either
/// side of two, all independent of each other and in every state. Throws UsageError.
[[nodiscard]] std::vector<ident::UncertainInput> aim_inputs(const std::vector<std::string>& texts,
                                                            const UpdateStates& states);

/// Puts the EA of a result of `rigfit axial` (JSON), and its damping ratio when asked for, into all
/// cables of all states; what each is known to, as inputs that move all of them together. Throws
/// model::SceneError.
[[nodiscard]] std::vector<ident::UncertainInput> axial_inputs(const std::string& path,
                                                              bool with_damping,
                                                              UpdateStates& states);

/// "NAME", "NAME@each", "NAME=TARGET,TARGET,-TARGET", any with "@each" at its end. Throws
/// UsageError.
[[nodiscard]] ident::FreeParameter free_parameter(std::string text);

/// Of `--free` (empty: every member's EI, as what is least known of a rig), each with its
/// `--prior`, "NAME=VALUE,STD". Throws UsageError.
[[nodiscard]] std::vector<ident::FreeParameter> free_parameters(
    const std::vector<std::string>& free, const std::vector<std::string>& priors,
    const model::Scene& scene);

}  // namespace rigfit::apps
