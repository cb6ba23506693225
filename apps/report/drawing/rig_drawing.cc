#include "apps/report/drawing/rig_drawing.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "apps/report/drawing/html_text.h"
#include "apps/report/drawing/label_places.h"

namespace rigfit::apps {
namespace {

using Eigen::Vector2d, Eigen::Vector3d;

constexpr double kWidth = 500, kMargin = 52, kLine = 17, kFont = 13;  // px
constexpr double kScaleStrip = 26;  // px, with the scale bar, under the drawing

std::string axis_words(const Vector3d& direction) {
  static constexpr std::array<const char*, 3> kNames{"x", "y", "z"};
  for (int k = 0; k < 3; ++k) {
    if (std::abs(direction[k]) > 0.99) {
      return std::string(direction[k] < 0 ? "−" : "") + kNames[static_cast<std::size_t>(k)];
    }
  }
  return fmt::format("({:.2g}, {:.2g}, {:.2g})", direction[0], direction[1], direction[2]);
}

const char* words_of(model::Sensor::Quantity quantity) {
  switch (quantity) {
    case model::Sensor::Quantity::acceleration:
      return "acceleration";
    case model::Sensor::Quantity::velocity:
      return "velocity";
    case model::Sensor::Quantity::displacement:
      return "displacement";
    case model::Sensor::Quantity::force:
      return "axial force";
  }
  return "";
}

Vector3d node_in(const model::Scene& scene, const std::string& name) {
  for (const auto& one : scene.nodes) {
    if (one.name == name) return one.position;
  }
  return Vector3d::Zero();
}

Vector3d position_in(const model::Scene& scene, const model::Place& place) {
  if (!place.node.empty()) return node_in(scene, place.node);
  for (const auto& member : scene.members) {
    if (member.name != place.member) continue;
    const Vector3d from = node_in(scene, member.nodes[0]), to = node_in(scene, member.nodes[1]);
    return from + place.position * (to - from);
  }
  return Vector3d::Zero();
}

class Drawing {
 public:
  explicit Drawing(const model::Scene& scene) : scene_(scene) { fit(); }

  std::string svg() {
    for (const auto& node : scene_.nodes) support(node);
    for (const auto& member : scene_.members) draw(member);
    for (const auto& node : scene_.nodes) mass(node);
    int number = 0;
    for (const auto& load : scene_.loads) draw(load, ++number);
    number = 0;
    for (const auto& sensor : scene_.sensors) draw(sensor, ++number);
    for (const auto& label : labels_) write(label);
    // Copies of one member (`[[repeat]]`) are not named one by one.
    if (scene_.members.size() <= 8) {
      for (const auto& member : scene_.members) name(member);
    }
    scale_bar();
    list();
    return fmt::format(
        "<svg class=\"rig\" xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {:g} {:g}\" "
        "width=\"{:g}\" height=\"{:g}\" font-family=\"sans-serif\" font-size=\"{:g}\" "
        "role=\"img\" aria-label=\"{}\">\n{}</svg>\n",
        kWidth, bottom_, kWidth, bottom_, kFont, escaped("The rig to scale: " + scene_.title),
        svg_);
  }

 private:
  /// Seen along z, or along x where the rig reaches further across.
  void fit() {
    Vector3d low = Vector3d::Constant(std::numeric_limits<double>::infinity()), high = -low;
    for (const auto& node : scene_.nodes) {
      low = low.cwiseMin(node.position);
      high = high.cwiseMax(node.position);
    }
    if (scene_.nodes.empty()) low = high = Vector3d::Zero();
    const Vector3d size = high - low;
    across_ = size[2] > size[0] ? 2 : 0;
    const double wide = std::max(size[across_], 1e-6), tall = size[1];
    scale_ = std::min((kWidth - 2 * kMargin) / wide, 240 / std::max(tall, 1e-6));
    scale_ = std::min(scale_, 1e6);
    height_ = scale_ * tall;
    origin_ = {kWidth / 2 - scale_ * (low[across_] + high[across_]) / 2,
               kMargin + height_ + scale_ * low[1]};
    bottom_ = kMargin + height_ + kMargin + kScaleStrip;
    places_ = LabelPlaces({2, 2, kWidth - 2, bottom_ - kScaleStrip});
  }

  [[nodiscard]] Vector2d at(const Vector3d& point) const {
    return {origin_[0] + scale_ * point[across_], origin_[1] - scale_ * point[1]};
  }

  /// Unit vector on paper from a node into the rig: away from its support.
  [[nodiscard]] Vector2d inwards(const model::SceneNode& one) const {
    Vector2d sum = Vector2d::Zero();
    for (const auto& member : scene_.members) {
      for (int end = 0; end < 2; ++end) {
        if (member.nodes[static_cast<std::size_t>(end)] != one.name) continue;
        const Vector2d along =
            at(node_in(scene_, member.nodes[static_cast<std::size_t>(1 - end)])) - at(one.position);
        if (along.norm() > 0) sum += along.normalized();
      }
    }
    return sum.norm() > 1e-9 ? Vector2d(sum.normalized()) : Vector2d(0, -1);
  }

