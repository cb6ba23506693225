#include "apps/report/page/answer.h"

#include <cctype>

#include "apps/describe/sheet.h"
#include "apps/report/drawing/html_text.h"
#include "model/scene/parameters.h"

namespace rigfit::apps {
namespace {

double per_si(const Answer& answer) { return describe::shown_unit(answer.unit).per_si; }

/// Half the 95 % interval over the value; infinite where an end is open.
double relative_half_width(const Answer& answer) {
  if (std::isnan(answer.low) || std::isnan(answer.high)) {
    return 1.96 * answer.std / std::abs(answer.value);
  }
  return 0.5 * (answer.high - answer.low) / std::abs(answer.value);
}

bool holds(const Answer& answer, double value) {
  if (std::isnan(answer.low) || std::isnan(answer.high)) {
    return std::abs(value - answer.value) <= 1.96 * answer.std;
  }
  return value >= answer.low && value <= answer.high;
}

std::string capitalised(std::string_view text) {
  std::string words(text);
  if (!words.empty()) {
    words[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(words[0])));
  }
  return words;
}

}  // namespace

std::string quantity_words(const Answer& answer) {
  const bool named = answer.of_structure && !answer.structure.empty();
  return state_words(answer.quantity) + (named ? ", " + answer.structure : std::string());
}

std::string unit_of(const Answer& answer) {
  return answer.unit.empty() || answer.unit == "%" ? "1" : answer.unit;
}

std::string value_words(const Answer& answer) {
  if (!answer.determined) return std::isfinite(answer.value) ? "not determined" : "none";
  return with_signs(describe::estimate_text(answer.value, answer.std, answer.unit));
}

std::string interval_words(const Answer& answer) {
  if (!answer.determined || (std::isnan(answer.low) && std::isnan(answer.high))) return {};
  const double scale = per_si(answer);
  const auto end = [&](double x) {
    return std::isfinite(x) ? with_signs(describe::value_digits(scale * x, scale * answer.std))
                            : "open";
  };
  return end(answer.low) + " to " + end(answer.high);
}

std::string verdict_words(const Answer& answer) {
  if (!answer.verdict.empty()) return answer.verdict;
  if (!answer.determined) return "not identifiable from these data";
  std::string words;
  const double half = relative_half_width(answer);
  if (std::isnan(half)) {
    words = "uncertainty not known";
  } else if (half < 0.5) {
    words = fmt::format("{} within {}",
                        half < 0.01  ? "well known,"
                        : half < 0.1 ? "known"
                                     : "roughly known,",
                        within_percent(half));
  } else {
    words = "poorly determined";
  }
  if (answer.reference) {
    const double off = answer.value / *answer.reference - 1;
    const std::string value = shown(per_si(answer) * *answer.reference, 4);
    words += fmt::format("; {} {}: {}", answer.reference_name, value,
                         std::isnan(half)                   ? shown_percent(off)
                         : holds(answer, *answer.reference) ? "inside the interval"
                                                            : "outside the interval");
  }
  return words;
}

bool doubtful(const Answer& answer) {
  if (!answer.verdict.empty()) return answer.verdict.starts_with("doubtful");
  if (!answer.determined) return true;
  const double half = relative_half_width(answer);
  return !(half < 0.5) || (answer.reference && !holds(answer, *answer.reference));
}

void recommend(std::vector<Answer*>& answers) {
  const auto same = [](const Answer& a, const Answer& b) {
    return a.quantity == b.quantity && a.unit == b.unit && std::isnan(a.mode_hz) &&
           std::isnan(b.mode_hz) &&
           (!(a.of_structure || b.of_structure) || a.structure == b.structure);
  };
  const auto known = [](const Answer& a) { return a.determined && a.std > 0; };
  for (auto one = answers.begin(); one != answers.end(); ++one) {
    for (auto other = answers.begin(); other != answers.end(); ++other) {
      if (one == other || !same(**one, **other) || !known(**other)) continue;
      const bool later = (*other)->std == (*one)->std && other > one;
      if (known(**one) && ((*other)->std > (*one)->std || later)) continue;
      (*one)->recommended = false;
    }
  }
  for (auto* one : answers) {
    if (!one->recommended || !known(*one)) continue;
    for (const auto* other : answers) {
      if (one == other || !same(*one, *other) || !known(*other) || !one->verdict.empty()) continue;
      if (std::abs(one->value - other->value) < 3 * std::hypot(one->std, other->std)) continue;
      one->verdict = fmt::format("doubtful: {} gives {}", other->how, value_words(*other));
    }
  }
}

std::string answers_csv(const std::vector<Answer>& answers) {
  std::string text;
  const auto blank = describe::json_of(Answer{});
  for (const auto& field : blank.items()) {
    text += (text.empty() ? "" : ",") + field.key();
  }
  for (const auto& answer : answers) {
    const char* before = "\n";
    const auto json = describe::json_of(answer);
    for (const auto& value : json) {
      text += before + (value.is_null()     ? ""
                        : value.is_string() ? csv_quoted(value.get<std::string>())
                                            : value.dump());
      before = ",";
    }
  }
  return text + "\n";
}

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

}  // namespace rigfit::apps
