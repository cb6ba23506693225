#include "model/scene/read_member.h"

#include <fmt/format.h>

namespace rigfit::model {
namespace {

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

}  // namespace

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

std::string name_in(TomlTable& table, const std::string& fallback) {
  if (!table.has("name") && !fallback.empty()) return fallback;
  std::string name = table.string("name");
  if (name.empty()) throw table.error("name", "is empty", "give each one a name of its own");
  return name;
}

double position_of(TomlTable& table) {
  const double position = table.number("position", Bound::any, "");
  if (position < 0 || position > 1) {
    throw table.error("position", fmt::format("must be from 0 to 1, got {}", position),
                      "give the fraction of the member's length from its first node");
  }
  return position;
}

}  // namespace rigfit::model
