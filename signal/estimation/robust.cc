#include "signal/estimation/robust.h"

#include <gsl/gsl_statistics_double.h>

#include <iterator>

namespace rigfit::signal {

std::vector<double> finite_values(const Ref<const VectorXd>& values) {
  std::vector<double> finite;
  std::ranges::copy_if(values, std::back_inserter(finite),
                       [](double x) { return std::isfinite(x); });
  return finite;
}

double median(std::vector<double> values) {
  return values.empty() ? 0 : gsl_stats_median(values.data(), 1, values.size());
}

double quantile(std::vector<double> values, double share) {
  if (values.empty()) return 0;
  std::ranges::sort(values);
  return gsl_stats_quantile_from_sorted_data(values.data(), 1, values.size(), share);
}

double robust_std(std::vector<double> values, double centre) {
  for (double& value : values) value = std::abs(value - centre);
  return 1.4826 * median(std::move(values));
}

}  // namespace rigfit::signal
