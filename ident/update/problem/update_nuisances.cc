// What is known to an uncertainty and not fitted, as coordinates of the same least-squares problem.
//
// Each is d ~ N(0, 1), in its own standard uncertainty, and a residual of its own. A parameter's
// covariance is its part of the whole (J'J)^-1, so that an error of an input which the fit can
// follow, or which the data tell, counts as far as it goes; the part of the variance by one of them
// is cov(parameter, d)^2.
//
// The place of the hits: an error bar of an averaged FRF holds what the hits scatter by, and hits
// scatter in place. sigma_x |dH/dx| <= std(H) in every line bounds the standard uncertainty of
// their mean place x along the member; the bound (its 5 % quantile over the lines, as error bars
// scatter) is taken where nothing else is said of the place. A mean that was aimed beside is not in
// the hits' scatter and must be stated.
//
// The force of the hits: noise n(t) on the hammer's signal moves H by the factor 1 - N / F, alike
// in all responses, and where a window keeps only the pulse, alike in neighbouring lines:
//   N / F = sum_j a_j exp(-i omega tau_j),  |tau_j| <= T / 2.
// A pulse that excites lines up to f lasts 1.5 / f at most (half sine), and windows keep three
// pulses, faded over half as long: T = 6.75 / f. The a_j are independent; what they add up to in a
// line is bounded as the place is, by the 5 % quantile of the lines' relative uncertainties.

#include "ident/update/problem/update_problem.h"
#include "model/frfs/frf_synthesis.h"

namespace rigfit::ident {
namespace {

// The 5 % quantile; 0 without any.
double least_of(std::vector<double> values) {
  constexpr double kQuantile = 0.05;
  if (values.empty()) return 0;
  const auto at = static_cast<std::ptrdiff_t>(kQuantile * static_cast<double>(values.size()));
  std::nth_element(values.begin(), values.begin() + at, values.end());
  return values[static_cast<std::size_t>(at)];
}

std::string in_state(const UpdateState& state) {
  return state.name.empty() ? "" : " [" + state.name + "]";
}

}  // namespace

UpdateProblem UpdateProblem::with_hits(VectorXd& q) const {
  UpdateProblem other = *this;
  if (!has_frfs()) return other;
  other.last_ = std::make_shared<LastModes>();  // its coordinates depend on q
  other.add_places_of_hits(q);
  other.add_forces();
  const Index before = q.size();
  q.conservativeResize(other.size());
  q.tail(q.size() - before).setZero();
  return other;
}

void UpdateProblem::add_nuisance(UpdateCoordinate coordinate) {
  coordinate.logarithmic = false;
  coordinate.high = std::numeric_limits<double>::infinity(), coordinate.low = -coordinate.high;
  coordinate.prior_std = 1;
  std::erase_if(coordinate.effects, [&](const auto& effect) {  // a fitted one has its own value
    return effect.change == 0 || is_moved(effect.state, effect.target, parameters_);
  });
  coordinates_.push_back(std::move(coordinate));
  ++priors_;
}

void UpdateProblem::add_places_of_hits(const VectorXd& q) {
  std::vector<UpdateCoordinate> places;  // added when q is no longer asked for
  for (int s = 0; s < static_cast<int>(states_.size()); ++s) {
    const auto& state = state_at(s);
    if (!takes_part(s)) continue;
    for (std::size_t l = 0; l < state.scene.loads.size(); ++l) {
      const auto& load = state.scene.loads[l];
      const std::string target = load.name + ".position";
      model::Scene scene;
      std::string failure;
      if (!load.place.node.empty() || is_moved(s, target, size())) continue;
      if (!fixed_scene(s, q, scene, failure)) continue;
      std::vector<double> largest;  // standard uncertainty that each line allows
      for (const auto& frf : state.frfs) {
        if (frf.load != l || frf.std.size() == 0) continue;
        const auto solved = model::synthesize_frf_sensitivities(
            scene, frf.frequency_hz, model::parameters_named(scene, {target}), {},
            frf.decay_rate_1_s);
        if (solved.frfs.H.empty()) continue;
        for (const auto line : rows_of(s, frf).line) {
          const auto k = static_cast<std::size_t>(line);
          const double slope =
              std::abs(solved.rate[0][k](static_cast<Index>(frf.sensor), static_cast<Index>(l)));
          if (slope > 0) largest.push_back(frf.std[line] / slope);
        }
      }
      if (largest.empty()) continue;
      places.push_back({"place of the hits of " + load.name + in_state(state),
                        -1,
                        -1,
                        {{s, target, least_of(std::move(largest))}}});
    }
  }
  for (auto& place : places) add_nuisance(std::move(place));
}

void UpdateProblem::add_forces() {
  constexpr int kDelays = 16;       // a band up to f holds 2 T f = 13.5 of them
  constexpr double kWindow = 6.75;  // T f
  for (int s = 0; s < static_cast<int>(states_.size()); ++s) {
    const auto& state = state_at(s);
    for (std::size_t l = 0; takes_part(s) && l < state.scene.loads.size(); ++l) {
      std::vector<double> relative;  // in the real or imaginary part
      double highest = 0;
      for (const auto& frf : state.frfs) {
        if (frf.load != l || frf.std.size() == 0) continue;
        for (Index k = 0; k < frf.H.size(); ++k) {
          const double own = frf.std[k] / std::abs(frf.H[k]);
          if (std::isfinite(own) && own > 0) relative.push_back(own);
        }
        for (const auto line : rows_of(s, frf).line) {
          highest = std::max(highest, frf.frequency_hz[line]);
        }
      }
      const double std = least_of(std::move(relative)) * std::sqrt(2.0 / kDelays);
      for (int j = 0; std > 0 && highest > 0 && j < kDelays; ++j) {
        const double share = static_cast<double>(j) / (kDelays - 1) - 0.5;
        add_nuisance({.name = "force of the hits of " + state.scene.loads[l].name + in_state(state),
                      .force = {s, l, std, share * kWindow / highest}});
      }
    }
  }
}

void UpdateProblem::add_force_noise(const VectorXd& q, const std::vector<FrfRows>& all, VectorXd& r,
                                    MatrixXd* jacobian) const {
  for (const auto& rows : all) {
    for (Index j = parameters_; j < size(); ++j) {
      const auto& force = coordinate_at(j).force;
      if (!(force.std > 0) || force.state != rows.state || force.load != rows.frf->load) continue;
      for (std::size_t k = 0; k < rows.line.size(); ++k) {
        const auto row = rows.first + 2 * static_cast<Index>(k);
        const std::complex<double> slope =
            std::polar(force.std / rows.relative_std[k],
                       -2 * M_PI * rows.frf->frequency_hz[rows.line[k]] * force.delay_s);
        r[row] += q[j] * slope.real();
        r[row + 1] += q[j] * slope.imag();
        if (jacobian == nullptr) continue;
        (*jacobian)(row, j) = slope.real();
        (*jacobian)(row + 1, j) = slope.imag();
      }
    }
  }
}

}  // namespace rigfit::ident
