// Tension of hangers with unknown end springs from their frequencies: does the 95 % interval hold,
// how long does a fit take? Then models that are wrong: are they ruled out, do intervals hold?
#include "ident/update/model_update.h"
#include "model/linear/modal_analysis.h"
#include "tests/bench/study.h"
#include "tests/ident/update/hanger.h"

namespace {

using namespace rigfit;
using Ends = model::Support::Kind;

struct Hanger {
  double length = 10, mass = 30, EI = 2e5, tension = 5e5, spring = 0;
};

model::Scene scene_of(const Hanger& hanger, Ends ends) {
  model::Scene scene = ident::testing::hanger(ends, hanger.EI, hanger.spring);
  scene.nodes[1].position.x() = hanger.length;
  auto& cable = scene.members[0];
  cable.segments = 0;  // as many as the accuracy needs
  cable.mass_per_length = hanger.mass;
  cable.EA = 2e3 * hanger.tension;
  cable.tension = hanger.tension;
  return scene;
}

struct Case {
  Hanger truth;
  std::vector<ident::MeasuredMode> modes;
};

Case draw(std::uint64_t seed, bool imperfect, Ends ends) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> uniform;
  std::normal_distribution<double> normal;
  const auto between = [&](double low, double high) {
    return low * std::pow(high / low, uniform(random));
  };
  Case one;
  auto& h = one.truth;
  h.length = between(2, 30);
  h.mass = between(5, 60);
  h.EI = between(1e3, 1e6);
  const double slenderness = between(5, 50);
  h.tension = h.EI * std::pow(slenderness / h.length, 2);
  h.spring = between(0.1, 300) * h.EI / h.length;
  const double noise = between(5e-4, 1e-2);
  model::ModesOptions options{.by_plane = {{9, 0}}};
  options.error_estimate = true;
  std::vector<double> f;
  for (const auto& mode : model::analyse_modes(scene_of(h, ends), options).modes) {
    if (mode.plane == model::ModePlane::in) f.push_back(mode.extrapolated_hz);
  }
  const double top = f.back();
  if (imperfect) {
    const auto missing =
        static_cast<int>(uniform(random) * (static_cast<double>(f.size()) / 3 + 1));
    for (int k = 0; k < missing; ++k) {
      f.erase(f.begin() + static_cast<int>(uniform(random) * static_cast<double>(f.size())));
    }
    if (uniform(random) < 0.5) f.push_back(top * between(0.15, 1));
    std::sort(f.begin(), f.end());
  }
  for (const double hz : f) {
    one.modes.push_back({.frequency_hz = {hz * (1 + noise * normal(random)), noise * hz},
                         .plane = model::ModePlane::in});
  }
  return one;
}

struct Kind {
  const char* name;
  Ends ends;
  bool imperfect;
  double span;
  Ends truth = Ends::elastic;
};

void fit(const Kind& kind, std::uint64_t seed, study::Table& table) {
  const Case one = draw(seed, kind.imperfect, kind.truth);
  Hanger start = one.truth;
  start.length *= kind.span;
  start.tension *= std::pow(3, 2 * std::fmod(0.618 * static_cast<double>(seed), 1.0) - 1);
  start.spring = 3 * start.EI / start.length;
  std::vector<ident::FreeParameter> free{{"h.tension"}};
  if (kind.ends == Ends::elastic) free.push_back({"spring", {"a.rotational_z", "b.rotational_z"}});
  const auto [result, seconds] = study::timed([&] {
    return ident::update_model({{"hanger", scene_of(start, kind.ends), one.modes}}, free);
  });
  table.add("median s", seconds);
  table.add("largest s", seconds);
  const bool answered = !result.alternatives.empty();
  table.add("no answer", !answered);
  if (!answered) return;
  const auto& tension = result.parameters[0];
  table.add("held, %", study::held(tension, one.truth.tension));
  table.add("model ruled out, %", result.fit.ruled_out());
  table.add("several answers, %", result.alternatives.front().weight < 0.9);
}

}  // namespace

int main(int argc, char** argv) {
  using enum study::Of;
  const Kind kinds[] = {
      {"springs free", Ends::elastic, false, 1},
      {"springs free, modes missing, one false", Ends::elastic, true, 1},
      {"right: pinned", Ends::pinned, false, 1, Ends::pinned},
      {"right: clamped", Ends::clamped, false, 1, Ends::clamped},
      {"wrong: pinned", Ends::pinned, false, 1},
      {"wrong: clamped", Ends::clamped, false, 1},
      {"wrong: span 3 % too long", Ends::elastic, false, 1.03},
  };
  study::run(study::arguments(argc, argv, 100),
             {"hangers",
              {{"no answer", sum},
               {"held, %"},
               {"model ruled out, %"},
               {"several answers, %"},
               {"median s", median},
               {"largest s", largest}}},
             kinds, fit);
}
