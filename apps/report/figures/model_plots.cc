#include "apps/report/figures/figures.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <iterator>

#include "apps/report/drawing/html_text.h"
#include "apps/report/drawing/palette.h"
#include "model/scene/sensor_quantity.h"

namespace rigfit::apps {
namespace {

using Eigen::Index;
using Eigen::Vector3d;

constexpr double kPanelWidth = 280, kPanelHeight = 190, kTitle = 36;

/// Parallel projection of space onto a panel.
class View {
 public:
  explicit View(const model::Equilibrium& equilibrium) {
    Vector3d low = Vector3d::Constant(1e300), high = -low;
    for (const auto& member : equilibrium.members) {
      low = low.cwiseMin(member.positions.rowwise().minCoeff());
      high = high.cwiseMax(member.positions.rowwise().maxCoeff());
    }
    centre_ = 0.5 * (low + high);
    size_ = std::max((high - low).maxCoeff(), 1e-9);
    double wide = 0, tall = 0;
    for (int corner = 0; corner < 8; ++corner) {
      Vector3d at;
      for (int k = 0; k < 3; ++k) at[k] = (corner >> k & 1) != 0 ? high[k] : low[k];
      const Eigen::Vector2d p = turned(at);
      wide = std::max(wide, 2 * std::abs(p[0]));
      tall = std::max(tall, 2 * std::abs(p[1]));
    }
    const double room = 2.4 * amplitude();
    scale_ = std::min((kPanelWidth - 50) / (wide + 0.3 * room),
                      (kPanelHeight - kTitle - 30) / (tall + room));
  }

  /// Largest displacement of a drawn mode, m.
  [[nodiscard]] double amplitude() const { return 0.1 * size_; }

  [[nodiscard]] Eigen::Vector2d at(const Vector3d& point) const {
    const Eigen::Vector2d p = turned(point);
    return {0.5 * kPanelWidth + scale_ * p[0], 0.5 * (kPanelHeight + kTitle) - scale_ * p[1]};
  }

 private:
  [[nodiscard]] Eigen::Vector2d turned(const Vector3d& point) const {
    constexpr double kYaw = -0.45, kPitch = 0.35;  // rad
    const Vector3d r = point - centre_;
    const double u = std::cos(kYaw) * r[0] + std::sin(kYaw) * r[2];
    const double depth = -std::sin(kYaw) * r[0] + std::cos(kYaw) * r[2];
    return {u, std::cos(kPitch) * r[1] - std::sin(kPitch) * depth};
  }

