#include <Eigen/Geometry>
#include <complex>

#include "apps/campaign_file/measured_modes.h"
#include "apps/report/figures/figures.h"
#include "model/scene/sensor_quantity.h"

namespace rigfit::apps {
namespace {

using Eigen::Index, Eigen::Vector2d, Eigen::Vector3d;
using Box = Eigen::AlignedBox2d;  // px, y grows downwards

/// A scene in parallel projection. The vertical stays upright; `yaw` turns the rig about it,
/// `pitch` tilts it towards the reader, rad.
class SceneView {
 public:
  /// `members`: points along each, m; drawn within `most` px. `around`: room kept around the
  /// members, as a share of the scene's extent.
  SceneView(const model::Scene& scene, std::vector<Eigen::Matrix3Xd> members, double yaw,
            double pitch, const Vector2d& most, const Vector2d& around)
      : scene_(scene), members_(std::move(members)) {
    turn_ << std::cos(yaw), 0, std::sin(yaw), std::sin(pitch) * std::sin(yaw), std::cos(pitch),
        -std::sin(pitch) * std::cos(yaw);
    Eigen::AlignedBox3d whole;
    Box seen;
    for (const auto& member : members_) {
      for (const auto& point : member.colwise()) {
        whole.extend(Vector3d(point));
        seen.extend(Vector2d(turn_ * point));
      }
    }
    if (whole.isEmpty()) whole.extend(Vector3d(Vector3d::Zero())), seen.extend(Vector2d(0, 0));
    extent_ = std::max(whole.sizes().maxCoeff(), 1e-9);
    middle_ = seen.center();
    const Vector2d size = (seen.sizes() + extent_ * around).cwiseMax(1e-6 * extent_);
    scale_ = most.cwiseQuotient(size).minCoeff();
    size_px_ = scale_ * size;
  }

  void centre_on(const Vector2d& paper) { centre_ = paper; }
  [[nodiscard]] double extent() const { return extent_; }  ///< m
  [[nodiscard]] double scale() const { return scale_; }    ///< px/m
  [[nodiscard]] const Vector2d& size_px() const { return size_px_; }
  [[nodiscard]] Vector2d at(const Vector3d& point) const {
    const Vector2d seen = scale_ * (turn_ * point - middle_);
    return centre_ + Vector2d(seen[0], -seen[1]);
  }

  /// On a member or at its end; empty: the scene has no such place.
  [[nodiscard]] std::optional<Vector3d> point(const model::Place& place) const {
    for (std::size_t m = 0; m < scene_.members.size() && m < members_.size(); ++m) {
      const auto& points = members_[m];
      const auto& member = scene_.members[m];
      const auto last = static_cast<double>(points.cols() - 1);
      const double t = place.node.empty() ? (member.name == place.member ? place.position : -1)
                       : member.nodes[0] == place.node ? 0
                       : member.nodes[1] == place.node ? 1
                                                       : -1;
      if (t < 0) continue;
      const auto first = static_cast<Index>(std::min(std::floor(t * last), last - 1));
      return points.col(first) +
             (t * last - static_cast<double>(first)) * (points.col(first + 1) - points.col(first));
    }
    return std::nullopt;
  }

  [[nodiscard]] std::string path(const Eigen::Matrix3Xd& points) const {
    std::string path;
    for (const auto& one : points.colwise()) {
      const Vector2d p = at(one);
      path += fmt::format("{}{:.1f} {:.1f}", path.empty() ? "M" : "L", p[0], p[1]);
    }
    return path;
  }

