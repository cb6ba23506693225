#include "signal/spectra/window.h"

namespace rigfit::signal {

VectorXd exponential_window(Index length, double sample_rate_hz, double decay_rate_1_s) {
  return VectorXd::NullaryExpr(length, [=](Index n) {
    return std::exp(-decay_rate_1_s * static_cast<double>(n) / sample_rate_hz);
  });
}

double decay_rate_for(double end_level, double duration_s) {
  if (!(end_level > 0 && end_level <= 1 && duration_s > 0)) {
    throw std::invalid_argument("an exponential window ends between 0 (not included) and 1");
  }
  return -std::log(end_level) / duration_s;
}

VectorXd force_window(Index length, Index first, Index last, Index taper) {
  return VectorXd::NullaryExpr(length, [=](Index n) {
    const Index outside = n < first ? first - n : n - last + 1;  // samples away from the flat part
    if (outside <= 0) return 1.0;
    if (outside > taper) return 0.0;
    const double x = static_cast<double>(outside) / static_cast<double>(taper + 1);
    return 0.5 * (1 + std::cos(std::numbers::pi * x));
  });
}

}  // namespace rigfit::signal
