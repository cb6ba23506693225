#include "model/scene/read_scene.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <map>
#include <set>

#include "model/algebra/numbers.h"
#include "model/scene/actual_state.h"
#include "model/scene/scene_numbers.h"
#include "model/scene/sensor_quantity.h"

namespace rigfit::model {
namespace {

/// The key "name"; `fallback` where it is missing and the fallback is not empty.
std::string name_in(TomlTable& table, const std::string& fallback) {
  if (!table.has("name") && !fallback.empty()) return fallback;
  std::string name = table.string("name");
  if (name.empty()) throw table.error("name", "is empty", "give each one a name of its own");
  return name;
}

/// The key "position" along a member, 0 to 1.
double position_of(TomlTable& table) {
  const double position = table.number("position", Bound::any, "");
  if (position < 0 || position > 1) {
    throw table.error("position", fmt::format("must be from 0 to 1, got {}", position),
                      "give the fraction of the member's length from its first node");
  }
  return position;
}

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

int segments_of(TomlTable& table) {
  if (!table.is_string("segments")) {
    return table.has("segments") ? table.integer_or("segments", 2, 10000, 0) : 0;
  }
  static_cast<void>(table.choice_or("segments", {"auto"}, "auto"));
  return 0;
}

std::array<double, 2> bending_stiffness(TomlTable& table, Member::Kind kind) {
  if (!table.is_array("EI")) {
    const double EI = table.number("EI", Bound::not_negative, "N m2");
    return {EI, EI};
  }
  const auto EI = table.numbers("EI", 2, 2, Bound::not_negative, "N m2");
  if (kind == Member::Kind::cable && EI[0] != EI[1]) {
    throw table.error("EI", "gives a cable two bending stiffnesses",
                      "give one number, or make it kind = \"beam\"");
  }
  return {EI[0], EI[1]};
}

void check_initial_state(const TomlTable& table, const Member& member) {
  const int given = member.tension.has_value() + member.unstretched_length.has_value() +
                    member.stretch.has_value();
  if (member.kind == Member::Kind::beam && given > 0) {
    const char* key = member.tension              ? "tension"
                      : member.unstretched_length ? "unstretched_length"
                                                  : "stretch";
    throw table.error(key, "is given for a beam, which is stress-free as drawn",
                      "leave it out, or make the member kind = \"cable\"");
  }
  if (member.kind == Member::Kind::cable && given == 0) {
    throw table.error("tension", "is missing",
                      "a cable needs one of tension (N), unstretched_length (m) or stretch (m)");
  }
  if (given > 1) {
    throw table.error(member.stretch ? "stretch" : "unstretched_length",
                      "says a second time how the cable is tensioned",
                      "keep only one of tension, unstretched_length and stretch");
  }
  if (member.thermal_expansion > 0 && (member.kind == Member::Kind::beam || member.tension)) {
    throw table.error("thermal_expansion",
                      member.tension ? "is given for a cable whose tension is given"
                                     : "is given for a beam, which is drawn as it is",
                      "leave it out: only cables given by unstretched_length or stretch take it");
  }
}

void read_damping(TomlTable& table, Member& member) {
  if (member.damping_ratio && *member.damping_ratio >= 1) {
    throw table.error("damping_ratio",
                      fmt::format("must be below 1, got {}", *member.damping_ratio),
                      "give the ratio to critical damping, such as 0.005 (not percent)");
  }
  if (!table.has("damping")) return;
  if (member.damping_ratio) {
    throw table.error("damping", "is given beside damping_ratio",
                      "keep one: joint dampers or a modal ratio");
  }
  TomlTable damping = table.table("damping");
  for (const auto& number : kDampingNumbers) number.read(damping, member.damping);
  damping.finish();
}

void read_joints(TomlTable& table, Member& member) {
  if (!table.has("joint")) return;
  auto words = table.strings("joint");
  if (words.size() == 1) words.push_back(words[0]);
  if (words.size() != 2) {
    throw table.error("joint", fmt::format("has {} values", words.size()),
                      "give one word for both ends, or two: [\"rigid\", \"pinned\"]");
  }
  for (std::size_t end = 0; end < 2; ++end) {
    if (words[end] != "rigid" && words[end] != "pinned") {
      throw table.error("joint", "does not know \"" + words[end] + "\"",
                        "it must be \"rigid\" or \"pinned\"");
    }
    member.joint[end] = words[end] == "pinned" ? Member::Joint::pinned : Member::Joint::rigid;
  }
}

Member read_member(TomlTable& table) {
  Member member;
  member.name = name_in(table, "");
  static_cast<void>(table.string("kind"));
  member.kind = table.choice_or("kind", {"cable", "beam"}, "") == "beam" ? Member::Kind::beam
                                                                         : Member::Kind::cable;
  const auto nodes = table.strings("nodes");
  if (nodes.size() != 2) {
    throw table.error("nodes", fmt::format("names {} nodes", nodes.size()),
                      "name the two nodes it joins: [\"left\", \"right\"]");
  }
  member.nodes = {nodes[0], nodes[1]};
  member.segments = segments_of(table);
  for (const auto& number : kMemberNumbers) number.read(table, member);
  if (table.has("mass_of")) {
    member.mass_of = table.choice_or("mass_of", {"unstretched", "installed"}, "") == "installed"
                         ? Member::MassOf::installed
                         : Member::MassOf::unstretched;
  }
  member.EI = bending_stiffness(table, member.kind);
  check_initial_state(table, member);
  member.assembled = table.choice_or("assembled", {"hanging", "straight"}, "hanging") == "straight"
                         ? Member::Assembled::straight
                         : Member::Assembled::hanging;
  read_damping(table, member);
  read_joints(table, member);
  for (TomlTable& mass : table.tables_or_empty("mass")) {
    AttachedMass attached;
    attached.position = position_of(mass);
    attached.mass = mass.number("mass", Bound::positive, "kg");
    mass.finish();
    member.masses.push_back(attached);
  }
  table.finish();
  return member;
}

constexpr int kMostCopies = 1000;

bool same(const Support& a, const Support& b) {
  return a.kind == b.kind && (a.kind != Support::Kind::elastic ||
                              (a.translational == b.translational && a.rotational == b.rotational));
}

template <class T>
const T* find(const std::vector<T>& things, const std::string& name) {
  const auto at = std::ranges::find(things, name, &T::name);
  return at == things.end() ? nullptr : &*at;
}

// The short form for a line of many poles: members and their nodes copied along an offset.
//
//   [[repeat]]
//   members = ["pole", "span"]     # what is copied, with the nodes they end at
//   count = 9                      # copies besides the original: "pole-2" ... "pole-10"
//   offset = [50.0, 0.0, 0.0]      # m, from each to the next
//
// A copied node that falls on a node there is already becomes that node. Two nodes of the repeated
// part that meet so must have the same support; a node outside it wins (the line's last anchor).
void repeat(Scene& scene, TomlTable& table) {
  const auto members = table.strings("members");
  if (members.empty()) throw table.error("members", "is empty", "name the members to copy");
  if (!table.has("count")) {
    throw table.error("count", "is missing", "give the number of copies besides the original");
  }
  const int count = table.integer_or("count", 1, kMostCopies, 1);
  const auto shift = table.numbers("offset", 3, 3, Bound::any, "m");
  const Vector3d offset(shift[0], shift[1], shift[2]);
  if (!(offset.norm() > 0)) {
    throw table.error("offset", "has no length", "give the distance to the next one");
  }
  table.finish();

  std::vector<std::string> nodes;  // nodes of the original, each once
  for (const auto& name : members) {
    const Member* member = find(scene.members, name);
    if (!member) {
      throw table.error("members", "there is no member \"" + name + "\"",
                        "name members that stand above");
    }
    for (const auto& node : member->nodes) {
      if (!find(scene.nodes, node)) {
        throw table.error("members",
                          fmt::format("\"{}\" ends at \"{}\", which is no node", name, node),
                          "add the node");
      }
      if (std::find(nodes.begin(), nodes.end(), node) == nodes.end()) nodes.push_back(node);
    }
  }

  const auto claim = [&](const std::string& name) {
    if (find(scene.nodes, name) || find(scene.members, name)) {
      throw table.error("members", "the copy \"" + name + "\" has a name that is taken",
                        "rename the other");
    }
  };
  const double near = 1e-9 * offset.norm();
  std::vector<std::string> part = nodes;  // the repeated nodes and their copies
  for (int copy = 2; copy <= count + 1; ++copy) {
    std::map<std::string, std::string> copied;
    for (const auto& name : nodes) {
      SceneNode node = *find(scene.nodes, name);
      node.position += (copy - 1) * offset;
      node.name = fmt::format("{}-{}", name, copy);
      const auto there = std::find_if(
          scene.nodes.begin(), scene.nodes.end(),
          [&](const SceneNode& other) { return (other.position - node.position).norm() <= near; });
      if (there == scene.nodes.end()) {
        claim(node.name);
        copied[name] = node.name;
        part.push_back(node.name);
        scene.nodes.push_back(std::move(node));
        continue;
      }
      const bool inside = std::find(part.begin(), part.end(), there->name) != part.end();
      if (inside && !same(there->support, node.support)) {
        throw table.error("offset",
                          fmt::format("copy {} of node \"{}\" falls on \"{}\", whose support "
                                      "differs",
                                      copy, name, there->name),
                          "give both the same support, and the line's last anchor a node of its "
                          "own outside the repeated members");
      }
      copied[name] = there->name;
    }
    for (const auto& name : members) {
      Member member = *find(scene.members, name);
      member.name = fmt::format("{}-{}", name, copy);
      claim(member.name);
      for (auto& node : member.nodes) node = copied[node];
      scene.members.push_back(std::move(member));
    }
  }
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
  std::vector<std::string> words(std::size(kSensorQuantities));
  std::ranges::transform(kSensorQuantities, words.begin(), &SensorQuantity::name);
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
  return known.empty() ? "there are none yet"
                       : fmt::format("there are \"{}\"", fmt::join(known, "\", \""));
}

class Reader {
 public:
  Reader(TomlTable root, const std::string& file) : root_(std::move(root)) { scene_.file = file; }

