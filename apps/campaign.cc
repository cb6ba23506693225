#include "apps/campaign.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "model/modal_analysis.h"
#include "model/read_scene.h"
#include "model/toml_table.h"

namespace rigfit::apps {
namespace fs = std::filesystem;
using model::Bound;
using model::TomlTable;

const char* name_of(ValueOrigin::Kind kind) {
  switch (kind) {
    case ValueOrigin::Kind::published:
      return "published";
    case ValueOrigin::Kind::inferred:
      return "inferred";
    case ValueOrigin::Kind::assumed:
      return "assumed";
  }
  return "";
}

namespace {

std::string name_in(TomlTable& table, std::set<std::string>& taken) {
  std::string name = table.string("name");
  // Names become file names and anchors in the report.
  const bool plain = !name.empty() && std::all_of(name.begin(), name.end(), [](unsigned char c) {
    return std::isalnum(c) || c == '-' || c == '_';
  });
  if (!plain) {
    throw table.error("name", "\"" + name + "\" cannot name a file of the report",
                      "use letters, digits, - and _ only; put words into title");
  }
  if (!taken.insert(name).second) {
    throw table.error("name", "\"" + name + "\" is used twice", "give each one a name of its own");
  }
  return name;
}

/// Refuses a parameter name that the scene does not have, at the key that gives it.
void check_parameter(const model::Scene& scene, const std::string& parameter,
                     const TomlTable& table, const std::string& key) {
  const auto known = model::parameter_names(scene);
  if (std::find(known.begin(), known.end(), parameter) != known.end()) return;
  try {
    static_cast<void>(model::parameter(scene, parameter));  // aliases such as EI_z
  } catch (const model::SceneError&) {
    const auto nearest = model::nearest_word(parameter, known);
    std::string remedy = nearest ? "did you mean \"" + *nearest + "\"?" : "its parameters:";
    if (!nearest) {
      for (const auto& name : known) remedy += " " + name;
    }
    throw table.error(key, "the scene has no parameter \"" + parameter + "\"", remedy);
  }
}

void read_origins(TomlTable& table, CampaignScene& scene) {
  std::set<std::string> said;
  for (const auto kind :
       {ValueOrigin::Kind::published, ValueOrigin::Kind::inferred, ValueOrigin::Kind::assumed}) {
    const std::string key = name_of(kind);
    if (!table.has(key)) continue;
    TomlTable origins = table.table(key);
    for (const auto& parameter : origins.keys()) {
      check_parameter(scene.scene, parameter, origins, parameter);
      if (!said.insert(parameter).second) {
        throw origins.error(parameter, "its origin is given twice", "keep one");
      }
      scene.origins.push_back({parameter, kind, origins.string(parameter)});
    }
    origins.finish();
  }
}

class Reader {
 public:
  explicit Reader(const fs::path& path) : root_(TomlTable::read_file(path)) {
    campaign_.file = path.string();
    campaign_.inputs.push_back(campaign_.file);
    folder_ = path.parent_path();
  }

  Campaign read() {
    campaign_.title = root_.string("title");
    campaign_.source = root_.string_or("source", "");
    campaign_.description = root_.string_or("description", "");
    if (root_.has("strand")) read_strand();
    std::set<std::string> scene_names, test_names;
    for (TomlTable& table : root_.tables_or_empty("scene")) read_campaign_scene(table, scene_names);
    for (TomlTable& table : root_.tables_or_empty("test")) read_test(table, test_names);
    if (campaign_.tests.empty()) {
      throw root_.error("test", "is missing", "a campaign needs at least one [[test]]");
    }
    root_.finish();
    return std::move(campaign_);
  }