  void line(const Vector2d& from, const Vector2d& to, double width, const char* more = "") {
    svg_ += fmt::format(
        "<line class=\"rig-line\" x1=\"{:.1f}\" y1=\"{:.1f}\" x2=\"{:.1f}\" y2=\"{:.1f}\" "
        "stroke=\"#1d2328\" stroke-width=\"{:g}\"{}/>\n",
        from[0], from[1], to[0], to[1], width, more);
  }

  void fill(const PaperBox& box, const std::string& words, const char* css) {
    text({0.5 * (box.left + box.right), box.bottom - 4}, words, "middle", css);
  }

  void text(const Vector2d& where, const std::string& words, const char* anchor = "middle",
            const char* css = "t") {
    svg_ +=
        fmt::format("<text class=\"{}\" x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"{}\">{}</text>\n",
                    css, where[0], where[1], anchor, escaped(words));
  }

  void hatch(const Vector2d& centre, const Vector2d& in) {
    const Vector2d side(-in[1], in[0]);
    places_.add_mark(box_around(centre - 13 * side - 7 * in, centre + 13 * side, 1));
    line(centre - 13 * side, centre + 13 * side, 2);
    for (int k = -2; k <= 2; ++k) {
      const Vector2d foot = centre + 5.5 * k * side;
      line(foot, foot - 7 * in + 5 * side, 1);
    }
  }

  void support(const model::SceneNode& one) {
    const Vector2d p = at(one.position), in = inwards(one), side(-in[1], in[0]);
    switch (one.support.kind) {
      case model::Support::Kind::free:
        return;
      case model::Support::Kind::clamped:
        hatch(p, in);
        return;
      case model::Support::Kind::pinned: {
        const Vector2d a = p - 13 * in + 8 * side, b = p - 13 * in - 8 * side;
        svg_ += fmt::format(
            "<path class=\"rig-fill\" fill=\"#fff\" stroke=\"#1d2328\" stroke-width=\"1.5\" "
            "d=\"M{:.1f} {:.1f}L{:.1f} {:.1f}L{:.1f} {:.1f}Z\"/>\n",
            p[0], p[1], a[0], a[1], b[0], b[1]);
        places_.add_mark(box_around(p - 8 * side, p - 13 * in + 8 * side, 1));
        hatch(p - 13 * in, in);
        return;
      }
      case model::Support::Kind::elastic: {
        std::string path = fmt::format("M{:.1f} {:.1f}", p[0], p[1]);
        for (int k = 1; k <= 6; ++k) {
          const double turn = k == 6 ? 0 : k % 2 == 0 ? -5 : 5;
          const Vector2d q = p - 3.6 * k * in + turn * side;
          path += fmt::format("L{:.1f} {:.1f}", q[0], q[1]);
        }
        svg_ += fmt::format(
            "<path class=\"rig-line\" fill=\"none\" stroke=\"#1d2328\" stroke-width=\"1.5\" "
            "d=\"{}\"/>\n",
            path);
        places_.add_mark(box_around(p - 5 * side, p - 22 * in + 5 * side, 1));
        hatch(p - 22 * in, in);
        return;
      }
    }
  }

  void draw(const model::Member& member) {
    const Vector3d from = node_in(scene_, member.nodes[0]), to = node_in(scene_, member.nodes[1]);
    const Vector2d a = at(from), b = at(to);
    const bool beam = member.kind == model::Member::Kind::beam;
    line(a, b, beam ? 5 : 2, beam ? " stroke-linecap=\"round\"" : "");
    places_.add_line(a, b);
    for (const auto& one : member.masses) {
      disc(at(from + one.position * (to - from)), one.mass);
      added_mass(one.mass, member.name);
    }
  }

  void name(const model::Member& member) {
    const Vector3d from = node_in(scene_, member.nodes[0]), to = node_in(scene_, member.nodes[1]);
    const std::string words = fmt::format("{}, {} m", member.name, shown((to - from).norm(), 3));
    const Vector2d size(text_width(words, kFont), kLine);
    for (const double place : {0.5, 0.4, 0.6, 0.25, 0.75, 0.1, 0.9}) {
      const Vector2d beside = at(from + place * (to - from));
      if (const auto box = places_.place(size, centres_around(beside, size))) {
        fill(*box, words, "t");
        return;
      }
    }
  }

  /// A mark's short name, drawn when all marks are: none where there is no room.
  struct Label {
    Vector2d mark;
    std::string words, css;
    Vector2d ahead = Vector2d::Zero();  ///< where it stands first, as a direction
  };

