// Speed against error: the rows of a study, which of them lie on the front, and how times are
// taken.
//
// A study solves one task by several methods and settings and compares each answer with a reference
// that is better than all of them and whose own error is estimated. A row lies on the front when no
// other row is both as fast and as accurate and clearly better in one of the two (kClearly): times
// repeat to about a tenth on a machine that does other things too. Errors below the reference's own
// count as equal.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "document/describe.h"

namespace rigfit::apps {

struct BenchRow {
  std::string method;
  /// Segments in a member, the mean over members; 0: none in this task.
  int segments = 0;
  std::optional<double> step_s;     ///< largest time step
  std::optional<double> tolerance;  ///< asked of the method
  double wall_s = 0;                ///< median, one thread, from the parsed inputs to the answer
  double relative_error = 1;        ///< 1 where the method failed
  bool is_default = false;          ///< what the program does when nothing is said
  bool on_front = false;
  std::string note;  ///< why it failed, or why a default is not on the front
};

struct BenchStudy {
  std::string task;
  std::string study;      ///< what varies where a task has several studies: "steps", "segments"
  std::string scene;      ///< title of the scene, or what the data are
  std::string error_of;   ///< whose relative error
  std::string reference;  ///< what it is compared with
  double reference_error = 0;
  /// Why a default that is not on the front is the default all the same: what it does besides.
  std::string default_does;
  std::vector<BenchRow> rows;
  std::string skipped;  ///< why there are no rows
};

/// How much a run may take.
struct BenchBudget {
  bool quick = false;
  int repeats = 15;    ///< most repeats of a row
  double row_s = 0.2;  ///< no further repeat of a row that took this long
};

/// Median time of runs of `work`, seconds. What takes microseconds is run often enough for the
/// clock.
[[nodiscard]] double median_time(const BenchBudget& budget, const std::function<void()>& work);

inline constexpr double kClearly = 0.9;  ///< a ratio of times or errors beyond scatter

/// Sets `on_front` of every row and the note of every default that is not on it.
void mark_front(BenchStudy& study);

/// "12.3 µs", "4.56 ms", "7.8 s".
[[nodiscard]] std::string time_words(double seconds);

}  // namespace rigfit::apps

namespace rigfit::describe {

template <>
struct Described<apps::BenchRow> {
  using T = apps::BenchRow;
  static constexpr std::string_view title{};
  static constexpr auto in_space = [](const T& r) { return r.segments > 0; };
  static constexpr auto fields = std::tuple{
      field(
          "",
          [](const T& r) {
            return std::string(r.is_default && r.on_front ? "front, default"
                               : r.is_default             ? "default"
                               : r.on_front               ? "front"
                                                          : "");
          },
          "", "place", ""),
      field("method", &T::method, "", "method", "with its setting"),
      field("segments", where(in_space, &T::segments), "", "segments", "of a member, on average"),
      field("step_s", &T::step_s, "s", "step", "the largest", 3),
      field("tolerance", &T::tolerance, "", "tolerance", "asked of the method", 2),
      field("wall_s", &T::wall_s, "s", "time", "median, one thread", 3),
      field("relative_error", &T::relative_error, "", "error", "1 where the method failed", 2),
      field("default", &T::is_default, "", "", "what the program does when nothing is said"),
      field("on_front", &T::on_front, "", "", "no other row is as fast and as accurate"),
      field("note", &T::note, "", "", "why it failed, or why a default is not on the front")};
};

}  // namespace rigfit::describe
