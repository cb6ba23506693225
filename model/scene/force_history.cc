#include "model/scene/force_history.h"

#include <cassert>

namespace rigfit::model {

LoadForce::LoadForce(Load load, const ForceHistory* record)
    : load_(std::move(load)), record_(record) {
  assert(load_.kind != Load::Kind::record || (record_ && !record_->time_s.empty()));
}

double LoadForce::at(double time_s) const {
  if (load_.kind == Load::Kind::impact) {
    const double t = time_s - load_.start;
    if (!(t > 0 && t < load_.duration)) return 0;
    return load_.peak * std::sin(std::numbers::pi * t / load_.duration);
  }
  if (load_.kind == Load::Kind::release) return 0;
  const auto& t = record_->time_s;
  const auto& f = record_->force_N;
  if (time_s < t.front() || time_s > t.back()) return 0;
  const auto above = std::upper_bound(t.begin(), t.end(), time_s);
  if (above == t.end()) return f.back();
  const auto i = static_cast<std::size_t>(above - t.begin());
  return f[i - 1] + (f[i] - f[i - 1]) * (time_s - t[i - 1]) / (t[i] - t[i - 1]);
}

std::vector<double> LoadForce::corners() const {
  if (load_.kind == Load::Kind::impact) return {load_.start, load_.start + load_.duration};
  if (load_.kind == Load::Kind::record) return record_->time_s;
  return {};
}

double LoadForce::end_s() const {
  const auto times = corners();
  return times.empty() ? 0 : std::max(0.0, times.back());
}

}  // namespace rigfit::model
