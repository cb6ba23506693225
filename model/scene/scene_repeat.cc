#include "model/scene/read_member.h"

#include <fmt/format.h>

#include <map>

#include "model/algebra/numbers.h"

namespace rigfit::model {
namespace {

constexpr int kMostCopies = 1000;

bool same(const Support& a, const Support& b) {
  return a.kind == b.kind && (a.kind != Support::Kind::elastic ||
                              (a.translational == b.translational && a.rotational == b.rotational));
}

template <class T>
T* find(std::vector<T>& things, const std::string& name) {
  const auto at = std::ranges::find(things, name, &T::name);
  return at == things.end() ? nullptr : &*at;
}

}  // namespace

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
        throw table.error("members", "\"" + name + "\" ends at \"" + node + "\", which is no node",
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

}  // namespace rigfit::model
