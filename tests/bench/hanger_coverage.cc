// Tension of hangers with unknown end springs from their frequencies: does the 95 % interval hold,
// how long does a fit take? Then models that are wrong: are they ruled out, do intervals hold?
// Prints a table; PART picks rows by name.   hanger_coverage [SEEDS] [FIRST SEED] [PART]
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <ctime>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "ident/update/model_update.h"
#include "model/linear/modal_analysis.h"
#include "tests/scenes.h"

namespace {

using namespace rigfit;
using model::testing::member, model::testing::node;

enum class Ends { springs, pinned, clamped };

struct Hanger {
  double length = 10, mass = 30, EI = 2e5, tension = 5e5, spring = 0, sensor = 0;
};

model::Scene scene_of(const Hanger& hanger, Ends ends) {
  using Kind = model::Support::Kind;
  const Kind kind = ends == Ends::springs   ? Kind::elastic
                    : ends == Ends::clamped ? Kind::clamped
                                            : Kind::pinned;
  model::Scene scene;
  scene.gravity.setZero();
  scene.nodes = {node("a", {0, 0, 0}, kind), node("b", {hanger.length, 0, 0}, kind)};
  if (ends == Ends::springs) {
    constexpr double kRigid = std::numeric_limits<double>::infinity();
    for (auto& end : scene.nodes) {
      end.support.translational.setConstant(kRigid);
      end.support.rotational = {kRigid, hanger.spring, hanger.spring};
    }
  }
  const auto add = [&](const char* name, const char* from, const char* to) {
    auto& cable = scene.members.emplace_back(member(model::Member::Kind::cable, name, from, to, 0,
                                                    hanger.mass, 2e3 * hanger.tension, hanger.EI));
    cable.GJ = hanger.EI;
    cable.tension = hanger.tension;
  };
  if (hanger.sensor > 0) {
    scene.nodes.push_back(node("sensor", {0.3 * hanger.length, 0, 0}));
    scene.nodes.back().mass = hanger.sensor;
    add("h", "a", "sensor");
    add("h2", "sensor", "b");
  } else {
    add("h", "a", "b");
  }
  return scene;
}

struct Case {
  Hanger truth;
  std::vector<ident::MeasuredMode> modes;
};

Case draw(std::uint64_t seed, bool imperfect, double sensor_share, Ends ends) {
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
  h.sensor = sensor_share * h.mass * h.length;
  const double noise = between(5e-4, 1e-2);
  model::ModesOptions options;
  options.count = 9;
  options.plane = model::ModePlane::in;
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
    ident::MeasuredMode mode;
    mode.frequency_hz = {hz * (1 + noise * normal(random)), noise * hz};
    mode.plane = model::ModePlane::in;
    one.modes.push_back(mode);
  }
  return one;
}

struct Row {
  int fits = 0, held = 0, flagged = 0, several = 0, silent = 0, none = 0;
  std::vector<double> seconds, width;
};

void add(Row& row, const Case& one, const Hanger& model, Ends ends, std::uint64_t seed) {
  Hanger start = model;
  start.tension *= std::pow(3, 2 * std::fmod(0.618 * static_cast<double>(seed), 1.0) - 1);
  start.spring = 3 * model.EI / model.length;
  start.sensor = 0;
  std::vector<ident::FreeParameter> free{{"h.tension"}};
  if (ends == Ends::springs) free.push_back({"spring", {"a.rotational_z", "b.rotational_z"}});
  const std::clock_t begin = std::clock();
  const auto result = ident::update_model({{"hanger", scene_of(start, ends), one.modes}}, free);
  row.seconds.push_back(static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC);
  ++row.fits;
  if (result.alternatives.empty()) {
    ++row.none;
    return;
  }
  const auto& tension = result.parameters[0];
  const bool held = !(tension.low > one.truth.tension) && !(tension.high < one.truth.tension);
  const bool several = result.alternatives.front().weight < 0.9;
  row.held += held;
  row.flagged += result.fit.ruled_out();
  row.several += several;
  row.silent += !held && !result.fit.ruled_out() && !several;
  const double width = (tension.high - tension.low) / tension.value;
  if (std::isfinite(width)) row.width.push_back(width);
}

double median(std::vector<double> values) {
  if (values.empty()) return 0;
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

}  // namespace

int main(int argc, char** argv) {
  const int seeds = argc > 1 ? std::atoi(argv[1]) : 100;
  const int first = argc > 2 ? std::atoi(argv[2]) : 1;
  const std::string part = argc > 3 ? argv[3] : "";
  fmt::print(
      "| {:<34} | fits | interval holds | ruled out | several | "
      "wrong and silent | no answer | median width | median s | slowest s |\n"
      "|---|---|---|---|---|---|---|---|---|---|\n",
      "case");
  struct Kind {
    const char* name;
    Ends ends;
    bool imperfect;
    double sensor, span;
    Ends truth = Ends::springs;
  };
  for (const Kind& kind :
       {Kind{"springs free", Ends::springs, false, 0, 1},
        Kind{"springs free, modes missing, one false", Ends::springs, true, 0, 1},
        Kind{"right: pinned", Ends::pinned, false, 0, 1, Ends::pinned},
        Kind{"right: clamped", Ends::clamped, false, 0, 1, Ends::clamped},
        Kind{"wrong: pinned", Ends::pinned, false, 0, 1},
        Kind{"wrong: clamped", Ends::clamped, false, 0, 1},
        Kind{"wrong: sensor of 2 % left out", Ends::springs, false, 0.02, 1},
        Kind{"wrong: span 3 % too long", Ends::springs, false, 0, 1.03}}) {
    if (std::string(kind.name).find(part) == std::string::npos) continue;
    Row row;
    for (int k = 0; k < seeds; ++k) {
      const auto seed = static_cast<std::uint64_t>(first + k);
      const Case one = draw(seed, kind.imperfect, kind.sensor, kind.truth);
      Hanger model = one.truth;
      model.length *= kind.span;
      add(row, one, model, kind.ends, seed);
    }
    const double n = row.fits / 100.0;
    fmt::print(
        "| {:<34} | {} | {:.1f} % | {:.1f} % | {:.1f} % | {:.1f} % | {} | "
        "{:.2f} % | {:.3f} | "
        "{:.2f} |\n",
        kind.name, row.fits, row.held / n, row.flagged / n, row.several / n, row.silent / n,
        row.none, 100 * median(row.width), median(row.seconds),
        *std::max_element(row.seconds.begin(), row.seconds.end()));
    std::fflush(stdout);
  }
}
