#include "ident/bending/friction_transient.h"

#include <gsl/gsl_errno.h>
#include <gsl/gsl_min.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <memory>

#include "signal/estimation/robust.h"

namespace rigfit::ident {
namespace {

constexpr Eigen::Index kBins = 150;   // bins in a stroke
constexpr Eigen::Index kBlocks = 12;  // blocks of a stroke's bins, to tell drift from white noise
constexpr double kHuber = 1.345;

struct Binned {
  double sign = 1;
  Eigen::ArrayXd s, x, y, w;
  Eigen::Index each = 1;  // samples in a bin
};

Binned binned(const FrictionStroke& stroke) {
  Binned b;
  b.sign = stroke.sign;
  const Eigen::Index n = stroke.load_N.size();
  b.each = std::max<Eigen::Index>(1, n / kBins);
  const Eigen::Index bins = n / b.each;
  b.s.resize(bins), b.x.resize(bins), b.y.resize(bins);
  for (Eigen::Index k = 0; k < bins; ++k) {
    b.s[k] = stroke.travel_m.segment(k * b.each, b.each).mean();
    b.x[k] = stroke.x_m.segment(k * b.each, b.each).mean();
    b.y[k] = stroke.load_N.segment(k * b.each, b.each).mean();
  }
  b.w = Eigen::ArrayXd::Ones(bins);
  return b;
}

// Least squares of one stroke in [1, x, -sign u]; columns scaled by what x and y span.
struct Line {
  Eigen::Vector3d p = Eigen::Vector3d::Zero();  // c, K, a
  Eigen::Matrix3d inverse = Eigen::Matrix3d::Zero();
  Eigen::ArrayXd u, residual;
  bool transient = false;
  bool usable = false;
};

bool solve(const Binned& b, int columns, Line& line) {
  const double centre = (b.w * b.x).sum() / b.w.sum();
  const double range = b.x.maxCoeff() - b.x.minCoeff();
  if (!(range > 0)) return false;
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  for (Eigen::Index k = 0; k < b.y.size(); ++k) {
    const Eigen::Vector3d row(1, (b.x[k] - centre) / range, columns == 3 ? -b.sign * line.u[k] : 0);
    normal.noalias() += b.w[k] * row * row.transpose();
    right += b.w[k] * b.y[k] * row;
  }
  if (columns == 2) normal(2, 2) = 1;
  const Eigen::LLT<Eigen::Matrix3d> factor(normal);
  if (factor.info() != Eigen::Success || !(factor.rcond() > 1e-10)) return false;
  // In c, K, a: c = c' - K' centre / range, K = K' / range.
  Eigen::Matrix3d back = Eigen::Matrix3d::Identity();
  back(0, 1) = -centre / range;
  back(1, 1) = 1 / range;
  line.p = back * factor.solve(right);
  line.inverse = back * factor.solve(Eigen::Matrix3d::Identity()) * back.transpose();
  line.transient = columns == 3;
  line.residual = b.y - line.p[0] - line.p[1] * b.x;
  if (columns == 3) {
    line.residual += b.sign * line.p[2] * line.u;
  } else {
    line.p[2] = 0;
  }
  line.usable = true;
  return true;
}

std::vector<Line> lines_of(const std::vector<Binned>& strokes, FrictionLaw law, double delta) {
  std::vector<Line> lines;
  for (const auto& b : strokes) {
    Line line;
    line.u = Eigen::ArrayXd::Zero(b.s.size());
    bool done = false;
    if (law != FrictionLaw::none) {
      for (Eigen::Index k = 0; k < b.s.size(); ++k) {
        line.u[k] = friction_transient(law, b.s[k] / delta);
      }
      done = solve(b, 3, line) && line.p[2] > 0;
    }
    if (!done && !solve(b, 2, line)) line.usable = false;
    lines.push_back(std::move(line));
  }
  return lines;
}

double squares(const std::vector<Binned>& strokes, const std::vector<Line>& lines) {
  double sum = 0;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    sum += (strokes[i].w * lines[i].residual.square()).sum();
  }
  return sum;
}

bool usable(const std::vector<Line>& lines) {
  return std::all_of(lines.begin(), lines.end(), [](const Line& line) { return line.usable; });
}

void reweigh(std::vector<Binned>& strokes, const std::vector<Line>& lines) {
  for (std::size_t i = 0; i < strokes.size(); ++i) {
    const Eigen::ArrayXd r = lines[i].residual.abs();
    const double scale =
        1.4826 * signal::median(std::vector<double>(r.data(), r.data() + r.size()));
    if (!(scale > 0)) continue;
    strokes[i].w = (kHuber * scale / r.max(kHuber * scale));
  }
}

// Noise of the bins: white, and a random walk of so much a bin (drift of the channels).
struct BinNoise {
  double white = 0, walk = 0;  // variances

