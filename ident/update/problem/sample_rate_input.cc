#include "ident/update/problem/sample_rate_input.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>

namespace rigfit::ident {

std::vector<UncertainInput> sample_rate_inputs(const std::vector<StateClock>& clocks) {
  constexpr double kSameRate = 1e-6;
  std::vector<UncertainInput> inputs;
  std::vector<double> rates;
  for (const auto& clock : clocks) {
    if (!(clock.relative_std > 0)) continue;
    std::size_t at = 0;
    while (at < rates.size() && std::abs(clock.rate_hz - rates[at]) > kSameRate * rates[at]) ++at;
    if (at == rates.size()) {
      rates.push_back(clock.rate_hz);
      inputs.push_back({std::string(kSampleRateTarget), {}});
    }
    auto& effects = inputs[at].effects;
    const auto same = std::find_if(effects.begin(), effects.end(),
                                   [&](const auto& one) { return one.state == clock.state; });
    if (same == effects.end()) {
      effects.push_back({clock.state, std::string(kSampleRateTarget), clock.relative_std});
    } else {
      same->change = std::max(same->change, clock.relative_std);
    }
  }
  for (std::size_t k = 0; inputs.size() > 1 && k < inputs.size(); ++k) {
    inputs[k].name += fmt::format(" of {:g} Hz", rates[k]);
  }
  return inputs;
}

}  // namespace rigfit::ident
