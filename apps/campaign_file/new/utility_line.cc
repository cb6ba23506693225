#include "apps/campaign_file/new/utility_line.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

namespace rigfit::apps {
namespace {

constexpr double kPi = std::numbers::pi;

void check(const UtilityLine& line) {
  const auto positive = [](double value, const char* what) {
    if (!(value > 0) || !std::isfinite(value))
      throw std::invalid_argument(std::string(what) + " must be positive");
  };
  if (line.poles < 1 || line.poles > 100) throw std::invalid_argument("1 to 100 poles");
  if (line.winkler_springs < 2 || line.winkler_springs > 50)
    throw std::invalid_argument("2 to 50 springs along the embedded length");
  positive(line.height_m, "the height");
  positive(line.ground_diameter_m, "the diameter at the ground");
  positive(line.top_diameter_m, "the diameter at the top");
  positive(line.modulus_Pa, "the modulus");
  positive(line.density_kg_m3, "the density");
  positive(line.span_m, "the span");
  if (line.conductors < 0) throw std::invalid_argument("the number of conductors is 0 or more");
  if (line.conductors > 0) positive(line.conductor_tension_N, "the conductors' tension");
  if (!(line.damage_from >= 0 && line.damage_from < line.damage_to && line.damage_to < 1))
    throw std::invalid_argument(
        "the zone of damage is within 0..1 of the height, from below to above");
  if (!(line.damage_depth >= 0 && line.damage_depth < 1))
    throw std::invalid_argument("the depth of damage is from 0 to below 1");
}

class LineWriter {
 public:
  explicit LineWriter(const UtilityLine& line) : line_(line) {}

  std::string scene() {
    head();
    const double height = line_.height_m;
    const bool strung = line_.conductors > 0;
    if (strung) node("dead end 1", 0, height, "support = \"pinned\"");
    for (int i = 1; i <= line_.poles; ++i) pole(i);
    if (strung)
      node("dead end 2", (line_.poles + 1) * line_.span_m, height, "support = \"pinned\"");
    for (int i = 1; strung && i <= line_.poles + 1; ++i) span(i);
    for (int i = 1; i <= line_.poles; ++i) instruments(i);
    return text_;
  }

 private:
  void head() {
    text_ += fmt::format(
        "# A line of {} utility poles. Written by `rigfit new --kind utility-line`; all numbers "
        "can be "
        "changed.\n"
        "# From hits on the line to the bare pole:\n"
        "#   rigfit modal hits/*.csv ... --json modes.json       its modes, poles and conductors "
        "coupled\n"
        "#   rigfit update line.toml --measured modes.csv --free \"pole1 base.EI\" "
        "\"ground1.rotational_z\" "
        "--json fit.json\n"
        "#   rigfit predict pole.toml --from fit.json --damage \"pole1 base.EI\"={:.6g}\n"
        "title = \"Utility line, {} poles of {:g} m, spans of {:g} m, {} conductors\"\n"
        "gravity = 9.80665       # m/s2\n"
        "accuracy = 1e-3\n\n",
        line_.poles, EI_at(line_.damage_from), line_.poles, line_.height_m, line_.span_m,
        line_.conductors);
  }

  [[nodiscard]] double diameter(double share) const {
    return line_.ground_diameter_m + share * (line_.top_diameter_m - line_.ground_diameter_m);
  }
  [[nodiscard]] double EI_at(double share) const {
    return line_.modulus_Pa * kPi * std::pow(diameter(share), 4) / 64;
  }

  void node(const std::string& name, double x, double y, const std::string& more) {
    text_ += fmt::format("[[node]]\nname = \"{}\"\nposition = [{:g}, {:g}, 0.0]   # m\n{}{}\n",
                         name, x, y, more, more.empty() ? "" : "\n");
  }

  /// From `from` to `to` of the height (negative: below ground, of the ground's diameter).
  void piece(const std::string& name, const std::string& first, const std::string& second,
             double from, double to, double EI_factor) {
    const double d = diameter(std::max(0.0, from)), area = kPi * d * d / 4;
    const double EI = line_.modulus_Pa * kPi * std::pow(d, 4) / 64;
    text_ += fmt::format(
        "[[member]]\nname = \"{}\"\nkind = \"beam\"\nnodes = [\"{}\", \"{}\"]\nsegments = {}\n"
        "mass_per_length = {:.6g}   # kg/m at its lower end, diameter {:.4g} m\n"
        "EA = {:.6g}                # N\nEI = {:.6g}                # N m2\n"
        "GJ = {:.6g}                # N m2, wood: E / 16 for the shear modulus\n"
        "taper = {:.6g}             # diameter at the upper over that at the lower end\n"
        "damping_ratio = {:g}\n\n",
        name, first, second, std::max(2, static_cast<int>(std::lround(16 * (to - from)))),
        line_.density_kg_m3 * area, d, line_.modulus_Pa * area, EI * EI_factor, EI / 8,
        diameter(std::max(0.0, to)) / d, line_.damping_ratio);
  }

