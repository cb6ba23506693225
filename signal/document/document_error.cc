#include "document/document_error.h"

namespace rigfit::document {

std::string place_text(const std::string& file, long line, long column) {
  std::string text = file;
  if (line > 0) text += ":" + std::to_string(line);
  if (column > 0) text += ":" + std::to_string(column);
  return text.empty() ? text : text + ": ";
}

std::string DocumentPlace::before() const {
  return place_text(file, line, column) + (key.empty() ? "" : key + ": ");
}

}  // namespace rigfit::document
