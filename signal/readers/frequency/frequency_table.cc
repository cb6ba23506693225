#include "signal/readers/frequency/frequency_table.h"

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

bool speaks_of_spectra(const std::string& text) {
  static constexpr std::array<std::string_view, 21> kWords = {
      "fft",         "spectrum",     "spectra",
      "spektrum",    "psd",          "asd",
      "autopower",   "autospectrum", "frf",
      "periodogram", "cpsd",         "crosspower",
      "coherence",   "db",           "accelerance",
      "inertance",   "receptance",   "mobility",
      "octave",      "rms spectrum", "transfer function"};
  return std::any_of(kWords.begin(), kWords.end(),
                     [&](std::string_view word) { return has_word(text, word); });
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
