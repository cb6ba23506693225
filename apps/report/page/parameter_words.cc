#include "apps/report/page/parameter_words.h"

#include <array>
#include <cctype>
#include <utility>

namespace rigfit::apps {
namespace {

constexpr std::array<std::pair<std::string_view, std::string_view>, 30> kQuantities{{
    {"EI", "bending stiffness EI"},
    {"EI_z", "bending stiffness EI_z"},
    {"EI_y", "bending stiffness EI_y"},
    {"EA", "axial stiffness EA"},
    {"GJ", "torsional stiffness GJ"},
    {"mass_per_length", "mass per length"},
    {"polar_inertia", "polar inertia per length"},
    {"tension", "tension T"},
    {"unstretched_length", "unstretched length"},
    {"stretch", "end displacement"},
    {"taper", "taper"},
    {"damping_ratio", "damping ratio ζ"},
    {"damping_axial", "axial damper"},
    {"damping_bending", "bending damper"},
    {"damping_torsion", "torsional damper"},
    {"mass", "mass"},
    {"x", "position x"},
    {"y", "position y"},
    {"z", "position z"},
    {"translational_x", "support stiffness k_x"},
    {"translational_y", "support stiffness k_y"},
    {"translational_z", "support stiffness k_z"},
    {"rotational_x", "support stiffness about x"},
    {"rotational_y", "support stiffness about y"},
    {"rotational_z", "support stiffness about z"},
    {"peak", "peak force"},
    {"position", "position along the member"},
    {"direction_x", "direction x"},
    {"thermal_expansion", "thermal expansion"},
    {"direction_y", "direction y"},
}};

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
  for (const auto& [key, words] : kQuantities) {
    if (key == quantity) return capitalised(name.substr(0, dot)) + " " + std::string(words);
  }
  return capitalised(name);
}

std::string with_parameter_words(std::string sentence) {
  const auto part_of_name = [](char c) {
    return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_';
  };
  for (std::size_t dot = 0; (dot = sentence.find('.', dot)) != std::string::npos; ++dot) {
    std::size_t end = dot + 1;
    while (end < sentence.size() && part_of_name(sentence[end])) ++end;
    const auto quantity = std::string_view(sentence).substr(dot + 1, end - dot - 1);
    for (const auto& [key, words] : kQuantities) {
      if (key != quantity || dot == 0 || !part_of_name(sentence[dot - 1])) continue;
      sentence.replace(dot, end - dot, " " + std::string(words));
      break;
    }
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
