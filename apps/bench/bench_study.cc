#include "apps/bench/bench_study.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>

namespace rigfit::apps {
namespace {

constexpr double kAsAccurate = 1.01;  // the same discretisation in other unknowns differs by less

double seconds_of(const std::function<void()>& work, long runs) {
  const auto begin = std::chrono::steady_clock::now();
  for (long i = 0; i < runs; ++i) work();
  const std::chrono::duration<double> spent = std::chrono::steady_clock::now() - begin;
  return spent.count() / static_cast<double>(runs);
}

std::string setting_words(const BenchRow& row) {
  std::string text = row.method;
  if (row.segments > 0) text += fmt::format(", {} segments", row.segments);
  if (row.step_s) text += fmt::format(", step {:.2g} ms", 1e3 * *row.step_s);
  if (row.tolerance) text += fmt::format(", tolerance {:.0e}", *row.tolerance);
  return text;
}

}  // namespace

double median_time(const BenchBudget& budget, const std::function<void()>& work) {
  constexpr double kClock = 2e-4;  // s: a thousand times what the clock resolves
  double first = seconds_of(work, 1);
  if (first >= budget.row_s) return first;
  const long batch =
      first < kClock ? std::clamp(static_cast<long>(kClock / std::max(first, 1e-9)), 1L, 100'000L)
                     : 1;
  std::vector<double> times;
  if (batch == 1) times.push_back(first);
  double spent = first;
  while (static_cast<int>(times.size()) < budget.repeats && spent < budget.row_s) {
    times.push_back(seconds_of(work, batch));
    spent += times.back() * static_cast<double>(batch);
  }
  std::sort(times.begin(), times.end());
  return times[times.size() / 2];
}

void mark_front(BenchStudy& study) {
  const auto error_of = [&](const BenchRow& row) {
    return std::max(row.relative_error, study.reference_error);
  };
  const auto beats = [&](const BenchRow& a, const BenchRow& b) {
    const double ea = error_of(a), eb = error_of(b);
    return a.wall_s <= b.wall_s && ea <= kAsAccurate * eb &&
           (a.wall_s < kClearly * b.wall_s || ea < kClearly * eb);
  };
  for (BenchRow& row : study.rows) {
    const BenchRow* better = nullptr;
    for (const BenchRow& other : study.rows) {
      if (&other == &row || !beats(other, row)) continue;
      if (!better || other.wall_s < better->wall_s) better = &other;
    }
    row.on_front = !better && row.relative_error < 1;
    if (row.is_default && better) {
      row.note =
          fmt::format("{} takes {} for an error of {:.1e}; {}", setting_words(*better),
                      time_words(better->wall_s), better->relative_error, study.default_does);
    }
  }
}

std::string time_words(double seconds) {
  return seconds < 9.995e-4 ? fmt::format("{:.3g} µs", 1e6 * seconds)
         : seconds < 0.9995 ? fmt::format("{:.3g} ms", 1e3 * seconds)
                            : fmt::format("{:.3g} s", seconds);
}

}  // namespace rigfit::apps