  /// Each with its foot away from the members; `size`: px of half a clamp.
  [[nodiscard]] std::string supports(double size) const {
    static constexpr std::array<const char*, 4> kShapes{"", "M0 0l6 10h-12z", "M-5 0h10v10h-10z",
                                                        "M0 0v3l-5 2l10 3l-10 3l10 3l-5 2"};
    std::string svg;
    for (const auto& node : scene_.nodes) {
      const auto where = point({node.name, "", 0});
      if (!where || node.support.kind == model::Support::Kind::free) continue;
      Vector2d inwards = Vector2d::Zero();
      for (const auto& member : scene_.members) {
        for (const std::size_t end : {0, 1}) {
          const auto other = point({member.nodes[1 - end], "", 0});
          if (member.nodes[end] == node.name && other) inwards += (at(*other) - at(*where));
        }
      }
      const double turn = std::atan2(inwards[0], -inwards[1]) * 180 / M_PI;
      const bool filled = node.support.kind != model::Support::Kind::elastic;
      const Vector2d p = at(*where);
      svg += fmt::format(
          "<path class=\"{}\" transform=\"translate({:.1f} {:.1f}) rotate({:.0f}) scale({:g})\" "
          "d=\"{}\" fill=\"{}\" stroke=\"#222\"><title>{}</title></path>\n",
          filled ? "support" : "frame", p[0], p[1], turn, size / 5,
          kShapes[static_cast<std::size_t>(node.support.kind)], filled ? "#222" : "none",
          escaped(node.name));
    }
    return svg;
  }

 private:
  const model::Scene& scene_;
  std::vector<Eigen::Matrix3Xd> members_;
  Eigen::Matrix<double, 2, 3> turn_;
  double extent_ = 1, scale_ = 1;
  Vector2d middle_, centre_ = Vector2d::Zero(), size_px_;
};

std::string rectangle(const char* css, const Vector2d& centre, const Vector2d& size,
                      const char* colours, const std::string& title = {}) {
  return fmt::format(
      "<rect class=\"{}\" x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:g}\" height=\"{:g}\" {}><title>{}"
      "</title></rect>\n",
      css, centre[0] - 0.5 * size[0], centre[1] - 0.5 * size[1], size[0], size[1], colours,
      escaped(title));
}

std::string circle(const char* css, const Vector2d& centre, double radius, const char* colours) {
  return fmt::format("<circle class=\"{}\" {} cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"{:.1f}\"/>\n", css,
                     colours, centre[0], centre[1], radius);
}

std::string svg_of(const Picture& picture, const char* css, double font_px,
                   const std::string& body) {
  return fmt::format(
      "<svg class=\"{0}\" xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {1:g} {2:g}\" "
      "width=\"{1:g}\" height=\"{2:g}\" role=\"img\" font-family=\"sans-serif\" "
      "font-size=\"{3:g}\">\n<title>{4}</title>\n<desc>{5}</desc>\n{6}</svg>\n",
      css, picture.width, picture.height, font_px, escaped(picture.title), escaped(picture.caption),
      body);
}

// The rig -----------------------------------------------------------------------------------------

constexpr double kFont = 13;  // px

/// The rig to scale from the side: marks first, then their names where nothing else is.
class RigDrawing {
 public:
  explicit RigDrawing(const model::Scene& scene) : scene_(scene), view_(view_of(scene)) {
    picture_.width = kWidth;
    picture_.height = view_.size_px()[1] + 2 * kMargin;
    view_.centre_on({0.5 * kWidth, 0.5 * picture_.height});
    paper_ = Box(Vector2d(2, 2), Vector2d(kWidth - 2, picture_.height - 2));
  }

  Picture drawn() {
    svg_ += view_.supports(8);
    for (const auto& node : scene_.nodes) {
      if (node.support.kind != model::Support::Kind::free) keep_off(view_.at(node.position), 17);
    }
    for (const auto& member : scene_.members) draw(member);
    for (const auto& node : scene_.nodes) mass(node.position, node.mass, node.name);
    for (const auto& load : scene_.loads) draw(load);
    for (const auto& sensor : scene_.sensors) draw(sensor);
    for (const auto& [where, words, css] : labels_) write(where, words, css);
    // Copies of one member (`[[repeat]]`) are not named one by one.
    if (scene_.members.size() <= 8) {
      for (const auto& member : scene_.members) name(member);
    }
    scale_bar();
    picture_.id = "rig-drawing";
    picture_.title = "What was tested";
    picture_.caption = scene_.title.empty() ? "The rig" : scene_.title;
    picture_.caption += ", to scale.";
    constexpr std::size_t kMost = 16;  // marks that the caption explains
    for (std::size_t i = 0; i < std::min(keys_.size(), kMost); ++i) {
      picture_.caption += " " + keys_[i] + ".";
    }
    if (!masses_.empty()) picture_.caption += " Discs: " + masses_ + ".";
    picture_.svg = svg_of(picture_, "rig", kFont, svg_);
    return std::move(picture_);
  }

