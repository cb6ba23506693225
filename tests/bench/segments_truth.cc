// How honest the estimate of extrapolated frequencies is, and what they cost. Random scenes: pinned
// cables, clamped ones, cables with a mass at a node of every chain or anywhere, standing beams,
// rigs of three members (12 modes, others 6). Truth: another sequence of chains, to 3e-9.
#include "model/linear/modal_analysis.h"
#include "model/linear/segment_extrapolation.h"
#include "tests/bench/study.h"
#include "tests/model/linear/random_scenes.h"

namespace {

using namespace rigfit;
using namespace rigfit::model;

constexpr int kKinds = 6;
constexpr const char* kKind[kKinds]{"pinned cable",  "clamped cable",  "mass at a node",
                                    "mass anywhere", "beam, tip mass", "rig, 12 modes"};

struct Case {
  std::string name;
  int kind;
  double accuracy;
};

void extrapolate(const Case& one, std::uint64_t seed, study::Table& table) {
  const Scene scene = testing::random_scene(
      one.kind, static_cast<unsigned>(kKinds * seed) + static_cast<unsigned>(one.kind));
  ModesOptions options{.count = one.kind == 5 ? 12 : 6};
  options.shapes = options.damped = false;
  const ChainModes coarse = find_modes(scene, options, std::vector<int>(scene.members.size(), 12));
  if (coarse.order.empty()) return;
  const SequenceStart start = sequence_start(scene, coarse, one.accuracy);
  // Places that the chains of `start` do not have, and half as fine again.
  SequenceStart finer = sequence_start(scene, coarse, 3e-9);
  for (auto& stretches : finer.stretches) {
    for (Stretch& stretch : stretches) stretch.segments = (7 * stretch.segments + 3) / 4;
  }
  const ResolvedModes truth = extrapolate_modes(scene, options, finer, 3e-9);
  const auto [found, seconds] =
      study::timed([&] { return extrapolate_modes(scene, options, start, one.accuracy); });
  double worst = 0;
  for (std::size_t k = 0; k < found.frequency_hz.size(); ++k) {
    worst = std::max(worst, std::abs(found.frequency_hz[k] / truth.limit_hz[k] - 1));
  }
  const double ratio = found.relative_error / worst;
  for (const char* column : {"estimate / error: least", "median", "largest"})
    table.add(column, ratio);
  table.add("beyond a factor of 3", ratio <= 1.0 / 3 || ratio >= 3);
  table.add("error above asked", worst > one.accuracy);
  table.add("median ms", 1e3 * seconds);
}

}  // namespace

int main(int argc, char** argv) {
  using enum study::Of;
  std::vector<Case> cases;
  for (const double accuracy : {1e-4, 1e-5, 1e-6}) {
    for (int kind = 0; kind < kKinds; ++kind) {
      cases.push_back({fmt::format("{}, {:.0e}", kKind[kind], accuracy), kind, accuracy});
    }
  }
  study::run(study::arguments(argc, argv, 50, 0),
             {"scenes, accuracy asked",
              {{"estimate / error: least", least},
               {"median", median},
               {"largest", largest},
               {"beyond a factor of 3", sum},
               {"error above asked", sum},
               {"median ms", median}}},
             cases, extrapolate);
}