 private:
  void read_strand() {
    TomlTable table = root_.table("strand");
    ident::StrandGeometry strand;
    strand.youngs_modulus_Pa = table.number("youngs_modulus", Bound::positive, "Pa");
    if (!table.has("wires")) throw table.error("wires", "is missing", "give their number");
    strand.elements = table.integer_or("wires", 1, 100000, 1);
    strand.element_diameter_m = table.number("wire_diameter", Bound::positive, "m");
    strand.strand_diameter_m = table.number("diameter", Bound::positive, "m");
    if (strand.element_diameter_m > strand.strand_diameter_m) {
      throw table.error("wire_diameter", "is larger than the strand's diameter",
                        "give both in metres");
    }
    table.finish();
    campaign_.strand = strand;
  }

  void read_campaign_scene(TomlTable& table, std::set<std::string>& taken) {
    CampaignScene scene;
    scene.name = name_in(table, taken);
    const fs::path file = folder_ / table.string("file");
    std::error_code error;
    if (!fs::is_regular_file(file, error)) {
      throw table.error("file", "there is no file " + file.string(),
                        "name a scene; the path starts at the campaign's folder");
    }
    scene.file = file.string();
    scene.scene = model::read_scene(file);
    add_input(scene.file);
    read_origins(table, scene);
    table.finish();
    campaign_.scenes.push_back(std::move(scene));
  }

  void read_test(TomlTable& table, std::set<std::string>& taken) {
    CampaignTest test;
    test.name = name_in(table, taken);
    test.title = table.string_or("title", test.name);
    static_cast<void>(table.string("kind"));
    if (table.choice_or("kind", {"bending", "modal"}, "") == "bending") {
      test.kind = CampaignTest::Kind::bending;
      read_bending(table, test);
    } else {
      test.kind = CampaignTest::Kind::modal;
      read_modal(table, test);
    }
    table.finish();
    campaign_.tests.push_back(std::move(test));
  }

  void read_bending(TomlTable& table, CampaignTest& test) {
    test.span_m = table.number("span", Bound::positive, "m");
    if (table.has("recording")) {
      read_bending_recordings(table, test);
      return;
    }
    TomlTable results = table.table("table");
    ResultColumns columns = open_table(results);
    columns.tension = column(results, columns, "tension");
    columns.EI = column(results, columns, "EI");
    results.finish();
    require_numbers(results, columns, "tension", *columns.tension);
    require_numbers(results, columns, "EI", *columns.EI);
    test.results = std::move(columns);
  }

  void read_bending_recordings(TomlTable& table, CampaignTest& test) {
    if (table.has("table")) {
      throw table.error("table", "is given beside recordings", "keep one of them");
    }
    test.span_std_m = table.number_or("span_std", Bound::not_negative, "m", 0);
    if (table.has("channels")) {
      TomlTable channels = table.table("channels");
      test.tension_channel = channels.string_or("tension", test.tension_channel);
      test.load_channel = channels.string_or("load", test.load_channel);
      test.deflection_channel = channels.string_or("deflection", test.deflection_channel);
      channels.finish();
    }
    test.recordings = read_recording_groups(table, folder_);
  }

