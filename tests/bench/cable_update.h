// The updating problem that the benches solve: a cable at 100 and 200 N, six out-of-plane
// frequencies of a fine chain measured in each without noise; free are EI and both tensions, which
// start 40 % and 10 % too high.
#pragma once

#include <string>
#include <vector>

#include "ident/update/model_update.h"

namespace rigfit::apps {

class CableUpdate {
 public:
  /// `fine_segments`: segments of the chain that gives the measured frequencies.
  explicit CableUpdate(int fine_segments);

  /// 0 segments: "auto".
  [[nodiscard]] ident::UpdateResult fit(int segments, const ident::UpdateOptions& options) const;
  /// Of EI and the tensions, the largest, relative; 1 where there is no answer.
  [[nodiscard]] double error_of(const ident::UpdateResult& result) const;
  /// What the frequencies' own segments do to the parameters is less than what two thirds as many
  /// do.
  [[nodiscard]] double reference_error() const;

 private:
  struct State {
    double tension_N = 0;
    std::vector<double> hz;
  };
  int fine_;
  double EI_Nm2_;
  std::vector<State> states_;
};

}  // namespace rigfit::apps
