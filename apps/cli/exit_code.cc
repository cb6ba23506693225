#include "apps/cli/exit_code.h"

#include "model/scene/scene_error.h"
#include "signal/recording/recording_error.h"

namespace rigfit::apps {

ExitCode exit_code_of(const std::exception& error) {
  if (dynamic_cast<const UsageError*>(&error)) return ExitCode::wrong_usage;
  if (dynamic_cast<const signal::RecordingError*>(&error)) return ExitCode::bad_input;
  if (dynamic_cast<const model::SceneError*>(&error)) return ExitCode::bad_input;
  if (dynamic_cast<const InputChanged*>(&error)) return ExitCode::bad_input;
  if (dynamic_cast<const OutputError*>(&error)) return ExitCode::bad_input;
  if (dynamic_cast<const Refused*>(&error)) return ExitCode::refused;
  if (dynamic_cast<const NotConverged*>(&error)) return ExitCode::not_converged;
  return ExitCode::fault;
}

}  // namespace rigfit::apps
