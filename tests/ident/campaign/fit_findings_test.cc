#include "ident/campaign/fit_findings.h"

#include "tests/ident/update/fit_data.h"
#include "tests/test.h"

namespace rigfit::ident::fit_findings_test {

/// A cantilever of EI 1.8 with four sensors in its plane.
model::Scene beam(double tip_mass) {
  auto scene = testing::beam(1.8, tip_mass);
  for (const double at : {0.25, 0.5, 0.75, 1.0}) {
    auto& sensor = scene.sensors.emplace_back();
    sensor.place = {"", "beam", at};
    sensor.direction = {1, 0, 0};
  }
  return scene;
}

std::vector<Finding> findings_of(const std::vector<MeasuredMode>& modes) {
  return fit_findings(
      update_model({{"beam", beam(0.03), modes}}, {{"beam.EI_z"}}, testing::plain_options()));
}

// A tip of 100 g in place of 30 g makes the first mode some 15 % lower against the higher ones,
// of 31 g by a fifth of a per cent.
TEST(FitFindings, WithoutStatedUncertaintiesAModelThatIsFarOffIsRuledOut) {
  for (const bool off : {false, true}) {
    const auto truth = beam(off ? 0.1 : 0.031);
    auto modes = testing::modes_of(truth, model::ModePlane::in, 5, 1e-3);
    for (auto& mode : modes) mode.frequency_hz.std = std::nan("");
    EXPECT_EQ(rigfit::testing::says(findings_of(modes), "model_ruled_out"), off);
  }
}

// The second and the third sensor's cables exchanged.
TEST(FitFindings, ShapesThatContradictTheModelAreToldOnce) {
  const auto truth = beam(0.03);
  for (const bool swapped : {false, true}) {
    auto modes = testing::modes_of(truth, model::ModePlane::in, 5, 1e-3);
    std::size_t next = 0;
    for (const auto& natural : model::analyse_modes(truth, {.count = 23}).modes) {
      if (natural.plane != model::ModePlane::in || next == modes.size()) continue;
      auto& shape = modes[next++].shape = natural.sensor_shape.cast<std::complex<double>>();
      if (swapped) std::swap(shape[1], shape[2]);
    }
    const auto findings = findings_of(modes);
    EXPECT_EQ(std::ranges::count(findings, "shapes_disagree", &Finding::code), swapped ? 1 : 0);
    for (const auto& finding : findings) {
      EXPECT_NE(finding.message.find("of 5 measured shapes"), std::string::npos) << finding.message;
    }
  }
}

}  // namespace rigfit::ident::fit_findings_test
