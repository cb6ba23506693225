#include <fmt/format.h>

#include "model/algebra/numbers.h"
#include "model/scene/read_scene.h"
#include "model/scene/scene_numbers.h"
#include "model/scene/sensor_quantity.h"

namespace rigfit::model {
namespace {

std::string quoted(const std::string& text) {
  std::string result = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') {
      result += '\\';
      result += c;
    } else if (c == '\n') {
      result += "\\n";
    } else if (c == '\t') {
      result += "\\t";
    } else if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) {
      result += fmt::format("\\u{:04x}", static_cast<unsigned char>(c));
    } else {
      result += c;
    }
  }
  return result + "\"";
}

/// Shortest text that reads back to the same double, always a TOML number.
std::string number(double value) {
  if (value == 0) return std::signbit(value) ? "-0.0" : "0";  // -0 would be a whole number: 0
  return fmt::format("{}", value);
}

std::string vector(const Vector3d& v) {
  return fmt::format("[{}, {}, {}]", number(v[0]), number(v[1]), number(v[2]));
}

std::string node_text(const SceneNode& node) {
  std::string text = fmt::format("\n[[node]]\nname = {}\nposition = {}  # m\n", quoted(node.name),
                                 vector(node.position));
  const Support& support = node.support;
  if (support.kind == Support::Kind::elastic) {
    text += fmt::format("support = {{ translational = {}, rotational = {} }}  # N/m, N m/rad\n",
                        vector(support.translational), vector(support.rotational));
  } else if (support.kind != Support::Kind::free) {
    text += fmt::format("support = \"{}\"\n",
                        support.kind == Support::Kind::pinned ? "pinned" : "clamped");
  }
  if (node.mass != 0) text += fmt::format("mass = {}  # kg\n", number(node.mass));
  return text;
}

std::string member_text(const Member& member) {
  const bool cable = member.kind == Member::Kind::cable;
  std::string text =
      fmt::format("\n[[member]]\nname = {}\nkind = \"{}\"\nnodes = [{}, {}]\n", quoted(member.name),
                  cable ? "cable" : "beam", quoted(member.nodes[0]), quoted(member.nodes[1]));
  const auto line = [&](const char* key, double value, const char* unit) {
    text += fmt::format("{} = {}{}{}\n", key, number(value), *unit ? "  # " : "", unit);
  };
  text += member.segments > 0 ? fmt::format("segments = {}\n", member.segments)
                              : std::string("segments = \"auto\"\n");
  if (member.mass_of == Member::MassOf::installed) text += "mass_of = \"installed\"\n";
  if (member.mass_of == Member::MassOf::unstretched) text += "mass_of = \"unstretched\"\n";
  if (member.EI[0] == member.EI[1]) {
    line("EI", member.EI[0], "N m2");
  } else {
    text += fmt::format("EI = [{}, {}]  # N m2, about z and about the horizontal in-plane axis\n",
                        number(member.EI[0]), number(member.EI[1]));
  }
  Member all = member, usual;
  for (const auto& one : kMemberNumbers) {
    const double* value = one.of(all);
    if (!value || !(one.required || one.is_optional() || *value != *one.of(usual))) continue;
    line(one.key, *value, one.unit);
  }
  if (member.assembled == Member::Assembled::straight) text += "assembled = \"straight\"\n";
  const auto joint = [](Member::Joint j) {
    return j == Member::Joint::pinned ? "\"pinned\"" : "\"rigid\"";
  };
  if (member.joint[0] != Member::Joint::rigid || member.joint[1] != Member::Joint::rigid) {
    text += fmt::format("joint = [{}, {}]\n", joint(member.joint[0]), joint(member.joint[1]));
  }
  const auto& damping = member.damping;
  if (!member.damping_ratio &&
      (damping.axial != 0 || damping.bending != 0 || damping.torsion != 0)) {
    text += fmt::format(
        "damping = {{ axial = {}, bending = {}, torsion = {} }}  # N s, N m2 s, N m2 s\n",
        number(damping.axial), number(damping.bending), number(damping.torsion));
  }
  for (const auto& mass : member.masses) {
    text += fmt::format("\n[[member.mass]]\nposition = {}\nmass = {}  # kg\n",
                        number(mass.position), number(mass.mass));
  }
  return text;
}

std::string place_text(const Place& place) {
  return place.node.empty() ? fmt::format("member = {}\nposition = {}\n", quoted(place.member),
                                          number(place.position))
                            : fmt::format("node = {}\n", quoted(place.node));
}

std::string load_text(const Load& load, const std::string& scene_file) {
  const bool release = load.kind == Load::Kind::release, impact = load.kind == Load::Kind::impact;
  std::string text = fmt::format("\n[[load]]\nname = {}\nkind = \"{}\"\n{}", quoted(load.name),
                                 impact    ? "impact"
                                 : release ? "release"
                                           : "record",
                                 place_text(load.place));
  if (release) return text + fmt::format("mass = {}  # kg\n", number(load.mass));
  text += fmt::format("direction = {}\n", vector(load.direction));
  if (impact) {
    text += fmt::format("peak = {}  # N\nduration = {}  # s\n", number(load.peak),
                        number(load.duration));
    if (load.start != 0) text += fmt::format("start = {}  # s\n", number(load.start));
    return text;
  }
  const auto folder = std::filesystem::path(scene_file).parent_path();
  auto file = std::filesystem::path(load.file).lexically_relative(folder.empty() ? "." : folder);
  if (file.empty()) file = load.file;
  return text + fmt::format("file = {}\n", quoted(file.string()));
}

std::string sensor_text(const Sensor& sensor) {
  return fmt::format("\n[[sensor]]\nname = {}\n{}direction = {}\nquantity = \"{}\"\n",
                     quoted(sensor.name), place_text(sensor.place), vector(sensor.direction),
                     described(sensor.quantity).name);
}

}  // namespace

std::string scene_text(const Scene& scene) {
  std::string text;
  if (!scene.title.empty()) text += fmt::format("title = {}\n", quoted(scene.title));
  if (scene.gravity[0] == 0 && scene.gravity[2] == 0 && scene.gravity[1] <= 0) {
    text += fmt::format("gravity = {}  # m/s2, along -y\n", number(std::abs(scene.gravity[1])));
  } else {
    text += fmt::format("gravity = {}  # m/s2\n", vector(scene.gravity));
  }
  text += fmt::format("accuracy = {}\n", number(scene.accuracy));
  if (scene.temperature_change != 0) {
    text += fmt::format("temperature_change = {}  # K\n", number(scene.temperature_change));
  }
  if (scene.load_cell.scale != 1 || scene.load_cell.zero != 0) {
    text += fmt::format(
        "\n[load_cell]  # tension = scale x reading + zero\nscale = {}\nzero = {}  # N\n",
        number(scene.load_cell.scale), number(scene.load_cell.zero));
  }
  for (const auto& node : scene.nodes) text += node_text(node);
  for (const auto& member : scene.members) text += member_text(member);
  for (const auto& load : scene.loads) text += load_text(load, scene.file);
  for (const auto& sensor : scene.sensors) text += sensor_text(sensor);
  return text;
}

}  // namespace rigfit::model
