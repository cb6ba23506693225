// A campaign: what was tested on a rig, how, which scenes stand for it, and which published or
// earlier results to compare with. One TOML file; paths in it are relative to it.
//
//   title = "..."        source = "..."        description = "..."
//   [strand]             youngs_modulus (Pa), wires, wire_diameter, diameter (m): bounds on EI
//   [[scene]]            name, file; tables published / inferred / assumed: parameter = how known
//   [[test]]             name, kind, title, and by kind:
//     kind = "bending"   span (m), and a [test.table] with columns tension, EI, or recordings:
//                        span_std (m), channels = { tension, load, deflection } and
//                        [[test.recording]] (see recording_group.h)
//     kind = "modal"     scene, planes, tension_of, EI_of and a [test.table] with columns tension
//                        (none: one state), measured, models = { label = column, ... }
//
// Every key is checked like a scene's; the scenes and tables it names are read and checked too.
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "apps/recording_group.h"
#include "apps/result_table.h"
#include "ident/strand.h"
#include "model/scene.h"

namespace rigfit::apps {

/// How a value of a scene is known.
struct ValueOrigin {
  enum class Kind { published, inferred, assumed };
  std::string parameter;  ///< such as "cable.EI"
  Kind kind = Kind::assumed;
  std::string how;
};
[[nodiscard]] const char* name_of(ValueOrigin::Kind kind);

struct CampaignScene {
  std::string name;
  std::string file;
  model::Scene scene;
  std::vector<ValueOrigin> origins;
};

/// Published or earlier results of one test, by tension where it has a column for it.
struct ResultColumns {
  ResultTable table;
  std::optional<std::size_t> tension, EI, measured;
  std::vector<std::pair<std::string, std::size_t>> models;  ///< label, column
};

struct CampaignTest {
  enum class Kind { bending, modal };
  std::string name;
  std::string title;
  Kind kind = Kind::modal;
  double span_m = 0;      ///< bending
  double span_std_m = 0;  ///< its standard uncertainty
  /// Bending: names of the channels.
  std::string tension_channel = "tension", load_channel = "load", deflection_channel = "deflection";
  std::optional<std::size_t> scene;            ///< modal: index of the scene
  bool in_plane = true, out_of_plane = false;  ///< modal: what the test was made to see
  std::vector<std::string> tension_of;         ///< scene parameters that take a state's tension
  std::vector<std::string> EI_of;              ///< scene parameters that take EI at that tension
  std::optional<ResultColumns> results;
  std::vector<RecordingGroup> recordings;
};

struct Campaign {
  std::string file;
  std::string title, source, description;
  std::optional<ident::StrandGeometry> strand;
  std::vector<CampaignScene> scenes;
  std::vector<CampaignTest> tests;
  std::vector<std::string> inputs;  ///< every file read
};

/// Throws model::SceneError.
[[nodiscard]] Campaign read_campaign(const std::filesystem::path& path);

}  // namespace rigfit::apps
