#include "model/scene/force_history.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>

namespace rigfit::model {

LoadForce::LoadForce(const Load& load, const ForceHistory* record)
    : kind_(load.kind),
      peak_(load.peak),
      duration_(load.duration),
      start_(load.start),
      record_(record) {
  assert(kind_ != Load::Kind::record || (record_ && !record_->time_s.empty()));
}

double LoadForce::at(double time_s) const {
  switch (kind_) {
    case Load::Kind::release:
      return 0;
    case Load::Kind::impact: {
      const double t = time_s - start_;
      if (!(t > 0 && t < duration_)) return 0;
      return peak_ * std::sin(std::numbers::pi * t / duration_);
    }
    case Load::Kind::record: {
      const auto& t = record_->time_s;
      const auto& f = record_->force_N;
      if (time_s < t.front() || time_s > t.back()) return 0;
      const auto above = std::upper_bound(t.begin(), t.end(), time_s);
      if (above == t.end()) return f.back();
      const auto i = static_cast<std::size_t>(above - t.begin());
      return f[i - 1] + (f[i] - f[i - 1]) * (time_s - t[i - 1]) / (t[i] - t[i - 1]);
    }
  }
  return 0;
}

std::vector<double> LoadForce::corners() const {
  if (kind_ == Load::Kind::impact) return {start_, start_ + duration_};
  if (kind_ == Load::Kind::record) return record_->time_s;
  return {};
}

double LoadForce::end_s() const {
  const auto times = corners();
  return times.empty() ? 0 : std::max(0.0, times.back());
}

}  // namespace rigfit::model