  void write(const Label& label) {
    const Vector2d size(text_width(label.words, kFont), kLine);
    auto centres = centres_around(label.mark, size);
    if (label.ahead.norm() > 0) {
      const double half = 0.5 * label.ahead.cwiseAbs().dot(size);
      centres.insert(centres.begin(), label.mark + (7 + half) * label.ahead);
    }
    if (const auto box = places_.place(size, centres)) {
      fill(*box, label.words, label.css.c_str());
    }
  }

  void disc(const Vector2d& centre, double mass_kg) {
    const double radius = std::clamp(2.5 + 1.5 * std::cbrt(mass_kg * 100), 3.0, 9.0);
    places_.add_mark(box_around(centre, centre, radius));
    svg_ += fmt::format(
        "<circle class=\"rig-mass\" fill=\"#5b6670\" cx=\"{:.1f}\" cy=\"{:.1f}\" "
        "r=\"{:.1f}\"/>\n",
        centre[0], centre[1], radius);
  }

  void added_mass(double kg, const std::string& place) {
    masses_ +=
        fmt::format("{} {} g {}", masses_.empty() ? "●  masses:" : ",", shown(1e3 * kg, 3), place);
  }

  void mass(const model::SceneNode& one) {
    if (!(one.mass > 0)) return;
    disc(at(one.position), one.mass);
    added_mass(one.mass, one.name);
  }

  /// Direction on paper; zero where it points at the reader.
  [[nodiscard]] Vector2d on_paper(const Vector3d& direction) const {
    const Vector2d d(direction[across_], -direction[1]);
    return d.norm() > 0.2 ? Vector2d(d.normalized()) : Vector2d(Vector2d::Zero());
  }

  void arrow(const Vector2d& tip, const Vector2d& direction, double length, const char* css,
             const char* colour) {
    if (direction.norm() == 0) {  // out of the paper
      places_.add_mark(box_around(tip, tip, 8));
      svg_ += fmt::format(
          "<circle class=\"{0} hollow\" fill=\"#fff\" stroke=\"{1}\" stroke-width=\"1.6\" "
          "cx=\"{2:.1f}\" cy=\"{3:.1f}\" r=\"7\"/><circle class=\"{0}\" fill=\"{1}\" "
          "cx=\"{2:.1f}\" "
          "cy=\"{3:.1f}\" r=\"2\"/>\n",
          css, colour, tip[0], tip[1]);
      return;
    }
    const Vector2d side(-direction[1], direction[0]), tail = tip - length * direction;
    places_.add_mark(box_around(tail, tip, 4));
    const Vector2d a = tip - 8 * direction + 4 * side, b = tip - 8 * direction - 4 * side;
    svg_ += fmt::format(
        "<path class=\"{0}\" fill=\"{1}\" stroke=\"{1}\" stroke-width=\"1.8\" d=\"M{2:.1f} "
        "{3:.1f}L{4:.1f} {5:.1f}M{4:.1f} {5:.1f}L{6:.1f} {7:.1f}L{8:.1f} {9:.1f}Z\"/>\n",
        css, colour, tail[0], tail[1], tip[0], tip[1], a[0], a[1], b[0], b[1]);
  }

  /// An arrow's tip, moved sideways from arrows and marks that are in its way.
  [[nodiscard]] Vector2d beside_marks(const Vector2d& tip, const Vector2d& direction,
                                      double length) const {
    const Vector2d side(-direction[1], direction[0]);
    for (const double shift : {0.0, 11.0, -11.0, 22.0, -22.0}) {
      Vector2d moved = tip + shift * side;
      if (!places_.covers_mark(box_around(moved, moved - length * direction, 4))) return moved;
    }
    return tip;
  }

  void draw(const model::Load& load, int number) {
    const Vector2d p = at(position_in(scene_, load.place));
    const std::string label = fmt::format("H{}", number);
    if (load.kind == model::Load::Kind::release) {
      const Vector2d foot = p + Vector2d(0, 30);
      line(p, foot, 1, " stroke-dasharray=\"3 3\"");
      svg_ += fmt::format(
          "<rect class=\"rig-hit\" fill=\"#b3261e\" x=\"{:.1f}\" y=\"{:.1f}\" width=\"16\" "
          "height=\"12\"/>\n",
          foot[0] - 8, foot[1]);
      places_.add_mark(box_around(foot - Vector2d(8, 0), foot + Vector2d(8, 12), 1));
      places_.add_line(p, foot);
      labels_.push_back({foot + Vector2d(0, 6), label, "t rig-hit"});
      keys_.push_back(fmt::format("{}  {}: {} kg hung and released", label,
                                  load.name.empty() ? "mass" : load.name, shown(load.mass, 3)));
      return;
    }
    const Vector2d direction = on_paper(load.direction);
    const Vector2d tip = beside_marks(p - 4 * direction, direction, 32);
    arrow(tip, direction, 32, "rig-hit", "#b3261e");
    labels_.push_back({tip - 32 * direction, label, "t rig-hit", -direction});
    keys_.push_back(fmt::format("{}  {}: struck along {}", label,
                                load.name.empty() ? "hit" : load.name, axis_words(load.direction)));
  }