  void pole(int i) {
    const double x = i * line_.span_m, height = line_.height_m;
    const auto ground = fmt::format("ground{}", i), top = fmt::format("top{}", i);
    if (line_.embedded_m > 0) {
      foundation(i, x, ground);
    } else {
      node(ground, x, 0,
           fmt::format(
               "# soil: springs at the ground line, N/m and N m/rad; the pole does not sink or "
               "twist\n"
               "support = {{ translational = [{0:.6g}, inf, {0:.6g}], rotational = [{1:.6g}, inf, "
               "{1:.6g}] }}",
               line_.soil_translational, line_.soil_rotational));
    }
    node(top, x, height,
         fmt::format("mass = {:g}   # kg: crossarm and insulators", line_.crossarm_kg));
    const double sound = 1, zone = i == 1 ? 1 - line_.damage_depth : 1;
    std::string below = ground;
    if (line_.damage_from > 0) {
      const auto lower = fmt::format("zone{} foot", i);
      node(lower, x, line_.damage_from * height, "");
      piece(fmt::format("pole{} root", i), ground, lower, 0, line_.damage_from, sound);
      below = lower;
    }
    const auto upper = fmt::format("zone{} head", i);
    node(upper, x, line_.damage_to * height, "");
    piece(fmt::format("pole{} base", i), below, upper, line_.damage_from, line_.damage_to, zone);
    piece(fmt::format("pole{} shaft", i), upper, top, line_.damage_to, 1, sound);
  }

  /// The embedded length: pieces between springs, each spring for its share of the depth.
  void foundation(int i, double x, const std::string& ground) {
    const int n = line_.winkler_springs;
    const double h = line_.embedded_m / (n - 1);
    std::string below;
    for (int k = 0; k < n; ++k) {
      const double depth = line_.embedded_m - k * h, share = k == 0 || k == n - 1 ? 0.5 : 1;
      const auto name = k == n - 1 ? ground : fmt::format("soil{} {}", i, k + 1);
      node(name, x, -depth + 0.0,
           fmt::format("# Winkler: {0:g} N/m per m over {1:.4g} m\n"
                       "support = {{ translational = [{2:.6g}, {3}, {2:.6g}], rotational = [0.0, "
                       "{4}, 0.0] }}",
                       line_.winkler_N_m2, share * h, line_.winkler_N_m2 * share * h,
                       k == 0 ? "inf" : "0.0", k == 0 ? "inf" : "0.0"));
      if (k > 0) {
        piece(fmt::format("pole{} embedded {}", i, k), below, name, -h / line_.height_m, 0, 1);
      }
      below = name;
    }
  }

  void span(int i) {
    const auto left = i == 1 ? std::string("dead end 1") : fmt::format("top{}", i - 1);
    const auto right = i == line_.poles + 1 ? std::string("dead end 2") : fmt::format("top{}", i);
    const double n = line_.conductors;
    text_ += fmt::format(
        "[[member]]\nname = \"span{}\"     # {} conductors as one cable\nkind = \"cable\"\n"
        "nodes = [\"{}\", \"{}\"]\nsegments = 20\njoint = \"pinned\"\n"
        "mass_per_length = {:.6g}   # kg/m\nEA = {:.6g}                # N\nEI = {:.6g}            "
        "    # N "
        "m2\ntension = {:.6g}           # N, horizontal\ndamping_ratio = 0.005\n\n",
        i, line_.conductors, left, right, n * line_.conductor_kg_m, n * line_.conductor_EA_N,
        n * line_.conductor_EI_Nm2, n * line_.conductor_tension_N);
  }

  void instruments(int i) {
    text_ += fmt::format(
        "[[load]]\nname = \"hammer {0}\"\nkind = \"impact\"\nmember = \"pole{0} shaft\"\nposition "
        "= 0.3\n"
        "direction = [1.0, 0.0, 0.0]\npeak = 2000.0   # N\nduration = 0.008  # s\n\n"
        "[[sensor]]\nname = \"pole {0}, middle\"\nmember = \"pole{0} shaft\"\nposition = 0.4\n"
        "direction = [1.0, 0.0, 0.0]\n\n"
        "[[sensor]]\nname = \"pole {0}, top\"\nnode = \"top{0}\"\ndirection = [1.0, 0.0, 0.0]\n\n",
        i);
  }

  const UtilityLine& line_;
  std::string text_;
};

}  // namespace

std::string utility_line_scene(const UtilityLine& line) {
  check(line);
  return LineWriter(line).scene();
}

}  // namespace rigfit::apps
