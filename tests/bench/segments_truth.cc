// How honest the estimate of extrapolated frequencies is, and what they cost.
//
//   segments_truth [SCENES [FIRST SEED]]   (default: 200 from 0; only the first table with a seed)
//
// Random scenes: pinned cables, clamped ones, cables with a mass at a node of every chain or
// anywhere, standing beams, rigs of three members (12 modes, others 6). Truth: another sequence of
// chains, to 3e-9. Times are the processor's, the least of five runs.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <random>
#include <string>
#include <vector>

#include "model/linear/modal_analysis.h"
#include "model/linear/segment_extrapolation.h"
#include "tests/scenes.h"

namespace {

using namespace rigfit::model;

constexpr int kKinds = 6;
constexpr const char* kKind[kKinds]{"pinned cable",  "clamped cable",  "mass at a node",
                                    "mass anywhere", "beam, tip mass", "rig, 12 modes"};

Scene random_scene(int kind, unsigned seed) {
  std::mt19937 generator(seed);
  const auto even = [&](double low, double high) {
    return std::uniform_real_distribution<>(low, high)(generator);
  };
  const auto log = [&](double low, double high) {
    return std::exp(even(std::log(low), std::log(high)));
  };
  if (kind == 5) {
    Scene scene = testing::cable_beam_rig(log(50, 500), log(0.1, 2), 0);
    scene.nodes[1].mass = even(0, 0.1);
    return scene;
  }
  if (kind == 4) {
    Scene scene = testing::vertical_beam(even(0.3, 1), log(1, 10), log(0.1, 1), 0);
    scene.nodes[1].mass = even(0, 0.1);
    return scene;
  }
  Scene scene = testing::paper_cable(log(20, 2000), log(0.05, 5), 0);
  scene.nodes[1].position << even(1, 4), even(0, 1), 0;
  if (kind == 1) {
    for (auto& node : scene.nodes) node.support.kind = Support::Kind::clamped;
  }
  const double place = even(0.1, 0.9), mass = log(0.002, 0.05);
  if (kind == 2) scene.members[0].masses = {{std::round(20 * place) / 20, mass}};
  if (kind == 3) scene.members[0].masses = {{place, mass}};
  return scene;
}

template <class Work>
double least_ms(Work work) {
  double least = 1e99;
  for (int run = 0; run < 5; ++run) {
    const std::clock_t begin = std::clock();
    work();
    least = std::min(least, 1e3 * static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC);
  }
  return least;
}

ModesOptions modes_of(int kind) {
  ModesOptions options;
  options.count = kind == 5 ? 12 : 6;
  options.shapes = options.damped = false;
  return options;
}

void honesty(int scenes, int first) {
  std::printf(
      "| asked | scenes | estimate / error: least | median | largest | within 3 | too small by "
      "more | error above asked | median ms |\n|---|---|---|---|---|---|---|---|---|\n");
  for (const double accuracy : {1e-4, 1e-5, 1e-6}) {
    for (int kind = 0; kind < kKinds; ++kind) {
      std::vector<double> ratios, times;
      int near = 0, small = 0, above = 0;
      for (int i = 0; i < scenes / kKinds; ++i) {
        const Scene scene = random_scene(kind, static_cast<unsigned>(first + i * kKinds + kind));
        const ModesOptions options = modes_of(kind);
        const ChainModes coarse =
            find_modes(scene, options, std::vector<int>(scene.members.size(), 12));
        if (coarse.order.empty()) continue;
        const SequenceStart start = sequence_start(scene, coarse, accuracy);
        // Places that the chains of `start` do not have, and half as fine again.
        SequenceStart finer = sequence_start(scene, coarse, 3e-9);
        for (auto& stretches : finer.stretches) {
          for (Stretch& stretch : stretches) stretch.segments = (7 * stretch.segments + 3) / 4;
        }
        const ExtrapolatedModes truth = extrapolate_modes(scene, options, finer, 3e-9);
        const std::clock_t begin = std::clock();
        const ExtrapolatedModes found = extrapolate_modes(scene, options, start, accuracy);
        times.push_back(1e3 * static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC);
        double worst = 0;
        for (std::size_t k = 0; k < found.frequency_hz.size(); ++k) {
          worst = std::max(worst, std::abs(found.frequency_hz[k] / truth.limit_hz[k] - 1));
        }
        ratios.push_back(found.relative_error / worst);
        near += ratios.back() > 1.0 / 3 && ratios.back() < 3;
        small += ratios.back() <= 1.0 / 3;
        above += worst > accuracy;
      }
      std::sort(ratios.begin(), ratios.end());
      std::sort(times.begin(), times.end());
      std::printf("| %.0e | %s | %.2f | %.2f | %.2f | %d of %zu | %d | %d | %.2f |\n", accuracy,
                  kKind[kind], ratios.front(), ratios[ratios.size() / 2], ratios.back(), near,
                  ratios.size(), small, above, times[times.size() / 2]);
    }
  }
}

void costs() {
  std::printf(
      "\n| scene | asked | longest chain | estimate | error | ms |\n|---|---|---|---|---|---|\n");
  const auto row = [](const char* name, Scene scene, int count) {
    ModesOptions options;
    options.count = count;
    options.shapes = options.damped = false;
    scene.accuracy = 1e-8;
    const ModalAnalysis truth = analyse_modes(scene, options);
    for (const double accuracy : {1e-4, 1e-6}) {
      scene.accuracy = accuracy;
      ModalAnalysis found;
      const double ms = least_ms([&] { found = analyse_modes(scene, options); });
      double worst = 0;
      for (std::size_t k = 0; k < found.modes.size(); ++k) {
        worst = std::max(worst,
                         std::abs(found.modes[k].frequency_hz / truth.modes[k].frequency_hz - 1));
      }
      std::printf("| %s | %.0e | %d | %.1e | %.1e | %.2f |\n", name, accuracy,
                  found.equilibrium.members[0].segments, found.relative_error_estimate, worst, ms);
    }
  };
  row("cable, 200 N, 6 modes", testing::paper_cable(200, 0.5972, 0), 6);
  row("cable, 25 N, 6 modes", testing::paper_cable(25, 0.2549, 0), 6);
  row("standing beam, 6 modes", testing::vertical_beam(0.75, 2.1, 0.295, 0), 6);
  row("rig, 12 modes", testing::cable_beam_rig(200, 0.5972, 0), 12);
}

}  // namespace

int main(int argc, char** argv) {
  honesty(argc > 1 ? std::atoi(argv[1]) : 200, argc > 2 ? std::atoi(argv[2]) : 0);
  if (argc > 2) return 0;
  costs();
  return 0;
}
