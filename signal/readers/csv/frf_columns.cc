#include "signal/readers/csv/frf_columns.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <numbers>
#include <utility>

#include "signal/readers/csv/csv_fields.h"
#include "signal/readers/files/frf_unit.h"
#include "signal/recording/recording_error.h"

namespace rigfit::signal {
namespace {

enum class Part { real, imaginary, magnitude, phase, coherence, other };

struct PartOfFrf {
  Part part = Part::other;
  std::string base;  ///< what the title says besides
};

/// "Real Point 3" -> {real, "point 3"}; the word may stand anywhere in the title.
PartOfFrf part_of(const std::string& title) {
  static constexpr std::array<std::pair<std::string_view, Part>, 26> kWords = {{
      {"imaginary", Part::imaginary},
      {"imaginaer", Part::imaginary},
      {"imaginär", Part::imaginary},
      {"imag", Part::imaginary},
      {"im", Part::imaginary},
      {"real", Part::real},
      {"re", Part::real},
      {"magnitude", Part::magnitude},
      {"mag", Part::magnitude},
      {"amplitude", Part::magnitude},
      {"ampl", Part::magnitude},
      {"amp", Part::magnitude},
      {"modulus", Part::magnitude},
      {"abs", Part::magnitude},
      {"betrag", Part::magnitude},
      {"gain", Part::magnitude},
      {"phase", Part::phase},
      {"angle", Part::phase},
      {"arg", Part::phase},
      {"coherence", Part::coherence},
      {"coh", Part::coherence},
      {"gamma2", Part::coherence},
      {"kohaerenz", Part::coherence},
      {"kohärenz", Part::coherence},
      {"real part", Part::real},
      {"imaginary part", Part::imaginary},
  }};
  std::string lower = lower_case(title);
  for (char& c : lower) {
    if (c == '_' || c == '(' || c == ')' || c == '[' || c == ']' || c == '-' || c == ':') c = ' ';
  }
  PartOfFrf result;
  std::vector<CsvField> words;
  split_fields(lower, {' ', '.'}, words);
  for (const auto& word : words) {
    const auto known = std::find_if(kWords.begin(), kWords.end(),
                                    [&](const auto& one) { return one.first == word.text; });
    if (known != kWords.end() && result.part == Part::other) {
      result.part = known->second;
    } else if (word.text != "part" && word.text != "of" && word.text != "db" && word.text != "h" &&
               word.text != "frf") {
      result.base += (result.base.empty() ? "" : " ") + std::string(word.text);
    }
  }
  return result;
}

/// The columns of one FRF in a table.
struct Columns {
  std::string base;
  const Channel *first = nullptr, *second = nullptr, *coherence = nullptr;
  bool polar = false;
};

std::vector<Columns> pairs_of(const FrequencyTable& table) {
  std::vector<Columns> found;
  const auto pair_of = [&](const std::string& base, bool polar) -> Columns& {
    // Of the same name, or the last one begun, where titles name only one of the two.
    for (auto& one : found) {
      if (one.base == base && one.polar == polar && one.second == nullptr) return one;
    }
    found.push_back({base, nullptr, nullptr, nullptr, polar});
    return found.back();
  };
  for (const auto& function : table.functions) {
    const PartOfFrf part = part_of(function.name);
    switch (part.part) {
      case Part::real:
      case Part::magnitude:
        pair_of(part.base, part.part == Part::magnitude).first = &function;
        break;
      case Part::imaginary:
      case Part::phase:
        pair_of(part.base, part.part == Part::phase).second = &function;
        break;
      case Part::coherence:
        for (auto& one : found) {
          if (one.coherence == nullptr && (one.base == part.base || found.size() == 1)) {
            one.coherence = &function;
            break;
          }
        }
        break;
      case Part::other:
        break;
    }
  }
  std::erase_if(found, [](const Columns& c) { return c.first == nullptr || c.second == nullptr; });
  return found;
}

/// Radians per number of a phase as read (degrees with a unit are converted already).
double phase_factor(const Channel& phase, FrfSet& set, const std::string& where) {
  if (phase.quantity == Quantity::angle) return 1;
  const double largest = phase.samples.cwiseAbs().maxCoeff();
  const bool degrees = largest > 2 * std::numbers::pi;
  set.notes.push_back({"phase_unit_assumed",
                       fmt::format("the phase has no unit and reaches {:.4g}: taken as {}", largest,
                                   degrees ? "degrees" : "radians"),
                       where});
  return degrees ? std::numbers::pi / 180 : 1;
}

Eigen::VectorXcd values_of(const Columns& columns, FrfSet& set, const std::string& where) {
  const Channel& first = *columns.first;
  Eigen::VectorXcd values(first.samples.size());
  if (!columns.polar) {
    values.real() = first.samples;
    values.imag() = columns.second->samples;
    return values;
  }
  const bool decibels = in_decibels(first);
  const double radians = phase_factor(*columns.second, set, where);
  for (Eigen::Index k = 0; k < values.size(); ++k) {
    const double magnitude = decibels ? std::pow(10.0, first.samples[k] / 20) : first.samples[k];
    values[k] = std::polar(1.0, radians * columns.second->samples[k]) * magnitude;
  }
  if (decibels) {
    set.notes.push_back({"decibel_reference",
                         "magnitudes in dB are taken over 1 of the FRF's unit: 10^(dB/20)", where});
  }
  return values;
}

FrfForm form_by_heading(const std::string& heading) {
  for (const auto& [word, form] :
       {std::pair<const char*, FrfForm>{"accelerance", FrfForm::accelerance},
        {"inertance", FrfForm::accelerance},
        {"mobility", FrfForm::mobility},
        {"receptance", FrfForm::receptance},
        {"compliance", FrfForm::receptance}}) {
    if (heading.find(word) != std::string::npos) return form;
  }
  return FrfForm::unknown;
}

/// Form and unit by the first FRF's columns; their numbers are in SI already where the unit is
/// known.
void set_form(const FrequencyTable& table, const Columns& columns, FrfSet& set) {
  if (const auto unit = parse_frf_unit(columns.first->source_unit)) {
    set.form = unit->form;
    set.unit = unit->unit;
    return;
  }
  set.form = form_by_heading(table.heading);
  if (const std::string unit = unit_of(set.form); !unit.empty()) {
    set.unit = unit;
    set.notes.push_back(
        {"unit_by_title",
         "the title says " + std::string(name_of(set.form)) + ": the numbers are taken in " + unit,
         table.path.string()});
    return;
  }
  set.notes.push_back({"no_unit",
                       "the FRFs have no unit that is known: the numbers are kept as they are; "
                       "frequencies and damping do not depend on it",
                       table.path.string()});
}

RecordingError refusal(const FrequencyTable& table, std::string problem, std::string remedy) {
  return {{table.path.string(), 0, 0, "", ""}, std::move(problem), std::move(remedy)};
}

}  // namespace

bool holds_frfs(const FrequencyTable& table) { return !pairs_of(table).empty(); }

FrfSet frfs_of(const std::vector<FrequencyTable>& tables) {
  FrfSet set;
  set.inputs.push_back({"force", 0, 0});
  std::vector<Eigen::VectorXcd> H;
  std::vector<Eigen::VectorXd> coherences;
  for (const auto& table : tables) {
    const auto pairs = pairs_of(table);
    if (pairs.empty()) {
      throw refusal(table, "is a spectrum without phase, not an FRF",
                    "export frequency, real and imaginary part (or magnitude and phase)");
    }
    if (set.frequency_hz.size() == 0) {
      set.frequency_hz = table.frequency_hz;
      set_form(table, pairs.front(), set);
    } else if (set.frequency_hz.size() != table.frequency_hz.size() ||
               (set.frequency_hz - table.frequency_hz).cwiseAbs().maxCoeff() >
                   1e-6 * set.frequency_hz.maxCoeff()) {
      throw refusal(table, "has other frequencies than " + tables.front().path.string(),
                    "give FRFs over the same lines");
    }
    for (const auto& note : table.notes) set.notes.push_back(note);
    for (const auto& columns : pairs) {
      const std::string stem = table.path.stem().string();
      const std::string name =
          columns.base.empty() ? stem
                               : (tables.size() == 1 ? columns.base : stem + " " + columns.base);
      set.responses.push_back({name, static_cast<int>(set.responses.size()) + 1, 0});
      H.push_back(values_of(columns, set, table.path.string()));
      if (columns.coherence != nullptr) coherences.push_back(columns.coherence->samples);
    }
  }
  // The line at 0 Hz is often no number; the last one is none where the file was cut short.
  Eigen::Index first = 0, lines = set.frequency_hz.size();
  const auto whole = [&](Eigen::Index line) {
    return std::all_of(H.begin(), H.end(),
                       [line](const auto& h) { return std::isfinite(std::abs(h[line])); });
  };
  if (!whole(0)) first = 1;
  if (lines > 2 && !whole(lines - 1)) --lines;
  if (const Eigen::Index left = set.frequency_hz.size() - (lines - first); left > 0) {
    set.notes.push_back({"line_left_out",
                         left == 2 ? "the first and the last line are no numbers and are left out"
                                   : std::string("the ") + (first == 1 ? "first" : "last") +
                                         " line is no number and is left out",
                         ""});
  }
  const Eigen::Index kept = lines - first;
  set.H.resize(kept, static_cast<Eigen::Index>(H.size()));
  for (std::size_t k = 0; k < H.size(); ++k) {
    set.H.col(static_cast<Eigen::Index>(k)) = H[k].segment(first, kept);
  }
  set.frequency_hz = Eigen::VectorXd(set.frequency_hz.segment(first, kept));
  if (!set.H.allFinite()) {
    throw refusal(tables.front(), "an FRF holds values that are no numbers",
                  "export the FRFs again");
  }
  if (coherences.size() == H.size()) {
    set.coherence.resize(kept, static_cast<Eigen::Index>(H.size()));
    for (std::size_t k = 0; k < H.size(); ++k) {
      set.coherence.col(static_cast<Eigen::Index>(k)) = coherences[k].segment(first, kept);
    }
    if (!set.coherence.allFinite()) set.coherence.resize(0, 0);
  }
  return set;
}

}  // namespace rigfit::signal
