#include "signal/spectra/line_means.h"

#include <gsl/gsl_cdf.h>
#include <gsl/gsl_movstat.h>

#include <memory>

namespace rigfit::signal {

ArrayXd mean_over_lines(const Ref<const ArrayXd>& powers, Index half) {
  const Index n = powers.size();
  if (n == 0) return {};
  half = std::min(half, n);
  // Lines, and the sum of those, before each end of a mean: the one ends where another that lies 2
  // half + 1 lines further begins.
  const auto reach = static_cast<double>(half), size = static_cast<double>(n);
  const ArrayXd ends = ArrayXd::LinSpaced(n + 2 * half + 1, -reach, size + reach).max(0).min(size);
  ArrayXd sums = ArrayXd::Zero(ends.size());
  for (Index k = 0; k < n; ++k) sums[half + k + 1] = sums[half + k] + powers[k];
  sums.tail(half).setConstant(sums[half + n]);
  return (sums.tail(n) - sums.head(n)).max(0) / (ends.tail(n) - ends.head(n));
}

ArrayXd median_over_lines(const Ref<const ArrayXd>& powers, Index half) {
  ArrayXd result(powers.size());
  if (powers.size() == 0) return result;
  const auto size = static_cast<std::size_t>(powers.size());
  const auto values = gsl_vector_const_view_array(powers.data(), size);
  auto medians = gsl_vector_view_array(result.data(), size);
  const std::unique_ptr<gsl_movstat_workspace, decltype(&gsl_movstat_free)> work(
      gsl_movstat_alloc(static_cast<std::size_t>(2 * half + 1)), &gsl_movstat_free);
  gsl_movstat_median(GSL_MOVSTAT_END_TRUNCATE, &values.vector, &medians.vector, work.get());
  return result;
}

ArrayXd narrow_where_raised(const Ref<const ArrayXd>& narrow, const Ref<const ArrayXd>& wide,
                            double degrees) {
  const double limit = gsl_cdf_chisq_Pinv(0.999, degrees) / degrees;
  return (narrow > limit * wide).select(narrow, wide);
}

}  // namespace rigfit::signal
