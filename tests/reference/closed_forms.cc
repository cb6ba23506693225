#include "tests/reference/closed_forms.h"

#include <array>
#include <cmath>
#include <numbers>

#include "tests/reference/bracketed_root.h"

namespace rigfit::model {
namespace {

using std::numbers::pi;

// cos z sinh z - sin z cosh z = (Re - Im) sinh((1+i) z), over cosh z; without cancellation for
// small z, without overflow for large.
double tip_mass_term(double z) {
  if (z < 1) {
    const double z4 = std::pow(z, 4);
    const double series = -2.0 / 3 * z * z * z *
                          (1 - z4 / 210 * (1 - z4 / 1980 * (1 - z4 / 8190 * (1 - z4 / 23256))));
    return series / std::cosh(z);
  }
  return std::cos(z) * std::tanh(z) - std::sin(z);
}

// w(1) and w'(1) of the column's equation w'''' + (gamma x + p) w'' + gamma w' = lambda4 w for two
// solutions that meet the tip's conditions; the determinant vanishes at a mode.
double column_determinant(double lambda4, double gamma, double p, double mu) {
  const auto end_values = [&](std::array<double, 4> a) {
    double w = a[0] + a[1] + a[2] + a[3], slope = a[1] + 2 * a[2] + 3 * a[3];
    int quiet = 0;
    for (int k = 0; k < 400 && quiet < 8; ++k) {
      const double next = (lambda4 * a[0] - gamma * (k + 1.0) * (k + 1.0) * a[1] -
                           p * (k + 2.0) * (k + 1.0) * a[2]) /
                          ((k + 4.0) * (k + 3.0) * (k + 2.0) * (k + 1.0));
      a = {a[1], a[2], a[3], next};
      w += next;
      slope += (k + 4.0) * next;
      quiet = std::abs((k + 4.0) * next) <= 1e-18 * (std::abs(w) + std::abs(slope)) ? quiet + 1 : 0;
    }
    return std::array{w, slope};
  };
  // Tip (x = 0): w'' = 0 and w''' + p w' = mu lambda4 w.
  const auto first = end_values({1, 0, 0, mu * lambda4 / 6});
  const auto second = end_values({0, 1, 0, -p / 6});
  return first[0] * second[1] - second[0] * first[1];
}

}  // namespace

std::vector<double> pinned_beam_frequencies(const UniformBeam& beam, int count) {
  std::vector<double> result;
  for (int n = 1; n <= count; ++n) {
    const double k = n * pi / beam.length_m;
    result.push_back(k *
                     std::sqrt((beam.tension_N + beam.EI_Nm2 * k * k) / beam.mass_per_length_kg_m) /
                     (2 * pi));
  }
  return result;
}

std::vector<double> clamped_beam_frequencies(const UniformBeam& beam, int count) {
  if (beam.EI_Nm2 == 0) return pinned_beam_frequencies(beam, count);
  const double half = beam.length_m / 2;
  const double s = beam.tension_N / beam.EI_Nm2 * half * half;  // a^2 - b^2, half lengths
  std::vector<double> result;
  for (int n = 1; n <= count; ++n) {
    // b = n pi/2 + delta with tan(delta) = b / (a tanh a), tanh on the other side for even n.
    const auto angles = [&](double delta) {
      const double b = n * pi / 2 + delta;
      return std::array{std::sqrt(b * b + s), b};
    };
    const double delta = bracketed_root(
        [&](double d) {
          const auto [a, b] = angles(d);
          const double t = std::tanh(a);
          return n % 2 == 1 ? d - std::atan2(b, a * t) : d - std::atan2(b * t, a);
        },
        0, pi / 2);
    const auto [a, b] = angles(delta);
    result.push_back(a * b / (half * half) * std::sqrt(beam.EI_Nm2 / beam.mass_per_length_kg_m) /
                     (2 * pi));
  }
  return result;
}

std::vector<double> cantilever_frequencies(const UniformBeam& beam, double tip_mass_kg, int count) {
  const double mu = tip_mass_kg / (beam.mass_per_length_kg_m * beam.length_m);
  const auto characteristic = [&](double z) {
    return 1 / std::cosh(z) + std::cos(z) + mu * z * tip_mass_term(z);
  };
  std::vector<double> result;
  for (int n = 1; n <= count; ++n) {
    const double z = bracketed_root(characteristic, (n - 1) * pi, n * pi);
    result.push_back(z * z / (beam.length_m * beam.length_m) *
                     std::sqrt(beam.EI_Nm2 / beam.mass_per_length_kg_m) / (2 * pi));
  }
  return result;
}

std::vector<double> standing_cantilever_frequencies(const UniformBeam& beam, double tip_mass_kg,
                                                    double gravity_m_s2, int count) {
  const double L = beam.length_m, m = beam.mass_per_length_kg_m;
  const double gamma = m * gravity_m_s2 * L * L * L / beam.EI_Nm2;
  const double p = tip_mass_kg * gravity_m_s2 * L * L / beam.EI_Nm2;
  const double mu = tip_mass_kg / (m * L);
  const auto determinant = [&](double z) {
    return column_determinant(std::pow(z, 4), gamma, p, mu);
  };
  std::vector<double> result;
  // Roots lie about pi apart, the first anywhere above zero.
  const double step = 0.05;
  double low = 0, value_low = determinant(low);
  while (static_cast<int>(result.size()) < count) {
    const double high = low + step, value_high = determinant(high);
    if (std::signbit(value_low) != std::signbit(value_high)) {
      const double z = bracketed_root(determinant, low, high);
      result.push_back(z * z / (L * L) * std::sqrt(beam.EI_Nm2 / m) / (2 * pi));
    }
    low = high;
    value_low = value_high;
  }
  return result;
}

double irvine_parameter(const SaggingCable& cable) {
  const double ratio =
      cable.mass_per_length_kg_m * cable.gravity_m_s2 * cable.span_m / cable.tension_N;
  return ratio * ratio * cable.EA_N / (cable.tension_N * (1 + ratio * ratio / 8));
}

std::vector<double> irvine_symmetric_frequencies(const SaggingCable& cable, int count) {
  const double lambda2 = irvine_parameter(cable);
  const double wave = std::sqrt(cable.tension_N / cable.mass_per_length_kg_m) / cable.span_m;
  // tan u = u - 4 u^3/lambda^2 with u = omega L / (2 c), multiplied by lambda^2 cos u.
  const auto characteristic = [&](double u) {
    return lambda2 * (std::sin(u) - u * std::cos(u)) + 4 * u * u * u * std::cos(u);
  };
  std::vector<double> result;
  for (int n = 1; n <= count; ++n) {
    const double u = lambda2 == 0 ? (n - 0.5) * pi
                                  : bracketed_root(characteristic, (n - 0.5) * pi, (n + 0.5) * pi);
    result.push_back(2 * u * wave / (2 * pi));
  }
  return result;
}

std::vector<double> irvine_antisymmetric_frequencies(const SaggingCable& cable, int count) {
  const double wave = std::sqrt(cable.tension_N / cable.mass_per_length_kg_m) / cable.span_m;
  std::vector<double> result;
  for (int n = 1; n <= count; ++n) result.push_back(n * wave);
  return result;
}

std::vector<double> irvine_out_of_plane_frequencies(const SaggingCable& cable, int count) {
  std::vector<double> result;
  for (double f : irvine_antisymmetric_frequencies(cable, count)) result.push_back(f / 2);
  return result;
}

CatenaryState catenary_of_tension(const ElasticCatenary& cable, double tension_N) {
  const double H = tension_N, w = cable.weight_per_length_N_m, stretch = H / cable.EA_N;
  const double a = H / w;
  // The slope of the profile is sinh(u), u from d + c at the first end to d - c at the second:
  //   L0 = 2 a sinh(c) cosh(d),  span = stretch L0 + 2 a c,
  //   -rise = 2 a sinh(c) sinh(d) (1 + stretch cosh(c) cosh(d))
  const auto half_range = [&](double d) {
    return bracketed_root(
        [&](double c) {
          return 2 * a * (c + stretch * std::sinh(c) * std::cosh(d)) - cable.span_m;
        },
        0, cable.span_m / (2 * a));
  };
  const auto drop = [&](double d) {
    const double c = half_range(d);
    return 2 * a * std::sinh(c) * std::sinh(d) * (1 + stretch * std::cosh(c) * std::cosh(d));
  };
  double d = 0;
  if (cable.rise_m != 0) {
    double limit =
        std::copysign(std::asinh(std::abs(cable.rise_m) / cable.span_m) + 0.1, -cable.rise_m);
    while (std::abs(drop(limit)) < std::abs(cable.rise_m)) limit *= 1.5;
    d = bracketed_root([&](double x) { return drop(x) + cable.rise_m; }, 0, limit);
  }
  const double c = half_range(d);
  CatenaryState state{.tension_N = H};
  // u falls from d + c to d - c; the profile's slope at the first end is -sinh(d + c).
  state.vertical_N = H * std::sinh(d + c);
  state.unstretched_length_m = 2 * a * std::sinh(c) * std::cosh(d);
  // Largest distance below the chord where the slope is the chord's: sinh(u) = -rise/span.
  const double s = (state.vertical_N + H * cable.rise_m / cable.span_m) / w;
  const Eigen::Vector2d lowest = catenary_point(cable, state, s);
  state.sag_m = cable.rise_m * lowest.x() / cable.span_m - lowest.y();
  return state;
}

CatenaryState catenary_of_length(const ElasticCatenary& cable, double unstretched_length_m) {
  const double chord = std::hypot(cable.span_m, cable.rise_m);
  // The length falls as the tension grows; log scale between slack and taut.
  const auto excess = [&](double log_tension) {
    return catenary_of_tension(cable, std::exp(log_tension)).unstretched_length_m -
           unstretched_length_m;
  };
  const double weight = cable.weight_per_length_N_m * chord;
  double low = std::log(weight), high = low;
  while (excess(low) < 0) low -= 1;
  while (excess(high) > 0) high += 1;
  return catenary_of_tension(cable, std::exp(bracketed_root(excess, low, high)));
}

Eigen::Vector2d catenary_point(const ElasticCatenary& cable, const CatenaryState& state,
                               double s_m) {
  const double H = state.tension_N, V = state.vertical_N, w = cable.weight_per_length_N_m;
  const double t0 = V / H, t1 = (V - w * s_m) / H;
  const double x = H * s_m / cable.EA_N + H / w * (std::asinh(t0) - std::asinh(t1));
  const double fall = s_m / cable.EA_N * (V - w * s_m / 2) +
                      H / w * (t0 - t1) * (t0 + t1) / (std::hypot(1, t0) + std::hypot(1, t1));
  return {x, -fall};
}

}  // namespace rigfit::model