  void draw(const model::Sensor& sensor, int number) {
    const Vector2d p = at(position_in(scene_, sensor.place)),
                   direction = on_paper(sensor.direction);
    svg_ += fmt::format(
        "<rect class=\"rig-sensor\" fill=\"#0072b2\" x=\"{:.1f}\" y=\"{:.1f}\" width=\"10\" "
        "height=\"10\"/>\n",
        p[0] - 5, p[1] - 5);
    Vector2d named = p;
    if (direction.norm() > 0) {
      named = beside_marks(p + 24 * direction, direction, 17);
      arrow(named, direction, 17, "rig-sensor", "#0072b2");
    }
    places_.add_mark(box_around(p, p, 6));
    const std::string label = fmt::format("S{}", number);
    labels_.push_back({named, label, "t rig-sensor", direction});
    keys_.push_back(fmt::format("{}  {}: {}, {}", label, sensor.name, words_of(sensor.quantity),
                                axis_words(sensor.direction)));
  }

  void scale_bar() {
    double length = std::pow(10, std::floor(std::log10(0.25 * kWidth / scale_)));
    for (const double factor : {5.0, 2.0}) {
      if (factor * length * scale_ <= 0.25 * kWidth) {
        length *= factor;
        break;
      }
    }
    const Vector2d from(16, bottom_ - 12), to(16 + scale_ * length, bottom_ - 12);
    line(from, to, 2);
    line(from - Vector2d(0, 4), from + Vector2d(0, 4), 1.5);
    line(to - Vector2d(0, 4), to + Vector2d(0, 4), 1.5);
    text(to + Vector2d(8, 4),
         length < 0.1 ? fmt::format("{:g} mm", 1e3 * length) : fmt::format("{:g} m", length),
         "start");
  }

  /// What the marks are, in two columns.
  void list() {
    constexpr std::size_t kMost = 16;
    constexpr double kLeft = 16, kColumn = kWidth / 2;
    if (!masses_.empty()) keys_.insert(keys_.begin(), masses_);
    const std::size_t more = keys_.size() > kMost ? keys_.size() - kMost : 0;
    keys_.resize(keys_.size() - more);
    if (more > 0) keys_.push_back(fmt::format("and {} more", more));
    std::vector<std::vector<std::string>> keys;
    std::size_t lines = 0;
    for (const auto& key : keys_) {
      keys.push_back(broken_into_lines(key, kFont, kColumn - kLeft - 14));
      lines += keys.back().size();
    }
    std::size_t used = 0, rows = 0;
    double x = kLeft, y = bottom_;
    for (const auto& key : keys) {
      if (x == kLeft && used > 0 && 2 * used >= lines) x = kColumn, y = bottom_, used = 0;
      for (std::size_t i = 0; i < key.size(); ++i) {
        y += kLine;
        text({x + (i > 0 ? 14 : 0), y}, key[i], "start");
      }
      used += key.size();
      rows = std::max(rows, used);
    }
    bottom_ += kLine * static_cast<double>(rows) + (rows > 0 ? 8 : 0);
  }

  const model::Scene& scene_;
  int across_ = 0;
  double scale_ = 1, height_ = 0, bottom_ = 0;
  Vector2d origin_ = Vector2d::Zero();
  LabelPlaces places_{{}};
  std::vector<Label> labels_;
  std::vector<std::string> keys_;
  std::string masses_, svg_;
};

}  // namespace

std::string rig_drawing(const model::Scene& scene) { return Drawing(scene).svg(); }

std::string rig_places(const model::Scene& scene) {
  std::string text = "series,origin,\"x, m\",\"y, m\",\"z, m\"\n";
  const auto add = [&](const char* what, const std::string& name, const Vector3d& at) {
    std::string plain;
    for (const char c : name) plain += c == '"' ? '\'' : c;
    text += fmt::format("\"{}: {}\",scene,{},{},{}\n", what, plain, at[0], at[1], at[2]);
  };
  for (const auto& node : scene.nodes) add("node", node.name, node.position);
  for (const auto& sensor : scene.sensors) {
    add("sensor", sensor.name, position_in(scene, sensor.place));
  }
  for (const auto& load : scene.loads) add("load", load.name, position_in(scene, load.place));
  return text;
}

}  // namespace rigfit::apps
