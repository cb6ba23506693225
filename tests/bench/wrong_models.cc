// Models that are wrong in one thing, fitted to four tensions of a cable: is each fit ruled out,
// does its interval hold? Then to one tension.
#include "ident/update/model_update.h"
#include "tests/bench/study.h"
#include "tests/ident/update/fit_data.h"

namespace {

using namespace rigfit;

constexpr double kEI = 0.6, kStd = 5e-4;

enum class Ends { pinned, clamped, springs };

model::Scene cable(double tension, Ends ends) {
  auto scene = model::testing::paper_cable(tension, 0.6, 40);
  scene.gravity.setZero();
  for (auto& node : scene.nodes) {
    using Kind = model::Support::Kind;
    node.support.kind = ends == Ends::pinned    ? Kind::pinned
                        : ends == Ends::clamped ? Kind::clamped
                                                : Kind::elastic;
    if (ends != Ends::springs) continue;
    constexpr double kFixed = std::numeric_limits<double>::infinity();
    node.support.translational.setConstant(kFixed);
    node.support.rotational = {kFixed, 2, 2};  // N m/rad
  }
  return scene;
}

struct Kind {
  std::string name;
  std::function<model::Scene(double)> truth, fitted;  // by tension
  std::vector<double> tensions = {100, 200, 300, 400};
};

ident::UpdateState state_of(const Kind& kind, double tension, std::mt19937_64& random) {
  ident::UpdateState state{
      fmt::format("{} N", tension), kind.fitted(tension),
      ident::testing::modes_of(kind.truth(tension), model::ModePlane::out, 6, kStd, &random)};
  model::set_parameter(state.scene, "cable.EI", 1.3 * kEI);
  return state;
}

std::vector<Kind> kinds() {
  const auto with = [](Ends ends) {
    return [ends](double tension) { return cable(tension, ends); };
  };
  const auto sensor = [](double tension) {
    auto scene = cable(tension, Ends::clamped);
    scene.members[0].masses.push_back({0.55, 0.010});
    return scene;
  };
  const auto by_tension = [](double tension) {  // 0.6 N m2 at 250 N
    auto scene = cable(tension, Ends::clamped);
    model::set_parameter(scene, "cable.EI", kEI * (0.6 + 0.4 * tension / 250));
    return scene;
  };
  const auto too_long = [](double tension) {
    auto scene = cable(tension, Ends::clamped);
    scene.nodes[1].position.x() *= 1.01;
    return scene;
  };
  const std::vector<Kind> four{
      {"right model", with(Ends::clamped), with(Ends::clamped)},
      {"end springs of 2 N m/rad left out", with(Ends::springs), with(Ends::pinned)},
      {"sensor of 10 g left out", sensor, with(Ends::clamped)},
      {"EI(T) ignored", by_tension, with(Ends::clamped)},
      {"pinned for clamped", with(Ends::clamped), with(Ends::pinned)},
      {"clamped for pinned", with(Ends::pinned), with(Ends::clamped)},
      {"span 1 % too long", with(Ends::clamped), too_long}};
  std::vector<Kind> all;
  for (const Kind& kind : four) {
    all.push_back(kind);
    all.push_back({kind.name + ", one tension", kind.truth, kind.fitted, {250}});
  }
  return all;
}

void fit(const Kind& kind, std::uint64_t seed, study::Table& table) {
  std::mt19937_64 random(seed);
  std::vector<ident::UpdateState> states;
  for (const double tension : kind.tensions) states.push_back(state_of(kind, tension, random));
  ident::UpdateOptions options;
  options.segment_uncertainty = false;  // the data have the model's segments
  const auto result = ident::update_model(states, {{"cable.EI"}}, options);
  const auto& EI = result.parameters[0];
  table.add("held, %", study::held(EI, kEI));
  table.add("ruled out, %", result.fit.ruled_out());
  table.add("error of EI, %", 100 * (EI.value / kEI - 1));
  table.add("std, %", 100 * EI.std / kEI);
}

}  // namespace

int main(int argc, char** argv) {
  using enum study::Of;
  study::run(
      study::arguments(argc, argv, 40),
      {"model",
       {{"held, %"}, {"ruled out, %"}, {"error of EI, %", mean, "{:+.1f}"}, {"std, %", mean}}},
      kinds(), fit);
}