  // Variance of sum_i weights_i y_i over one stroke.
  double variance_of(const Eigen::ArrayXd& weights) const {
    double tail = 0, squares = 0;
    for (Eigen::Index i = weights.size() - 1; i > 0; --i) {
      tail += weights[i];
      squares += tail * tail;
    }
    return white * weights.square().sum() + walk * squares;
  }
};

// Columns of a stroke's fit, and what moves each of c, K, a by a unit of y: rows of (X'X)^-1 X'.
struct Design {
  Eigen::MatrixX3d X, influence;
};

Design design_of(const Binned& b, const Line& line) {
  Design design;
  const Eigen::Index n = b.y.size();
  design.X.setZero(n, 3);
  design.X.col(0).setOnes();
  design.X.col(1) = b.x.matrix();
  if (line.transient) design.X.col(2) = -b.sign * line.u.matrix();
  Binned even = b;
  even.w.setOnes();
  Line plain = line;
  if (solve(even, line.transient ? 3 : 2, plain)) design.influence = design.X * plain.inverse;
  return design;
}

// Both variances from two sums of squares of the residuals, those of bins and those of sums over
// blocks of bins, equated to what they are expected to be: tr(M V M) and tr(B M V M B') with
// M = 1 - X (X'X)^-1 X'. Huber's psi over its mean slope stands for the residuals, as its sums
// move the robust line (Huber, Robust Statistics, 7.6).
BinNoise noise_of(const std::vector<Binned>& strokes, const std::vector<Line>& lines,
                  const std::vector<Design>& designs) {
  double each = 0, each_white = 0, each_walk = 0, block = 0, block_white = 0, block_walk = 0;
  double kept = 0, count = 0;
  for (const auto& b : strokes) {
    kept += (b.w >= 1).cast<double>().sum();
    count += static_cast<double>(b.w.size());
  }
  const double slope = std::max(0.5, kept / count);
  for (std::size_t i = 0; i < strokes.size(); ++i) {
    const Eigen::Index n = strokes[i].y.size();
    const Eigen::MatrixX3d &X = designs[i].X, &A = designs[i].influence;
    if (A.rows() != n) continue;
    const Eigen::VectorXd psi = (strokes[i].w * lines[i].residual / slope).matrix();
    const Eigen::Index blocks = std::min(kBlocks, n / 2);
    const auto first = [&](Eigen::Index k) { return k * n / blocks; };
    const auto sums = [&](const Eigen::VectorXd& y) {
      double squares = 0;
      for (Eigen::Index k = 0; k < blocks; ++k) {
        squares += std::pow(y.segment(first(k), first(k + 1) - first(k)).sum(), 2);
      }
      return squares;
    };
    each += psi.squaredNorm();
    block += sums(psi);
    const double columns = lines[i].transient ? 3 : 2;
    each_white += static_cast<double>(n) - columns;
    for (Eigen::Index k = 0; k < blocks; ++k) {  // tr(B M B') = |B|^2 - (B X)(X'X)^-1 (B X)'
      const Eigen::Index at = first(k), length = first(k + 1) - at;
      block_white +=
          static_cast<double>(length) -
          X.middleRows(at, length).colwise().sum().dot(A.middleRows(at, length).colwise().sum());
    }
    Eigen::VectorXd step = Eigen::VectorXd::Ones(n);
    for (Eigen::Index j = 1; j < n; ++j) {
      step[j - 1] = 0;
      const Eigen::VectorXd left = step - X * (A.transpose() * step);
      each_walk += left.squaredNorm();
      block_walk += sums(left);
    }
  }
  const double determinant = each_white * block_walk - block_white * each_walk;
  BinNoise noise;
  if (determinant > 0) noise.walk = (each_white * block - block_white * each) / determinant;
  noise.walk = std::max(0.0, noise.walk);
  noise.white = std::max(0.0, (each - each_walk * noise.walk) / std::max(1.0, each_white));
  return noise;
}

// Largest delta over a stroke's travel: by half of the stroke at most an eighth of the transient is
// left. What lasts longer cannot be told from the slope; the diagram is curved then.
double longest(FrictionLaw law) { return law == FrictionLaw::exponential ? 0.24 : 0.071; }

// delta with the least squares, by profile: a grid in its logarithm, then Brent's minimiser.
double best_travel(const std::vector<Binned>& strokes, FrictionLaw law, double whole) {
  auto cost = [&](double log_delta) {
    const auto lines = lines_of(strokes, law, std::exp(log_delta));
    return usable(lines) ? squares(strokes, lines) : 1e300;  // GSL takes no infinity
  };
  constexpr Eigen::Index kSteps = 14;
  const Eigen::ArrayXd grid =
      Eigen::ArrayXd::LinSpaced(kSteps + 1, std::log(0.01 * whole), std::log(longest(law) * whole));
  const Eigen::ArrayXd values = grid.unaryExpr(cost);
  Eigen::Index k = 0;
  values.minCoeff(&k);
  if (k == 0 || k == kSteps || !(values[k] < values[k - 1] && values[k] < values[k + 1])) {
    return std::exp(grid[k]);
  }
  gsl_function function{[](double x, void* of) { return (*static_cast<decltype(cost)*>(of))(x); },
                        &cost};
  const std::unique_ptr<gsl_min_fminimizer, void (*)(gsl_min_fminimizer*)> brent(
      gsl_min_fminimizer_alloc(gsl_min_fminimizer_brent), gsl_min_fminimizer_free);
  gsl_min_fminimizer_set_with_values(brent.get(), &function, grid[k], values[k], grid[k - 1],
                                     values[k - 1], grid[k + 1], values[k + 1]);
  for (int step = 0; step < 10; ++step) {
    if (gsl_min_fminimizer_iterate(brent.get()) != GSL_SUCCESS) break;
  }
  return std::exp(gsl_min_fminimizer_x_minimum(brent.get()));
}

}  // namespace

