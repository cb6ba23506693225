#include "signal/readers/frequency_table.h"

#include <cctype>
#include <regex>

#include "signal/recording/recording_time.h"

namespace rigfit::signal {

namespace {

RecordingError refused_frf(const FrfPart& part, std::string problem, std::string remedy) {
  return {{part.file, part.line}, std::move(problem), std::move(remedy)};
}

/// Place of the point in the list, added when it is new.
Index place(std::vector<MeasuredPoint>& points, const MeasuredPoint& point) {
  const Index at = std::ranges::find(points, point) - points.begin();
  if (at == std::ssize(points)) points.push_back(point);
  return at;
}

/// Finite, rising and not negative.
bool rises(const VectorXd& values) {
  const Index n = values.size();
  return values.allFinite() && values[0] >= 0 &&
         (values.tail(n - 1).array() > values.head(n - 1).array()).all();
}

void check_lines(const FrfPart& part, const FrfPart& first) {
  const auto& f = part.frequency_hz;
  if (!rises(f)) {
    throw refused_frf(part, "the frequencies do not rise", "export the FRFs again");
  }
  if (!same_lines(f, first.frequency_hz)) {
    throw refused_frf(part, "has other frequencies than the first FRF",
                      "give functions over the same lines");
  }
  if (part.unit.form != first.unit.form) {
    throw refused_frf(part, "is of another form (receptance, mobility, accelerance) than the first",
                      "convert all FRFs to one form first");
  }
}

/// One of the words, parted by '|', that stands by itself in lower case.
std::regex word_of(const std::string& words) {
  return std::regex("(?:^|[^a-z])(" + words + ")(?![a-z])");
}
const std::regex kDecibel = word_of("db"), kLevel = word_of("db|rms|magnitude");
const std::regex kSpectrum = word_of(
    "fft|spectrum|spectra|spektrum|psd|asd|autopower|autospectrum|frf|cpsd|coherence|crosspower|"
    "octave|periodogram|accelerance|inertance|receptance|mobility|transfer function");

/// The first such word in the text; empty: none.
std::string word_in(const std::string& text, const std::regex& word) {
  std::smatch found;
  return std::regex_search(text, found, word) ? found[1].str() : "";
}

bool is_hertz(const std::string& unit) {
  const auto parsed = parse_unit(unit);
  return parsed && parsed->si == "Hz";
}

bool is_frequency_name(const std::string& name) {
  static const std::regex kBeginning("^(freq|frek|fréq|frec|f_hz|hz)");
  const std::string word = lower_case(name);
  return word.find("response") == std::string::npos && std::regex_search(word, kBeginning);
}

bool speaks_of_spectra(const std::string& text) {
  return std::regex_search(text, kSpectrum) || std::regex_search(text, kDecibel);
}

/// Frequencies that do not rise, of a table of spectra or of one whose first frequency comes again.
void refuse_repeated(const CsvTable& table, std::size_t column) {
  const auto& f = table.channels[column].samples;
  for (Index k = 1; k < f.size(); ++k) {
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
      {"|magnitude|mag|spl|amplitude|ampl|amp|modulus|abs|betrag|gain|", Part::magnitude},
      {"|phase|angle|arg|", Part::phase},
      {"|coherence|coh|gamma2|kohaerenz|kohärenz|", Part::coherence},
  };
  static const std::regex kSign("[_()\\[\\]:-]");
  const std::string lower = std::regex_replace(lower_case(title), kSign, " ");
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
  for (std::size_t k = 1; k < table.channels.size(); ++k) {
    const Channel& function = table.channels[k];
    const PartOfFrf part = part_of(function.name);
    const bool polar = part.part == Part::magnitude || part.part == Part::phase;
    if (part.part == Part::real || part.part == Part::magnitude) {
      found.push_back({part.base, polar, &function});
    } else if (part.part != Part::other) {
      // Belongs to a pair of this name that lacks it.
      const bool is_coherence = part.part == Part::coherence;
      const auto member = is_coherence ? &Columns::coherence : &Columns::second;
      const auto one = std::ranges::find_if(found, [&](const Columns& c) {
        const bool fits =
            is_coherence ? found.size() == 1 : c.base == part.base && c.polar == polar;
        return c.*member == nullptr && (fits || (is_coherence && c.base == part.base));
      });
      if (one != found.end()) (*one).*member = &function;
    }
  }
  std::erase_if(found, [](const Columns& c) { return c.second == nullptr; });
  return found;
}

/// Values in SI; `known` is the channel whose unit is that of the real or imaginary part without
/// one.
VectorXcd values_of(const Columns& columns, const Channel& known, FrfSet& set,
                    const std::string& where) {
  const Channel& first = *columns.first;
  const auto parts = [](const auto& real, const auto& imaginary) -> VectorXcd {
    return real.template cast<Complex>() + imaginary * Complex(0, 1);
  };
  const auto si = [&](const Channel& part) -> VectorXd {
    if (part.source_unit.empty()) return known.si_per_source * part.samples;
    if (part.source_unit == known.source_unit) return part.samples;
    throw RecordingError({where, 0, 0, part.name, part.source_unit},
                         "is of another unit than \"" + known.name + "\", " + known.source_unit,
                         "write one unit into the titles of both parts");
  };
  if (!columns.polar) return parts(si(first), si(*columns.second));
  if (columns.second->quantity != Quantity::angle) {
    throw RecordingError({where, 0, 0, columns.second->name}, "the phase has no unit",
                         "write it into its title: Phase (deg) or Phase (rad)");
  }
  const ArrayXd phase = columns.second->samples;
  ArrayXd magnitude = first.samples;
  if (std::regex_search(lower_case(first.source_unit + " " + first.name), kDecibel)) {
    magnitude = Eigen::pow(10.0, magnitude / 20);
    add_note(set.notes, "assumed", where,
             "magnitudes in dB are taken over 1 of the FRF's unit: 10^(dB/20)");
  }
  return parts(magnitude * phase.cos(), magnitude * phase.sin());
}

}  // namespace

std::optional<FrfUnit> parse_frf_unit(const std::string& text) {
  const auto q = parse_quotient(text, Quantity::force);
  if (!q) return std::nullopt;
  return FrfUnit{q->over.factor / q->under.factor, form_of(q->over.quantity),
                 "(" + q->over.si + ")/" + q->under.si};
}

bool same_lines(const VectorXd& a, const VectorXd& b) {
  return a.size() == b.size() && a.allFinite() &&
         (a - b).cwiseAbs().maxCoeff() <= 1e-6 * std::max(1e-300, b.cwiseAbs().maxCoeff());
}

FrfSet set_of_parts(const std::vector<FrfPart>& parts) {
  FrfSet set;
  const FrfPart& first = parts.front();
  set.form = first.unit.form;
  set.unit = first.unit.unit;
  if (set.unit.empty()) {
    add_note(set.notes, "no_unit", first.file,
             "the FRFs have no unit that is known: the numbers are kept as they are; frequencies "
             "and damping do not depend on it");
  }
  std::map<std::pair<Index, Index>, const FrfPart*> placed;
  for (const auto& part : parts) {
    check_lines(part, first);
    const std::pair at(place(set.responses, part.response), place(set.inputs, part.input));
    if (placed.emplace(at, &part).second) continue;
    throw refused_frf(
        part,
        fmt::format("is a second FRF from \"{}\" to \"{}\"", part.input.name, part.response.name),
        "keep one of the two");
  }
  const auto responses = static_cast<Index>(set.responses.size());
  const auto inputs = static_cast<Index>(set.inputs.size());
  for (Index r = 0; r < responses; ++r) {
    for (Index i = 0; i < inputs; ++i) {
      if (placed.contains({r, i})) continue;
      throw refused_frf(
          first,
          fmt::format("no FRF from \"{}\" to \"{}\"", set.inputs[static_cast<std::size_t>(i)].name,
                      set.responses[static_cast<std::size_t>(r)].name),
          "give FRFs of all responses to all inputs");
    }
  }
  const auto note = [&](const char* code, const std::string& message) {
    set.notes.push_back({code, message, ""});
  };
  const Index lines = first.frequency_hz.size();
  const auto is_number = [&](Index line) {
    return std::ranges::all_of(
        parts, [&](const FrfPart& part) { return std::isfinite(std::abs(part.H[line])); });
  };
  const Index begin = lines > 1 && !is_number(0) ? 1 : 0;
  const Index end = lines > 2 && !is_number(lines - 1) ? lines - 1 : lines;
  if (const Index left = lines - (end - begin); left > 0) {
    note("data_left_out", fmt::format("lines without numbers at the ends are left out: {}", left));
  }
  const Index kept = end - begin, columns = responses * inputs;
  set.frequency_hz = first.frequency_hz.segment(begin, kept);
  set.H.resize(kept, columns);
  for (const auto& [at, part] : placed) {
    set.H.col(set.column(at.first, at.second)) = part->H.segment(begin, kept);
    if (!part->H.segment(begin, kept).allFinite()) {
      throw refused_frf(*part, "an FRF holds values that are no numbers", "export the FRFs again");
    }
  }
  const auto fill = [&](VectorXd FrfPart::*values, MatrixXd& into, const std::string& what) {
    const auto known = std::ranges::count_if(
        parts, [&](const FrfPart& part) { return (part.*values).size() == lines; });
    if (known == 0) return;
    if (known < columns) return note("incomplete", what + " of some FRFs only: left out");
    into.resize(kept, columns);
    for (const auto& [at, part] : placed) {
      into.col(set.column(at.first, at.second)) = (part->*values).segment(begin, kept);
    }
    if (into.allFinite()) return;
    note("not_a_number", what + " holds values that are no numbers: left out");
    into.resize(0, 0);
  };
  fill(&FrfPart::coherence, set.coherence, "coherence");
  fill(&FrfPart::H_std, set.H_std, "standard deviation");
  return set;
}

std::optional<std::size_t> frequency_column(const CsvTable& table) {
  std::string titles = table.layout.heading;
  for (std::size_t k = 0; k < table.channels.size(); ++k) {
    if (table.is_time(k)) return std::nullopt;
    titles += lower_case(table.columns[k].name + " " + table.columns[k].unit) + '\n';
  }
  if (table.channels.size() < 2 || table.channels[0].samples.size() < 3) return std::nullopt;
  // The frequencies stand first, or behind a column of line numbers.
  for (std::size_t k = 0; k < std::min<std::size_t>(2, table.channels.size() - 1); ++k) {
    const CsvColumn& column = table.columns[k];
    const bool hertz = is_hertz(column.unit), named = is_frequency_name(column.name);
    if (!hertz && !named) continue;
    const bool other = !hertz && (!column.unit.empty() || column.name.ends_with(')'));
    if (!rises(table.channels[k].samples)) {
      if (!other) refuse_repeated(table, k);
      continue;
    }
    if (!other) return k;
    throw RecordingError({table.file, table.layout.body_line, 0, column.name, column.unit},
                         "the frequencies are in no unit of frequency that is known",
                         "give them in Hz, and write Hz into their title");
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
    std::string word = word_in(title, kSpectrum);
    if (word.empty() && !is_dated) word = word_in(title, kLevel);
    if (!word.empty()) return column.name.empty() ? word : column.name;
  }
  return is_dated ? "" : word_in(table.layout.heading, kSpectrum);
}

FrfSet frfs_of(const std::vector<CsvTable>& tables) {
  FrfSet about;  // notes
  std::vector<FrfPart> parts;
  for (const auto& table : tables) {
    const std::string stem = std::filesystem::path(table.file).stem().string();
    const auto pairs = pairs_of(table);
    if (pairs.empty()) {
      throw file_error(table.file,
                       "is a spectrum without phase, or its titles do not name the parts",
                       "export frequency, real and imaginary part (or magnitude and phase)");
    }
    about.notes.insert(about.notes.end(), table.notes.begin(), table.notes.end());
    const Channel* known = nullptr;
    for (const auto& columns : pairs) {
      const std::string name = columns.base.empty() ? stem
                               : tables.size() == 1 ? columns.base
                                                    : stem + " " + columns.base;
      const bool is_first = columns.polar || !columns.first->source_unit.empty();
      const Channel& own = is_first ? *columns.first : *columns.second;
      if (known == nullptr || columns.polar || !own.source_unit.empty()) known = &own;
      FrfPart part;
      part.response = {name, static_cast<int>(parts.size()) + 1, 0};
      part.input.name = "force";
      part.unit = parse_frf_unit(known->source_unit).value_or(FrfUnit());
      part.frequency_hz = table.channels[0].samples;
      part.H = values_of(columns, *known, about, table.file);
      part.file = table.file;
      if (columns.coherence != nullptr) part.coherence = columns.coherence->samples;
      parts.push_back(std::move(part));
    }
  }
  FrfSet set = set_of_parts(parts);
  set.notes.insert(set.notes.begin(), about.notes.begin(), about.notes.end());
  return set;
}

}  // namespace rigfit::signal
