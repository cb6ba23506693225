// Reads mode shapes of other programs: datasets 55 of a universal file, with the points of 15 or
// 2411 and the units of 164. FRFs and time histories in the same file are ignored.
//
// Dataset 55 ("data at nodes") gives normal modes (analysis type 2: frequency in hertz, viscous and
// hysteretic damping, the latter twice a damping ratio) and complex modes (types 3 and 7:
// eigenvalue p in rad/s, natural frequency |p| / 2 pi, damping ratio -Re p / |p|). Values are real
// or complex, three or six a node. In a conjugate pair the mode of positive frequency is taken.
// Layout: SDRC Universal File Datasets 15, 55, 164, 2411.
#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <string_view>

#include "signal/numerics/numbers.h"

namespace rigfit::signal {

/// A node of datasets 15 or 2411.
struct UffNode {
  std::array<double, 3> position_m{0, 0, 0};
  /// Coordinate system of the displacements at the node; 0 and 1 are the global ones.
  int displacement_system = 0;
};

/// One mode of datasets 55.
struct UffMode {
  long line = 0;             ///< line of the dataset's number in the file
  double frequency_hz = 0;   ///< undamped natural frequency, positive
  double damping_ratio = 0;  ///< NaN: the file gives none (zero)
  /// Displacements along x, y, z by node; empty: values without directions.
  std::map<int, std::array<Complex, 3>> shape;
};

/// Modes and nodes of a file.
struct UffModes {
  std::map<int, UffNode> nodes;      ///< by number
  std::vector<UffMode> modes;        ///< by rising frequency
  std::vector<std::string> remarks;  ///< items left out, for a person
};

/// Throws RecordingError with the line that cannot be read, and when there is no mode.
[[nodiscard]] UffModes read_uff_modes(std::string_view bytes, const std::filesystem::path& path);
/// Reads a file. Throws RecordingError.
[[nodiscard]] UffModes read_uff_modes(const std::filesystem::path& path);

}  // namespace rigfit::signal
