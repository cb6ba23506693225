#include "model/scene/read_scene.h"

#include <fmt/format.h>

#include <set>

#include "model/algebra/numbers.h"
#include "model/scene/actual_state.h"
#include "model/scene/read_member.h"
#include "model/scene/sensor_quantity.h"

namespace rigfit::model {
namespace {

Vector3d vector3(TomlTable& table, const std::string& key, const std::string& unit) {
  const auto v = table.numbers(key, 3, 3, Bound::any, unit);
  return {v[0], v[1], v[2]};
}

Vector3d unit_vector(TomlTable& table, const std::string& key, const Vector3d& fallback) {
  if (!table.has(key)) return fallback;
  const Vector3d direction = vector3(table, key, "");
  const double length = direction.stableNorm();
  if (!(length > 0)) {
    throw table.error(key, "has no length", "give a direction such as [0, -1, 0] (down)");
  }
  // A unit vector stays as written, so that a scene reads back to the same numbers.
  return std::abs(length - 1) < 1e-14 ? direction : Vector3d(direction / length);
}

Support support_of(TomlTable& node) {
  Support support;
  if (node.is_table("support")) {
    TomlTable table = node.table("support");
    support.kind = Support::Kind::elastic;
    for (const auto& [key, unit, target] :
         {std::tuple{"translational", "N/m", &support.translational},
          std::tuple{"rotational", "N m/rad", &support.rotational}}) {
      if (!table.has(key)) continue;
      const auto v = table.numbers(key, 3, 3, Bound::not_negative, unit, true);
      *target = {v[0], v[1], v[2]};
    }
    table.finish();
    return support;
  }
  if (!node.has("support")) return support;
  if (!node.is_string("support")) {
    throw node.error("support", "must be a word or a table of stiffnesses",
                     "write \"free\", \"clamped\", \"pinned\" or { translational = [x, y, z], "
                     "rotational = [x, y, z] } in N/m and N m/rad (inf: fixed)");
  }
  const std::string word = node.choice_or("support", {"free", "clamped", "pinned"}, "free");
  support.kind = word == "free"      ? Support::Kind::free
                 : word == "clamped" ? Support::Kind::clamped
                                     : Support::Kind::pinned;
  return support;
}

SceneNode read_node(TomlTable& table) {
  SceneNode node;
  node.name = name_in(table, "");
  node.position = vector3(table, "position", "m");
  node.support = support_of(table);
  node.mass = table.number_or("mass", Bound::not_negative, "kg", 0);
  table.finish();
  return node;
}

Place read_place(TomlTable& table) {
  Place place;
  if (table.has("node") && table.has("member")) {
    throw table.error("node", "is given beside a member",
                      "keep one: a node, or member and position");
  }
  if (table.has("node")) {
    place.node = table.string("node");
    if (table.has("position")) {
      throw table.error("position", "is given for a node", "leave it out, or name a member");
    }
    return place;
  }
  if (!table.has("member")) {
    throw table.error("member", "is missing", "say where: node, or member and position (0..1)");
  }
  place.member = table.string("member");
  place.position = position_of(table);
  return place;
}

Load read_load(TomlTable& table, std::size_t index, const std::filesystem::path& folder,
               const Vector3d& gravity) {
  Load load;
  load.name = name_in(table, fmt::format("load-{}", index + 1));
  static_cast<void>(table.string("kind"));
  const std::string kind = table.choice_or("kind", {"impact", "release", "record"}, "");
  load.place = read_place(table);
  if (kind == "release") {
    load.kind = Load::Kind::release;
    load.mass = table.number("mass", Bound::positive, "kg");
    if (gravity.isZero()) {
      throw table.error("kind", "hangs a mass where there is no gravity",
                        "give the scene a gravity, or use an impact");
    }
    if (table.has("direction")) {
      throw table.error("direction", "is given for a release, whose mass hangs along gravity",
                        "leave it out");
    }
    load.direction = gravity.normalized();
  } else {
    load.direction = unit_vector(table, "direction", {0, -1, 0});
  }
  if (kind == "impact") {
    load.kind = Load::Kind::impact;
    load.peak = table.number("peak", Bound::positive, "N");
    load.duration = table.number("duration", Bound::positive, "s");
    load.start = table.number_or("start", Bound::not_negative, "s", 0);
  } else if (kind == "record") {
    load.kind = Load::Kind::record;
    const std::filesystem::path file = folder / table.string("file");
    std::error_code error;
    if (!std::filesystem::is_regular_file(file, error)) {
      throw table.error("file", "there is no file " + file.string(),
                        "name a CSV of time and force; the path starts at the scene's folder");
    }
    load.file = file.string();
  }
  table.finish();
  return load;
}

Sensor read_sensor(TomlTable& table, std::size_t index) {
  Sensor sensor;
  sensor.name = name_in(table, fmt::format("sensor-{}", index + 1));
  sensor.place = read_place(table);
  sensor.direction = unit_vector(table, "direction", {0, 1, 0});
  std::vector<std::string> words;
  for (const SensorQuantity& one : kSensorQuantities) words.emplace_back(one.name);
  const std::string word = table.choice_or("quantity", words, words.front());
  sensor.quantity = static_cast<Sensor::Quantity>(std::ranges::find(words, word) - words.begin());
  if (described(sensor.quantity).reading == SensorReading::axial_force &&
      !sensor.place.node.empty()) {
    throw table.error("node", "cannot carry a force sensor: tension belongs to a member",
                      "name a member and a position");
  }
  table.finish();
  return sensor;
}

/// Refuses a name that was given before (nodes, members and loads share one set of names, as
/// parameters are called "<name>.<quantity>").
void claim(std::set<std::string>& names, const std::string& name, const TomlTable& table,
           const char* remedy = "give nodes, members and loads names of their own") {
  if (names.insert(name).second) return;
  throw table.error("name", "\"" + name + "\" is used twice", remedy);
}

std::string missing(const std::string& name, const std::vector<std::string>& known) {
  const auto nearest = document::nearest_word(name, known);
  if (nearest) return "did you mean \"" + *nearest + "\"?";
  std::string list;
  for (const auto& word : known) list += (list.empty() ? "\"" : ", \"") + word + "\"";
  return list.empty() ? "there are none yet" : "there are " + list;
}

class Reader {
 public:
  Reader(TomlTable root, const std::string& file) : root_(std::move(root)) { scene_.file = file; }

