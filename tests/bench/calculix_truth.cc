// CalculiX as an independent truth of extrapolated frequencies, and how good a truth it is.
//
//   calculix_truth [SCENES [FIRST SEED]]
//
// Random beams, standing and hanging, with a tip mass and a flexural rigidity for each plane: modes
// out of the plane. (In it, and at pinned ends, ccx 2.20's expanded beam elements drift by 1e-4 to
// 1e-3 as they get shorter than a few thicknesses; clamped cables, whose tension a thermal strain
// makes, come out a hundredth off.) ccx has shear and rotary inertia, which segments have not: both
// act with the square of the radius of gyration r, so that every scene is solved with r/L = 1e-3
// and 3e-3 (EA = EI/r^2, in both
// programs) and d = ln f_ccx - ln f_segments taken to r = 0: (9 d_1 - d_3)/8, and from 20 and 40
// elements to none by their fourth order. That last step, or 2e-6 of rounding (what 80 elements
// differ by in first modes), is what ccx is taken to err by. f_segments is good to 1e-8 by its own
// estimate. Two sequences are held against f_ccx: that of `modes`, and one of 2, 3, 4, 6 ...
// segments, whose errors are large enough for ccx to see. Needs ccx (Debian package calculix-ccx);
// without it says so.
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
#include "tests/scenes.h"

namespace {

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

/// Frequencies out of the plane, as the caller's options ask.
ExtrapolatedModes extrapolated(const Scene& scene, double accuracy, int coarser) {
  ModesOptions options;
  options.count = kModes;
  options.plane = ModePlane::out;
  options.damped = options.shapes = false;
  const ChainModes coarse = find_modes(scene, options, std::vector<int>(1, 12));
  SequenceStart start = sequence_start(scene, coarse, accuracy);
  for (auto& stretches : start.stretches) {
    for (Stretch& stretch : stretches) {
      stretch.segments = (stretch.segments + coarser - 1) / coarser;
    }
  }
  return extrapolate_modes(scene, options, start, accuracy);
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
  CalculixOptions options;
  options.elements_per_member = elements;
  options.frequencies = 3 * kModes;
  options.poisson_ratio = 0;
  const Folder folder;
  std::ofstream(folder.path() / "deck.inp")
      << calculix_deck(scene, analysis.equilibrium, options).text;
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

/// One scene: what ccx says beside the segments' limit, and what ccx errs by.
struct Truth {
  std::vector<double> d, error;
};
Truth truth_of(int kind, unsigned seed) {
  Truth out;
  std::vector<std::vector<double>> d[2];  // by slenderness, elements
  for (const int which : {0, 1}) {
    const Scene scene = random_scene(kind, seed, which == 0 ? kThin : kThick);
    const ExtrapolatedModes limit = extrapolated(scene, 1e-8, 1);
    for (const int elements : {20, 40}) {
      std::vector<double> logs = calculix_logs(scene, elements, limit.limit_hz);
      if (logs.empty()) return {};
      for (std::size_t k = 0; k < logs.size(); ++k) logs[k] -= std::log(limit.limit_hz[k]);
      d[which].push_back(std::move(logs));
    }
  }
  for (std::size_t k = 0; k < d[0][1].size(); ++k) {
    const auto slender = [&](std::size_t i) { return (9 * d[0][i][k] - d[1][i][k]) / 8; };
    const double step = (slender(1) - slender(0)) / 15;
    out.d.push_back(slender(1) + step);
    out.error.push_back(std::max(std::abs(step), kRounding));
  }
  return out;
}

double median(std::vector<double> values) {
  if (values.empty()) return 0;
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

/// An estimate held against ccx.
struct Held {
  std::vector<double> ratio;  // estimate over error, where ccx sees the error
  int near = 0, small = 0, unseen = 0, contradicted = 0;

  void add(const ExtrapolatedModes& found, const Truth& truth, const ExtrapolatedModes& limit) {
    double worst = 0, blind = 0;
    for (std::size_t k = 0; k < found.frequency_hz.size(); ++k) {
      worst = std::max(worst,
                       std::abs(std::log(found.frequency_hz[k] / limit.limit_hz[k]) - truth.d[k]));
      blind = std::max(blind, truth.error[k]);
    }
    if (worst <= 3 * blind) {
      ++unseen;
      contradicted += worst > found.relative_error + 3 * blind;
      return;
    }
    ratio.push_back(found.relative_error / worst);
    near += ratio.back() > 1.0 / 3 && ratio.back() < 3;
    small += ratio.back() <= 1.0 / 3;
  }
  void print(const char* kind, const char* which) {
    std::sort(ratio.begin(), ratio.end());
    std::printf("| %s | %s | %zu | %.2f | %.2f | %.2f | %d | %d | %d |\n", kind, which,
                ratio.size(), ratio.empty() ? 0 : ratio.front(), median(ratio),
                ratio.empty() ? 0 : ratio.back(), near, small, unseen);
  }
};

}  // namespace

int main(int argc, char** argv) {
  if (!runs("command -v ccx > /dev/null 2>&1")) {
    std::printf("no program \"ccx\" is installed (Debian package calculix-ccx): nothing to do\n");
    return 0;
  }
  const int scenes = argc > 1 ? std::atoi(argv[1]) : 40;
  const int first = argc > 2 ? std::atoi(argv[2]) : 1;
  constexpr const char* kKind[]{"standing beam", "hanging beam"};
  std::vector<Held> held(4);
  std::printf(
      "| scene | seeds | ccx failed | |ln f_ccx - ln f_segments|: median | largest | ccx's own "
      "error: "
      "median | largest |\n|---|---|---|---|---|---|---|\n");
  for (int kind = 0; kind < 2; ++kind) {
    std::vector<double> apart, own;
    int failed = 0;
    for (int i = 0; i < scenes / 2; ++i) {
      const auto seed = static_cast<unsigned>(first + i);
      const Truth truth = truth_of(kind, seed);
      if (truth.d.empty()) {
        ++failed;
        continue;
      }
      double worst = 0, blind = 0;
      for (std::size_t k = 0; k < truth.d.size(); ++k) {
        worst = std::max(worst, std::abs(truth.d[k]));
        blind = std::max(blind, truth.error[k]);
      }
      apart.push_back(worst);
      own.push_back(blind);
      const Scene scene = random_scene(kind, seed, kThin);
      const ExtrapolatedModes limit = extrapolated(scene, 1e-8, 1);
      for (const int which : {0, 1}) {
        held[2 * std::size_t(kind) + std::size_t(which)].add(
            extrapolated(scene, which == 0 ? 1e-4 : 1, which == 0 ? 1 : 1000), truth, limit);
      }
    }
    std::printf("| %s | %d | %d | %.1e | %.1e | %.1e | %.1e |\n", kKind[kind], scenes / 2, failed,
                median(apart), apart.empty() ? 0 : *std::max_element(apart.begin(), apart.end()),
                median(own), own.empty() ? 0 : *std::max_element(own.begin(), own.end()));
    std::fflush(stdout);
  }
  std::printf(
      "\n| scene | sequence | errors seen by ccx | estimate / error: least | median | largest | "
      "within 3 | too small by more | below what ccx sees "
      "|\n|---|---|---|---|---|---|---|---|---|\n");
  for (std::size_t i = 0; i < held.size(); ++i) {
    held[i].print(kKind[i / 2], i % 2 == 0 ? "as `modes`, 1e-4" : "of 2, 3, 4, 6 ... segments");
    if (held[i].contradicted > 0) std::printf("contradicted: %d\n", held[i].contradicted);
  }
  return 0;
}
