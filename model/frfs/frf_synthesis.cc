#include "model/frfs/frf_synthesis.h"

#include "model/frfs/frf_equations.h"
#include "model/linear/damped_modes.h"
#include "model/linear/perturbed_equilibrium.h"

namespace rigfit::model {
namespace {

constexpr double kEqual = 1e-9;  // relative distance of squared frequencies found to 1e-10

/// The rates of one motion's equations with one parameter.
struct EquationRates : MotionRates {
  EnvelopeMatrix damping;
  MatrixXd sensors, loads;
  // Modal dampers: sum_r g_r m_r m_r' has the rate sum_rs pair_rs (m_r m_s') + sum_r g_r (n_r m_r'
  // + m_r n_r'), n_r the rate of m_r = M phi_r less what the other damped modes take of it.
  MatrixXd pair, normal;
};

/// What does not depend on the parameter: factors of K - omega_r^2 M, for the damped modes' rates.
class ShapeSolver {
 public:
  explicit ShapeSolver(const FrfEquations& equations) : equations_(equations) {
    const MotionModes& motion = *equations.motion;
    factors_.resize(static_cast<std::size_t>(equations.zeta.size()));
    EnvelopeMatrix shifted = motion.stiffness;
    for (std::size_t r = 0; r < factors_.size(); ++r) {
      shifted.values() = motion.stiffness.values() - motion.omega2[Index(r)] * motion.mass.values();
      factors_[r].factor(shifted);
    }
  }

  /// phi_r's rate outside of the damped modes' space, for the right side -(K_p - omega_r^2 M_p)
  /// phi_r. K - omega_r^2 M is singular along phi_r alone, which the projections take out.
  VectorXd outside(std::size_t r, VectorXd right) const {
    const MatrixXd& shapes = equations_.motion->shapes;
    right -= equations_.dampers * (shapes.transpose() * right);
    factors_[r].solve_in_place(right);
    right -= shapes * (equations_.dampers.transpose() * right);
    return right;
  }