  void read_modal(TomlTable& table, CampaignTest& test) {
    const std::string scene = table.string("scene");
    std::vector<std::string> names;
    for (const auto& known : campaign_.scenes) names.push_back(known.name);
    const auto at = std::find(names.begin(), names.end(), scene);
    if (at == names.end()) {
      const auto nearest = model::nearest_word(scene, names);
      throw table.error("scene", "there is no scene \"" + scene + "\"",
                        nearest ? "did you mean \"" + *nearest + "\"?"
                                : "add it under [[scene]] with name and file");
    }
    test.scene = static_cast<std::size_t>(at - names.begin());
    if (table.has("planes")) {
      const auto planes = table.string_or_strings("planes");
      test.in_plane = test.out_of_plane = false;
      for (const auto& plane : planes) {
        if (plane != "in" && plane != "out") {
          throw table.error("planes", "does not know \"" + plane + "\"",
                            "name \"in\" (the plane of gravity), \"out\" or both");
        }
        (plane == "in" ? test.in_plane : test.out_of_plane) = true;
      }
      if (planes.empty()) throw table.error("planes", "is empty", "name \"in\", \"out\" or both");
    }
    test.tension_of = parameters(table, "tension_of", *test.scene);
    test.EI_of = parameters(table, "EI_of", *test.scene);
    TomlTable results = table.table("table");
    ResultColumns columns = open_table(results);
    if (results.has("tension")) columns.tension = column(results, columns, "tension");
    columns.measured = column(results, columns, "measured");
    if (results.has("models")) {
      TomlTable models = results.table("models");
      for (const auto& label : models.keys()) {
        columns.models.emplace_back(label, column(models, columns, label));
      }
      models.finish();
    }
    results.finish();
    if (columns.tension) {
      require_numbers(results, columns, "tension", *columns.tension);
      if (test.tension_of.empty()) {
        throw table.error("tension_of", "is missing although the table goes by tension",
                          "name the scene's parameters that take it, such as \"cable.tension\"");
      }
    } else if (!test.tension_of.empty()) {
      throw table.error("tension_of", "is given although the table has no tension column",
                        "add tension = \"...\" to the table, or leave tension_of out");
    }
    if (!test.EI_of.empty() && !columns.tension) {
      throw table.error("EI_of", "is given although the table has no tension column",
                        "EI follows the tension; leave EI_of out");
    }
    check_frequencies(results, columns);
    test.results = std::move(columns);
  }

  std::vector<std::string> parameters(TomlTable& table, const std::string& key,
                                      std::size_t scene) const {
    if (!table.has(key)) return {};
    auto names = table.string_or_strings(key);
    for (const auto& name : names) {
      check_parameter(campaign_.scenes[scene].scene, name, table, key);
    }
    return names;
  }

  ResultColumns open_table(TomlTable& table) {
    ResultColumns columns;
    const fs::path file = folder_ / table.string("file");
    std::error_code error;
    if (!fs::is_regular_file(file, error)) {
      throw table.error("file", "there is no file " + file.string(),
                        "name a CSV table; the path starts at the campaign's folder");
    }
    columns.table = read_result_table(file);
    add_input(columns.table.file);
    return columns;
  }

  static std::size_t column(TomlTable& table, const ResultColumns& columns,
                            const std::string& key) {
    const std::string name = table.string(key);
    try {
      return columns.table.column(name);
    } catch (const model::SceneError& error) {
      throw table.error(key, columns.table.file + " " + error.problem(), error.remedy());
    }
  }

  static void require_numbers(const TomlTable& table, const ResultColumns& columns,
                              const std::string& key, std::size_t index) {
    for (std::size_t row = 0; row < columns.table.rows.size(); ++row) {
      if (!(columns.table.rows[row][index] > 0)) {
        throw table.error(key,
                          fmt::format("{}, line {}: the value is blank, zero or negative",
                                      columns.table.file, columns.table.lines[row]),
                          "give every row a positive number in this column");
      }
    }
  }

  static void check_frequencies(const TomlTable& table, const ResultColumns& columns) {
    std::vector<std::size_t> indices{*columns.measured};
    for (const auto& [label, index] : columns.models) indices.push_back(index);
    for (const std::size_t index : indices) {
      for (std::size_t row = 0; row < columns.table.rows.size(); ++row) {
        if (columns.table.rows[row][index] <= 0) {
          throw table.error(
              "file",
              fmt::format("{}, line {}: the frequency {} Hz is not positive", columns.table.file,
                          columns.table.lines[row], columns.table.rows[row][index]),
              "give frequencies in Hz, and nothing where none was found");
        }
      }
    }
  }

  void add_input(const std::string& file) {
    if (std::find(campaign_.inputs.begin(), campaign_.inputs.end(), file) ==
        campaign_.inputs.end()) {
      campaign_.inputs.push_back(file);
    }
  }

  TomlTable root_;
  fs::path folder_;
  Campaign campaign_;
};

}  // namespace

Campaign read_campaign(const fs::path& path) { return Reader(path).read(); }

}  // namespace rigfit::apps
