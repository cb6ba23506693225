// Measured modes as people keep them: a table with one mode a line.
//
//   frequency_hz, std, damping_ratio, damping_std, plane, tension_N, shape:<sensor> ...
//
// Only the frequency is needed; blank: not measured. `plane` is in or out (of the test). Other
// tables are read too by naming their frequency column ("test_Hz"). Lines that start with # are
// remarks.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "ident/model_update.h"

namespace rigfit::apps {

struct MeasuredTableRow {
  ident::MeasuredMode mode;
  std::optional<double> tension_N;
  std::vector<double> compared;  ///< of the columns asked for, NaN where blank
};

/// `column`: of the frequency; empty: "frequency_hz". `plane`: for rows that name none. `sensors`:
/// the scene's, in the order that shapes are wanted. `compare`: further columns of frequencies;
/// a table may lack them. Throws model::SceneError with file and line.
[[nodiscard]] std::vector<MeasuredTableRow> read_measured_modes(
    const std::filesystem::path& path, const std::string& column,
    std::optional<model::ModePlane> plane, const std::vector<std::string>& sensors,
    const std::vector<std::string>& compare = {});

}  // namespace rigfit::apps
