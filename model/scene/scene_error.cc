#include "model/scene/scene_error.h"

#include <fmt/format.h>

namespace rigfit::model {
namespace {

std::string message(const SceneError::Where& where, const std::string& problem,
                    const std::string& remedy) {
  std::string text = where.file;
  if (where.line > 0) text += fmt::format(":{}", where.line);
  if (where.column > 0) text += fmt::format(":{}", where.column);
  if (!text.empty()) text += ": ";
  if (!where.key.empty()) text += fmt::format("{}: ", where.key);
  text += problem;
  if (!remedy.empty()) text += "; " + remedy;
  return text;
}

}  // namespace

SceneError::SceneError(Where where, std::string problem, std::string remedy)
    : std::runtime_error(message(where, problem, remedy)),
      where_(std::move(where)),
      problem_(std::move(problem)),
      remedy_(std::move(remedy)) {}

}  // namespace rigfit::model
