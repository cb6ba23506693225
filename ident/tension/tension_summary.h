// Value, interval and budget of a tension from the cells of its posterior, over kinds of ends.
#pragma once

#include <limits>
#include <string>
#include <vector>

#include "ident/tension/tension_data.h"

namespace rigfit::ident {

/// One kind of ends: its model as corrected, its answers, heaviest first.
struct EndsPosterior {
  CableEnds ends = CableEnds::pinned;
  CableModel model;
  std::vector<TensionAnswer> answers;
  double ln_evidence = -std::numeric_limits<double>::infinity();
  bool corrected = true;  ///< false: needed and not to be had

  [[nodiscard]] CableState state() const { return answers.front().state(); }
};

/// Mean and variances of T over the cells of one or several kinds of ends, by the law of total
/// variance: between ends, assignments, springs, rigidities; within: frequencies and model.
struct TensionSummary {
  signal::Estimate tension, EI, spring;
  double low = 0, high = 0;
  std::vector<UpdateBudgetTerm> budget;
};

/// Value, std and budget are of what lies in the 95 % interval or within half its width beside it:
/// an improbable other answer far off would otherwise make the std larger than the interval.
[[nodiscard]] TensionSummary summarise_tension(const std::vector<const EndsPosterior*>& all);

}  // namespace rigfit::ident
