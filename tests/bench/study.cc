#include "tests/bench/study.h"

#include <charconv>
#include <cstdio>
#include <cstdlib>
#include <numeric>
#include <stdexcept>

namespace rigfit::study {

Table::Table(std::string rows, std::vector<Column> columns)
    : rows_(std::move(rows)), columns_(std::move(columns)), cells_(columns_.size()) {}

Table::Cell& Table::cell(std::string_view column) {
  for (std::size_t i = 0; i < columns_.size(); ++i) {
    if (columns_[i].title == column) return cells_[i];
  }
  throw std::logic_error(fmt::format("no column \"{}\"", column));
}

void Table::add(std::string_view column, double sample) { cell(column).samples.push_back(sample); }

void Table::add(std::string_view column, const std::string& code) { ++cell(column).codes[code]; }

std::string Table::text(const Column& column, Cell cell) {
  auto& samples = cell.samples;
  if (column.of == Of::codes) {
    std::string words;
    for (const auto& [code, count] : cell.codes) {
      words += fmt::format("{}{} {}", words.empty() ? "" : ", ", code, count);
    }
    return words.empty() ? "-" : words;
  }
  const auto print = [&](const char* usual, double value) {
    return fmt::format(fmt::runtime(column.format.empty() ? usual : column.format), value);
  };
  const double sum = std::accumulate(samples.begin(), samples.end(), 0.0);
  if (column.of == Of::sum) return print("{:.0f}", sum);
  if (samples.empty()) return "-";
  const auto n = static_cast<double>(samples.size());
  std::sort(samples.begin(), samples.end());
  switch (column.of) {
    case Of::share:
      return print("{:.1f}", 100 * sum / n);
    case Of::rms:
      return print(
          "{:.3g}",
          std::sqrt(std::inner_product(samples.begin(), samples.end(), samples.begin(), 0.0) / n));
    case Of::least:
      return print("{:.3g}", samples.front());
    case Of::median:
      return print("{:.3g}", samples[samples.size() / 2]);
    case Of::largest:
      return print("{:.3g}", samples.back());
    default:
      return print("{:.3g}", sum / n);
  }
}

void Table::end_row(const std::string& name) {
  if (!head_printed_) {
    std::string head = "| " + rows_ + " |", line = "|---|";
    for (const auto& column : columns_) head += " " + column.title + " |", line += "---|";
    fmt::print("{}\n{}\n", head, line);
    head_printed_ = true;
  }
  fmt::print("| {} |", name);
  for (std::size_t i = 0; i < columns_.size(); ++i) {
    fmt::print(" {} |", text(columns_[i], std::exchange(cells_[i], {})));
  }
  fmt::print("\n");
  std::fflush(stdout);
}

Arguments arguments(int argc, char** argv, int seeds, std::uint64_t first) {
  Arguments out{seeds, first, argc > 3 ? argv[3] : ""};
  const auto number = [&](int i, auto& value) {
    if (argc <= i) return true;
    const std::string_view word = argv[i];
    const auto read = std::from_chars(word.data(), word.data() + word.size(), value);
    return read.ec == std::errc() && read.ptr == word.data() + word.size();
  };
  if (argc > 4 || !number(1, out.seeds) || !number(2, out.first)) {
    fmt::print(stderr, "usage: {} [SEEDS] [FIRST SEED] [PART OF A NAME]\n", argv[0]);
    std::exit(2);
  }
  return out;
}

}  // namespace rigfit::study
