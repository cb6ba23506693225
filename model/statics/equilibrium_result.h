// Result of the static equilibrium: status, and sag and tension of every member.
#pragma once

#include <tuple>

#include "document/describe.h"
#include "model/algebra/numbers.h"

namespace rigfit::model {

/// How the search for the equilibrium ended.
enum class EquilibriumStatus { converged, slack, buckled, mechanism, not_converged };
/// The word in JSON, such as "slack".
[[nodiscard]] const char* name_of(EquilibriumStatus status);

/// One member at rest.
struct MemberEquilibrium {
  std::string member;
  double sag_m = 0;          ///< largest distance from the chord
  double tension_N = 0;      ///< horizontal component (mean axial force of a beam)
  double tension_max_N = 0;  ///< along the member
  double unstretched_length_m = 0;
  int segments = 0;
  Matrix3Xd positions;  ///< m, 3 x (segments + 1), from the first node to the second

  static constexpr auto fields() {
    using T = MemberEquilibrium;
    return std::tuple{
        field("member", &T::member, "", "member", "name"),
        field("tension_N", &T::tension_N, "N", "tension", "horizontal; mean axial force of a beam"),
        field("sag_m", &T::sag_m, "m", "sag", "largest distance from the chord"),
        field("tension_max_N", &T::tension_max_N),
        field("unstretched_length_m", &T::unstretched_length_m),
        field("segments", &T::segments, "", "segments", "")};
  }
};

/// The static equilibrium of a scene; check `status` first.
struct Equilibrium {
  EquilibriumStatus status = EquilibriumStatus::not_converged;
  std::string reason;   ///< for a person, when not converged
  double residual = 0;  ///< largest unbalanced force over the largest member force
  int iterations = 0;
  std::vector<MemberEquilibrium> members;

  static constexpr auto fields() {
    using T = Equilibrium;
    return std::tuple{field("status", &T::status), field("reason", &T::reason),
                      field("residual", &T::residual), field("iterations", &T::iterations),
                      field("members", &T::members, "", "members", "at rest")};
  }
};

}  // namespace rigfit::model
