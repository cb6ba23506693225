// Normal random numbers of a seed.
#pragma once

#include <cstdint>
#include <random>

namespace rigfit::testing {

class Normal {
 public:
  explicit Normal(std::uint64_t seed) : engine_(seed) {}
  double operator()() { return distribution_(engine_); }

 private:
  std::mt19937_64 engine_;
  std::normal_distribution<double> distribution_;
};

}  // namespace rigfit::testing
