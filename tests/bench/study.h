// What the programs of this folder share: headers of numerical code, their arguments,
// `[SEEDS] [FIRST SEED] [PART OF A NAME]`, and a Markdown table with a row a case, whose columns
// gather samples over the seeds.
#pragma once

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <complex>
#include <cstdint>
#include <ctime>
#include <functional>
#include <limits>
#include <map>
#include <numbers>
#include <optional>
#include <random>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace rigfit {
using Complex = std::complex<double>;
using Eigen::Index;
}  // namespace rigfit

namespace rigfit::study {

/// What a cell prints of its samples; `share` in percent, `codes` each word with how often it came.
enum class Of { sum, share, mean, rms, least, median, largest, codes };

struct Column {
  std::string title;
  Of of = Of::share;
  std::string format =
      "";  ///< of fmt; "": one decimal of a share, whole sums, three digits of others
};

class Table {
 public:
  /// `rows`: the title of the first column, which has the rows' names.
  Table(std::string rows, std::vector<Column> columns);

  void add(std::string_view column, double sample);
  void add(std::string_view column, const std::string& code);
  /// Prints the row that the samples since the last one make, before the first one the head. A cell
  /// without samples prints "-", a sum 0.
  void end_row(const std::string& name);

 private:
  struct Cell {
    std::vector<double> samples;
    std::map<std::string, int> codes;
  };
  Cell& cell(std::string_view column);
  static std::string text(const Column& column, Cell cell);

  std::string rows_;
  std::vector<Column> columns_;
  std::vector<Cell> cells_;
  bool head_printed_ = false;
};

struct Arguments {
  int seeds = 0;
  std::uint64_t first = 1;
  std::string part;  ///< rows whose name contains it
};

/// Ends the program with exit code 2 and a line of usage where the first two are no numbers.
[[nodiscard]] Arguments arguments(int argc, char** argv, int seeds, std::uint64_t first = 1);

/// Adds one(case, seed, table) of each seed to a row for each case; a case has a `name`.
template <class Cases, class One>
void run(const Arguments& arguments, Table table, const Cases& cases, const One& one) {
  for (const auto& kind : cases) {
    const std::string name = kind.name;
    if (name.find(arguments.part) == std::string::npos) continue;
    for (int k = 0; k < arguments.seeds; ++k) {
      one(kind, arguments.first + static_cast<std::uint64_t>(k), table);
    }
    table.end_row(name);
  }
}

/// Interval: a struct with `low` and `high`; a NaN is an open end.
template <class Interval>
[[nodiscard]] bool held(const Interval& interval, double truth) {
  return !(interval.low > truth) && !(interval.high < truth);
}

/// What `call` returns and the processor time that it takes, s.
template <class Call>
[[nodiscard]] auto timed(const Call& call) {
  const std::clock_t begin = std::clock();
  auto result = call();
  return std::pair(std::move(result), static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC);
}

/// Takes the one of the things not yet taken that is nearest by distance(index), if that is below
/// `reach`; -1: none.
template <class Distance>
[[nodiscard]] int take_nearest(std::vector<bool>& taken, double reach, const Distance& distance) {
  int best = -1;
  for (std::size_t i = 0; i < taken.size(); ++i) {
    if (taken[i] || !(distance(i) < reach)) continue;
    best = static_cast<int>(i), reach = distance(i);
  }
  if (best >= 0) taken[best] = true;
  return best;
}

}  // namespace rigfit::study
