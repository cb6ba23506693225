#include "ident/bending/table_line.h"

#include "signal/estimation/robust.h"

namespace rigfit::ident {
namespace {

// Robust standard deviations from which a sample is no part of its average: of normal noise none in
// a million, and a tenth of that in rows of five, whose medians follow them.
constexpr double kOffRow = 8;

}  // namespace

double sample_noise(const VectorXd& x) {
  if (x.size() < 20) return 0;
  std::vector<double> seconds;
  double squares = 0;
  for (Index i = 1; i + 1 < x.size(); ++i) {
    seconds.push_back(std::abs(x[i - 1] - 2 * x[i] + x[i + 1]));
    squares += seconds.back() * seconds.back();
  }
  const double robust = signal::robust_std(seconds, 0) / std::sqrt(6.0);
  // A coarse converter repeats its value more often than not.
  return robust > 0 ? robust : std::sqrt(squares / static_cast<double>(seconds.size()) / 6);
}

double read_step(const VectorXd& values, bool read) {
  // Euclid's algorithm, to what units round.
  const double least = 1e-9 * values.cwiseAbs().maxCoeff();
  double step = 0;
  for (double rest : values) {
    while (std::abs(rest) > least) step = std::exchange(rest, std::remainder(step, rest));
  }
  step = std::abs(step);
  std::vector<double> changes;
  for (Index i = 1; i < values.size(); ++i) {
    if (values[i] != values[i - 1]) changes.push_back(std::abs(values[i] - values[i - 1]));
  }
  if (signal::quantile(changes, 0.25) > 1.5 * step) return step;
  if (!read || !(step > 0)) return 0;
  for (double ten = std::pow(10, std::ceil(std::log10(step)));; ten /= 10) {
    for (const double dial : {5 * ten, 2 * ten, ten}) {
      if (std::abs(std::remainder(step, dial)) < 1e-6 * step) return dial;
    }
  }
}

std::vector<Index> find_spikes(const VectorXd& x) {
  std::vector<Index> spikes;
  const Index n = x.size();
  if (n < 20) return spikes;
  std::vector<double> off(static_cast<std::size_t>(n));
  for (Index i = 0; i < n; ++i) {
    double least = std::numeric_limits<double>::infinity();
    if (i >= 2) least = std::min(least, std::abs(x[i] - 2 * x[i - 1] + x[i - 2]));
    if (i + 2 < n) least = std::min(least, std::abs(x[i] - 2 * x[i + 1] + x[i + 2]));
    if (i >= 1 && i + 1 < n) least = std::min(least, std::abs(x[i] - 0.5 * (x[i - 1] + x[i + 1])));
    off[static_cast<std::size_t>(i)] = least;
  }
  const double scale = signal::robust_std(off, 0);
  const std::vector<double> values(x.begin(), x.end());
  const double central = signal::quantile(values, 0.9) - signal::quantile(values, 0.1);
  const double limit = std::max(12 * scale, 0.05 * central);
  for (Index i = 0; i < n; ++i) {
    const bool end = i == 0 || i == n - 1;
    if (!(off[static_cast<std::size_t>(i)] > (end ? std::max(limit, central) : limit))) continue;
    // A spike has one or two samples; what falls over more is on its way between two strokes.
    const double before = x[std::max<Index>(i - 2, 0)];
    const double behind = x[std::min(i + 2, n - 1)];
    if (end || (x[i] - before) * (x[i] - behind) > 0) spikes.push_back(i);
  }
  return spikes;
}

std::vector<StrokeRange> find_strokes(const VectorXd& d, double least) {
  std::vector<StrokeRange> runs;
  Index start = 0, extreme = 0;
  int direction = 0;
  for (Index i = 1; i < d.size(); ++i) {
    if (direction == 0) {
      if (std::abs(d[i] - d[start]) >= least) {
        direction = d[i] > d[start] ? 1 : -1;
        // The stroke begins at the last sample before it left.
        for (Index k = start; k <= i; ++k) {
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

TableStroke rows_of(const StrokeRange& run, const VectorXd& x, const VectorXd& load,
                    bool averaged) {
  const Index samples = run.last - run.first + 1;
  const Index n = averaged ? std::min(samples, kShortStroke) : samples;
  TableStroke stroke{run.direction > 0, VectorXd(n), VectorXd(n), {}, {}};
  const auto u = x.segment(run.first, samples), v = load.segment(run.first, samples);
  // Distance of each sample from the median of its row, along the stroke's mean slope.
  std::vector<double> off;
  const double slope = (v[samples - 1] - v[0]) / (u[samples - 1] - u[0]);
  for (Index k = 0; averaged && k < n; ++k) {
    const Index from = k * samples / n, count = (k + 1) * samples / n - from;
    const VectorXd rest = v.segment(from, count) - slope * u.segment(from, count);
    const double middle = signal::median({rest.begin(), rest.end()});
    for (const double r : rest) off.push_back(std::abs(r - middle));
  }
  const double most = averaged ? kOffRow * signal::robust_std(off, 0) : 0;
  Index rows = 0;
  int off_here = 0;
  for (Index k = 0; k < n; ++k) {
    const Index from = k * samples / n, to = (k + 1) * samples / n;
    double count = 0, x_sum = 0, load_sum = 0;
    for (Index i = from; i < to; ++i) {
      if (most > 0 && off[static_cast<std::size_t>(i)] > most) continue;
      x_sum += u[i], load_sum += v[i], ++count;
    }
    off_here += static_cast<int>(static_cast<double>(to - from) - count);
    if (count == 0) continue;  // of two samples far apart neither is known to be right
    stroke.off.push_back(std::exchange(off_here, 0));
    stroke.x_m[rows] = x_sum / count, stroke.load_N[rows] = load_sum / count;
    ++rows;
  }
  stroke.x_m.conservativeResize(rows), stroke.load_N.conservativeResize(rows);
  stroke.used.assign(static_cast<std::size_t>(rows), 1);
  return stroke;
}

bool leave_ends_out(TableStroke& stroke, double turn, double limit, StraightPart& part) {
  constexpr double kLeastLoad = 0.25;  // share of the stroke's load
  const Index n = stroke.x_m.size();
  ArrayXd x = stroke.x_m, y = stroke.load_N;
  const double travel = std::abs(x[n - 1] - x[0]), load = y.maxCoeff() - y.minCoeff();
  Index from = 0, to = n - 1;
  for (Index i = 0; i < n && std::abs(x[i] - x[0]) < turn * travel; ++i) {
    stroke.loading ? ++from : --to;
  }
  if (!stroke.loading) x = x.reverse().eval(), y = y.reverse().eval();
  const auto straight = [&](Index i, Index j) {
    ArrayXd u = x.segment(i, j - i + 1), v = y.segment(i, j - i + 1);
    u -= u.mean(), v -= v.mean();
    return (v - (u * v).sum() / u.square().sum() * u).abs().maxCoeff() <= limit;
  };
  Index first = 0, last = -1;
  double most = kLeastLoad * load;
  for (Index i = from; i + 3 <= to && (last < 0 || i <= (first + last) / 2); ++i) {
    for (Index j = to; j >= i + 3; --j) {
      if (!(y[j] - y[i] > most) || !straight(i, j)) continue;
      first = i, last = j, most = y[j] - y[i];
      break;
    }
  }
  if (last < 0) return false;
  // An average over a break holds some of both sides.
  if (first > from && last - first > 4) ++first;
  if (last < to && last - first > 4) --last;
  part = {(x[first] - x[from]) / travel, (x[to] - x[last]) / travel,
          std::max((x[last] - x[first]) / travel, (y[last] - y[first]) / load)};
  if (!stroke.loading) std::swap(part.at_turn, part.at_end);
  for (Index i = 0; i < n; ++i) {
    if (i >= first && i <= last) continue;
    stroke.used[static_cast<std::size_t>(stroke.loading ? i : n - 1 - i)] = 0;
  }
  return true;
}

}  // namespace rigfit::ident
