#include "document/document_error.h"

#include <fmt/format.h>

namespace rigfit::document {
namespace {

std::string message(const DocumentError::Where& where, const std::string& problem,
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

DocumentError::DocumentError(Where where, std::string problem, std::string remedy)
    : std::runtime_error(message(where, problem, remedy)),
      where_(std::move(where)),
      problem_(std::move(problem)),
      remedy_(std::move(remedy)) {}

}  // namespace rigfit::document