 private:
  const FrfEquations& equations_;
  std::vector<EnvelopeFactor> factors_;
};

/// Derivative of the modal ratios that comes from the turning shapes alone. Shapes of close
/// frequencies turn fast, so that they have a step of their own.
VectorXd turning_rate(const MotionModes& motion, const MatrixXd& shape_rate, const ChainState& rest,
                      const Scene& scene) {
  const double fastest = shape_rate.cwiseAbs().maxCoeff() / motion.shapes.cwiseAbs().maxCoeff();
  if (!(fastest > 0)) return VectorXd::Zero(motion.omega2.size());
  const double part = 1e-4 / fastest;
  const auto at = [&](double factor) {
    return modal_ratios(*motion.assembly, motion.shapes + factor * shape_rate, rest, scene);
  };
  return (at(part) - at(-part)) / (2 * part);
}

/// Rates of the modal dampers.
void damper_rates(const FrfEquations& equations, const ShapeSolver& solver, const ChainState& rest,
                  const Scene& scene, const Neighbours& near, EquationRates& rates) {
  const MotionModes& motion = *equations.motion;
  const Index count = equations.zeta.size();
  const MatrixXd& phi = motion.shapes;
  const MatrixXd dk_phi = rates.stiffness * phi, dm_phi = rates.mass * phi;
  const MatrixXd k = phi.transpose() * dk_phi, m = phi.transpose() * dm_phi;
  const VectorXd& lambda = motion.omega2;
  const VectorXd lambda_rate = k.diagonal() - lambda.cwiseProduct(m.diagonal());

  // Shapes to first order, for the ratios' weights by strain energy: equal frequencies share their
  // damped space, in which they are not turned.
  MatrixXd shape_rate(phi.rows(), count);
  rates.normal.resize(phi.rows(), count);
  for (Index r = 0; r < count; ++r) {
    const VectorXd outside =
        solver.outside(std::size_t(r), lambda[r] * dm_phi.col(r) - dk_phi.col(r));
    VectorXd inside = VectorXd::Zero(count);
    for (Index s = 0; s < count; ++s) {
      const double gap = lambda[r] - lambda[s];
      if (s == r) {
        inside[s] = -0.5 * m(r, r);
      } else if (std::abs(gap) > kEqual * lambda[r]) {
        inside[s] = (k(s, r) - lambda[r] * m(s, r)) / gap;
      }
    }
    shape_rate.col(r) = outside + phi * inside;
    rates.normal.col(r) =
        dm_phi.col(r) + motion.mass * outside - 0.5 * m(r, r) * equations.dampers.col(r);
  }
  const auto ratios_on = [&](std::size_t side) {
    const PerturbedEquilibrium& rig = near.rigs[side];
    return modal_ratios(*rates.sides[side].assembly, phi, rig.state, rig.scene);
  };
  const VectorXd zeta_rate = (ratios_on(1) - ratios_on(0)) / near.step.width() +
                             turning_rate(motion, shape_rate, rest, scene);

  const VectorXd omega = lambda.cwiseSqrt();
  const VectorXd gain = 2 * equations.zeta.cwiseProduct(omega);
  rates.pair.setZero(count, count);
  for (Index r = 0; r < count; ++r) {
    rates.pair(r, r) = 2 * zeta_rate[r] * omega[r] + equations.zeta[r] * lambda_rate[r] / omega[r];
    for (Index s = 0; s < r; ++s) {
      const double gap = lambda[r] - lambda[s];
      double value = 0;
      if (std::abs(gap) > kEqual * lambda[r]) {
        value = ((gain[r] - gain[s]) * k(r, s) -
                 (gain[r] * lambda[r] - gain[s] * lambda[s]) * m(r, s)) /
                gap;
      } else {  // the limit for one ratio: d(2 zeta omega) / d(omega^2) = zeta / omega
        const double slope = equations.zeta[r] / omega[r];
        value = slope * k(r, s) - (gain[r] + slope * lambda[r]) * m(r, s);
      }
      rates.pair(r, s) = rates.pair(s, r) = value;
    }
  }
}

/// v' A u for one envelope matrix and many columns.
void add_form(const EnvelopeMatrix& a, Complex factor, const MatrixXcd& v, const MatrixXcd& u,
              MatrixXcd& sum) {
  if (a.values().isZero(0)) return;  // most parameters move one matrix or none
  for (Index c = 0; c < u.cols(); ++c) {
    sum.col(c) += factor * (v.transpose() * (a * VectorXcd(u.col(c))));
  }
}

/// By differences of FRFs synthesised anew, for what leaves the plane of symmetry.
std::vector<MatrixXcd> rate_anew(Scene scene, const Chain& chain, const VectorXd& frequency_hz,
                                 const ParameterAccess& access, const ParameterStep& step,
                                 const ModesOptions& options, double decay_rate_1_s) {
  for (std::size_t m = 0; m < chain.members.size(); ++m) {
    scene.members[m].segments = chain.members[m].segments;
  }
  const auto at = [&](double value) {
    Scene moved = scene;
    access.set(moved, value);
    return synthesize_frfs(moved, frequency_hz, options, decay_rate_1_s).H;
  };
  auto high = at(step.high);
  const auto low = at(step.low);
  if (high.size() != low.size()) return {};
  for (std::size_t i = 0; i < high.size(); ++i) high[i] = (high[i] - low[i]) / step.width();
  return high;
}

}  // namespace

FrfSensitivities synthesize_frf_sensitivities(const Scene& scene, const VectorXd& frequency_hz,
                                              const std::vector<ParameterAccess>& wanted,
                                              const ModesOptions& options, double decay_rate_1_s) {
  FrfSensitivities out;
  out.frfs.frequency_hz = frequency_hz;
  const ChainModes modes = frf_modes(scene, frequency_hz, options);
  out.frfs.equilibrium = describe(*modes.chain, modes.equilibrium, scene);
  if (modes.equilibrium.status != EquilibriumStatus::converged) return out;
  const ChainState& state = modes.equilibrium.state;
  const auto sensors = static_cast<Index>(scene.sensors.size());
  const auto loads = static_cast<Index>(scene.loads.size());
  const auto lines = static_cast<std::size_t>(frequency_hz.size());
  const std::vector<MatrixXcd> none(lines, MatrixXcd::Zero(sensors, loads));
  out.frfs.H = none;
  out.rate.assign(wanted.size(), none);

  std::optional<BorderedSolver> tangent;
  if (!wanted.empty()) tangent.emplace(tangent_at_rest(*modes.chain, state));
  std::vector<Neighbours> neighbours;
  for (std::size_t p = 0; p < wanted.size(); ++p) {
    const Neighbours& near =
        neighbours.emplace_back(neighbours_of(scene, modes, *tangent, wanted[p]));
    if (near.comparable) continue;
    out.rate[p] = rate_anew(scene, *modes.chain, frequency_hz, wanted[p], near.step.wider(),
                            options, decay_rate_1_s);
  }

  for (const MotionModes& motion : modes.motions) {
    const FrfEquations equations = frf_equations(motion, state, scene);
    const bool modal = equations.zeta.size() > 0;
    std::optional<ShapeSolver> shapes;
    if (modal && !wanted.empty()) shapes.emplace(equations);
    std::vector<EquationRates> rates(wanted.size());
    for (std::size_t p = 0; p < wanted.size(); ++p) {
      const Neighbours& near = neighbours[p];
      if (!near.comparable) continue;
      static_cast<MotionRates&>(rates[p]) = motion_rates(near, motion);
      const auto side = [&](std::size_t s) {
        return frf_equations(rates[p].sides[s], near.rigs[s].state, near.rigs[s].scene);
      };
      const FrfEquations low = side(0), high = side(1);
      const double width = near.step.width();
      rates[p].damping = rate_of(low.damping, high.damping, width);
      rates[p].sensors = (high.sensors - low.sensors) / width;
      rates[p].loads = (high.loads - low.loads) / width;
      if (modal) damper_rates(equations, *shapes, state, scene, near, rates[p]);
    }

    MatrixXd right = equations.loads;
    if (!wanted.empty()) {
      right.conservativeResize(Eigen::NoChange, loads + sensors);
      right.rightCols(sensors) = equations.sensors;
    }
    const double highest = lines > 0 ? frequency_hz.maxCoeff() : 0;
    FrfSolver solver(equations, right, std::abs(laplace_variable(highest, decay_rate_1_s)));
    const VectorXd gain =
        2 * equations.zeta.cwiseProduct(motion.omega2.head(equations.zeta.size()).cwiseSqrt());
    for (std::size_t line = 0; line < lines; ++line) {
      const Complex laplace = laplace_variable(frequency_hz[Index(line)], decay_rate_1_s);
      const MatrixXcd& solution = solver.solve(laplace);
      const MatrixXcd u = solution.leftCols(loads);
      const MatrixXcd v = solution.rightCols(solution.cols() - loads);
      VectorXcd factor(sensors);
      for (Index s = 0; s < sensors; ++s) {
        factor[s] = quantity_factor(scene.sensors[std::size_t(s)].quantity, laplace);
      }
      out.frfs.H[line] += factor.asDiagonal() * (equations.sensors.transpose() * u);
      for (std::size_t p = 0; p < wanted.size(); ++p) {
        if (!neighbours[p].comparable) continue;
        const EquationRates& r = rates[p];
        MatrixXcd h = r.sensors.transpose() * u + v.transpose() * r.loads;
        add_form(r.stiffness, -1.0, v, u, h);
        add_form(r.mass, -laplace * laplace, v, u, h);
        add_form(r.damping, -laplace, v, u, h);
        if (modal && laplace != Complex(0)) {
          const MatrixXcd mu = equations.dampers.transpose() * u;
          const MatrixXcd mv = equations.dampers.transpose() * v;
          const MatrixXcd nu = gain.asDiagonal() * (r.normal.transpose() * u);
          const MatrixXcd nv = gain.asDiagonal() * (r.normal.transpose() * v);
          h -= laplace * (mv.transpose() * (r.pair * mu + nu) + nv.transpose() * mu);
        }
        out.rate[p][line] += factor.asDiagonal() * h;
      }
    }
  }
  return out;
}

SynthesizedFrfs synthesize_frfs(const Scene& scene, const VectorXd& frequency_hz,
                                const ModesOptions& options, double decay_rate_1_s) {
  return synthesize_frf_sensitivities(scene, frequency_hz, {}, options, decay_rate_1_s).frfs;
}

}  // namespace rigfit::model
