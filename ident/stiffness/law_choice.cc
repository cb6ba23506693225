#include "ident/stiffness/law_choice.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "signal/numerics/numbers.h"

namespace rigfit::ident {
namespace {

using signal::kNaN;

std::string list_of(const std::vector<std::string>& words) {
  std::string text;
  for (std::size_t i = 0; i < words.size(); ++i) {
    text += (i == 0 ? "" : i + 1 == words.size() ? " and " : ", ") + words[i];
  }
  return text;
}

}  // namespace

void rank_laws(StiffnessLaws& result, std::size_t points,
               const std::vector<std::string>& left_out) {
  auto& laws = result.laws;
  std::stable_sort(laws.begin(), laws.end(), [](const FittedLaw& a, const FittedLaw& b) {
    const bool first = std::isfinite(a.aicc), second = std::isfinite(b.aicc);
    if (first != second) return first;
    return first ? a.aicc < b.aicc : a.rms_relative_error < b.rms_relative_error;
  });
  double total = 0;
  for (const auto& law : laws) {
    if (std::isfinite(law.aicc)) total += std::exp(-0.5 * (law.aicc - laws[0].aicc));
  }
  std::vector<std::string> ranked, close, unranked;
  for (auto& law : laws) {
    if (std::isfinite(law.aicc)) {
      law.akaike_weight = std::exp(-0.5 * (law.aicc - laws[0].aicc)) / total;
      ranked.push_back(name_of(law.kind));
      if (law.aicc - laws[0].aicc < 2) close.push_back(name_of(law.kind));
    } else {
      unranked.push_back(name_of(law.kind));
    }
  }
  if (laws.empty()) {
    result.sentence = fmt::format("{} points are too few for any law.", points);
    return;
  }
  if (ranked.size() < 2) {
    // One that could be ranked among several that could not says nothing about the choice.
    std::stable_sort(laws.begin(), laws.end(), [](const FittedLaw& x, const FittedLaw& y) {
      return x.rms_relative_error < y.rms_relative_error;
    });
    if (laws.size() > 1) {
      for (auto& law : laws) law.akaike_weight = kNaN;
    }
    result.sentence = fmt::format(
        "{} points{} are too few to choose between the laws (AICc needs more); they are listed by "
        "their misfit, which always favours the law with the most parameters.",
        points, result.weighted ? "" : " without stated uncertainty");
  } else if (close.size() > 1) {
    result.sentence =
        fmt::format("The points cannot choose between {}: their AICc lie within 2 of each other.",
                    list_of(close));
  } else {
    result.decided = true;
    result.sentence = fmt::format("The points favour the {} law (AICc lower by {:.1f} than {}).",
                                  ranked[0], laws[1].aicc - laws[0].aicc, ranked[1]);
  }
  if (ranked.size() > 1 && !unranked.empty()) {
    result.sentence += fmt::format(" Too few points to rank {}.", list_of(unranked));
  }
  if (!left_out.empty()) {
    result.sentence +=
        fmt::format(" Left out, with more parameters than points: {}.", list_of(left_out));
  }
}

}  // namespace rigfit::ident
