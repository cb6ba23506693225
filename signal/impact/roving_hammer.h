// Combines impact tests at several points into one set of FRFs: the transducers stay, the hammer
// moves.
//
// Each point is an impact test of its own (impact_frfs.h); their FRFs become the columns of one set
// whose inputs are the points. A point with the name of a response is a driving point, and two such
// points allow a reciprocity check.
#pragma once

#include "signal/impact/impact_frfs.h"
#include "signal/spectra/frf_checks.h"

namespace rigfit::signal {

struct StruckPoint {
  std::string name;  ///< empty: the only point, its input has the name of the force
  std::vector<Recording> recordings;  ///< hits on the point, all with the same channels
  /// The response at the point, an index; none: that of the point's name, if there is one.
  std::optional<Index> response = {};
};

struct DrivingPoint {
  Index response = 0, input = 0;  ///< indices in `RovingHammer::frfs`
  DrivingPointCheck check;
};

struct RovingHammer {
  std::vector<ImpactTest> tests;  ///< one per point, in the given order
  /// Responses x the points with an accepted hit, in their order; no lines when there is none.
  FrfSet frfs;
  std::vector<DrivingPoint> driving_points;
  std::vector<ReciprocityCheck> reciprocity;
  std::vector<Note> notes;
};

/// All recordings need the same channels and sample rate. All blocks have the length of the
/// shortest that any point's hits allow. Throws like analyse_impact_test.
[[nodiscard]] RovingHammer analyse_roving_hammer(std::span<const StruckPoint> points,
                                                 const std::string& force,
                                                 std::span<const std::string> responses,
                                                 const ImpactTestOptions& options = {});

}  // namespace rigfit::signal