 private:
  static constexpr double kWidth = 500, kMargin = 52;  // px

  /// Along z, or along x where the rig reaches further across.
  static SceneView view_of(const model::Scene& scene) {
    Vector3d low = Vector3d::Constant(HUGE_VAL), high = -low;
    std::vector<Eigen::Matrix3Xd> members;
    for (const auto& member : scene.members) {
      members.emplace_back(3, 2);
      for (const std::size_t end : {0, 1}) {
        const Vector3d at = position_of(scene, {member.nodes[end], "", 0});
        members.back().col(static_cast<Index>(end)) = at;
        low = low.cwiseMin(at), high = high.cwiseMax(at);
      }
    }
    const bool across = high[2] - low[2] > high[0] - low[0];
    return {scene, std::move(members),          across ? M_PI / 2 : 0,
            0,     {kWidth - 2 * kMargin, 240}, {0, 0}};
  }

  void keep_off(const Vector2d& centre, double half) {
    taken_.emplace_back(centre.array() - half, centre.array() + half);
  }
  [[nodiscard]] bool is_free(const Box& box) const {
    return paper_.contains(box) &&
           std::ranges::none_of(taken_, [&](const Box& one) { return one.intersects(box); });
  }

  void line(const Vector2d& from, const Vector2d& to, double width) {
    svg_ += fmt::format(
        "<path class=\"rig-line\" d=\"M{:.1f} {:.1f}L{:.1f} {:.1f}\" fill=\"none\" "
        "stroke=\"#1d2328\" stroke-width=\"{:g}\"/>\n",
        from[0], from[1], to[0], to[1], width);
    const int pieces = 1 + static_cast<int>((to - from).norm() / 3);  // no label fits between
    for (int k = 0; k <= pieces; ++k) keep_off(from + k * (to - from) / pieces, 1);
  }

  /// As near as it can be, over nothing else; nowhere where there is no room.
  void write(const Vector2d& where, const std::string& words, const char* css) {
    const Vector2d size(0.68 * kFont * characters(words) + 4, kFont + 4);
    for (const double distance : {8.0, 14.0, 20.0, 28.0, 38.0, 50.0}) {
      for (const int eighth : {1, 3, 7, 5, 2, 6, 0, 4}) {
        const Vector2d out = Eigen::Rotation2Dd(-eighth * M_PI / 4) * Vector2d(1, 0);
        const Vector2d side =
            out.unaryExpr([](double x) { return std::abs(x) < 0.1 ? 0 : std::copysign(0.5, x); });
        const Vector2d centre = where + distance * out + side.cwiseProduct(size);
        const Box box(Vector2d(centre - 0.5 * size), Vector2d(centre + 0.5 * size));
        if (!is_free(box)) continue;
        taken_.push_back(box);
        svg_ += fmt::format(
            "<text class=\"{}\" x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"middle\">{}</text>\n", css,
            centre[0], box.max()[1] - 4, escaped(words));
        return;
      }
    }
  }

  void draw(const model::Member& member) {
    const Vector3d from = position_of(scene_, {member.nodes[0], "", 0}),
                   to = position_of(scene_, {member.nodes[1], "", 0});
    line(view_.at(from), view_.at(to), member.kind == model::Member::Kind::beam ? 5 : 2);
    for (const auto& one : member.masses) {
      mass(from + one.position * (to - from), one.mass, member.name);
    }
  }

  void name(const model::Member& member) {
    const auto at = [&](double share) { return position_of(scene_, {"", member.name, share}); };
    write(view_.at(at(0.5)), fmt::format("{}, {} m", member.name, shown((at(1) - at(0)).norm(), 3)),
          "t");
  }

  void mass(const Vector3d& where, double kg, const std::string& place) {
    if (!(kg > 0)) return;
    const double radius = std::clamp(2.5 + 1.5 * std::cbrt(100 * kg), 3.0, 9.0);
    const Vector2d p = view_.at(where);
    keep_off(p, radius);
    svg_ += circle("rig-mass", p, radius, "fill=\"#5b6670\"");
    masses_ += fmt::format("{}{} g {}", masses_.empty() ? "" : ", ", shown(1e3 * kg, 3), place);
  }