  Scene read() {
    read_tables();
    check_connected();
    check_conditions();
    return std::move(scene_);
  }

 private:
  template <class T>
  static std::vector<std::string> names(const std::vector<T>& things) {
    std::vector<std::string> result(things.size());
    std::ranges::transform(things, result.begin(), &T::name);
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
    std::vector<TomlTable> loads = root_.tables_or_empty("load");
    std::vector<TomlTable> sensors = root_.tables_or_empty("sensor");
    root_.finish();  // a misspelt [[node]] is that before it is a member without nodes
    check_members();
    const auto folder = std::filesystem::path(scene_.file).parent_path();
    for (TomlTable& table : loads) {
      scene_.loads.push_back(read_load(table, scene_.loads.size(), folder, scene_.gravity));
      claim(taken, scene_.loads.back().name, table);
      check_place(scene_.loads.back().place, table);
    }
    for (TomlTable& table : sensors) {
      scene_.sensors.push_back(read_sensor(table, scene_.sensors.size()));
      claim(sensors_taken, scene_.sensors.back().name, table, "give each sensor a name of its own");
      check_place(scene_.sensors.back().place, table);
    }
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

  void check_members() const {
    std::vector<bool> used(scene_.nodes.size(), false);
    for (std::size_t m = 0; m < scene_.members.size(); ++m) {
      const Member& member = scene_.members[m];
      const TomlTable& table = member_tables_[m];
      for (const auto& name : member.nodes) {
        const SceneNode* node = find(scene_.nodes, name);
        if (!node) {
          throw table.error("nodes", "there is no node \"" + name + "\"",
                            missing(name, names(scene_.nodes)));
        }
        used[static_cast<std::size_t>(node - scene_.nodes.data())] = true;
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
        throw node_tables_[i].error("name",
                                    "no member ends at node \"" + scene_.nodes[i].name + "\"",
                                    "name it in a member's nodes, or delete it");
      }
    }
  }

  void check_place(const Place& place, const TomlTable& table) const {
    const bool at_node = !place.node.empty();
    const auto known = at_node ? names(scene_.nodes) : names(scene_.members);
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
  std::vector<TomlTable> node_tables_, member_tables_;
};

}  // namespace

Scene read_scene(const std::filesystem::path& path) {
  return Reader(TomlTable::read_file(path), path.string()).read();
}

Scene parse_scene(std::string_view text, const std::string& file) {
  return Reader(TomlTable::parse(text, file), file).read();
}

}  // namespace rigfit::model