double friction_transient(FrictionLaw law, double z) {
  if (law == FrictionLaw::none) return 0;
  return law == FrictionLaw::exponential ? std::exp(-z) : 1 / (1 + z);
}

FrictionFit fit_friction(const std::vector<FrictionStroke>& strokes, FrictionLaw law,
                         double noise_x_m) {
  FrictionFit fit;
  fit.law = law;
  std::vector<Binned> bins;
  double whole = 0;
  for (const auto& stroke : strokes) {
    if (stroke.load_N.size() < 12) return fit;
    bins.push_back(binned(stroke));
    whole = std::max(whole, stroke.travel_m.maxCoeff());
  }
  if (bins.empty() || !(whole > 0)) return fit;
  const bool friction = law != FrictionLaw::none;
  std::vector<Line> lines;
  fit.travel_m = 0.05 * whole;
  for (int pass = 0; pass < 3; ++pass) {
    if (friction) fit.travel_m = best_travel(bins, law, whole);
    lines = lines_of(bins, law, fit.travel_m);
    if (!usable(lines)) return fit;
    if (pass < 2) reweigh(bins, lines);
  }

  // Residuals of a record hang together (drift, quantisation): fewer count than there are.
  double sum = 0, lagged = 0, count = 0;
  int parameters = 0;
  std::vector<Design> designs;
  for (std::size_t i = 0; i < bins.size(); ++i) {
    const Eigen::ArrayXd r = bins[i].w.sqrt() * lines[i].residual;
    sum += r.square().sum();
    lagged += (r.head(r.size() - 1) * r.tail(r.size() - 1)).sum();
    count += static_cast<double>(r.size());
    parameters += lines[i].transient ? 3 : 2;
    designs.push_back(design_of(bins[i], lines[i]));
  }
  if (friction) ++parameters;
  const double correlation = sum > 0 ? std::clamp(lagged / sum, 0.0, 0.95) : 0;
  const double effective =
      std::max(count * (1 - correlation) / (1 + correlation), static_cast<double>(parameters) + 2);
  const double freedom = std::max(1.0, count - parameters);
  const BinNoise noise = noise_of(bins, lines, designs);
  double white = 0, all = 0;  // variance of the slopes
  for (const auto& design : designs) {
    if (design.influence.rows() == 0) return fit;
    white += BinNoise{noise.white, 0}.variance_of(design.influence.col(1));
    all += noise.variance_of(design.influence.col(1));
  }
  const double share = all > 0 ? white / all : 1;
  fit.walk_share = 1 - share;
  // White noise is known from every bin, a walk from blocks of them.
  const double each = count / static_cast<double>(lines.size());
  fit.degrees_of_freedom = 1 / (share / (each - 3) + fit.walk_share / (kBlocks - 3));
  fit.residual_rms_N = std::sqrt(sum / freedom);
  // An exact table has no residuals: rounding bounds the logarithm.
  double largest = 0;
  for (const auto& b : bins) largest = std::max(largest, b.y.abs().maxCoeff());
  const double floor = std::pow(1e-9 * largest, 2) * count;
  fit.aicc = effective * std::log(std::max(sum, floor) / count) + 2.0 * parameters +
             2.0 * parameters * (parameters + 1) / std::max(1.0, effective - parameters - 1);

  // delta is common to the strokes: what it adds to each K is fully correlated.
  double curvature = 0, travel_variance = 0;
  std::vector<double> slope_by_travel(bins.size(), 0.0);
  if (friction) {
    const double h = 1e-3 * fit.travel_m;
    for (std::size_t i = 0; i < bins.size(); ++i) {
      if (!lines[i].transient) continue;
      const auto& b = bins[i];
      Eigen::ArrayXd derivative(b.s.size());
      for (Eigen::Index k = 0; k < b.s.size(); ++k) {
        derivative[k] = -b.sign * lines[i].p[2] *
                        (friction_transient(law, b.s[k] / (fit.travel_m + h)) -
                         friction_transient(law, b.s[k] / (fit.travel_m - h))) /
                        (2 * h);
      }
      Eigen::Vector3d coupling = Eigen::Vector3d::Zero();
      for (Eigen::Index k = 0; k < b.s.size(); ++k) {
        coupling += b.w[k] * derivative[k] * Eigen::Vector3d(1, b.x[k], -b.sign * lines[i].u[k]);
      }
      const Eigen::Vector3d moved = lines[i].inverse * coupling;
      curvature += (b.w * derivative.square()).sum() - coupling.dot(moved);
      slope_by_travel[i] = -moved[1];
      // What of the derivative the line does not take: it alone tells delta.
      travel_variance += noise.variance_of(derivative - (designs[i].X * moved).array());
    }
  }
  const double travel_std = curvature > 0 ? std::sqrt(travel_variance) / curvature : 0;
  for (std::size_t i = 0; i < bins.size(); ++i) {
    const auto& b = bins[i];
    // Noise of x flattens a fitted slope by its share of what x alone explains.
    const double alone = 1 / lines[i].inverse(1, 1);
    const double noise2 = noise_x_m * noise_x_m / static_cast<double>(b.each);
    const double attenuation = 1 - std::min(0.5, noise2 * static_cast<double>(b.x.size()) / alone);
    const double K = lines[i].p[1] / attenuation;
    fit.stiffness_N_m.push_back(
        {K, std::sqrt(noise.variance_of(designs[i].influence.col(1))) / attenuation});
    fit.by_travel.push_back(slope_by_travel[i] * travel_std);
    fit.load_N.push_back(lines[i].p[2]);
  }
  fit.usable = true;
  return fit;
}

}  // namespace rigfit::ident
