#include "apps/report/figures/figures.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <iterator>
#include <limits>
#include <numbers>

#include "apps/report/drawing/html_text.h"
#include "apps/report/drawing/palette.h"
#include "model/scene/sensor_quantity.h"
#include "signal/spectra/fft.h"

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

/// The extremes of stretches of samples, in the order in which they come, at most about 6000; gaps
/// stay gaps.
template <class Time>
void add_extremes(PlotSeries& series, const Eigen::Ref<const Eigen::VectorXd>& samples, Time time) {
  constexpr Index kMost = 6000;
  const Index count = samples.size(),
              stretch = count <= kMost ? 1 : (2 * count + kMost - 1) / kMost;
  for (Index first = 0; first < count; first += stretch) {
    Index low = -1, high = -1;
    bool gap = false;
    for (Index i = first; i < std::min(count, first + stretch); ++i) {
      if (!std::isfinite(samples[i])) {
        gap = true;
        continue;
      }
      if (low < 0 || samples[i] < samples[low]) low = i;
      if (high < 0 || samples[i] > samples[high]) high = i;
    }
    if (low > high) std::swap(low, high);
    if (low >= 0) series.add(time(low), samples[low]);
    if (low != high) series.add(time(high), samples[high]);
    if (gap) series.add(time(first), std::numeric_limits<double>::quiet_NaN());
  }
}

