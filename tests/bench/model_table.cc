// Prints three tables: error against segments, what "auto" takes, and time against size.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <string>
#include <vector>

#include "model/linear/modes.h"
#include "model/linear/segment_choice.h"
#include "tests/model/test_scenes.h"
#include "tests/reference/closed_forms.h"
#include "tests/reference/utility_line.h"

namespace {

using namespace rigfit::model;

double lowest_in(const Scene& scene, int segments, RotaryInertia inertia, Motion motion) {
  ModesOptions options;
  options.count = 4;
  options.segments = segments;
  options.rotary_inertia = inertia;
  const std::vector<int> all(scene.members.size(), segments);
  const ChainModes modes = find_modes(scene, options, all);
  for (std::size_t i = 0; i < modes.order.size(); ++i) {
    if (modes.motions[std::size_t(modes.order[i].motion)].motion == motion) {
      return modes.frequency_hz(i);
    }
  }
  return NAN;
}

void errors(const char* name, const Scene& scene, double truth) {
  for (const RotaryInertia inertia : {RotaryInertia::accurate, RotaryInertia::rigid_rod}) {
    std::printf("| %-22s | %-9s |", name,
                inertia == RotaryInertia::accurate ? "accurate" : "rigid rod");
    for (const int n : {10, 20, 30, 60, 120}) {
      std::printf(" %+9.1e |", lowest_in(scene, n, inertia, Motion::out_of_plane) / truth - 1);
    }
    std::printf("\n");
  }
}

/// What "auto" takes, its estimate, and the error against six and nine times as many, extrapolated.
void automatic(const char* name, Scene scene, double accuracy) {
  for (Member& member : scene.members) member.segments = 0;
  scene.accuracy = accuracy;
  ModesOptions options;
  const SegmentChoice choice = choose_segments(scene, options);
  std::vector<int> six, nine;
  std::string counts;
  for (const int n : choice.segments) {
    six.push_back(6 * n);
    nine.push_back(9 * n);
    counts += (counts.empty() ? "" : " + ") + std::to_string(n);
  }
  const ChainModes fine = find_modes(scene, options, six),
                   finest = find_modes(scene, options, nine);
  double worst = 0;
  for (std::size_t i = 0; i < choice.modes.order.size(); ++i) {
    const double a = fine.frequency_hz(i), b = finest.frequency_hz(i);
    worst = std::max(worst, std::abs(choice.modes.frequency_hz(i) / (b + (b - a) / 1.25) - 1));
  }
  std::printf("| %-22s | %7.0e | %-14s | %8.1e | %8.1e |\n", name, accuracy, counts.c_str(),
              choice.error.relative, worst);
}

/// Median processor time of five runs, ms.
double time_of(const Scene& scene, int count, int& unknowns, bool& complete) {
  ModesOptions options;
  options.count = count;
  std::vector<double> times;
  for (int run = 0; run < 5; ++run) {
    const std::clock_t start = std::clock();
    const ChainModes modes = find_modes(scene, options);
    times.push_back(1e3 * double(std::clock() - start) / CLOCKS_PER_SEC);
    unknowns = 0;
    for (const auto& motion : modes.motions) unknowns += motion.assembly->size();
    complete = modes.complete();
  }
  std::nth_element(times.begin(), times.begin() + 2, times.end());
  return times[2];
}

void time_row(const char* name, const Scene& scene, int count) {
  int unknowns = 0;
  bool complete = false;
  const double ms = time_of(scene, count, unknowns, complete);
  std::printf("| %-26s | %8d | %5d | %10.3f | %s |\n", name, unknowns, count, ms,
              complete ? "yes" : "no");
}

}  // namespace

int main() {
  std::printf("Relative error of the first out-of-plane frequency against segments\n\n");
  std::printf(
      "| scene                  | inertia   |      n=10 |        20 |        30 |        60 |      "
      " 120 |\n");
  std::printf("|---|---|---|---|---|---|---|\n");
  const double strain = 200 / 221780.0;
  const UniformBeam taut{2.4, 0.16667 / (1 + strain), 0.5972 * (1 + strain), 200};
  Scene cable = testing::paper_cable(200, 0.5972);
  cable.gravity.setZero();
  errors("cable, pinned", cable, pinned_beam_frequencies(taut, 1)[0]);
  for (auto& node : cable.nodes) node.support.kind = Support::Kind::clamped;
  errors("cable, clamped", cable, clamped_beam_frequencies(taut, 1)[0]);
  Scene beam = testing::vertical_beam(0.75, 2.1, 0.295);
  beam.gravity.setZero();
  beam.nodes[1].mass = 0.02;
  errors("cantilever, tip mass", beam, cantilever_frequencies({0.75, 0.295, 2.1, 0}, 0.02, 1)[0]);

  std::printf("\nsegments = \"auto\": first six modes\n\n");
  std::printf("| scene                  | asked   | segments       | estimate | error    |\n");
  std::printf("|---|---|---|---|---|\n");
  for (const double accuracy : {1e-3, 1e-4, 1e-5}) {
    automatic("cable, 25 N", testing::paper_cable(25, 0.2549), accuracy);
    automatic("cable, 200 N", testing::paper_cable(200, 0.5972), accuracy);
    automatic("standing beam", testing::vertical_beam(0.75, 2.1, 0.295), accuracy);
    automatic("rig (beam, 2 cables)", testing::cable_beam_rig(200, 0.5972), accuracy);
  }

  std::printf("\nEquilibrium and modes from a parsed scene on, processor time of one core\n\n");
  std::printf("| scene                      | unknowns | modes | median, ms | complete |\n");
  std::printf("|---|---|---|---|---|\n");
  time_row("cable, 30 segments, 200 N", testing::paper_cable(200, 0.5972), 6);
  time_row("cable, 30 segments, 25 N", testing::paper_cable(25, 0.2549), 6);
  time_row("rig, 90 segments", testing::cable_beam_rig(200, 0.5972), 12);
  for (const bool growing : {false, true}) {
    for (const int poles : {12, 25, 50, 100}) {
      const Scene line = rigfit::apps::utility_line(poles, 60, 20);
      time_row(line.title.c_str(), line, growing ? poles : 50);
    }
  }
  return 0;
}
