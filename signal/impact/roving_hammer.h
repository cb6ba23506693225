// Impact tests of several points struck, as one set of FRFs: the transducers stay, the hammer
// moves.
//
// Each point is an impact test of its own (impact_frfs.h); their FRFs become the columns of one set
// whose inputs are the points. A point that bears the name of a response is its driving point, and
// two such points are each other's reciprocity check.
#pragma once

#include <Eigen/Core>
#include <span>
#include <string>
#include <vector>

#include "signal/impact/impact_frfs.h"
#include "signal/recording/recording.h"
#include "signal/spectra/frf_checks.h"
#include "signal/spectra/frf_set.h"

namespace rigfit::signal {

struct StruckPoint {
  std::string name;
  std::span<const Recording> recordings;  ///< recordings of hits on the point
};

struct DrivingPoint {
  Eigen::Index response = 0, input = 0;  ///< of `RovingHammer::frfs`
  DrivingPointCheck check;
};

struct RovingHammer {
  std::vector<ImpactTest> tests;  ///< one a point, as given
  /// Responses x the points with an accepted hit, in their order; no lines when there is none.
  FrfSet frfs;
  std::vector<DrivingPoint> driving_points;
  std::vector<ReciprocityCheck> reciprocity;
  std::vector<Note> notes;
};

/// All recordings have the same channels and sample rate. `options.driving_response` is not used:
/// the points' names tell. Blocks are as long as the shortest that a point's hits leave. Throws as
/// analyse_impact_test does.
[[nodiscard]] RovingHammer analyse_roving_hammer(std::span<const StruckPoint> points,
                                                 const std::string& force,
                                                 std::span<const std::string> responses,
                                                 const ImpactTestOptions& options = {});

}  // namespace rigfit::signal
