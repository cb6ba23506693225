#include "model/scene/force_history.h"

namespace rigfit::model {

double LoadForce::at(double time_s) const {
  if (load.kind == Load::Kind::impact) {
    const double t = time_s - load.start;
    if (!(t > 0 && t < load.duration)) return 0;
    return load.peak * std::sin(std::numbers::pi * t / load.duration);
  }
  if (load.kind == Load::Kind::release) return 0;
  const auto& t = record->time_s;
  const auto& f = record->force_N;
  if (time_s < t.front() || time_s > t.back()) return 0;
  const auto above = std::upper_bound(t.begin(), t.end(), time_s);
  if (above == t.end()) return f.back();
  const auto i = static_cast<std::size_t>(above - t.begin());
  return f[i - 1] + (f[i] - f[i - 1]) * (time_s - t[i - 1]) / (t[i] - t[i - 1]);
}

std::vector<double> LoadForce::corners() const {
  if (load.kind == Load::Kind::impact) return {load.start, load.start + load.duration};
  if (load.kind == Load::Kind::record) return record->time_s;
  return {};
}

double LoadForce::end_s() const {
  const auto times = corners();
  return times.empty() ? 0 : std::max(0.0, times.back());
}

double last_force_s(const std::vector<LoadForce>& forces) {
  double last = 0;
  for (const LoadForce& force : forces) last = std::max(last, force.end_s());
  return last;
}

}  // namespace rigfit::model
