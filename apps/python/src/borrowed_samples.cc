#include "apps/python/src/borrowed_samples.h"

#include <cstdint>
#include <cstring>

namespace rigfit::python {
namespace {

/// What Eigen 3 keeps of a dynamic vector.
struct Storage {
  const double* data = nullptr;
  Eigen::Index count = 0;
};
static_assert(sizeof(Storage) == sizeof(Eigen::VectorXd));
static_assert(EIGEN_WORLD_VERSION == 3);

}  // namespace

bool can_borrow(const double* data) {
  constexpr std::uintptr_t kAlignment =
      EIGEN_DEFAULT_ALIGN_BYTES > 0 ? EIGEN_DEFAULT_ALIGN_BYTES : alignof(double);
  return reinterpret_cast<std::uintptr_t>(data) % kAlignment == 0;
}

void borrow(Eigen::VectorXd& vector, const double* data, Eigen::Index count) {
  vector.resize(0);
  const Storage storage{data, count};
  std::memcpy(static_cast<void*>(&vector), &storage, sizeof storage);
}

void give_back(Eigen::VectorXd& vector) {
  const Storage nothing;
  std::memcpy(static_cast<void*>(&vector), &nothing, sizeof nothing);
}

signal::Recording borrowed(const signal::Recording& recording) {
  signal::Recording shallow;
  shallow.path = recording.path;
  shallow.format = recording.format;
  shallow.sample_rate_hz = recording.sample_rate_hz;
  shallow.start_time_s = recording.start_time_s;
  shallow.time_jitter_s = recording.time_jitter_s;
  shallow.time_s = recording.time_s;
  shallow.notes = recording.notes;
  shallow.channels.resize(recording.channels.size());
  for (std::size_t c = 0; c < recording.channels.size(); ++c) {
    const signal::Channel& from = recording.channels[c];
    signal::Channel& to = shallow.channels[c];
    to.name = from.name;
    to.unit = from.unit;
    to.source_unit = from.source_unit;
    to.si_per_source = from.si_per_source;
    to.si_offset = from.si_offset;
    to.quantity = from.quantity;
    to.direction = from.direction;
    to.nominal_range = from.nominal_range;
    to.missing_samples = from.missing_samples;
  }
  // Nothing throws from here on: no vector is destroyed that borrows.
  for (std::size_t c = 0; c < recording.channels.size(); ++c) {
    const Eigen::VectorXd& from = recording.channels[c].samples;
    borrow(shallow.channels[c].samples, from.data(), from.size());
  }
  return shallow;
}

void give_back(signal::Recording& recording) {
  for (signal::Channel& channel : recording.channels) give_back(channel.samples);
}

}  // namespace rigfit::python
