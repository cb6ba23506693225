// Runs every recording of a folder and prints found against known. The folder's files do not belong
// to the project; what is known is stated here or in the folder's README.md. Folders with known
// values: ruler_frfs, bar_frfs (FRFs in UFF 58); any other UFF file of FRFs is run as well.
//
//   modal_recordings FOLDER
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <string>
#include <vector>

#include "signal/modal/modal_identification.h"
#include "signal/readers/uff/read_uff.h"

namespace rigfit {
namespace {

struct Known {
  std::string folder;
  double low_hz = 0, high_hz = 0;
  std::vector<double> frequency_hz;
  std::vector<double> damping_ratio;  ///< 0: not stated
};

std::vector<Known> known_folders() {
  return {
      {"ruler_frfs", 10, 700, {39.44, 108.6, 211.8, 352.8, 551.1}, {0.0053, 0.006, 0, 0, 0.0013}},
      {"bar_frfs",
       65,
       1000,
       {111.994, 306.855, 596.369, 974.136},
       {0.000135, 0.00012, 0.0001, 0.00011}},
  };
}

void run_file(const std::filesystem::path& path, const Known* known) {
  fmt::print("\n## {}\n\n", path.string());
  try {
    const signal::FrfSet set = signal::read_uff_frfs(path.string());
    signal::ModalOptions options;
    if (known) {
      options.low_hz = known->low_hz;
      options.high_hz = known->high_hz;
    }
    const auto begin = std::chrono::steady_clock::now();
    const signal::ModalResult found = identify_modes(set, options);
    const double seconds =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    fmt::print(
        "{} responses, {} inputs, {} lines, {:.1f} s.\n\n| f, Hz | std | damping, % | std | "
        "between "
        "points, Hz | points | by | known f | known damping, % | remark "
        "|\n|---|---|---|---|---|---|"
        "---|---|---|---|\n",
        set.responses.size(), set.inputs.size(), found.lines_used, seconds);
    std::vector<bool> seen(known ? known->frequency_hz.size() : 0, false);
    for (const signal::IdentifiedMode& mode : found.model.modes) {
      std::string f, z;
      for (std::size_t i = 0; i < seen.size(); ++i) {
        if (seen[i] || std::abs(mode.frequency_hz.value / known->frequency_hz[i] - 1) > 0.01) {
          continue;
        }
        seen[i] = true;
        f = fmt::format("{}", known->frequency_hz[i]);
        if (known->damping_ratio[i] > 0) z = fmt::format("{:.4g}", 100 * known->damping_ratio[i]);
        break;
      }
      fmt::print("| {:.6g} | {:.2g} | {:.4g} | {:.2g} | {:.2g} | {} | {} | {} | {} | {} |\n",
                 mode.frequency_hz.value, mode.frequency_hz.std, 100 * mode.damping_ratio.value,
                 100 * mode.damping_ratio.std, mode.between_points_std_hz, mode.points.size(),
                 mode.refinement, f, z, mode.doubtful ? "doubtful: " + mode.doubt : "");
    }
    for (std::size_t i = 0; i < seen.size(); ++i) {
      if (!seen[i]) fmt::print("\nNot found: {} Hz.\n", known->frequency_hz[i]);
    }
  } catch (const std::exception& error) {
    fmt::print("no FRFs: {}\n", error.what());
  }
}

}  // namespace
}  // namespace rigfit

int main(int argc, char** argv) {
  if (argc != 2 || !std::filesystem::is_directory(argv[1])) {
    std::fputs("modal_recordings FOLDER\n", stderr);
    return 2;
  }
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(argv[1])) {
    const std::string extension = entry.path().extension().string();
    if (entry.is_regular_file() && (extension == ".uff" || extension == ".unv")) {
      files.push_back(entry.path());
    }
  }
  std::sort(files.begin(), files.end());
  const auto known = rigfit::known_folders();
  for (const auto& path : files) {
    const std::string folder = path.parent_path().filename().string();
    const auto it =
        std::find_if(known.begin(), known.end(), [&](const auto& k) { return k.folder == folder; });
    rigfit::run_file(path, it == known.end() ? nullptr : &*it);
  }
  return 0;
}