  Vector3d centre_;
  double size_ = 1, scale_ = 1;
};

std::string path_of(const View& view, const Eigen::Matrix3Xd& points) {
  std::string path;
  for (Index i = 0; i < points.cols(); ++i) {
    const auto p = view.at(points.col(i));
    path += fmt::format("{}{:.1f} {:.1f}", i == 0 ? "M" : "L", p[0], p[1]);
  }
  return path;
}

/// Where a place of the scene hangs, and its node's column.
struct Hung {
  const model::MemberEquilibrium* member = nullptr;
  std::size_t index = 0;
  Index column = 0;
};

std::optional<Hung> hung(const model::Scene& scene, const model::Equilibrium& equilibrium,
                         const model::Place& place) {
  for (std::size_t m = 0; m < scene.members.size() && m < equilibrium.members.size(); ++m) {
    const auto& member = equilibrium.members[m];
    const Index last = member.positions.cols() - 1;
    if (place.node.empty() && scene.members[m].name == place.member) {
      return Hung{&member, m,
                  static_cast<Index>(std::lround(place.position * static_cast<double>(last)))};
    }
    for (std::size_t end = 0; end < 2; ++end) {
      if (!place.node.empty() && scene.members[m].nodes[end] == place.node) {
        return Hung{&member, m, end == 0 ? 0 : last};
      }
    }
  }
  return std::nullopt;
}

std::string supports(const View& view, const model::Scene& scene,
                     const model::Equilibrium& equilibrium) {
  std::string svg;
  for (const auto& node : scene.nodes) {
    const auto where = hung(scene, equilibrium, {node.name, "", 0});
    if (!where) continue;
    const auto p = view.at(where->member->positions.col(where->column));
    const char* shape = nullptr;
    switch (node.support.kind) {
      case model::Support::Kind::pinned:
        shape = "M{0:.1f} {1:.1f}l6 10h-12z";
        break;
      case model::Support::Kind::clamped:
        shape = "M{0:.1f} {1:.1f}m-5 -5h10v10h-10z";
        break;
      case model::Support::Kind::elastic:
        shape = "M{0:.1f} {1:.1f}v3l-5 2l10 3l-10 3l10 3l-5 2";
        break;
      case model::Support::Kind::free:
        break;
    }
    if (!shape) continue;
    const bool filled = node.support.kind != model::Support::Kind::elastic;
    svg += fmt::format(
        "<path class=\"{}\" d=\"{}\" fill=\"{}\" stroke=\"#222\"><title>{}</title></path>\n",
        filled ? "support" : "frame", fmt::format(fmt::runtime(shape), p[0], p[1]),
        filled ? "#222" : "none", escaped(node.name));
  }
  return svg;
}

/// Points between two nodes where the motion changes sign, on the member at rest.
std::string nodal_points(const View& view, const Eigen::Matrix3Xd& rest,
                         const Eigen::Matrix3Xd& moved, double largest) {
  Index direction = 0;
  moved.cwiseAbs().rowwise().maxCoeff().maxCoeff(&direction);
  std::string svg;
  for (Index i = 1; i + 1 < moved.cols(); ++i) {
    const double a = moved(direction, i), b = moved(direction, i + 1);
    if (!(a * b < 0) || std::max(std::abs(a), std::abs(b)) < 1e-3 * largest) continue;
    const Vector3d at = rest.col(i) + a / (a - b) * (rest.col(i + 1) - rest.col(i));
    const auto p = view.at(at);
    svg += fmt::format(
        "<circle class=\"frame node\" cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"2.6\" fill=\"#fff\" "
        "stroke=\"#555\"/>\n",
        p[0], p[1]);
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

/// Factor that lays a measured shape over the model's: least squares, in the complex plane.
std::complex<double> fitted_factor(const Eigen::VectorXcd& measured, const Eigen::VectorXd& model) {
  const double size = measured.squaredNorm();
  if (!(size > 0)) return 0;
  return measured.dot(model.cast<std::complex<double>>()) / size;
}

std::string mode_panel(const View& view, const model::Scene& scene,
                       const model::ModalAnalysis& analysis, std::size_t index,
                       const MeasuredShape* measured) {
  const auto& mode = analysis.modes[index];
  const auto& equilibrium = analysis.equilibrium;
  const double largest = largest_of(mode), factor = view.amplitude() / largest;
  std::string svg;
  for (std::size_t m = 0; m < mode.shape.size(); ++m) {
    const auto& rest = equilibrium.members[m].positions;
    const auto& moved = mode.shape[m].displacement;
    if (moved.cols() != rest.cols()) continue;
    svg += fmt::format(
        "<path class=\"rest\" d=\"{}\" fill=\"none\" stroke=\"#888\" stroke-dasharray=\"3 3\"/>\n"
        "<g class=\"s0\" stroke=\"{}\"><path class=\"line\" d=\"{}\" fill=\"none\" "
        "stroke-width=\"2.6\" "
        "stroke-linejoin=\"round\"/></g>\n",
        path_of(view, rest), series_colour(0), path_of(view, rest + factor * moved));
    svg += nodal_points(view, rest, moved, largest);
  }
  svg += supports(view, scene, equilibrium);
  const bool shaped = measured &&
                      measured->shape.size() == static_cast<Index>(scene.sensors.size()) &&
                      mode.sensor_shape.size() == measured->shape.size();
  const std::complex<double> fit =
      shaped ? fitted_factor(measured->shape, mode.sensor_shape) : std::complex<double>(0);
  for (std::size_t s = 0; s < scene.sensors.size(); ++s) {
    const auto where = hung(scene, equilibrium, scene.sensors[s].place);
    if (!where) continue;
    const Vector3d rest = where->member->positions.col(where->column);
    const auto p = view.at(rest);
    svg += fmt::format(
        "<rect class=\"frame sensor\" x=\"{:.1f}\" y=\"{:.1f}\" width=\"6\" height=\"6\" "
        "fill=\"#fff\" "
        "stroke=\"#222\"><title>{}</title></rect>\n",
        p[0] - 3, p[1] - 3, escaped(scene.sensors[s].name));
    if (!shaped) continue;
    const double value = (fit * measured->shape[static_cast<Index>(s)]).real();
    const auto q = view.at(rest + factor * value * scene.sensors[s].direction);
    svg += fmt::format(
        "<g class=\"s1\" fill=\"{4}\" stroke=\"{4}\"><path class=\"line\" d=\"M{0:.1f} "
        "{1:.1f}L{2:.1f} "
        "{3:.1f}\" fill=\"none\"/><circle cx=\"{2:.1f}\" cy=\"{3:.1f}\" r=\"4.5\"/></g>\n",
        p[0], p[1], q[0], q[1], series_colour(1));
  }
  const auto text = [&](double y, const std::string& words, const std::string& css,
                        const char* more) {
    svg += fmt::format("<text class=\"{}\" x=\"12\" y=\"{:g}\"{}>{}</text>\n", css, y, more,
                       escaped(words));
  };
  text(14,
       fmt::format("{}  {} Hz, {}, {}", index + 1, shown(mode.frequency_hz, 5), name_of(mode.plane),
                   name_of(mode.family)),
       "t", " fill=\"#222\" font-weight=\"bold\"");
  if (measured) {
    text(
        30,
        fmt::format("{} {} Hz{}", name_of(measured->origin), shown(measured->frequency_hz, 5),
                    std::isfinite(measured->mac) ? fmt::format(", MAC {:.3f}", measured->mac) : ""),
        "t", " fill=\"#222\"");
  }
  return svg;
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

std::vector<Picture> shapes_pictures(const std::string& id, const std::string& state,
                                     const model::Scene& scene,
                                     const model::ModalAnalysis& analysis,
                                     const std::vector<MeasuredShape>& measured, std::size_t most) {
  // Modes and columns in a picture: a quarter of a page on paper.
  constexpr std::size_t kModes = 6, kColumns = 2;
  std::vector<std::size_t> drawn;
  for (std::size_t i = 0; i < analysis.modes.size() && drawn.size() < most; ++i) {
    if (largest_of(analysis.modes[i]) > 0) drawn.push_back(i);
  }
  std::vector<Picture> pictures;
  if (analysis.equilibrium.members.empty()) return pictures;
  const View view(analysis.equilibrium);
  for (std::size_t from = 0; from < drawn.size(); from += kModes) {
    const std::size_t count = std::min(kModes, drawn.size() - from);
    Picture picture;
    picture.id = from == 0 ? id : fmt::format("{}-{}", id, from / kModes + 1);
    picture.title = measured.empty() ? "Mode shapes" : "Mode shapes, test over model";
    if (!state.empty()) picture.title += ": " + state;
    if (drawn.size() > kModes) {
      picture.title += fmt::format(", {} to {}", drawn[from] + 1, drawn[from + count - 1] + 1);
    }
    if (from > 0) {
      picture.caption = pictures.front().caption;
    } else {
      picture.caption =
          "Line: the model, enlarged; broken: at rest. Triangles: pinned, filled squares: clamped, "
          "open squares: sensors, open circles: nodes of the shape.";
      if (!measured.empty()) picture.caption += " Points: measured, scaled to the model.";
      if (drawn.size() < analysis.modes.size()) {
        picture.caption +=
            fmt::format(" The first {} of {} modes.", drawn.size(), analysis.modes.size());
      }
    }
    picture.csv = "mode,frequency_hz,member,x_m,y_m,z_m,dx,dy,dz\n";
    std::string body;
    for (std::size_t k = 0; k < count; ++k) {
      const std::size_t mode = drawn[from + k];
      const auto at = std::find_if(measured.begin(), measured.end(),
                                   [&](const MeasuredShape& one) { return one.mode == mode; });
      body += fmt::format(
          "<g transform=\"translate({:g} {:g})\">\n{}</g>\n",
          kPanelWidth * static_cast<double>(k % kColumns),
          kPanelHeight * static_cast<double>(k / kColumns),
          mode_panel(view, scene, analysis, mode, at == measured.end() ? nullptr : &*at));
      add_csv(picture.csv, analysis, mode);
    }
    picture.width = kPanelWidth * static_cast<double>(std::min(kColumns, count));
    picture.height = kPanelHeight * static_cast<double>((count + kColumns - 1) / kColumns);
    picture.svg = fmt::format(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {0:g} {1:g}\" width=\"{0:g}\" "
        "height=\"{1:g}\" role=\"img\" font-family=\"sans-serif\" "
        "font-size=\"14\">\n<title>{2}</title>\n"
        "<desc>{3}</desc>\n{4}</svg>\n",
        picture.width, picture.height, escaped(picture.title), escaped(picture.caption), body);
    pictures.push_back(std::move(picture));
  }
  return pictures;
}

Plot mode_frequencies_plot(const std::string& id, const model::ModalAnalysis& analysis) {
  Plot plot;
  plot.id = id;
  plot.title = "Natural frequencies";
  plot.caption = "By mode number, a series for each plane.";
  plot.x_label = "mode";
  plot.y_label = "frequency, Hz";
  for (std::size_t i = 0; i < analysis.modes.size(); ++i) {
    const auto& mode = analysis.modes[i];
    const std::string name = name_of(mode.plane);
    auto at = std::find_if(plot.series.begin(), plot.series.end(),
                           [&](const PlotSeries& series) { return series.name == name; });
    if (at == plot.series.end()) {
      PlotSeries series;
      series.name = name;
      series.origin = Origin::modelled;
      series.style = PlotSeries::Style::points;
      series.variant = static_cast<int>(plot.series.size());
      plot.series.push_back(std::move(series));
      at = plot.series.end() - 1;
    }
    at->x.push_back(static_cast<double>(i + 1));
    at->y.push_back(mode.frequency_hz);
  }
  return plot;
}

std::vector<Plot> response_plots(const std::string& id, const model::Scene& scene,
                                 const model::ResponseResult& response) {
  std::vector<Plot> plots, spectra;
  for (Index s = 0; s < response.samples.cols(); ++s) {
    const auto k = static_cast<std::size_t>(s);
    const std::string unit = unit_words(model::described(scene.sensors[k].quantity).unit);
    Plot plot;
    plot.id = fmt::format("{}-{}", id, s + 1);
    plot.title = "Response: " + response.sensors[k];
    plot.caption =
        response.nonlinear ? "Computed with its large motion." : "Linear about the equilibrium.";
    plot.x_label = "time, s";
    plot.y_label = fmt::format("{}, {}", model::described(scene.sensors[k].quantity).name, unit);
    plot.link = id;
    PlotSeries series;
    series.name = response.sensors[k];
    series.origin = Origin::modelled;
    add_samples(series, response.samples.col(s), 0, response.rate_hz);
    plot.series.push_back(std::move(series));
    plots.push_back(std::move(plot));
    auto same = std::find_if(spectra.begin(), spectra.end(),
                             [&](const Plot& one) { return one.y_label == "amplitude, " + unit; });
    if (same == spectra.end()) {
      Plot spectrum;
      spectrum.id = fmt::format("{}-spectrum-{}", id, spectra.size() + 1);
      spectrum.title = "Spectra";
      spectrum.caption = "Amplitudes by frequency over the whole time, Hann window.";
      spectrum.x_label = "frequency, Hz";
      spectrum.y_label = "amplitude, " + unit;
      spectrum.log_y = true;
      spectra.push_back(std::move(spectrum));
      same = spectra.end() - 1;
    }
    PlotSeries lines;
    lines.name = response.sensors[k];
    lines.origin = Origin::modelled;
    lines.variant = static_cast<int>(same->series.size());
    same->series.push_back(
        amplitude_spectrum(response.samples.col(s), response.rate_hz, 0, std::move(lines)));
  }
  std::move(spectra.begin(), spectra.end(), std::back_inserter(plots));
  return plots;
}

}  // namespace rigfit::apps
