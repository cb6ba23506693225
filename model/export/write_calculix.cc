#include "model/export/write_calculix.h"

#include <fmt/format.h>

#include <iterator>
#include <map>

#include "model/scene/actual_state.h"
#include "model/scene/model_reduction.h"

namespace rigfit::model {
namespace {

constexpr double kTightStrain = 2e-3;  // cooling of the first step, beyond the final thermal strain
// The unit of the deck's temperatures: ccx 2.20 starts a step's iteration far off when they are of
// order one.
constexpr double kDegree = 1e-3;

SceneError cannot(const Scene& scene, const std::string& key, const std::string& problem) {
  return SceneError({scene.file, 0, 0, key}, problem + " cannot be written for CalculiX",
                    "take it out of the scene that is exported");
}

class DeckWriter {
 public:
  DeckWriter(const Scene& scene, const Equilibrium& equilibrium, const CalculixOptions& options)
      : scene_(scene), equilibrium_(equilibrium), options_(options) {}

  CalculixDeck write() {
    check();
    line("*HEADING");
    line(scene_.title.empty() ? "rigfit scene" : scene_.title);
    write_nodes_and_elements();
    write_supports();
    line("*INITIAL CONDITIONS,TYPE=TEMPERATURE");
    line("ALL,0.");
    write_static_step(kDegree, "0.1,1.");
    write_static_step(2 * kDegree, "0.05,1.,1e-6,0.2");
    line("*STEP,PERTURBATION");
    line("*FREQUENCY");
    line(fmt::format("{}", options_.frequencies));
    line("*END STEP");
    return {std::move(text_), std::move(members_), std::move(notes_)};
  }

 private:
  void line(std::string_view content) {
    text_ += content;
    text_ += '\n';
  }

  void check() {
    for (const auto& member : scene_.members) {
      if (!(member.EI[0] > 0 && member.EI[1] > 0)) {
        throw cannot(scene_, member.name + ".EI", "a member without bending stiffness");
      }
      if (member.taper != 1) throw cannot(scene_, member.name + ".taper", "a tapered member");
      if (member.joint[0] == Member::Joint::pinned || member.joint[1] == Member::Joint::pinned) {
        throw cannot(scene_, member.name + ".joint", "a released joint");
      }
      const auto turns = [&](const SceneNode& node) {
        return node.support.kind == Support::Kind::pinned ||
               !std::count(member.nodes.begin(), member.nodes.end(), node.name);
      };
      if (member.kind == Member::Kind::cable && scene_.gravity.norm() > 0 &&
          member.assembled == Member::Assembled::hanging &&
          !std::all_of(scene_.nodes.begin(), scene_.nodes.end(), turns)) {
        notes_.push_back(member.name +
                         ": its ends that cannot turn are stress-free in the deck where it is "
                         "straight, in the scene where it hangs: the more it sags, the more the "
                         "deck's tension and frequencies differ (assembled = \"straight\" is the "
                         "deck's state)");
      }
    }
    for (const auto& node : scene_.nodes) {
      if (node.support.kind == Support::Kind::elastic && node.support.rotational.maxCoeff() > 0) {
        throw cannot(scene_, node.name + ".support", "a rotational spring");
      }
    }
  }

  Vector3d position(const std::string& node) const {
    return scene_.nodes[at(index_named(scene_, scene_.nodes, node))].position;
  }

  int node_number(const std::string& node) {
    const auto [entry, fresh] = numbers_.try_emplace(node, next_node_);
    if (fresh) add_node(position(node));
    return entry->second;
  }

  int add_node(const Vector3d& at) {
    nodes_ += fmt::format("{},{:.12g},{:.12g},{:.12g}\n", next_node_, at.x(), at.y(), at.z());
    return next_node_++;
  }

