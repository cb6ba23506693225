// Means of a spectrum over neighbouring lines.
#pragma once

#include "signal/numerics/numbers.h"

namespace rigfit::signal {

/// Mean over lines k - half .. k + half of each line k, over fewer at the ends, never below 0: what
/// rounding makes of a mean of powers that are 0.
[[nodiscard]] ArrayXd mean_over_lines(const Ref<const ArrayXd>& powers, Index half);

/// Median over the same lines.
[[nodiscard]] ArrayXd median_over_lines(const Ref<const ArrayXd>& powers, Index half);

/// Lines on either side over which noise is smooth.
inline constexpr Index kSmoothingLines = 10;
/// Lines on either side that a line of hum or a resonance that leaks is wide.
inline constexpr Index kNarrow = 2;

/// Compares noise power over few and over many lines: the first where it exceeds the second by more
/// than chance (99.9 % of chi-square), as in a line of hum or at a resonance that leaks. `degrees`
/// of freedom of `narrow`.
[[nodiscard]] ArrayXd narrow_where_raised(const Ref<const ArrayXd>& narrow,
                                          const Ref<const ArrayXd>& wide, double degrees);

}  // namespace rigfit::signal