  Scene read() {
    read_tables();
    const auto node_names = names(scene_.nodes), member_names = names(scene_.members);
    check_members(node_names);
    for (std::size_t i = 0; i < scene_.loads.size(); ++i) {
      check_place(scene_.loads[i].place, load_tables_[i], node_names, member_names);
    }
    for (std::size_t i = 0; i < scene_.sensors.size(); ++i) {
      check_place(scene_.sensors[i].place, sensor_tables_[i], node_names, member_names);
    }
    check_connected();
    check_conditions();
    return std::move(scene_);
  }

 private:
  template <class T>
  static std::vector<std::string> names(const std::vector<T>& things) {
    std::vector<std::string> result;
    for (const auto& thing : things) result.push_back(thing.name);
    return result;
  }

  void read_tables() {
    scene_.title = root_.string_or("title", "");
    if (root_.is_array("gravity")) {
      scene_.gravity = vector3(root_, "gravity", "m/s2");
    } else {
      scene_.gravity = {
          0, -root_.number_or("gravity", Bound::not_negative, "m/s2", kStandardGravity), 0};
    }
    scene_.accuracy = root_.number_or("accuracy", Bound::positive, "", scene_.accuracy);
    if (scene_.accuracy > 0.1) {
      throw root_.error("accuracy", fmt::format("must be at most 0.1, got {}", scene_.accuracy),
                        "give a relative error in frequency, such as 1e-4");
    }
    read_conditions();
    std::set<std::string> taken, sensors_taken;
    for (TomlTable& table : root_.tables_or_empty("node")) {
      scene_.nodes.push_back(read_node(table));
      claim(taken, scene_.nodes.back().name, table);
      node_tables_.push_back(table);
    }
    for (TomlTable& table : root_.tables_or_empty("member")) {
      scene_.members.push_back(read_member(table));
      claim(taken, scene_.members.back().name, table);
      member_tables_.push_back(table);
    }
    if (scene_.members.empty()) {
      throw root_.error("member", "is missing", "a scene needs at least one [[member]]");
    }
    for (TomlTable& table : root_.tables_or_empty("repeat")) {
      repeat(scene_, table);
      // Copies answer for the line of their [[repeat]].
      node_tables_.resize(scene_.nodes.size(), table);
      member_tables_.resize(scene_.members.size(), table);
      for (const auto& name : names(scene_.nodes)) taken.insert(name);
      for (const auto& name : names(scene_.members)) taken.insert(name);
    }
    const auto folder = std::filesystem::path(scene_.file).parent_path();
    for (TomlTable& table : root_.tables_or_empty("load")) {
      scene_.loads.push_back(read_load(table, scene_.loads.size(), folder, scene_.gravity));
      claim(taken, scene_.loads.back().name, table);
      load_tables_.push_back(table);
    }
    for (TomlTable& table : root_.tables_or_empty("sensor")) {
      scene_.sensors.push_back(read_sensor(table, scene_.sensors.size()));
      claim(sensors_taken, scene_.sensors.back().name, table, "give each sensor a name of its own");
      sensor_tables_.push_back(table);
    }
    root_.finish();
  }

  void read_conditions() {
    scene_.temperature_change = root_.number_or("temperature_change", Bound::any, "K", 0);
    if (!root_.has("load_cell")) return;
    TomlTable cell = root_.table("load_cell");
    scene_.load_cell.scale = cell.number_or("scale", Bound::positive, "", 1);
    scene_.load_cell.zero = cell.number_or("zero", Bound::any, "N", 0);
    cell.finish();
    load_cell_table_ = cell;
  }

