#include "ident/bending/bending_strokes.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "ident/bending/deming_line.h"
#include "signal/estimation/robust.h"

namespace rigfit::ident {
namespace {

DemingLine line_through(const StrokeData& data, Eigen::Index first, Eigen::Index last,
                        bool uncertainty) {
  const Eigen::Index n = last - first + 1;
  return fit_deming_line(data.x.segment(first, n), data.load.segment(first, n),
                         data.deflection_noise, data.load_noise, uncertainty);
}

}  // namespace

double sample_noise(const Eigen::VectorXd& x) {
  if (x.size() < 20) return 0;
  std::vector<double> seconds;
  double squares = 0;
  for (Eigen::Index i = 1; i + 1 < x.size(); ++i) {
    seconds.push_back(std::abs(x[i - 1] - 2 * x[i] + x[i + 1]));
    squares += seconds.back() * seconds.back();
  }
  const double robust = 1.4826 * signal::median(seconds) / std::sqrt(6.0);
  // A coarse converter repeats its value more often than not.
  return robust > 0 ? robust : std::sqrt(squares / static_cast<double>(seconds.size()) / 6);
}

double central_range(const std::vector<double>& values) {
  return signal::quantile(values, 0.9) - signal::quantile(values, 0.1);
}

std::vector<Eigen::Index> find_spikes(const Eigen::VectorXd& x) {
  std::vector<Eigen::Index> spikes;
  const Eigen::Index n = x.size();
  if (n < 20) return spikes;
  std::vector<double> off(static_cast<std::size_t>(n));
  for (Eigen::Index i = 0; i < n; ++i) {
    double least = std::numeric_limits<double>::infinity();
    if (i >= 2) least = std::min(least, std::abs(x[i] - 2 * x[i - 1] + x[i - 2]));
    if (i + 2 < n) least = std::min(least, std::abs(x[i] - 2 * x[i + 1] + x[i + 2]));
    if (i >= 1 && i + 1 < n) least = std::min(least, std::abs(x[i] - 0.5 * (x[i - 1] + x[i + 1])));
    off[static_cast<std::size_t>(i)] = least;
  }
  const double scale = 1.4826 * signal::median(off);
  const double limit = std::max(12 * scale, 0.05 * central_range({x.begin(), x.end()}));
  for (Eigen::Index i = 0; i < n; ++i) {
    if (off[static_cast<std::size_t>(i)] > limit) spikes.push_back(i);
  }
  return spikes;
}

std::vector<StrokeRange> find_strokes(const Eigen::VectorXd& d, double least) {
  std::vector<StrokeRange> runs;
  Eigen::Index start = 0, extreme = 0;
  int direction = 0;
  for (Eigen::Index i = 1; i < d.size(); ++i) {
    if (direction == 0) {
      if (std::abs(d[i] - d[start]) >= least) {
        direction = d[i] > d[start] ? 1 : -1;
        // The stroke begins at the last sample before it left.
        for (Eigen::Index k = start; k <= i; ++k) {
          if (direction * (d[k] - d[start]) <= 0) start = k;
        }
        extreme = i;
      }
      continue;
    }
    if (direction * (d[i] - d[extreme]) > 0) extreme = i;
    if (direction * (d[extreme] - d[i]) >= least) {
      runs.push_back({start, extreme, direction});
      start = extreme;
      extreme = i;
      direction = -direction;
    }
  }
  if (direction != 0) runs.push_back({start, extreme, direction});
  return runs;
}

BendingStroke fit_straight_part(const StrokeRange& run, const StrokeData& data, double turn_share,
                                double& degrees_of_freedom) {
  const Eigen::VectorXd &x = data.x, &d = data.deflection;
  BendingStroke stroke;
  stroke.loading = run.direction > 0;
  stroke.first = run.first;
  stroke.last = run.last;
  const Eigen::Index samples = run.last - run.first + 1;
  const double start = d[run.first], travel = d[run.last] - start;
  const auto share = [&](Eigen::Index i) { return (d[i] - start) / travel; };
  Eigen::Index earliest = run.first;
  if (samples >= 20) {
    while (share(earliest) < turn_share) ++earliest;
  }
  // Toe lies at the bottom, stop and friction's turn at the top of the loading stroke.
  const double from = stroke.loading ? 0.35 : 0.15, to = stroke.loading ? 0.85 : 0.65;
  Eigen::Index first = earliest, last = run.last;
  const Eigen::Index least = std::min<Eigen::Index>(4, last - first + 1);
  while (first + least <= last && share(first) < from) ++first;
  while (last - least >= first && share(last) > to) --last;
  DemingLine line = line_through(data, first, last, false);

  // Where a local median over a twentieth of the stroke leaves the line: wild samples, as long as
  // they are not most of them, move it by no more than the noise does. On a grid fine enough to see
  // where that begins, so that long records cost no more than short ones a sample.
  const Eigen::Index half = samples / 40, grid = std::max<Eigen::Index>(1, half / 8);
  // A median of noise scatters sqrt(pi / 2) times as much as its mean.
  const double averaged = std::sqrt(static_cast<double>(2 * half + 1) / 1.5708);
  std::vector<double> residuals(static_cast<std::size_t>(samples)), window;
  std::vector<char> known(static_cast<std::size_t>(samples / grid + 1));
  for (int pass = 0; pass < 4 && line.usable; ++pass) {
    const double noise = std::hypot(data.load_noise, line.slope * data.deflection_noise);
    const double limit = std::max(kStraight * data.load_range, 4 * noise / averaged);
    for (Eigen::Index k = 0; k < samples; ++k) {
      residuals[static_cast<std::size_t>(k)] =
          data.load[run.first + k] - line.offset - line.slope * x[run.first + k];
    }
    std::fill(known.begin(), known.end(), 'n');
    const auto off = [&](Eigen::Index i) {
      const Eigen::Index cell = (i - run.first) / grid;
      char& answer = known[static_cast<std::size_t>(cell)];
      if (answer == 'n') {
        const Eigen::Index centre = std::min(cell * grid + grid / 2, samples - 1);
        const Eigen::Index low = std::max<Eigen::Index>(0, centre - half);
        const Eigen::Index high = std::min(samples, centre + half + 1);
        window.assign(residuals.begin() + low, residuals.begin() + high);
        answer = std::abs(signal::median(window)) > limit ? 'y' : 'o';
      }
      return answer == 'y';
    };
    Eigen::Index new_first = first, new_last = last;
    while (new_first > earliest && !off(new_first - 1)) --new_first;
    while (new_first + least < new_last && off(new_first)) ++new_first;
    while (new_last < run.last && !off(new_last + 1)) ++new_last;
    while (new_last - least > new_first && off(new_last)) --new_last;
    if (new_first == first && new_last == last) break;
    first = new_first;
    last = new_last;
    line = line_through(data, first, last, false);
  }
  line = line_through(data, first, last, true);
  stroke.used_first = first;
  stroke.used_last = last;
  stroke.stiffness_N_m = {line.usable ? line.slope : std::numeric_limits<double>::quiet_NaN(),
                          line.usable ? line.slope_std : std::numeric_limits<double>::quiet_NaN()};
  stroke.offset_N = line.offset;
  stroke.residual_rms_N = line.residual_rms;
  stroke.curvature = line.curvature;
  stroke.curvature_std = line.curvature_std;
  degrees_of_freedom = line.degrees_of_freedom;
  return stroke;
}

}  // namespace rigfit::ident
