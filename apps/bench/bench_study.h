// Speed against error: a study solves one task by several methods and settings and compares each
// answer with a reference that is better than all of them and whose own error is estimated.
#pragma once

#include <optional>
#include <string>
#include <tuple>
#include <vector>

#include "apps/report/drawing/plot.h"
#include "document/describe.h"
#include "model/scene/scene.h"

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
  std::string note;                 ///< why it failed

  static constexpr auto fields() {
    using T = BenchRow;
    return std::tuple{
        field("method", &T::method, "", "method", "with its setting"),
        field("segments", describe::positive(&T::segments), "", "segments",
              "of a member, on average"),
        field("step_s", &T::step_s, "s", "step", "the largest", 3),
        field("tolerance", &T::tolerance, "", "tolerance", "asked of the method", 2),
        field("wall_s", &T::wall_s, "s", "time", "median, one thread", 3),
        field("relative_error", &T::relative_error, "", "error", "1 where the method failed", 2),
        field("default", &T::is_default, "", "", "what the program does when nothing is said"),
        field("note", &T::note, "", "remark", "why it failed")};
  }
};

struct BenchStudy {
  std::string task = "nonlinear-response";
  std::string study;      ///< what varies: "steps", "segments"
  std::string scene;      ///< title of the scene
  std::string error_of;   ///< whose relative error
  std::string reference;  ///< what it is compared with
  double reference_error = 0;
  std::vector<BenchRow> rows;
  std::string skipped;  ///< why there are no rows

  static constexpr auto fields() {
    using T = BenchStudy;
    return std::tuple{
        field("task", &T::task),           field("study", &T::study),
        field("scene", &T::scene),         field("error_of", &T::error_of),
        field("reference", &T::reference), field("reference_error", &T::reference_error)};
  }
};

/// Time against error, a series a method; without series where nothing of the study has a time and
/// an error.
[[nodiscard]] Plot bench_plot(const BenchStudy& study);

/// The paper's cable at 200 N, 1 kg hung at its quarter span and cut at t = 0; 30 segments.
[[nodiscard]] model::Scene bench_released_cable();

/// Large motions: "steps" compares integrators on the same segments with the explicit scheme at a
/// fraction of its step (its own error: against a step one and a half times as long);
/// "segments" compares numbers of segments with many (own error: against two thirds as many).
/// Sensors of acceleration and velocity are read as displacements: the accelerations of a cut
/// string hold frequencies up to where the segments end. A scene whose loads are records is skipped
/// with a reason. `quick`: few repeats, coarser references.
[[nodiscard]] std::vector<BenchStudy> response_studies(const model::Scene& scene, double duration_s,
                                                       bool quick);

}  // namespace rigfit::apps
