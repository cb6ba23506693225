// Recordings, FRFs and modes as files that other programs read: CSV, and universal files with
// recordings and FRFs as dataset 58 (binary, 58b: IEEE numbers), mode shapes as dataset 55, points
// as dataset 15.
//
// Data for which universal files have no exact place (long names, the exact rate, averages, the
// decay rate of a window) go to identification lines 1, 2, 4 and 5, so that files written here are
// read back without loss.
#pragma once

#include "signal/modes/modal_model.h"

namespace rigfit::signal {

/// A header of `key,value` lines, a line of names with units, a column of times, whose title is
/// `axis` (they may be frequencies), then one per channel in its source unit, with `digits`
/// significant digits (17 gives back the same doubles); a missing sample is an empty field.
[[nodiscard]] std::string csv_text(const Recording& recording,
                                   const std::vector<std::pair<std::string, std::string>>& header,
                                   int digits = 7, const std::string& axis = "Time (s)");

/// One dataset 58 (time response) per channel; `remark` is their second identification line. Values
/// at even times are in single precision, as most loggers write them (7 digits, half the size).
[[nodiscard]] std::string uff_text(const Recording& recording, const std::string& remark = {});

/// For each response and input a dataset 58 of function type 4 and, where they are known, one of
/// type 6 (coherence) and one of type 0 (standard deviation of real and imaginary part).
[[nodiscard]] std::string uff_text(const FrfSet& frfs);

/// Position of a node, for dataset 15.
struct NodePosition {
  int node = 0;
  std::array<double, 3> position_m{0, 0, 0};
};

/// Dataset 15 (when positions are given), then for each mode a dataset 55 with a complex eigenvalue
/// (analysis type 3): shapes at nodes by direction, values as they are, unscaled. Responses without
/// a node are numbered from 1 in their order; those without a direction are written as z. "Modal A"
/// is 0: not given.
[[nodiscard]] std::string uff_text(const ModalModel& modes,
                                   const std::vector<NodePosition>& positions = {});

}  // namespace rigfit::signal
