// CalculiX as an independent truth of extrapolated frequencies, and how good a truth it is.
//
// Random beams, standing and hanging, with a tip mass and a flexural rigidity for each plane: modes
// out of the plane. (In it, and at pinned ends, ccx 2.20's expanded beam elements drift by 1e-4 to
// 1e-3 as they get shorter than a few thicknesses; clamped cables, whose tension a thermal strain
// makes, come out a hundredth off.) ccx has shear and rotary inertia, which segments have not: both
// act with the square of the radius of gyration r, so that every scene is solved with r/L = 1e-3
// and 3e-3 (EA = EI/r^2, in both programs) and d = ln f_ccx - ln f_segments taken to r = 0: (9 d_1
// - d_3)/8, and from 20 and 40 elements to none by their fourth order. That last step, or 2e-6 of
// rounding (what 80 elements differ by in first modes), is what ccx is taken to err by. f_segments
// is good to 1e-8 by its own estimate. Needs ccx (Debian package calculix-ccx); without it says so.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <string>
#include <vector>

#include "model/export/write_calculix.h"
#include "model/linear/modal_analysis.h"
#include "model/linear/segment_extrapolation.h"
#include "tests/bench/study.h"
#include "tests/scenes.h"

namespace {

using namespace rigfit;
using namespace rigfit::model;
namespace fs = std::filesystem;

constexpr int kModes = 3;
constexpr double kRounding = 2e-6;             // rounding of ccx
constexpr double kThin = 1e-3, kThick = 3e-3;  // radius of gyration over length
constexpr double kNear = 0.01;                 // relative distance of frequencies that are one mode

Scene random_scene(int kind, unsigned seed, double slenderness) {
  std::mt19937 generator(seed);
  const auto even = [&](double low, double high) {
    return std::uniform_real_distribution<>(low, high)(generator);
  };
  const auto log = [&](double low, double high) {
    return std::exp(even(std::log(low), std::log(high)));
  };
  const double length = even(0.3, 1), EI = log(1, 10), mass = log(0.1, 1);
  Scene scene = testing::vertical_beam(length, EI, mass, 0);
  scene.nodes[1].mass = even(0, 0.1);
  if (kind == 1) scene.nodes[1].position.y() = -length;
  Member& member = scene.members[0];
  member.EI[1] = 1.3 * member.EI[0];  // planes apart, so that modes are told by frequency
  member.EA = member.EI[0] / std::pow(slenderness * length, 2);
  return scene;
}

/// Frequencies out of the plane, good to 1e-8.
ExtrapolatedModes extrapolated(const Scene& scene) {
  ModesOptions options{.count = kModes, .plane = ModePlane::out};
  options.damped = options.shapes = false;
  const ChainModes coarse = find_modes(scene, options, std::vector<int>(1, 12));
  return extrapolate_modes(scene, options, sequence_start(scene, coarse, 1e-8), 1e-8);
}

/// A folder of its own, gone at the end.
class Folder {
 public:
  Folder() {
    std::string name = (fs::temp_directory_path() / "rigfit-ccx-XXXXXX").string();
    if (const char* made = ::mkdtemp(name.data())) path_ = made;
  }
  ~Folder() {
    std::error_code ignored;
    if (!path_.empty()) fs::remove_all(path_, ignored);
  }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  [[nodiscard]] const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

bool runs(const std::string& command) { return std::system(command.c_str()) == 0; }

/// ln of each of `hz` as ccx finds it; empty: ccx fails or has no such modes.
std::vector<double> calculix_logs(const Scene& scene, int elements, const std::vector<double>& hz) {
  const ModalAnalysis analysis = analyse_modes(scene);
  const Folder folder;
  std::ofstream(folder.path() / "deck.inp")
      << calculix_deck(
             scene, analysis.equilibrium,
             {.elements_per_member = elements, .frequencies = 3 * kModes, .poisson_ratio = 0})
             .text;
  if (!runs("cd '" + folder.path().string() + "' && OMP_NUM_THREADS=1 ccx deck > log 2>&1")) {
    return {};
  }
  std::ifstream dat(folder.path() / "deck.dat");
  const std::vector<double> found = calculix_frequencies({std::istreambuf_iterator<char>(dat), {}});
  std::vector<double> out;
  for (const double wanted : hz) {
    const auto best = std::min_element(found.begin(), found.end(), [&](double a, double b) {
      return std::abs(a - wanted) < std::abs(b - wanted);
    });
    if (best == found.end() || std::abs(*best / wanted - 1) > kNear) return {};
    out.push_back(std::log(*best));
  }
  return out;
}

struct Kind {
  const char* name;
  int number;
};

void compare(const Kind& kind, std::uint64_t seed, study::Table& table) {
  std::vector<std::vector<double>> d[2];  // by slenderness, elements
  for (const int which : {0, 1}) {
    const Scene scene =
        random_scene(kind.number, static_cast<unsigned>(seed), which == 0 ? kThin : kThick);
    const ExtrapolatedModes limit = extrapolated(scene);
    for (const int elements : {20, 40}) {
      std::vector<double> logs = calculix_logs(scene, elements, limit.limit_hz);
      if (logs.empty()) return table.add("ccx failed", 1);
      for (std::size_t k = 0; k < logs.size(); ++k) logs[k] -= std::log(limit.limit_hz[k]);
      d[which].push_back(std::move(logs));
    }
  }
  double worst = 0, own = 0;
  for (std::size_t k = 0; k < d[0][1].size(); ++k) {
    const auto slender = [&](std::size_t i) { return (9 * d[0][i][k] - d[1][i][k]) / 8; };
    const double step = (slender(1) - slender(0)) / 15;
    worst = std::max(worst, std::abs(slender(1) + step));
    own = std::max({own, std::abs(step), kRounding});
  }
  for (const char* column : {"ln f_ccx - ln f: median", "largest"}) table.add(column, worst);
  for (const char* column : {"ccx's own error: median", "its largest"}) table.add(column, own);
}

}  // namespace

int main(int argc, char** argv) {
  using enum study::Of;
  if (!runs("command -v ccx > /dev/null 2>&1")) {
    std::printf("no program \"ccx\" is installed (Debian package calculix-ccx): nothing to do\n");
    return 0;
  }
  study::run(study::arguments(argc, argv, 20),
             {"scene",
              {{"ccx failed", sum},
               {"ln f_ccx - ln f: median", median},
               {"largest", largest},
               {"ccx's own error: median", median},
               {"its largest", largest}}},
             std::vector<Kind>{{"standing beam", 0}, {"hanging beam", 1}}, compare);
}
