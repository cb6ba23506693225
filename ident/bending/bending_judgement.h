// What a fitted bending test shows of itself: toe, stop, stick-slip, friction, a curved diagram, a
// slope that says nothing. Inside of bending_analysis.
#pragma once

#include <Eigen/Core>

#include "ident/bending/bending_result.h"
#include "ident/bending/table_line.h"

namespace rigfit::ident {

/// Complete rows as fitted.
struct BendingCurve {
  const Eigen::VectorXd &tension_N, &load_N, &deflection_m;
  double deflection_range_m = 0, load_range_N = 0;
};

/// Adds findings, the range of tension, hysteresis and the slopes of loading and unloading to a
/// result whose strokes and stiffness are known. `table`: usable where strokes have few rows.
void judge_bending(const BendingCurve& curve, const TableLine& table,
                   const BendingTestOptions& options, BendingTestResult& result);

}  // namespace rigfit::ident
