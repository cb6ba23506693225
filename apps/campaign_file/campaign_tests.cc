#include "apps/campaign_file/campaign_tests.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "model/linear/modal_analysis.h"

namespace rigfit::apps {
namespace fs = std::filesystem;
using model::Bound;
using model::TomlTable;

const char* name_of(CampaignTest::Kind kind) {
  switch (kind) {
    case CampaignTest::Kind::bending:
      return "bending";
    case CampaignTest::Kind::axial:
      return "axial";
    case CampaignTest::Kind::decay:
      return "decay";
    case CampaignTest::Kind::modal:
      return "modal";
    case CampaignTest::Kind::tension:
      return "tension";
  }
  return "";
}

std::optional<model::ModePlane> CampaignTest::plane() const {
  if (in_plane == out_of_plane) return std::nullopt;
  return in_plane ? model::ModePlane::in : model::ModePlane::out;
}

namespace {

std::size_t column(TomlTable& table, const ResultColumns& columns, const std::string& key) {
  const std::string name = table.string(key);
  try {
    return columns.table.column(name);
  } catch (const model::SceneError& error) {
    if (error.where().column > 0) throw;  // a cell of the table, not its name
    throw table.error(key, columns.table.file + " " + error.problem(), error.remedy());
  }
}

void require_numbers(const TomlTable& table, const ResultColumns& columns, const std::string& key,
                     std::size_t index) {
  for (std::size_t row = 0; row < columns.table.rows.size(); ++row) {
    if (columns.table.rows[row][index] > 0) continue;
    throw table.error(key,
                      fmt::format("{}, line {}: the value is blank, zero or negative",
                                  columns.table.file, columns.table.lines[row]),
                      "give every row a positive number in this column");
  }
}

void check_frequencies(const TomlTable& table, const ResultColumns& columns) {
  std::vector<std::size_t> indices;
  if (columns.measured) indices.push_back(*columns.measured);
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

std::optional<std::pair<double, double>> band_of(TomlTable& table) {
  if (!table.has("band")) return std::nullopt;
  const auto band = table.numbers("band", 2, 2, Bound::not_negative, "Hz");
  if (!(band[0] < band[1])) {
    throw table.error("band", "does not rise", "give the lower frequency first, in Hz");
  }
  return std::pair{band[0], band[1]};
}

/// One of the names, or an error with the nearest.
void require_one_of(const std::string& name, const std::vector<std::string>& names,
                    const TomlTable& table, const std::string& key, const std::string& what) {
  if (std::find(names.begin(), names.end(), name) != names.end()) return;
  const auto nearest = model::nearest_word(name, names);
  std::string known;
  for (const auto& other : names) known += (known.empty() ? "\"" : ", \"") + other + "\"";
  throw table.error(key, "the scene has no " + what + " \"" + name + "\"",
                    nearest         ? "did you mean \"" + *nearest + "\"?"
                    : names.empty() ? "add one to the scene"
                                    : "there are: " + known);
}

std::vector<std::string> load_names(const model::Scene& scene) {
  std::vector<std::string> names;
  for (const auto& load : scene.loads) names.push_back(load.name);
  return names;
}

}  // namespace

CampaignTestReader::CampaignTestReader(Campaign& campaign, fs::path folder)
    : campaign_(campaign), folder_(std::move(folder)) {}

CampaignTest CampaignTestReader::read(TomlTable& table, const std::string& name) {
  CampaignTest test;
  test.name = name;
  test.title = table.string_or("title", test.name);
  static_cast<void>(table.string("kind"));
  const std::string kind =
      table.choice_or("kind", {"bending", "axial", "decay", "modal", "tension"}, "");
  if (kind == "bending") {
    test.kind = CampaignTest::Kind::bending;
    read_bending(table, test);
  } else if (kind == "axial") {
    test.kind = CampaignTest::Kind::axial;
    read_axial(table, test);
  } else if (kind == "decay") {
    test.kind = CampaignTest::Kind::decay;
    read_decay(table, test);
  } else if (kind == "tension") {
    test.kind = CampaignTest::Kind::tension;
    read_tension(table, test);
  } else {
    test.kind = CampaignTest::Kind::modal;
    read_modal(table, test);
  }
  table.finish();
  return test;
}

void CampaignTestReader::read_recordings(TomlTable& table, CampaignTest& test) {
  test.recordings = read_recording_groups(table, folder_);
  if (test.recordings.empty()) {
    throw table.error("recording", "is missing",
                      "name recordings in a [[test.recording]] with files = [\"...\"]");
  }
}

namespace {

/// A beam without tension; empty: the test has one.
std::optional<BentBeam> bent_beam(TomlTable& table) {
  constexpr std::array<const char*, 5> kKeys = {"ends", "rectangle", "diameter", "second_moment",
                                                "section_std"};
  if (!table.has("tension")) {
    for (const char* key : kKeys) {
      if (!table.has(key)) continue;
      throw table.error(key, "belongs to a beam without tension",
                        "add tension = 0, or leave " + std::string(key) + " out");
    }
    return std::nullopt;
  }
  if (table.number("tension", Bound::not_negative, "N") > 0) {
    throw table.error("tension", "is not 0",
                      "recordings of a cable under tension hold a channel of it; tension = 0 is "
                      "for a beam without");
  }
  BentBeam beam;
  const std::string ends = table.choice_or("ends", {"clamped", "pinned", "cantilever"}, "clamped");
  beam.ends = ends == "pinned"       ? ident::BeamEnds::pinned
              : ends == "cantilever" ? ident::BeamEnds::cantilever
                                     : ident::BeamEnds::clamped;
  int given = 0;
  if (table.has("rectangle")) {
    const auto sides = table.numbers("rectangle", 2, 2, Bound::positive, "m");
    beam.section.rectangle_m = {sides[0], sides[1]};
    ++given;
  }
  if (table.has("diameter")) {
    beam.section.diameter_m = table.number("diameter", Bound::positive, "m");
    ++given;
  }
  if (table.has("second_moment")) {
    beam.section.second_moment_m4 = table.number("second_moment", Bound::positive, "m4");
    ++given;
  }
  if (given > 1) {
    throw table.error("tension", "a beam with more than one cross-section",
                      "keep one of rectangle, diameter and second_moment");
  }
  beam.section.relative_std = table.number_or("section_std", Bound::not_negative, "", 0);
  return beam;
}

}  // namespace

void CampaignTestReader::read_bending(TomlTable& table, CampaignTest& test) {
  test.span_m = table.number("span", Bound::positive, "m");
  test.beam = bent_beam(table);
  if (!table.has("recording") && !test.beam) {
    TomlTable results = table.table("table");
    ResultColumns columns = open_table(results);
    columns.tension = column(results, columns, "tension");
    columns.EI = column(results, columns, "EI");
    results.finish();
    require_numbers(results, columns, "tension", *columns.tension);
    require_numbers(results, columns, "EI", *columns.EI);
    test.results = std::move(columns);
    return;
  }
  if (table.has("table")) {
    throw table.error("table", "is given beside recordings", "keep one of them");
  }
  const auto std_of = [&table](const char* key, const char* unit) {
    return table.number_or(key, Bound::not_negative, unit, 0);
  };
  test.span_std_m = std_of("span_std", "m");
  test.tension_zero_std_N = std_of("tension_zero_std", "N");
  test.clamp_stiffness_Nm_rad = std_of("clamp_stiffness", "N m/rad");
  test.tension_calibration_std = std_of("tension_calibration_std", "");
  test.load_calibration_std = std_of("load_calibration_std", "");
  test.deflection_calibration_std = std_of("deflection_calibration_std", "");
  if (table.has("channels")) {
    TomlTable channels = table.table("channels");
    test.tension_channel = channels.string_or("tension", test.tension_channel);
    test.load_channel = channels.string_or("load", test.load_channel);
    test.deflection_channel = channels.string_or("deflection", test.deflection_channel);
    channels.finish();
  }
  read_recordings(table, test);
}

void CampaignTestReader::read_axial(TomlTable& table, CampaignTest& test) {
  auto& setup = test.axial;
  setup.mass_kg = {table.number("mass", Bound::positive, "kg"),
                   table.number_or("mass_std", Bound::not_negative, "kg", 0)};
  setup.mass_per_length_kg_m = {
      table.number_or("mass_per_length", Bound::not_negative, "kg/m", 0),
      table.number_or("mass_per_length_std", Bound::not_negative, "kg/m", 0)};
  setup.length_std_m = table.optional_number("length_std", Bound::not_negative, "m");
  setup.adapter_stiffness_N_m = {
      table.number_or("adapter_stiffness", Bound::not_negative, "N/m", 0),
      table.number_or("adapter_stiffness_std", Bound::not_negative, "N/m", 0)};
  if (table.has("frame_stiffness")) {
    setup.frame_stated = true;
    if (!table.is_string("frame_stiffness") || table.string("frame_stiffness") != "rigid") {
      setup.frame_stiffness_N_m.value = table.number("frame_stiffness", Bound::positive, "N/m");
    }
  }
  setup.frame_stiffness_N_m.std =
      table.number_or("frame_stiffness_std", Bound::not_negative, "N/m", 0);
  setup.series_compliance_std_m_N =
      table.optional_number("compliance_std", Bound::not_negative, "m/N");
  setup.catalogue_EA_N = table.number_or("catalogue_EA", Bound::not_negative, "N", 0);
  if (table.has("channel")) test.channels = {table.string("channel")};
  test.band_hz = band_of(table);
  read_recordings(table, test);
  for (const auto& group : test.recordings) {
    if (!group.length_m) {
      throw table.error("recording", "a recording of an axial test has no length",
                        "give every [[test.recording]] the length of cable in m");
    }
  }
  if (table.has("reference")) {
    TomlTable reference = table.table("reference");
    test.reference_name = reference.string_or("name", test.reference_name);
    for (const char* key : {"EA", "damping_ratio"}) {
      if (const auto value = reference.optional_number(key, Bound::positive, "SI")) {
        test.reference[key] = *value;
      }
    }
    reference.finish();
  }
}

void CampaignTestReader::read_decay(TomlTable& table, CampaignTest& test) {
  if (table.has("channels")) test.channels = table.string_or_strings("channels");
  test.band_hz = band_of(table);
  if (table.has("scene")) {
    read_scene_keys(table, test);
    const auto& scene = campaign_.scenes[*test.scene].scene;
    test.hammer.load = table.string_or("load", "");
    if (!test.hammer.load.empty()) {
      require_one_of(test.hammer.load, load_names(scene), table, "load", "load");
    } else if (scene.loads.size() == 1) {
      test.hammer.load = scene.loads.front().name;
    } else {
      throw table.error(
          "load",
          "is missing although the scene has " + std::to_string(scene.loads.size()) + " loads",
          "name the load that sets it free, or leave scene out");
    }
  }
  read_recordings(table, test);
  check_tensions(table, test);
}

std::size_t CampaignTestReader::scene_index(TomlTable& table) const {
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
  return static_cast<std::size_t>(at - names.begin());
}

void CampaignTestReader::read_scene_keys(TomlTable& table, CampaignTest& test) {
  test.scene = scene_index(table);
  test.tension_of = parameters(table, "tension_of", *test.scene);
  test.EI_of = parameters(table, "EI_of", *test.scene);
  test.EA_of = parameters(table, "EA_of", *test.scene);
  test.damping_of = parameters(table, "damping_of", *test.scene);
  if (!table.has("sensors")) return;
  std::vector<std::string> known;
  for (const auto& sensor : campaign_.scenes[*test.scene].scene.sensors) {
    known.push_back(sensor.name);
  }
  TomlTable sensors = table.table("sensors");
  for (const auto& channel : sensors.keys()) {
    const std::string sensor = sensors.string(channel);
    require_one_of(sensor, known, sensors, channel, "sensor");
    test.hammer.sensors[channel] = sensor;
  }
  sensors.finish();
}

void CampaignTestReader::read_modal(TomlTable& table, CampaignTest& test) {
  if (table.has("scene") || !table.has("recording") || table.has("table")) {
    read_scene_keys(table, test);
  }
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
  const bool recorded = table.has("recording");
  if (recorded) read_hammer(table, test);
  if (!recorded || table.has("table")) read_results(table, test);
  check_tensions(table, test);
}

void CampaignTestReader::read_hammer(TomlTable& table, CampaignTest& test) {
  HammerTest& hammer = test.hammer;
  hammer.force = table.string("force");
  if (table.has("responses")) hammer.responses = table.string_or_strings("responses");
  hammer.estimator = table.choice_or("estimator", {"h1", "h2", "hv"}, "h1");
  hammer.force_window_s = table.number_or("force_window", Bound::positive, "s", 0);
  hammer.exponential_end_level = table.number_or("exponential_window", Bound::positive, "1", 0);
  if (hammer.exponential_end_level >= 1) {
    throw table.error("exponential_window", "is not below 1",
                      "give the window's level at the end of the block, such as 0.05");
  }
  hammer.max_order = table.integer_or("max_order", 2, 400, 0);
  test.band_hz = band_of(table);
  if (table.has("direction")) {
    const auto d = table.numbers("direction", 3, 3, Bound::any, "1");
    const Eigen::Vector3d direction(d[0], d[1], d[2]);
    if (!(direction.norm() > 0)) {
      throw table.error("direction", "is zero", "give the direction struck and measured along");
    }
    test.direction = direction.normalized();
  }
  if (!test.scene) {  // places struck have any names
    hammer.load = table.string_or("load", "");
    read_recordings(table, test);
    for (auto& group : test.recordings) {
      if (group.load.empty()) group.load = hammer.load;
    }
    return;
  }
  const auto& scene = campaign_.scenes[*test.scene].scene;
  std::vector<std::string> impacts;
  for (const auto& load : scene.loads) {
    if (load.kind == model::Load::Kind::impact) impacts.push_back(load.name);
  }
  hammer.load = table.string_or("load", impacts.size() == 1 ? impacts.front() : "");
  if (!hammer.load.empty()) require_one_of(hammer.load, impacts, table, "load", "impact");
  read_recordings(table, test);
  for (auto& group : test.recordings) {
    if (!group.load.empty()) require_one_of(group.load, impacts, table, "recording", "impact");
    if (group.load.empty()) group.load = hammer.load;
  }
}

void CampaignTestReader::read_results(TomlTable& table, CampaignTest& test) {
  TomlTable results = table.table("table");
  ResultColumns columns = open_table(results);
  if (results.has("tension")) columns.tension = column(results, columns, "tension");
  if (test.recordings.empty() || results.has("measured")) {
    columns.measured = column(results, columns, "measured");
  }
  if (results.has("models")) {
    TomlTable models = results.table("models");
    for (const auto& label : models.keys()) {
      columns.models.emplace_back(label, column(models, columns, label));
    }
    models.finish();
  }
  results.finish();
  if (columns.tension) require_numbers(results, columns, "tension", *columns.tension);
  check_frequencies(results, columns);
  test.results = std::move(columns);
}

/// What goes by tension says so in all its places.
void CampaignTestReader::check_tensions(TomlTable& table, const CampaignTest& test) const {
  const bool by_table = test.results && test.results->tension;
  std::size_t with = 0;
  for (const auto& group : test.recordings) with += group.tension_N.has_value();
  if (with > 0 && with < test.recordings.size()) {
    throw table.error("recording", "some recordings have a tension and some have none",
                      "give every [[test.recording]] its tension, or none");
  }
  if (!test.scene) return;
  const bool by_tension = by_table || with > 0;
  if (by_tension && test.tension_of.empty()) {
    throw table.error("tension_of",
                      by_table ? "is missing although the table goes by tension"
                               : "is missing although the recordings go by tension",
                      "name the scene's parameters that take it, such as \"cable.tension\"");
  }
  if (!by_tension && !test.tension_of.empty()) {
    throw table.error(
        "tension_of",
        test.results ? "is given although the table has no tension column"
                     : "is given although the recordings have no tension",
        test.results ? "add tension = \"...\" to the table, or leave tension_of out"
                     : "add tension = ... to every [[test.recording]], or leave tension_of out");
  }
  if (test.results && !test.recordings.empty() && by_table != (with > 0)) {
    throw table.error("table", "only one of table and recordings goes by tension",
                      "give both their tensions, or neither");
  }
  if (!test.EI_of.empty() && !by_tension) {
    throw table.error("EI_of",
                      test.results ? "is given although the table has no tension column"
                                   : "is given although the recordings have no tension",
                      "EI follows the tension; leave EI_of out");
  }
}

std::vector<std::string> CampaignTestReader::parameters(TomlTable& table, const std::string& key,
                                                        std::size_t scene) const {
  if (!table.has(key)) return {};
  auto names = table.string_or_strings(key);
  for (const auto& name : names) {
    check_parameter(campaign_.scenes[scene].scene, name, table, key);
  }
  return names;
}

ResultColumns CampaignTestReader::open_table(TomlTable& table) {
  ResultColumns columns;
  const fs::path file = folder_ / table.string("file");
  std::error_code error;
  if (!fs::is_regular_file(file, error)) {
    throw table.error("file", "there is no file " + file.string(),
                      "name a CSV table; the path starts at the campaign's folder");
  }
  columns.table = read_result_table(file);
  auto& inputs = campaign_.inputs;
  if (std::find(inputs.begin(), inputs.end(), columns.table.file) == inputs.end()) {
    inputs.push_back(columns.table.file);
  }
  return columns;
}

}  // namespace rigfit::apps
