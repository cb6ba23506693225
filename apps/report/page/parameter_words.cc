#include "apps/report/page/parameter_words.h"

#include <cctype>

#include "model/scene/parameters.h"

namespace rigfit::apps {
namespace {

std::string capitalised(std::string_view text) {
  std::string words(text);
  if (!words.empty()) {
    words[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(words[0])));
  }
  return words;
}

}  // namespace

std::string parameter_words(std::string_view name) {
  if (name == "load_cell.scale") return "Load cell scale";
  if (name == "load_cell.zero") return "Load cell zero";
  if (name == "temperature_change") return "Temperature change";
  const auto dot = name.rfind('.');
  if (dot == std::string_view::npos) return capitalised(name);
  const auto quantity = name.substr(dot + 1);
  const std::string words = model::quantity_words(quantity);
  return words.empty() ? capitalised(name) : capitalised(name.substr(0, dot)) + " " + words;
}

std::string with_parameter_words(std::string sentence) {
  const auto part_of_name = [](char c) {
    return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_';
  };
  for (std::size_t dot = 0; (dot = sentence.find('.', dot)) != std::string::npos; ++dot) {
    std::size_t end = dot + 1;
    while (end < sentence.size() && part_of_name(sentence[end])) ++end;
    const auto quantity = std::string_view(sentence).substr(dot + 1, end - dot - 1);
    const std::string words = model::quantity_words(quantity);
    if (words.empty() || dot == 0 || !part_of_name(sentence[dot - 1])) continue;
    sentence.replace(dot, end - dot, " " + words);
  }
  return sentence;
}

std::string state_words(std::string name) {
  for (const std::string_view word : {", as built", "as built"}) {
    if (const auto at = name.find(word); at != std::string::npos) name.erase(at, word.size());
  }
  return name;
}

bool shown_in_percent(std::string_view name) { return name.ends_with("damping_ratio"); }

}  // namespace rigfit::apps
