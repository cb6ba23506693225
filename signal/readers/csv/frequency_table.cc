#include "signal/readers/csv/frequency_table.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>

#include "signal/readers/csv/csv_fields.h"
#include "signal/readers/csv/csv_time.h"
#include "signal/recording/recording_error.h"

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

bool is_hertz(const std::string& unit) {
  const std::string word = lower_case(unit);
  return word == "hz" || word == "khz" || word == "hertz";
}

bool is_frequency_name(const std::string& name) {
  const std::string word = lower_case(name);
  static constexpr std::array<std::string_view, 11> kBeginnings = {
      "frequency", "freq",   "frequenz", "frekvens", "fréquence", "frecuencia",
      "frequenza", "f [hz]", "f (hz)",   "f_hz",     "hz"};
  return std::any_of(kBeginnings.begin(), kBeginnings.end(), [&](std::string_view beginning) {
    return word.starts_with(beginning) && word.find("response") == std::string::npos;
  });
}

constexpr std::array<std::string_view, 19> kSpectrumWords = {
    "fft",        "spectrum",     "spectra",          "spektrum",
    "psd",        "asd",          "autopower",        "frf",
    "cpsd",       "autospectrum", "periodogram",      "coherence",
    "crosspower", "octave",       "accelerance",      "inertance",
    "receptance", "mobility",     "transfer function"};

/// The first of `words` in the text; empty: none.
template <std::size_t N>
std::string_view word_in(const std::string& text, const std::array<std::string_view, N>& words) {
  for (const std::string_view word : words) {
    if (has_word(text, word)) return word;
  }
  return {};
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

}  // namespace

bool in_decibels(const Channel& function) {
  return has_word(lower_case(function.source_unit + " " + function.name), "db");
}

std::optional<std::size_t> frequency_column(const CsvTable& table) {
  const auto column = [&](std::size_t k) -> const CsvColumn& {
    return table.layout.columns[table.column[k]];
  };
  std::string titles = table.layout.heading;
  for (std::size_t k = 0; k < table.channels.size(); ++k) {
    if (column(k).kind == ColumnKind::clock || table.channels[k].quantity == Quantity::time ||
        is_time_name(column(k).name)) {
      return std::nullopt;
    }
    titles += lower_case(column(k).name + " " + column(k).unit) + '\n';
  }
  if (table.channels.size() < 2) return std::nullopt;
  // The frequencies stand first, or behind a column of line numbers.
  for (std::size_t k = 0; k < std::min<std::size_t>(2, table.channels.size() - 1); ++k) {
    const bool named =
        is_hertz(column(k).unit) || (column(k).unit.empty() && is_frequency_name(column(k).name));
    if (named && rises(table.channels[k].samples)) return k;
  }
  const auto& first = table.channels[0].samples;
  if (!table.channels[0].source_unit.empty() || !speaks_of_spectra(titles) || !rises(first)) {
    return std::nullopt;
  }
  return std::size_t{0};
}

std::string spectrum_without_frequencies(const CsvTable& table) {
  static constexpr std::array<std::string_view, 3> kWithoutRate = {"db", "rms", "magnitude"};
  const bool has_rate = table.layout.stated_rate_hz > 0;
  for (std::size_t k = 0; k < table.channels.size(); ++k) {
    const CsvColumn& column = table.layout.columns[table.column[k]];
    if (column.kind == ColumnKind::clock || table.channels[k].quantity == Quantity::time ||
        is_time_name(column.name)) {
      return {};
    }
  }
  for (std::size_t k = 0; k < table.channels.size(); ++k) {
    const CsvColumn& column = table.layout.columns[table.column[k]];
    const std::string title = lower_case(column.name + " " + column.unit);
    std::string_view word = word_in(title, kSpectrumWords);
    if (word.empty() && !has_rate) {
      word = word_in(title, kWithoutRate);
      const auto& values = table.channels[k].samples;
      const bool negative = (values.array() < 0).any();  // NaN is not
      if (negative && word != "db") word = {};
    }
    if (!word.empty()) return column.name.empty() ? std::string(word) : column.name;
  }
  return has_rate ? std::string() : std::string(word_in(table.layout.heading, kSpectrumWords));
}

std::optional<FrequencyTable> read_frequency_table(std::string_view bytes,
                                                   const std::filesystem::path& path,
                                                   const ReadOptions& options) {
  std::string converted;
  CsvTable csv = read_csv_columns(text_without_mark(bytes, converted, path.string()), path.string(),
                                  {}, options);
  const auto at = frequency_column(csv);
  if (!at) return std::nullopt;
  FrequencyTable table;
  table.path = path;
  table.heading = csv.layout.heading;
  table.notes = std::move(csv.notes);
  table.frequency_hz = csv.channels[*at].samples;
  for (std::size_t k = *at + 1; k < csv.channels.size(); ++k) {
    const auto kind = csv.layout.columns[csv.column[k]].kind;
    if (kind == ColumnKind::numbers) table.functions.push_back(std::move(csv.channels[k]));
  }
  if (table.functions.empty()) {
    throw RecordingError({path.string(), csv.layout.body_line, 0, "", ""},
                         "holds frequencies and nothing beside them", "export the functions too");
  }
  return table;
}

}  // namespace rigfit::signal