  void write_nodes_and_elements() {
    std::string elements, sections;
    for (std::size_t i = 0; i < scene_.members.size(); ++i) {
      const Member& member = scene_.members[i];
      const Vector3d from = position(member.nodes[0]);
      const Vector3d span = chord_of(scene_, member);
      const int steps = 2 * options_.elements_per_member;
      std::vector<int> line_nodes{node_number(member.nodes[0])};
      for (int k = 1; k < steps; ++k) line_nodes.push_back(add_node(from + span * k / steps));
      line_nodes.push_back(node_number(member.nodes[1]));
      elements += fmt::format("*ELEMENT,TYPE=B32R,ELSET=M{}\n", i + 1);
      for (std::size_t k = 0; k + 2 < line_nodes.size(); k += 2) {
        elements += fmt::format("{},{},{},{}\n", next_element_++, line_nodes[k], line_nodes[k + 1],
                                line_nodes[k + 2]);
      }
      sections += section(member, i, span);
      add_point_masses(member, line_nodes, elements);
    }
    for (const auto& node : scene_.nodes) {
      if (node.mass > 0) elements += point_mass(node_number(node.name), node.mass);
    }
    text_ += "*NODE,NSET=ALL\n" + nodes_ + elements;
    text_ += sections;
  }

  // Local direction 1 of the section is the horizontal one across the member (z for the rig's
  // plane), about which EI[0] bends.
  std::string section(const Member& member, std::size_t i, const Vector3d& span) {
    const MemberEquilibrium& rest = equilibrium_.members[i];
    const double L0 = rest.unstretched_length_m, length = span.norm();
    const double height = std::sqrt(12 * member.EI[0] / member.EA);
    const double width = std::sqrt(12 * member.EI[1] / member.EA);
    // ccx measures Green's strain from the deck's straight length L and Kirchhoff's stress, the
    // scene force and strain e per unstretched length L0: E A (L0 / L)^3 (1 + e)(1 + e / 2) e for
    // EA e. The modulus makes the force at rest the scene's.
    const double ratio = length / L0, e = rest.tension_N / member.EA;
    const double modulus =
        member.EA * ratio * ratio * ratio / ((1 + e) * (1 + e / 2)) / (height * width);
    const double density = member.mass_per_length * L0 / (height * width * length);
    const bool cable = member.kind == Member::Kind::cable;
    const double thermal = cable ? thermal_strain(L0 / length) : 0;
    add_rest(member, modulus * height * width, e, thermal, L0, length);
    const Vector3d across = material_axes(span).col(1);
    return fmt::format(
        "*MATERIAL,NAME=MAT{0}\n*ELASTIC\n{1:.12g},{2:.12g}\n*DENSITY\n{3:.12g}\n"
        "{9}"
        "*BEAM SECTION,ELSET=M{0},MATERIAL=MAT{0},SECTION=RECT\n{4:.12g},{5:.12g}\n"
        "{6:.12g},{7:.12g},{8:.12g}\n",
        i + 1, modulus, options_.poisson_ratio, density, width, height, across.x(), across.y(),
        across.z(), cable ? expansion(thermal) : "");
  }

  // What the deck's cable, with thermal strain a, bears where it is as long as the scene's at rest,
  // with strain e.
  void add_rest(const Member& member, double EA, double e, double a, double L0, double length) {
    const double now = L0 * (1 + e) / length, taken = a - a * a / 2;
    const double force = EA * ((now * now - 1) / 2 - taken) * now;
    const double slope = EA * (1.5 * now * now - 0.5 - taken) / length;
    members_.push_back({member.name, force, e * member.EA, slope / (member.EA / L0)});
  }

  // a with a - a^2/2 = g, Green's strain from the straight length to the unstretched one.
  static double thermal_strain(double stretch) {
    const double green = (stretch * stretch - 1) / 2;
    return 2 * green / (1 + std::sqrt(1 - 2 * green));
  }

  // One temperature serves all cables: strain = alpha(t) t is tight at t = 1 and as the scene asks
  // at t = 2.
  static std::string expansion(double strain) {
    return fmt::format("*EXPANSION\n{:.12g},{}\n{:.12g},{}\n", (strain - kTightStrain) / kDegree,
                       kDegree, strain / (2 * kDegree), 2 * kDegree);
  }

  void add_point_masses(const Member& member, const std::vector<int>& line_nodes,
                        std::string& elements) {
    for (const auto& attached : member.masses) {
      const double place = attached.position * static_cast<double>(line_nodes.size() - 1);
      const auto nearest = static_cast<std::size_t>(std::lround(place));
      if (std::abs(place - static_cast<double>(nearest)) > 1e-6) {
        notes_.push_back(
            fmt::format("{}: a mass at {:.4f} was put at the nearest node, {:.4f}", member.name,
                        attached.position,
                        static_cast<double>(nearest) / static_cast<double>(line_nodes.size() - 1)));
      }
      elements += point_mass(line_nodes[nearest], attached.mass);
    }
  }

