#include "signal/readers/csv/frequency_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <complex>
#include <numbers>
#include <ranges>
#include <span>
#include <utility>

#include "signal/readers/files/frf_parts.h"
#include "signal/recording/recording_error.h"
#include "signal/recording/recording_time.h"

namespace rigfit::signal {

namespace {

/// Whether `text` (lower case) holds the word by itself.
bool has_word(std::string_view text, std::string_view word) {
  const auto is_letter = [](char c) { return std::isalpha(static_cast<unsigned char>(c)) != 0; };
  for (std::size_t at = text.find(word); at != std::string_view::npos;
       at = text.find(word, at + 1)) {
    const std::size_t end = at + word.size();
    if ((at == 0 || !is_letter(text[at - 1])) && (end >= text.size() || !is_letter(text[end]))) {
      return true;
    }
  }
  return false;
}

bool is_hertz(const std::string& unit) { return is_listed("|hz|khz|hertz|", lower_case(unit)); }

bool is_frequency_name(const std::string& name) {
  const std::string word = lower_case(name);
  if (word.find("response") != std::string::npos) return false;
  return std::ranges::any_of(
      std::to_array<std::string_view>({"freq", "frek", "fréq", "frec", "f_hz", "hz"}),
      [&](std::string_view beginning) { return word.starts_with(beginning); });
}

constexpr std::string_view kSpectrumWords[] = {
    "fft",        "spectrum",    "spectra",          "spektrum",
    "psd",        "asd",         "autopower",        "autospectrum",
    "frf",        "cpsd",        "coherence",        "crosspower",
    "octave",     "periodogram", "accelerance",      "inertance",
    "receptance", "mobility",    "transfer function"};

/// The first of the words in the text (lower case); empty: none.
std::string_view word_in(const std::string& text, std::span<const std::string_view> words) {
  const auto found =
      std::ranges::find_if(words, [&](std::string_view word) { return has_word(text, word); });
  return found == words.end() ? std::string_view{} : *found;
}

bool speaks_of_spectra(const std::string& text) {
  return !word_in(text, kSpectrumWords).empty() || has_word(text, "db");
}

/// Finite, rising and not negative.
bool rises(const Eigen::VectorXd& values) {
  const Eigen::Index n = values.size();
  return n >= 3 && values.allFinite() && values[0] >= 0 &&
         (values.tail(n - 1).array() > values.head(n - 1).array()).all();
}

/// Frequencies that do not rise, of a table of spectra or of one whose first frequency comes again.
void refuse_repeated(const CsvTable& table, std::size_t column) {
  const auto& f = table.channels[column].samples;
  for (Eigen::Index k = 1; k < f.size(); ++k) {
    const bool again = f[k] == f[k - 1] || f[k] == f[0];
    if (!again && !(f[k] < f[k - 1] && speaks_of_spectra(table.layout.heading))) continue;
    throw RecordingError(
        {table.file, table.layout.body_line + static_cast<long>(k), 0, table.channels[column].name,
         fmt::format("{:.9g}", f[k])},
        "the frequency repeats or falls, so that this table has several values for it",
        "export one table with rising frequencies; several FRFs: a column each, or a file each");
  }
}

enum class Part { real, imaginary, magnitude, phase, coherence, other };

struct PartOfFrf {
  Part part = Part::other;
  std::string base;  ///< what the title says besides
};

/// "Real Point 3" -> {real, "point 3"}; the word may stand anywhere in the title.
PartOfFrf part_of(const std::string& title) {
  static constexpr std::pair<std::string_view, Part> kWords[] = {
      {"|imaginary|imaginaer|imaginär|imag|im|", Part::imaginary},
      {"|real|re|", Part::real},
      {"|magnitude|mag|amplitude|ampl|amp|modulus|abs|betrag|gain|", Part::magnitude},
      {"|phase|angle|arg|", Part::phase},
      {"|coherence|coh|gamma2|kohaerenz|kohärenz|", Part::coherence},
  };
  std::string lower = lower_case(title);
  for (char& c : lower) {
    if (c == '_' || c == '(' || c == ')' || c == '[' || c == ']' || c == '-' || c == ':') c = ' ';
  }
  PartOfFrf result;
  std::vector<CsvField> words;
  split_fields(lower, {' ', '.'}, words);
  for (const auto& word : words) {
    const std::string text(word.text);
    const auto* const known =
        std::find_if(std::begin(kWords), std::end(kWords),
                     [&](const auto& one) { return is_listed(one.first, text); });
    if (known != std::end(kWords) && result.part == Part::other) {
      result.part = known->second;
    } else if (!is_listed("|part|of|db|h|frf|", text)) {
      result.base += (result.base.empty() ? "" : " ") + text;
    }
  }
  return result;
}

/// The columns of one FRF in a table.
struct Columns {
  std::string base;
  bool polar = false;
  const Channel *first = nullptr, *second = nullptr, *coherence = nullptr;
};

std::vector<Columns> pairs_of(const CsvTable& table) {
  std::vector<Columns> found;
  const auto take = [&](const Channel* Columns::*place, const Channel& function,
                        const PartOfFrf& of, bool polar) {
    // A pair of this name that lacks its second part, or a new one.
    const auto one = std::ranges::find_if(found, [&](const Columns& c) {
      return c.base == of.base && c.polar == polar && c.second == nullptr;
    });
    auto& pair = one != found.end() ? *one : found.emplace_back(Columns{of.base, polar});
    pair.*place = &function;
  };
  for (const auto& function : table.channels | std::views::drop(1)) {
    const PartOfFrf part = part_of(function.name);
    const bool polar = part.part == Part::magnitude || part.part == Part::phase;
    if (part.part == Part::real || part.part == Part::magnitude) {
      take(&Columns::first, function, part, polar);
    } else if (part.part == Part::imaginary || part.part == Part::phase) {
      take(&Columns::second, function, part, polar);
    } else if (part.part == Part::coherence) {
      const auto one = std::ranges::find_if(found, [&](const Columns& c) {
        return c.coherence == nullptr && (c.base == part.base || found.size() == 1);
      });
      if (one != found.end()) one->coherence = &function;
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
  add_note(set.notes, "assumed", where, "the phase has no unit and reaches {:.4g}: taken as {}",
           largest, degrees ? "degrees" : "radians");
  return degrees ? std::numbers::pi / 180 : 1;
}

Eigen::VectorXcd values_of(const Columns& columns, FrfSet& set, const std::string& where) {
  const Channel& first = *columns.first;
  const auto parts = [](const auto& real, const auto& imaginary) -> Eigen::VectorXcd {
    return real.template cast<std::complex<double>>() + imaginary * std::complex<double>(0, 1);
  };
  if (!columns.polar) return parts(first.samples, columns.second->samples);
  const Eigen::ArrayXd phase =
      phase_factor(*columns.second, set, where) * columns.second->samples.array();
  Eigen::ArrayXd magnitude = first.samples;
  if (has_word(lower_case(first.source_unit + " " + first.name), "db")) {
    magnitude = Eigen::pow(10.0, magnitude / 20);
    add_note(set.notes, "assumed", where,
             "magnitudes in dB are taken over 1 of the FRF's unit: 10^(dB/20)");
  }
  return parts(magnitude * phase.cos(), magnitude * phase.sin());
}

/// Form and unit by the first FRF's columns; their numbers are in SI already where the unit is
/// known.
void set_form(const CsvTable& table, const Columns& columns, FrfSet& set) {
  if (const auto unit = parse_frf_unit(columns.first->source_unit)) {
    set.form = unit->form;
    set.unit = unit->unit;
    return;
  }
  add_note(set.notes, "no_unit", table.file,
           "the FRFs have no unit that is known: the numbers are kept as they are; "
           "frequencies and damping do not depend on it");
}

}  // namespace

std::optional<std::size_t> frequency_column(const CsvTable& table) {
  std::string titles = table.layout.heading;
  for (std::size_t k = 0; k < table.channels.size(); ++k) {
    if (table.is_time(k)) return std::nullopt;
    titles += lower_case(table.columns[k].name + " " + table.columns[k].unit) + '\n';
  }
  if (table.channels.size() < 2) return std::nullopt;
  // The frequencies stand first, or behind a column of line numbers.
  for (std::size_t k = 0; k < std::min<std::size_t>(2, table.channels.size() - 1); ++k) {
    const CsvColumn& column = table.columns[k];
    if (!is_hertz(column.unit) && !(column.unit.empty() && is_frequency_name(column.name)))
      continue;
    if (rises(table.channels[k].samples)) return k;
    refuse_repeated(table, k);
  }
  const Channel& first = table.channels[0];
  return first.source_unit.empty() && speaks_of_spectra(titles) && rises(first.samples)
             ? std::optional<std::size_t>(0)
             : std::nullopt;
}

std::string spectrum_without_frequencies(const CsvTable& table) {
  bool is_dated = table.layout.stated_rate_hz > 0;
  for (std::size_t k = 0; k < table.channels.size(); ++k) is_dated |= table.is_time(k);
  for (const CsvColumn& column : table.columns) {
    const std::string title = lower_case(column.name + " " + column.unit);
    std::string_view word = word_in(title, kSpectrumWords);
    constexpr std::string_view kLevels[] = {"db", "rms", "magnitude"};
    if (word.empty() && !is_dated) word = word_in(title, kLevels);
    if (!word.empty()) return column.name.empty() ? std::string(word) : column.name;
  }
  return is_dated ? std::string() : std::string(word_in(table.layout.heading, kSpectrumWords));
}

std::optional<CsvTable> frequency_table_of(CsvTable table) {
  const auto at = frequency_column(table);
  if (!at) return std::nullopt;
  std::vector<Channel> kept;
  for (std::size_t k = *at; k < table.channels.size(); ++k) {
    if (k > *at && table.columns[k].kind != ColumnKind::numbers) continue;
    kept.push_back(std::move(table.channels[k]));
  }
  table.channels = std::move(kept);
  return table;
}

FrfSet frfs_of(const std::vector<CsvTable>& tables) {
  FrfSet about;  // form, unit and notes
  std::vector<FrfPart> parts;
  for (const auto& table : tables) {
    const std::string stem = std::filesystem::path(table.file).stem().string();
    const auto pairs = pairs_of(table);
    if (pairs.empty()) {
      throw file_error(table.file, "is a spectrum without phase, not an FRF",
                       "export frequency, real and imaginary part (or magnitude and phase)");
    }
    if (parts.empty()) set_form(table, pairs.front(), about);
    about.notes.insert(about.notes.end(), table.notes.begin(), table.notes.end());
    for (const auto& columns : pairs) {
      const std::string name = columns.base.empty() ? stem
                               : tables.size() == 1 ? columns.base
                                                    : stem + " " + columns.base;
      FrfPart part{{name, static_cast<int>(parts.size()) + 1, 0},
                   {"force", 0, 0},
                   about.form,
                   table.channels[0].samples,
                   values_of(columns, about, table.file),
                   {},
                   {},
                   table.file};
      if (columns.coherence != nullptr) part.coherence = columns.coherence->samples;
      parts.push_back(std::move(part));
    }
  }
  FrfSet set = set_of_parts(parts);
  set.unit = about.unit;
  set.notes.insert(set.notes.begin(), about.notes.begin(), about.notes.end());
  return set;
}

}  // namespace rigfit::signal