  /// A mark with its label beside it and its meaning in the caption.
  void mark(const std::string& svg, const Vector2d& at, const std::string& label, const char* css,
            const std::string& meaning) {
    svg_ += svg;
    keep_off(at, 7);
    labels_.emplace_back(at, label, css);
    keys_.push_back(label + ": " + meaning);
  }

  void draw(const model::Load& load) {
    const Vector2d p = view_.at(position_of(scene_, load.place));
    mark(circle("rig-hit", p, 7, "fill=\"#b3261e\""), p, fmt::format("H{}", ++loads_), "t rig-hit",
         load.kind == model::Load::Kind::release
             ? fmt::format("{} kg hung and released", shown(load.mass, 3))
             : "struck along " + axis_words(load.direction));
  }

  void draw(const model::Sensor& sensor) {
    const Vector2d p = view_.at(position_of(scene_, sensor.place));
    mark(rectangle("rig-sensor", p, {9, 9}, "fill=\"#0072b2\"", sensor.name), p,
         fmt::format("S{}", ++sensors_), "t rig-sensor",
         fmt::format("{}, {} along {}", sensor.name, model::described(sensor.quantity).name,
                     axis_words(sensor.direction)));
  }

  static std::string axis_words(const Vector3d& direction) {
    Index axis = 0;
    if (direction.cwiseAbs().maxCoeff(&axis) > 0.99) {
      return fmt::format("{}{}", direction[axis] < 0 ? "−" : "", "xyz"[axis]);
    }
    return fmt::format("({:.2g}, {:.2g}, {:.2g})", direction[0], direction[1], direction[2]);
  }

  void scale_bar() {
    const double most = 0.25 * kWidth / view_.scale();
    double length = std::pow(10, std::floor(std::log10(most)));
    length *= 5 * length <= most ? 5 : 2 * length <= most ? 2 : 1;
    const Vector2d from(16, picture_.height - 12), to = from + Vector2d(view_.scale() * length, 0);
    line(from, to, 2);
    svg_ += fmt::format("<text class=\"t\" x=\"{:.1f}\" y=\"{:.1f}\">{:g} m</text>\n", to[0] + 8,
                        to[1] + 4, length);
  }