  /// Load cell and temperature find a cable, and leave a tension and a length.
  void check_conditions() {
    const auto& members = scene_.members;
    const auto read = [](const Member& m) { return m.tension.has_value(); };
    if (load_cell_table_ && std::none_of(members.begin(), members.end(), read)) {
      throw root_.error("load_cell", "belongs to no cable: none is given by its tension",
                        "delete it, or give the cables' tensions as read");
    }
    const auto expands = [](const Member& m) { return m.thermal_expansion != 0; };
    if (scene_.temperature_change != 0 && std::none_of(members.begin(), members.end(), expands)) {
      throw root_.error("temperature_change", "changes nothing: no cable has a thermal_expansion",
                        "delete it, or give thermal_expansion of the cables (steel: 1.2e-5 1/K)");
    }
    for (std::size_t m = 0; load_cell_table_ && m < members.size(); ++m) {
      if (!members[m].tension) continue;
      const double tension = scene_.load_cell.tension(*members[m].tension);
      if (tension > 0) continue;
      throw load_cell_table_->error("zero",
                                    fmt::format("makes {} N of the {} N of \"{}\"", tension,
                                                *members[m].tension, members[m].name),
                                    "tension = scale x reading + zero must be positive");
    }
  }

  void check_members(const std::vector<std::string>& node_names) {
    std::vector<bool> used(node_names.size(), false);
    for (std::size_t m = 0; m < scene_.members.size(); ++m) {
      const Member& member = scene_.members[m];
      const TomlTable& table = member_tables_[m];
      for (const auto& name : member.nodes) {
        const auto node = std::ranges::find(node_names, name);
        if (node == node_names.end()) {
          throw table.error("nodes", "there is no node \"" + name + "\"",
                            missing(name, node_names));
        }
        used[static_cast<std::size_t>(node - node_names.begin())] = true;
      }
      const Vector3d chord = chord_of(scene_, member);
      if (member.nodes[0] == member.nodes[1] || !(chord.stableNorm() > 0)) {
        throw table.error("nodes", "\"" + member.name + "\" has no length: its ends coincide",
                          "join two nodes at different positions");
      }
      if (member.stretch && *member.stretch >= chord.stableNorm()) {
        throw table.error("stretch",
                          fmt::format("is {} m, as long as the {} m between its nodes or longer",
                                      *member.stretch, chord.stableNorm()),
                          "give the displacement of the end by which the cable was tensioned");
      }
    }
    for (std::size_t i = 0; i < used.size(); ++i) {
      if (!used[i]) {
        throw node_tables_[i].error("name", "no member ends at node \"" + node_names[i] + "\"",
                                    "name it in a member's nodes, or delete it");
      }
    }
  }

  static void check_place(const Place& place, const TomlTable& table,
                          const std::vector<std::string>& node_names,
                          const std::vector<std::string>& member_names) {
    const bool at_node = !place.node.empty();
    const auto& known = at_node ? node_names : member_names;
    const auto& name = at_node ? place.node : place.member;
    if (std::ranges::find(known, name) == known.end()) {
      throw table.error(at_node ? "node" : "member",
                        fmt::format("there is no {} \"{}\"", at_node ? "node" : "member", name),
                        missing(name, known));
    }
  }

  /// All members hang together, and something holds them.
  void check_connected() {
    std::set<std::string> reached{scene_.members[0].nodes[0]};
    for (bool grew = true; grew;) {
      grew = false;
      for (const auto& member : scene_.members) {
        const bool first = reached.contains(member.nodes[0]),
                   second = reached.contains(member.nodes[1]);
        if (first == second) continue;
        reached.insert(member.nodes[first ? 1 : 0]);
        grew = true;
      }
    }
    for (std::size_t m = 0; m < scene_.members.size(); ++m) {
      if (!reached.contains(scene_.members[m].nodes[0])) {
        throw member_tables_[m].error("nodes",
                                      fmt::format("\"{}\" is not connected to \"{}\"",
                                                  scene_.members[m].name, scene_.members[0].name),
                                      "let them share a node, or make two scenes of them");
      }
    }
    const bool held = std::ranges::any_of(
        scene_.nodes, [](const auto& node) { return node.support.kind != Support::Kind::free; });
    if (!held && !scene_.gravity.isZero()) {
      throw root_.error("node", "nothing holds the rig: no node has a support",
                        "give at least one node support = \"clamped\" or \"pinned\", or set "
                        "gravity = 0 for a free one");
    }
  }

  TomlTable root_;
  Scene scene_;
  std::optional<TomlTable> load_cell_table_;
  std::vector<TomlTable> node_tables_, member_tables_, load_tables_, sensor_tables_;
};

}  // namespace

Scene read_scene(const std::filesystem::path& path) {
  return Reader(TomlTable::read_file(path), path.string()).read();
}

Scene parse_scene(std::string_view text, const std::string& file) {
  return Reader(TomlTable::parse(text, file), file).read();
}

}  // namespace rigfit::model
