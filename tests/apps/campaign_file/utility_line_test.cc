#include "apps/campaign_file/new/utility_line.h"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "model/linear/modal_analysis.h"
#include "model/scene/parameters.h"
#include "model/scene/read_scene.h"

namespace rigfit::apps::utility_line_test {
namespace {

model::ModalAnalysis modes_of(const UtilityLine& line, int count = 2) {
  model::ModesOptions options;
  options.count = count;
  options.shapes = options.error_estimate = false;
  return model::analyse_modes(model::parse_scene(utility_line_scene(line), "line.toml"), options);
}

TEST(UtilityLine, ABarePoleInRockIsACantilever) {
  // Without taper, soil, crossarm and conductors: f1 = 1.8751^2 / (2 pi L^2) sqrt(EI / m), times
  // sqrt(1 - m g L^3 / (7.837 EI)) for its own weight (Greenhill's critical length; the factor is
  // linear in the weight to 1e-3 of the shift). Segments and stretch: below 1e-3.
  UtilityLine line;
  line.poles = 1;
  line.conductors = 0;
  line.crossarm_kg = 0;
  line.top_diameter_m = line.ground_diameter_m;
  line.soil_translational = line.soil_rotational = 1e14;
  const double EI = line.modulus_Pa * M_PI * std::pow(0.3, 4) / 64;
  const double m = line.density_kg_m3 * M_PI * 0.09 / 4;
  const double weight = m * 9.80665 * 1000 / (7.837 * EI);
  const double f = 1.8751 * 1.8751 / (2 * M_PI * 100) * std::sqrt(EI / m * (1 - weight));
  const auto found = modes_of(line);
  ASSERT_EQ(found.modes.size(), 2u);
  EXPECT_NEAR(found.modes[0].frequency_hz / f, 1, 1.5e-3);
}

TEST(UtilityLine, SoilDamageAndTaperAreThere) {
  UtilityLine line;
  line.poles = 1;
  line.conductors = 0;
  const double sound = modes_of(line).modes[0].frequency_hz;
  line.damage_depth = 0.3;
  EXPECT_LT(modes_of(line).modes[0].frequency_hz, 0.99 * sound);
  line.damage_depth = 0;
  line.soil_rotational /= 10;
  EXPECT_LT(modes_of(line).modes[0].frequency_hz, 0.9 * sound);
  // Very stiff Winkler springs hold the pole at the ground; softer ones less.
  line.embedded_m = 2;
  line.winkler_N_m2 = 1e12;
  const double held = modes_of(line).modes[0].frequency_hz;
  EXPECT_GT(held, sound);
  line.winkler_N_m2 = 1e7;
  EXPECT_LT(modes_of(line).modes[0].frequency_hz, 0.99 * held);
}

TEST(UtilityLine, ALineOfPolesHasItsParametersAndAnEquilibrium) {
  UtilityLine line;
  line.damage_from = 0.3;
  line.damage_to = 0.5;
  const auto scene = model::parse_scene(utility_line_scene(line), "line.toml");
  for (const char* name :
       {"pole1 base.EI", "pole3 base.EI", "ground1.rotational_z", "span4.tension"})
    EXPECT_GT(model::parameter(scene, name), 0) << name;
  const auto found = modes_of(line, 4);
  ASSERT_EQ(found.modes.size(), 4u) << found.equilibrium.reason;
  // The conductors' first swaying is that of their sag: below 1 / 2L sqrt(T / m).
  EXPECT_LT(found.modes[0].frequency_hz, std::sqrt(6000 / 0.38) / 120);
  line.damage_to = 0.2;
  EXPECT_THROW((void)utility_line_scene(line), std::invalid_argument);
}

}  // namespace
}  // namespace rigfit::apps::utility_line_test
