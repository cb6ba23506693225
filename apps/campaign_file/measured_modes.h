// Measured modes as people keep them: a table with one mode a line.
//
//   frequency_hz, std, damping_ratio, damping_std, plane, order, tension_N, shape:<sensor> ...
//
// Only the frequency is needed; blank: not measured. `order` counts the modes of a plane from 1
// (`tension` obeys it). `plane` is in or out (of the test). Other tables are read too by naming
// their frequency column ("test_Hz"). How it may be written: text_table.h.
//
// Or as other programs keep them: universal files with datasets 55, and 15 or 2411 for where their
// nodes are (signal/readers/read_recording.h).
#pragma once

#include "apps/cli/verb_context.h"
#include "ident/update/model_update.h"

namespace rigfit::apps {

struct MeasuredTableRow : ident::MeasuredMode {
  std::optional<double> tension_N;
};

/// Where a sensor or load of the scene is, m, along straight members.
[[nodiscard]] Eigen::Vector3d position_of(const model::Scene& scene, const model::Place& place);

/// Whether the file begins as a universal file does. Throws signal::RecordingError for no file.
[[nodiscard]] bool is_universal_file(const std::filesystem::path& path);

/// A table, or a universal file's datasets 55, as an input of the run. `column`: of the frequency;
/// empty: "frequency_hz". `plane`: for rows that name none. A sensor's node is the one of the file
/// that is where the sensor is in the scene (within 1/1000 of its extent; the coordinates of both
/// must agree); shapes are taken where every sensor has a node, and a warning says where not.
/// Throws model::SceneError with file and line, signal::RecordingError, UsageError where a
/// universal file has a `column`.
[[nodiscard]] std::vector<MeasuredTableRow> measured_modes(const std::string& path,
                                                           const std::string& column,
                                                           std::optional<model::ModePlane> plane,
                                                           const model::Scene& scene,
                                                           VerbContext& context);

}  // namespace rigfit::apps