  const model::Scene& scene_;
  SceneView view_;
  Picture picture_;
  Box paper_;
  std::vector<Box> taken_;
  std::vector<std::tuple<Vector2d, std::string, const char*>> labels_;
  std::vector<std::string> keys_;
  std::string masses_, svg_;
  int loads_ = 0, sensors_ = 0;
};

// Shapes of modes ---------------------------------------------------------------------------------

constexpr double kPanelWidth = 280, kPanelHeight = 190, kTitle = 36;
constexpr double kAmplitude = 0.1;  // largest displacement of a drawn mode over the scene's extent

/// Points between two nodes where the motion changes sign, on the member at rest.
std::string nodal_points(const SceneView& view, const Eigen::Matrix3Xd& rest,
                         const Eigen::Matrix3Xd& moved, double largest) {
  Index direction = 0;
  moved.cwiseAbs().rowwise().maxCoeff().maxCoeff(&direction);
  std::string svg;
  for (Index i = 1; i + 1 < moved.cols(); ++i) {
    const double a = moved(direction, i), b = moved(direction, i + 1);
    if (!(a * b < 0) || std::max(std::abs(a), std::abs(b)) < 1e-3 * largest) continue;
    const auto p = view.at(rest.col(i) + a / (a - b) * (rest.col(i + 1) - rest.col(i)));
    svg += circle("frame node", p, 2.6, "fill=\"#fff\" stroke=\"#555\"");
  }
  return svg;
}

double largest_of(const model::NaturalMode& mode) {
  double largest = 0;
  for (const auto& shape : mode.shape) {
    if (shape.displacement.size() > 0) {
      largest = std::max(largest, shape.displacement.colwise().norm().maxCoeff());
    }
  }
  return largest;
}

std::string mode_panel(const SceneView& view, const model::Scene& scene,
                       const model::ModalAnalysis& analysis, std::size_t index,
                       const ident::MeasuredRow* measured) {
  const auto& mode = analysis.modes[index];
  const double largest = largest_of(mode), factor = kAmplitude * view.extent() / largest;
  std::string svg;
  for (std::size_t m = 0; m < mode.shape.size(); ++m) {
    const auto& rest = analysis.equilibrium.members[m].positions;
    const auto& moved = mode.shape[m].displacement;
    if (moved.cols() != rest.cols()) continue;
    svg += fmt::format(
        "<path class=\"rest\" d=\"{}\" fill=\"none\" stroke=\"#888\" stroke-dasharray=\"3 3\"/>\n"
        "<g class=\"s0\" stroke=\"{}\"><path class=\"line\" d=\"{}\" fill=\"none\" "
        "stroke-width=\"2.6\" stroke-linejoin=\"round\"/></g>\n",
        view.path(rest), series_colour(0), view.path(rest + factor * moved));
    svg += nodal_points(view, rest, moved, largest);
  }
  svg += view.supports(5);
  const auto sensors = static_cast<Index>(scene.sensors.size());
  const bool shaped = measured && measured->shape.size() == sensors &&
                      mode.sensor_shape.size() == sensors && measured->shape.squaredNorm() > 0;
  // Lays the measured shape over the model's: least squares, in the complex plane.
  const std::complex<double> fit =
      shaped ? measured->shape.dot(mode.sensor_shape.cast<std::complex<double>>()) /
                   measured->shape.squaredNorm()
             : 0;
  for (Index s = 0; s < sensors; ++s) {
    const auto& sensor = scene.sensors[static_cast<std::size_t>(s)];
    const auto rest = view.point(sensor.place);
    if (!rest) continue;
    const auto p = view.at(*rest);
    svg += rectangle("frame sensor", p, {6, 6}, "fill=\"#fff\" stroke=\"#222\"", sensor.name);
    if (!shaped) continue;
    const auto q = view.at(*rest + factor * (fit * measured->shape[s]).real() * sensor.direction);
    svg += fmt::format(
        "<g class=\"s1\" fill=\"{4}\" stroke=\"{4}\"><path class=\"line\" d=\"M{0:.1f} "
        "{1:.1f}L{2:.1f} {3:.1f}\" fill=\"none\"/><circle cx=\"{2:.1f}\" cy=\"{3:.1f}\" r=\"4.5\"/>"
        "</g>\n",
        p[0], p[1], q[0], q[1], series_colour(1));
  }
  svg += fmt::format(
      "<text class=\"t\" x=\"12\" y=\"14\" fill=\"#222\" font-weight=\"bold\">{}  {} Hz, {}, {}"
      "</text>\n",
      index + 1, shown(mode.frequency_hz, 5), name_of(mode.plane), name_of(mode.family));
  if (!measured) return svg;
  return svg + fmt::format(
                   "<text class=\"t\" x=\"12\" y=\"30\" fill=\"#222\">{} {} Hz{}</text>\n",
                   name_of(measured->origin), shown(measured->frequency_hz.value, 5),
                   std::isfinite(measured->mac) ? fmt::format(", MAC {:.3f}", measured->mac) : "");
}

void add_csv(std::string& csv, const model::ModalAnalysis& analysis, std::size_t index) {
  const auto& mode = analysis.modes[index];
  for (std::size_t m = 0; m < mode.shape.size(); ++m) {
    const auto& rest = analysis.equilibrium.members[m].positions;
    const auto& moved = mode.shape[m].displacement;
    for (Index i = 0; i < std::min(moved.cols(), rest.cols()); ++i) {
      fmt::format_to(std::back_inserter(csv), "{},{},{},{},{},{},{},{},{}\n", index + 1,
                     mode.frequency_hz, m + 1, rest(0, i), rest(1, i), rest(2, i), moved(0, i),
                     moved(1, i), moved(2, i));
    }
  }
}

}  // namespace

Picture rig_picture(const model::Scene& scene) {
  Picture picture = RigDrawing(scene).drawn();
  picture.csv = "place,\"x, m\",\"y, m\",\"z, m\"\n";
  const auto add = [&](const std::string& what, const Vector3d& at) {
    picture.csv += fmt::format("{},{},{},{}\n", csv_quoted(what), at[0], at[1], at[2]);
  };
  for (const auto& node : scene.nodes) add("node: " + node.name, node.position);
  for (const auto& one : scene.sensors) add("sensor: " + one.name, position_of(scene, one.place));
  for (const auto& one : scene.loads) add("load: " + one.name, position_of(scene, one.place));
  return picture;
}

std::vector<Picture> shapes_pictures(const std::string& id, const std::string& state,
                                     const model::Scene& scene,
                                     const model::ModalAnalysis& analysis,
                                     const std::vector<ident::MeasuredRow>& rows) {
  // Modes and columns in a picture: a quarter of a page on paper.
  constexpr std::size_t kModes = 6, kColumns = 2, kMost = 16;
  const auto paired = [&](std::size_t mode) {
    const auto at = std::ranges::find_if(rows, [&](const auto& row) {
      return row.mode == mode && std::isfinite(row.frequency_hz.value);
    });
    return at == rows.end() ? nullptr : &*at;
  };
  std::vector<std::size_t> drawn;
  for (std::size_t i = 0; i < analysis.modes.size() && drawn.size() < kMost; ++i) {
    if (largest_of(analysis.modes[i]) > 0) drawn.push_back(i);
  }
  std::vector<Eigen::Matrix3Xd> members;
  for (const auto& member : analysis.equilibrium.members) members.push_back(member.positions);
  std::vector<Picture> pictures;
  if (members.empty()) return pictures;
  const bool measured = std::ranges::any_of(
      rows, [](const auto& row) { return row.mode && std::isfinite(row.frequency_hz.value); });
  SceneView view(scene, std::move(members), -0.45, 0.35,
                 {kPanelWidth - 50, kPanelHeight - kTitle - 30}, kAmplitude * Vector2d(0.72, 2.4));
  view.centre_on({0.5 * kPanelWidth, 0.5 * (kPanelHeight + kTitle)});
  std::string caption =
      "Line: the model, enlarged; broken: at rest. Triangles: pinned, filled squares: clamped, "
      "open squares: sensors, open circles: nodes of the shape.";
  if (measured) caption += " Points: measured, scaled to the model.";
  if (drawn.size() < analysis.modes.size()) {
    caption += fmt::format(" The first {} of {} modes.", drawn.size(), analysis.modes.size());
  }
  for (std::size_t from = 0; from < drawn.size(); from += kModes) {
    const std::size_t count = std::min(kModes, drawn.size() - from);
    Picture picture;
    picture.id = from == 0 ? id : fmt::format("{}-{}", id, from / kModes + 1);
    picture.title = measured ? "Mode shapes, test over model" : "Mode shapes";
    if (!state.empty()) picture.title += ": " + state;
    if (drawn.size() > kModes) {
      picture.title += fmt::format(fmt::runtime(count > 1 ? ", {} to {}" : ", {}"), drawn[from] + 1,
                                   drawn[from + count - 1] + 1);
    }
    picture.caption = caption;
    picture.csv = "mode,frequency_hz,member,x_m,y_m,z_m,dx,dy,dz\n";
    std::string body;
    for (std::size_t k = 0; k < count; ++k) {
      const std::size_t mode = drawn[from + k], row = k / kColumns;
      body += fmt::format("<g transform=\"translate({:g} {:g})\">\n{}</g>\n",
                          kPanelWidth * static_cast<double>(k % kColumns),
                          kPanelHeight * static_cast<double>(row),
                          mode_panel(view, scene, analysis, mode, paired(mode)));
      add_csv(picture.csv, analysis, mode);
    }
    picture.width = kPanelWidth * kColumns;
    picture.height = kPanelHeight * static_cast<double>((count + kColumns - 1) / kColumns);
    picture.svg = svg_of(picture, "shapes", 14, body);
    pictures.push_back(std::move(picture));
  }
  return pictures;
}

}  // namespace rigfit::apps
