#include "tests/reference/frf_differences.h"

#include <cmath>

namespace rigfit::ident {

model::FrfSensitivities frf_differences(const model::Scene& scene,
                                        const Eigen::VectorXd& frequency_hz,
                                        const std::vector<std::string>& parameters,
                                        double decay_rate_1_s) {
  const auto synthesised = [&](const model::Scene& at) {
    return model::synthesize_frfs(at, frequency_hz, {}, decay_rate_1_s);
  };
  model::FrfSensitivities result;
  result.frfs = synthesised(scene);
  if (result.frfs.H.empty()) return result;
  for (const auto& name : parameters) {
    const double value = model::parameter(scene, name);
    const double step = value != 0 ? 1e-4 * std::abs(value) : 1e-4;
    model::Scene up = scene, down = scene;
    model::set_parameter(up, name, value + step);
    if (value != 0) model::set_parameter(down, name, value - step);
    const auto above = synthesised(up);
    const auto below = value != 0 ? synthesised(down) : result.frfs;
    const double width = value != 0 ? 2 * step : step;
    std::vector<Eigen::MatrixXcd> rate;
    for (std::size_t k = 0; k < result.frfs.H.size(); ++k) {
      const bool both = k < above.H.size() && k < below.H.size();
      rate.push_back(both ? Eigen::MatrixXcd((above.H[k] - below.H[k]) / width)
                          : Eigen::MatrixXcd::Constant(result.frfs.H[k].rows(),
                                                       result.frfs.H[k].cols(), std::nan("")));
    }
    result.rate.push_back(std::move(rate));
  }
  return result;
}

}  // namespace rigfit::ident
