// What `update` fits to: tables of measured modes, FRFs, decays; by state of the rig. And what it
// takes as known: readings, lengths, masses, and what the tests before gave (EI over tension, EA).
#pragma once

#include "apps/cli/verb.h"
#include "ident/stiffness/stiffness_curve.h"
#include "ident/update/model_update.h"
#include "ident/update/problem/update_data.h"
#include "model/scene/scene.h"

namespace rigfit::apps {

struct UpdateData {
  std::vector<std::string> scenes;  ///< one for all, or one for each file below, in their order
  std::vector<std::string> modes, frfs, decays;  ///< files
  /// One for each file that is no table (universal files of modes may have none); empty: the
  /// scene's.
  std::vector<double> tensions;
  std::vector<std::string> planes;  ///< in, out, any: one for all or for each file
  std::string column;               ///< column of the frequencies in tables
  std::string decay_channel;
  std::string stiffness;  ///< table of tension_N, EI_Nm2, or JSON result of bending tests
  int segments = 0;       ///< segments in every member while fitting; 0: the scene's
  double band_low_hz = 0, band_high_hz = 0;  ///< of FRFs, decays, universal files; 0: no end
};

struct UpdateStates {
  std::vector<ident::UpdateState> states;
  std::vector<std::string> scene_files;  ///< by state
  std::vector<std::optional<double>> tension;
  ident::StiffnessCurve stiffness;         ///< that gave the states' EI; empty: none
  std::vector<std::vector<int>> segments;  ///< by state, of each member as its file says
};

/// Throws UsageError, Refused, model::SceneError, signal::RecordingError.
[[nodiscard]] UpdateStates read_update_states(const UpdateData& data, VerbContext& context);

// What is taken as known, with its uncertainty.

/// Inputs of `--input`, one a text: "TARGET[,-TARGET...]=STD", STD a number or, with "%", relative
/// to the first target's value; "@each" at its end: independent in every state. TARGET is a scene
/// parameter, or `tension`: that of all cables, as a load cell reads it, with the EI that the
/// stiffness table gives there. Then a stiffness table's points, where it has their std, each by
/// itself. Throws UsageError, model::SceneError.
[[nodiscard]] std::vector<ident::UncertainInput> uncertain_inputs(
    const std::vector<std::string>& texts, const UpdateStates& states);

/// Puts the EA of a result of `rigfit axial` (JSON) into all cables of all states; what it is known
/// to, as an input that moves all of them together. Throws model::SceneError.
[[nodiscard]] std::vector<ident::UncertainInput> axial_inputs(const std::string& path,
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
