#include "ident/axial/axial_monte_carlo.h"

#include <algorithm>
#include <cmath>
#include <random>

#include "ident/axial/rod_stiffness.h"

namespace rigfit::ident {
namespace {

struct Line {
  double level = 0, slope = 0, slope_std = 0, chi2 = 0;
};

// y = level + slope x, variances 1 / w.
Line weighted_line(std::span<const double> x, std::span<const double> y,
                   std::span<const double> w) {
  double sw = 0, mx = 0, my = 0, sxx = 0, sxy = 0;
  for (std::size_t i = 0; i < x.size(); ++i) sw += w[i], mx += w[i] * x[i], my += w[i] * y[i];
  mx /= sw, my /= sw;
  for (std::size_t i = 0; i < x.size(); ++i) {
    sxx += w[i] * (x[i] - mx) * (x[i] - mx), sxy += w[i] * (x[i] - mx) * (y[i] - my);
  }
  Line line{my - sxy / sxx * mx, sxy / sxx, 1 / std::sqrt(sxx), 0};
  for (std::size_t i = 0; i < x.size(); ++i) {
    line.chi2 += w[i] * std::pow(y[i] - line.level - line.slope * x[i], 2);
  }
  return line;
}

// Of the frame and the adapter that are told, as compliances.
double told_compliance(double stiffness) { return stiffness > 0 ? 1 / stiffness : 0; }

// 1 / kc of a rod of which the part `place` of a compliance s lies below, the rest above: all of it
// below by rod_stiffness, and the rest by the mass that moves, (m L / 3) (a^2 + a b + b^2), a and b
// the motions of the cable's ends.
double cable_compliance(RodOnMass rod, double s, double place) {
  const double told = told_compliance(rod.adapter_N_m), frame = told_compliance(rod.frame_N_m);
  rod.adapter_N_m = told + frame + s > 0 ? 1 / (told + frame + s) : 0;
  rod.frame_N_m = 0;
  const auto below = rod_stiffness(rod);
  const double k = below.series_N_m;
  const double a = k * (s * (1 - place) + frame), b = 1 - k * (told + s * place);
  const double c = 1 - k * (told + frame + s);
  const double moved = (a * a + a * b + b * b - c * c) / 3;
  const double share = rod.mass_per_length_kg_m * rod.length_m / rod.mass_kg * moved;
  return 1 / below.cable_N_m - share / (k * (1 + share));
}

// EA of one draw of what the lengths share, without their own errors; its relative standard
// uncertainty from these, and how the lengths disagree.
struct Draw {
  double EA = 0, relative_std = 0, chi2 = 0;
};

Draw solve(std::span<const AxialLengthData> lengths, const AxialSetup& setup, const AxialFit& fit,
           RodOnMass rod, double place, double s) {
  const std::size_t n = lengths.size();
  const bool line = fit.series && !setup.series_compliance_std_m_N;
  std::vector<double> x(n), y(n), w(n);
  Draw draw;
  for (int round = 0; round < (line ? 3 : 1); ++round) {
    double sum = 0, mean = 0;
    for (std::size_t i = 0; i < n; ++i) {
      const auto& one = lengths[i];
      rod.length_m = x[i] = one.length_m;
      rod.omega_squared = std::exp(one.log_omega_squared);
      const double own = cable_compliance(rod, s, place);
      y[i] = own + s;
      // Relative, of 1 / kc: the frequency's of the whole chain, the length's of the cable.
      const double chain = 1 / (rod.omega_squared * rod.mass_kg * own);
      const double variance = std::pow(chain * std::max(one.log_omega_squared_std, 1e-12), 2) +
                              std::pow(setup.length_std_m / x[i], 2) +
                              fit.between_std * fit.between_std;
      w[i] = 1 / (variance * own * own);
      sum += 1 / variance, mean += std::log(x[i] / own) / variance;
    }
    if (!line) {
      mean /= sum;
      draw = {std::exp(mean), 1 / std::sqrt(sum), 0};
      for (std::size_t i = 0; i < n; ++i) {
        draw.chi2 += w[i] * std::pow((y[i] - s) * (mean - std::log(x[i] / (y[i] - s))), 2);
      }
      continue;
    }
    const Line found = weighted_line(x, y, w);
    draw = {1 / found.slope, found.slope_std / found.slope, found.chi2};
    s = found.level;
  }
  return draw;
}

}  // namespace

std::vector<double> axial_monte_carlo(std::span<const AxialLengthData> lengths,
                                      const AxialSetup& setup,
                                      std::span<const AxialCandidate> candidates,
                                      double repeat_degrees, int draws, std::uint64_t seed) {
  std::mt19937_64 generator(seed);
  std::normal_distribution<double> normal;
  const auto student = [&](double degrees) {  // common factor of a part known to few degrees
    if (!(degrees > 0)) return 1.0;
    std::chi_squared_distribution<double> chi2(degrees);
    return std::sqrt(degrees / chi2(generator));
  };
  struct Weighted {
    double EA, weight;
  };
  std::vector<Weighted> values;
  for (const auto& candidate : candidates) {
    const auto& fit = candidate.fit;
    const std::size_t first = values.size();
    double least = INFINITY, sum = 0;
    const int own_draws = static_cast<int>(std::lround(draws * candidate.weight));
    for (int d = 0; d < own_draws; ++d) {
      RodOnMass rod;
      rod.mass_kg = setup.mass_kg.value + setup.mass_kg.std * normal(generator);
      rod.mass_per_length_kg_m =
          setup.mass_per_length_kg_m.value + setup.mass_per_length_kg_m.std * normal(generator);
      rod.adapter_N_m = setup.adapter_stiffness_N_m.value;
      if (rod.adapter_N_m > 0) {
        rod.adapter_N_m += setup.adapter_stiffness_N_m.std * normal(generator);
      }
      rod.frame_N_m = setup.frame_stiffness_N_m.value;
      if (rod.frame_N_m > 0) rod.frame_N_m += setup.frame_stiffness_N_m.std * normal(generator);
      double s = fit.series ? fit.compliance_m_N : 0;
      if (fit.series && setup.series_compliance_std_m_N) {
        s = *setup.series_compliance_std_m_N * normal(generator);
      }
      Draw draw = solve(lengths, setup, fit, rod, 0.5 + 0.5 * normal(generator), s);
      const double scatter =
          student(candidate.scatter_degrees > 0 ? candidate.scatter_degrees : repeat_degrees);
      draw.EA /= 1 + draw.relative_std * scatter * normal(generator);
      if (!(std::isfinite(draw.EA) && draw.EA > 0 && std::isfinite(draw.chi2))) continue;
      values.push_back({draw.EA, draw.chi2});
      least = std::min(least, draw.chi2);
    }
    for (std::size_t i = first; i < values.size(); ++i) {
      sum += values[i].weight = std::exp(-0.5 * (values[i].weight - least));
    }
    for (std::size_t i = first; i < values.size(); ++i) values[i].weight *= candidate.weight / sum;
  }
  double total = 0, squares = 0;
  for (const auto& v : values) total += v.weight, squares += v.weight * v.weight;
  if (!(total * total > 100 * squares)) return {};
  std::sort(values.begin(), values.end(),
            [](const Weighted& a, const Weighted& b) { return a.EA < b.EA; });
  std::vector<double> even;
  double below = 0;
  for (std::size_t i = 0; i < values.size() && even.size() < static_cast<std::size_t>(draws); ++i) {
    below += values[i].weight;
    while (even.size() < static_cast<std::size_t>(draws) &&
           below >= total * (static_cast<double>(even.size()) + 0.5) / draws) {
      even.push_back(values[i].EA);
    }
  }
  return even;
}

}  // namespace rigfit::ident
