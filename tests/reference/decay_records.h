// Records of free decays with defects, integrated in time, and what the estimator says of them.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <map>
#include <random>
#include <string>
#include <vector>

#include "signal/decay/decay.h"

namespace rigfit::decay_records {

struct Record {
  Eigen::VectorXd samples;
  double rate_hz = 0;
  double frequency_hz = 0, damping_ratio = 0;  ///< truth; 0: there is none, refusal is right
  std::size_t modes = 1;                       ///< that there are
  signal::DecayOptions options;
};

using Random = std::mt19937_64;

struct Kind {
  std::string name;
  std::function<Record(Random&)> make;
};

[[nodiscard]] const std::vector<Kind>& kinds();

struct Tally {
  int records = 0, sure = 0, frequency_held = 0, damping_held = 0, wrong = 0;
  int more_modes = 0;  ///< records with more modes than there are
  std::map<std::string, int> refused, warned;
  double median_ms = 0;
  [[nodiscard]] std::string row(const std::string& name) const;
};

/// `wrong`: records without a truth that are answered, and negative damping in any answer.
[[nodiscard]] Tally study(const Kind& kind, int records);

}  // namespace rigfit::decay_records