PlotSeries amplitude_spectrum(const Eigen::Ref<const Eigen::VectorXd>& samples, double rate_hz,
                              double high_hz, PlotSeries series) {
  const Index n = samples.size();
  Eigen::VectorXd windowed(n);
  const double mean = samples.mean();
  for (Index i = 0; i < n; ++i) {  // Hann
    const double phase = 2 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(n);
    windowed[i] = (0.5 - 0.5 * std::cos(phase)) * (samples[i] - mean);
  }
  const Index length = signal::good_fft_length(n);
  const Eigen::VectorXcd lines = signal::real_spectra(windowed, length).col(0);
  const Eigen::VectorXd frequency = signal::line_frequencies(length, rate_hz);
  for (Index k = 1; k < lines.size() && (high_hz <= 0 || frequency[k] <= high_hz); ++k) {
    series.add(frequency[k], 4 * std::abs(lines[k]) / static_cast<double>(n));
  }
  return series;
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

std::vector<Block> modes_blocks(const std::string& id, const model::Scene& scene,
                                const model::ModalAnalysis& analysis) {
  std::vector<Block> blocks;
  if (analysis.modes.empty()) return blocks;
  for (auto& one : shapes_pictures(id, "", scene, analysis)) blocks.emplace_back(std::move(one));
  Plot plot{"frequencies", "Natural frequencies", "By mode number, a series for each plane.",
            "mode", "frequency, Hz"};
  for (std::size_t i = 0; i < analysis.modes.size(); ++i) {
    const auto& mode = analysis.modes[i];
    const std::string name = name_of(mode.plane);
    auto at = std::find_if(plot.series.begin(), plot.series.end(),
                           [&](const PlotSeries& series) { return series.name == name; });
    if (at == plot.series.end()) {
      plot.series.push_back({name, Origin::modelled, static_cast<int>(plot.series.size()),
                             PlotSeries::Style::points});
      at = plot.series.end() - 1;
    }
    at->add(static_cast<double>(i + 1), mode.frequency_hz);
  }
  blocks.emplace_back(std::move(plot));
  return blocks;
}

std::vector<Plot> response_plots(const std::string& id, const model::Scene& scene,
                                 const model::ResponseResult& response) {
  std::vector<Plot> plots, spectra;
  for (Index s = 0; s < response.samples.cols(); ++s) {
    const auto k = static_cast<std::size_t>(s);
    const auto& quantity = model::described(scene.sensors[k].quantity);
    const std::string unit = unit_words(quantity.unit);
    Plot plot{
        fmt::format("{}-{}", id, s + 1), "Response: " + response.sensors[k],
        response.nonlinear ? "Computed with its large motion." : "Linear about the equilibrium.",
        "time, s", fmt::format("{}, {}", quantity.name, unit)};
    plot.link = id;
    PlotSeries series{response.sensors[k]};
    add_extremes(series, response.samples.col(s),
                 [&](Index i) { return static_cast<double>(i) / response.rate_hz; });
    plot.add(std::move(series));
    plots.push_back(std::move(plot));
    auto same = std::find_if(spectra.begin(), spectra.end(),
                             [&](const Plot& one) { return one.y_label == "amplitude, " + unit; });
    if (same == spectra.end()) {
      spectra.push_back({fmt::format("{}-spectrum-{}", id, spectra.size() + 1), "Spectra",
                         "Amplitudes by frequency over the whole time, Hann window.",
                         "frequency, Hz", "amplitude, " + unit, false, true});
      same = spectra.end() - 1;
    }
    same->series.push_back(amplitude_spectrum(
        response.samples.col(s), response.rate_hz, 0,
        {response.sensors[k], Origin::modelled, static_cast<int>(same->series.size())}));
  }
  std::move(spectra.begin(), spectra.end(), std::back_inserter(plots));
  return plots;
}

std::vector<Plot> release_plots(const std::string& id, const AnalysedDecay& decay,
                                const std::vector<ident::ReleaseAnswer>& answers, double high_hz) {
  constexpr double kBefore_s = 0.02, kFirst_s = 0.5;
  const bool large = std::any_of(answers.begin(), answers.end(),
                                 [](const auto& answer) { return answer.response.nonlinear; });
  const std::string unit = unit_words(decay.unit);
  Plot plot{id + "-model", "First half second, test and model",
            fmt::format("The record and the model's response to the same release or tap, {}; only "
                        "the model's time was shifted, to where both agree best. Nothing was "
                        "fitted to this record.",
                        large ? "computed with its large motion" : "linear"),
            "time, s", fmt::format("{}, {}", decay.channel, unit)};
  Plot spectra{id + "-spectrum",
               "Spectra, test and model",
               "Amplitudes by frequency of both, over the same time after the start.",
               "frequency, Hz",
               "amplitude, " + unit,
               false,
               true};
  const Eigen::VectorXd record = ident::filled(decay.samples);
  Index first = -1, common = 0;
  const auto add = [&](PlotSeries series, const auto& samples, Index start) {
    const double t0 = static_cast<double>(first) / decay.rate_hz;
    for (Index i = 0; i < samples.size() && start + i < record.size(); ++i) {
      const double t = static_cast<double>(start + i) / decay.rate_hz;
      if (t >= t0 - kBefore_s && t <= t0 + kFirst_s) series.add(decay.start_s + t, samples[i]);
    }
    plot.add(std::move(series));
  };
  const PlotSeries test{"test", decay.origin};
  for (std::size_t k = 0; k < answers.size(); ++k) {
    const auto& answer = answers[k];
    if (!answer.failure.empty()) continue;
    // The last stands for the report, those before it are broken lines.
    const PlotSeries series{
        "rigfit model, " + answer.label, Origin::modelled, static_cast<int>(answers.size() - k),
        k + 1 < answers.size() ? PlotSeries::Style::dashed : PlotSeries::Style::line};
    const auto model = answer.response.samples.col(0);
    const Index length = std::min(record.size() - answer.start, model.size());
    if (first < 0) {
      first = answer.start, common = length;
      add(test, decay.samples, 0);
      spectra.add(amplitude_spectrum(record.segment(first, common), decay.rate_hz, high_hz, test));
    }
    add(series, model, answer.start);
    spectra.add(
        amplitude_spectrum(model.head(std::min(common, length)), decay.rate_hz, high_hz, series));
  }
  if (first < 0) return {};
  return {std::move(plot), std::move(spectra)};
}

std::vector<Plot> recording_plots(const std::string& id, const signal::Recording& recording,
                                  const signal::QualityResult& quality) {
  constexpr std::size_t kMostClipped = 1000;  // points drawn of clipped samples
  std::vector<Plot> plots;
  const bool over_time =
      (recording.sample_rate_hz > 0 || recording.time_s.size() > 0) &&
      std::none_of(recording.notes.begin(), recording.notes.end(),
                   [](const auto& note) { return note.code == "not_a_time_history"; });
  if (!over_time) return plots;
  const auto time = [&](Index i) {
    return recording.time_s.size() > 0
               ? recording.time_s[i]
               : recording.start_time_s + static_cast<double>(i) / recording.sample_rate_hz;
  };
  for (std::size_t k = 0; k < recording.channels.size(); ++k) {
    const auto& channel = recording.channels[k];
    const auto& found = quality.channels[k];
    Plot plot{fmt::format("{}-{}", id, k + 1),
              fmt::format("{}: {}", short_name(recording.path.string()), channel.name),
              found.findings.empty() ? "Nothing was found wrong with this channel." : "Found:",
              "time, s", fmt::format("{}, {}", channel.name, unit_words(channel.unit))};
    plot.link = id;
    PlotSeries record{"record", Origin::measured};
    add_extremes(record, channel.samples, time);
    plot.add(std::move(record));
    PlotSeries clipped{fmt::format("clipped ({} samples)", found.clipped_samples), Origin::modelled,
                       1, PlotSeries::Style::points};
    for (Index i = 0; found.clipped_samples > 0 && i < channel.samples.size(); ++i) {
      const double y = channel.samples[i];
      const bool at_end = y == found.max || y == found.min;
      if (at_end && clipped.x.size() < kMostClipped) clipped.add(time(i), y);
    }
    plot.add(std::move(clipped));
    for (const auto& finding : found.findings) {
      plot.caption += fmt::format(" {}: {}.", finding.code, finding.message);
      if (finding.first < 0 || finding.first >= channel.samples.size()) continue;
      std::string word = finding.code;
      std::replace(word.begin(), word.end(), '_', ' ');
      plot.marks.push_back({time(finding.first), word, Origin::modelled, true});
    }
    std::sort(plot.marks.begin(), plot.marks.end(),
              [](const PlotMark& a, const PlotMark& b) { return a.x < b.x; });
    plots.push_back(std::move(plot));
  }
  return plots;
}

}  // namespace rigfit::apps
