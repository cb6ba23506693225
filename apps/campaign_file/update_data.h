// What `update` fits to: tables of measured modes, FRFs, decays; by state of the rig.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "apps/cli/verb.h"
#include "ident/stiffness/stiffness_curve.h"
#include "ident/update/model_update.h"
#include "ident/update/problem/sample_rate_input.h"

namespace rigfit::apps {

struct UpdateData {
  std::vector<std::string> scenes;  ///< one for all, or one for each file below, in their order
  std::vector<std::string> modes, frfs, decays;  ///< files
  /// One for each file that is no table (universal files of modes may have none); empty: the
  /// scene's.
  std::vector<double> tensions;
  std::vector<std::string> planes;   ///< in, out, any: one for all or for each file
  std::string column;                ///< column of the frequencies in tables
  std::vector<std::string> compare;  ///< further columns: frequencies of other models
  std::string decay_channel;
  std::string stiffness;  ///< table of tension_N, EI_Nm2, or JSON result of bending tests
  int segments = 0;       ///< segments in every member while fitting; 0: the scene's
  std::optional<std::pair<double, double>> band_hz;  ///< of FRFs, decays, universal files
};

struct UpdateStates {
  std::vector<ident::UpdateState> states;
  std::vector<std::string> scene_files;  ///< by state
  std::vector<std::optional<double>> tension;
  ident::StiffnessCurve stiffness;         ///< that gave the states' EI; empty: none
  std::vector<std::vector<int>> segments;  ///< by state, of each member as its file says
  /// By state, measured mode, column of `compare`: what another model says; NaN where it is blank.
  std::vector<std::vector<std::vector<double>>> compared;
  std::vector<ident::StateClock> clocks;  ///< clocks of the states' recordings and FRFs
};

/// Throws UsageError, Refused, model::SceneError, signal::RecordingError.
[[nodiscard]] UpdateStates read_update_states(const UpdateData& data, VerbContext& context);

}  // namespace rigfit::apps
