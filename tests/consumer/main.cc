// A program of someone else's that uses the installed library.
#include <cmath>
#include <cstdio>

#include "ident/stiffness/strand.h"
#include "model/scene/scene.h"
#include "signal/recording/recording.h"

int main() {
  rigfit::model::Scene scene;
  rigfit::signal::Recording recording;
  const auto cylinder = rigfit::ident::equivalent_cylinder(0.5972, 221780, 0.16667);
  const double EA =
      cylinder.youngs_modulus_Pa * std::acos(-1.0) * std::pow(cylinder.diameter_m, 2) / 4;
  std::printf("EA %.1f N, %zu nodes, %ld samples\n", EA, scene.nodes.size(),
              static_cast<long>(recording.samples()));
  return std::abs(EA - 221780) < 1e-6 * 221780 ? 0 : 1;
}