  std::string point_mass(int node, double mass) {
    ++point_masses_;
    return fmt::format("*ELEMENT,TYPE=MASS,ELSET=P{0}\n{1},{2}\n*MASS,ELSET=P{0}\n{3:.12g}\n",
                       point_masses_, next_element_++, node, mass);
  }

  void write_supports() {
    for (const auto& node : scene_.nodes) {
      const int number = node_number(node.name);
      switch (node.support.kind) {
        case Support::Kind::free:
          break;
        case Support::Kind::clamped:
          line(fmt::format("*BOUNDARY\n{},1,6", number));
          break;
        case Support::Kind::pinned:
          line(fmt::format("*BOUNDARY\n{},1,3", number));
          hold_twist(node.name, number);
          break;
        case Support::Kind::elastic:
          for (int axis = 0; axis < 3; ++axis) {
            const double stiffness = node.support.translational[axis];
            if (std::isinf(stiffness)) {
              line(fmt::format("*BOUNDARY\n{},{},{}", number, axis + 1, axis + 1));
            } else if (stiffness > 0) {
              ++springs_;
              line(
                  fmt::format("*ELEMENT,TYPE=SPRING1,ELSET=S{0}\n{1},{2}\n*SPRING,ELSET=S{0}\n{3}\n"
                              "{4:.12e}",  // ccx takes no spring without a decimal point
                              springs_, next_element_++, number, axis + 1, stiffness));
            }
          }
          break;
      }
    }
  }

  // A pinned end is free to turn but not about the member's own axis. Where no axis of the deck
  // lies along it ccx has no way to say so: an equation between rotations does not hold them.
  void hold_twist(const std::string& node, int number) {
    const Member* ending = nullptr;  // a beam before cables
    for (const auto& member : scene_.members) {
      if (member.nodes[0] != node && member.nodes[1] != node) continue;
      if (!ending || (ending->kind == Member::Kind::cable && member.kind == Member::Kind::beam)) {
        ending = &member;
      }
    }
    if (!ending) return;
    const Vector3d axis = chord_of(scene_, *ending).normalized();
    Index main = 0;
    axis.cwiseAbs().maxCoeff(&main);
    if (ending->kind == Member::Kind::beam && std::abs(std::abs(axis[main]) - 1) < 1e-12) {
      return line(fmt::format("*BOUNDARY\n{0},{1},{1}", number, main + 4));
    }
    notes_.push_back(
        node + ": free to twist, which gives the deck a spinning mode that the scene has not" +
        (ending->kind == Member::Kind::cable
             ? " (ccx would hold a sagging end's other rotations too)"
             : ""));
  }

  void write_static_step(double temperature, const char* increments) {
    line("*STEP,NLGEOM,INC=500");
    line("*STATIC");
    line(increments);
    line("*TEMPERATURE");
    line(fmt::format("ALL,{}", temperature));
    const double gravity = scene_.gravity.norm();
    if (gravity > 0) {
      line("*DLOAD");
      const Vector3d down = scene_.gravity / gravity;
      for (std::size_t i = 0; i < scene_.members.size(); ++i) {
        line(fmt::format("M{},GRAV,{:.12g},{:.12g},{:.12g},{:.12g}", i + 1, gravity, down.x(),
                         down.y(), down.z()));
      }
      for (int i = 1; i <= point_masses_; ++i) {
        line(fmt::format("P{},GRAV,{:.12g},{:.12g},{:.12g},{:.12g}", i, gravity, down.x(), down.y(),
                         down.z()));
      }
    }
    line("*END STEP");
  }

  const Scene& scene_;
  const Equilibrium& equilibrium_;
  const CalculixOptions& options_;
  std::string text_, nodes_;
  std::vector<CalculixMember> members_;
  std::vector<std::string> notes_;
  std::map<std::string, int> numbers_;
  int next_node_ = 1;
  int next_element_ = 1;
  int point_masses_ = 0;
  int springs_ = 0;
};

}  // namespace

CalculixDeck calculix_deck(const Scene& scene, const Equilibrium& equilibrium,
                           const CalculixOptions& options) {
  const Scene actual = actual_state(scene);
  return DeckWriter(actual, equilibrium, options).write();
}

}  // namespace rigfit::model
