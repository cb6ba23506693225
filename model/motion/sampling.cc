#include "model/motion/sampling.h"

#include <algorithm>
#include <cmath>

namespace rigfit::model {

double EnergyHistory::drift() const {
  double moving = 0, worst = 0;
  for (std::size_t i = 0; i < account.size(); ++i) {
    const Energy now = account[i].sum();
    moving = std::max(moving, now.kinetic);
    worst = std::max(
        worst, std::abs(now.total() - account[0].sum().total() - supplied[i] + dissipated[i]));
  }
  return moving > 0 ? worst / moving : 0;
}

long SamplingOptions::rows() const {
  return static_cast<long>(std::floor(duration_s * rate_hz * (1 + 1e-12))) + 1;
}

long SamplingOptions::energy_stride() const {
  return energy_samples > 0 ? std::max(1L, (rows() - 1) / energy_samples) : rows();
}

}  // namespace rigfit::model
