#include "model/frfs/frf_synthesis.h"

#include <Eigen/LU>

#include "model/linear/damped_modes.h"
#include "model/linear/perturbed_equilibrium.h"
#include "model/linear/segment_extrapolation.h"
#include "model/scene/sensor_quantity.h"

// The damped equations of one motion at a line, with its loads, sensors and modal dampers:
//
//   D = K + s C + s^2 M + s sum_r g_r (M phi_r)(M phi_r)',  g_r = 2 zeta_r omega_r,
//
// s = i omega + a, a the decay rate of an exponential window shared by force and response (0:
// none); the sum (modal damping ratios) over the modes the motion carries. Without joint dampers
// these modes answer each for itself, by 1 / (s^2 + s g_r + omega_r^2), and what lies outside of
// them without damping,
//   (K + s^2 M)^-1 b = sum_k (-s^2)^k (K^-1 M)^k K^-1 b,
// which converges by (|s| / omega)^2 a term, omega the first mode that is not carried: twice the
// highest line, so that some 25 vectors serve all lines in place of a factorisation each. With
// joint dampers the sum is inverted by Woodbury's formula, line by line.

namespace rigfit::model {
namespace {

/// i omega + a of a line, 1/s.
Complex laplace_variable(double frequency_hz, double decay_rate_1_s) {
  return {decay_rate_1_s, 2 * M_PI * frequency_hz};
}

/// From displacement (or force) to a sensor's quantity.
Complex quantity_factor(Sensor::Quantity quantity, Complex s) {
  const int derivatives = described(quantity).derivatives;
  return derivatives == 0 ? Complex(1) : derivatives == 1 ? s : s * s;
}

struct FrfEquations {
  const MotionModes* motion = nullptr;
  EnvelopeMatrix damping;   ///< joint dampers
  MatrixXd sensors, loads;  ///< unknowns x sensors, unknowns x loads
  MatrixXd dampers;         ///< M phi_r: unknowns x modes; empty without modal ratios
  VectorXd zeta;            ///< modal ratio of each damper
};

/// `motion` must outlive the result.
FrfEquations frf_equations(const MotionModes& motion, const ChainState& state, const Scene& scene) {
  FrfEquations out;
  out.motion = &motion;
  out.damping = motion.assembly->matrix();
  motion.assembly->damping(state, out.damping);
  out.sensors = sensor_rows(*motion.assembly, state, scene);
  out.loads = load_rows(*motion.assembly);
  out.dampers.resize(out.loads.rows(), 0);
  if (motion.omega2.size() > 0) {
    out.zeta = modal_ratios(*motion.assembly, motion.shapes, state, scene);
    out.dampers = motion.mass * motion.shapes;
  }
  return out;
}

/// Real parts above imaginary parts.
Map<Eigen::Matrix2Xd> real_rows(Ref<VectorXcd> x) {
  return {reinterpret_cast<double*>(x.data()), 2, x.size()};
}

/// D^-1 of given right sides, line by line.
class FrfSolver {
 public:
  /// `farthest`: the largest |s|.
  FrfSolver(const FrfEquations& equations, const MatrixXd& right, double farthest)
      : equations_(equations),
        wanted_(right.cols()),
        joint_(!equations.damping.values().isZero(0)),
        dynamic_(equations.motion->stiffness.envelope()),
        gain_(equations.zeta.size()) {
    const Index dampers = equations.zeta.size();
    right_.resize(right.rows(), wanted_ + dampers);
    right_.leftCols(wanted_) = right.cast<Complex>();
    right_.rightCols(dampers) = equations.dampers.cast<Complex>();
    solution_.resize(right.rows(), wanted_);
    if (dampers == 0 || joint_) return;
    modal_ = equations.motion->shapes.transpose() * right;
    expand(right - equations.dampers * modal_, farthest);
  }

  /// unknowns x right sides; valid until the next call.
  [[nodiscard]] const MatrixXcd& solve(Complex s) {
    const MotionModes& motion = *equations_.motion;
    for (Index r = 0; r < gain_.size(); ++r) {
      gain_[r] = 2 * equations_.zeta[r] * std::sqrt(motion.omega2[r]) * s;
    }
    if (basis_.empty()) {
      solve_jointly(s);
    } else {
      solve_by_modes(s);
    }
    return solution_;
  }

 private:
  /// The vectors of the series; none where it does not converge.
  void expand(const MatrixXd& outside, double farthest) {
    const MotionModes& motion = *equations_.motion;
    EnvelopeFactor stiffness;
    stiffness.factor(motion.stiffness);
    std::vector<MatrixXd> terms;
    double size = 1, first = 0;
    while (size > 1e-14 * first) {
      const auto k = terms.size();
      if (k == 64) return;
      MatrixXd term = k > 0 ? motion.mass * terms.back() : outside;
      stiffness.solve_in_place(term);
      // Rounding along the modes, which would grow by (|s| / omega_r)^2 a term, is taken out.
      term -= motion.shapes * (equations_.dampers.transpose() * term);
      size = term.norm() * std::pow(farthest, 2 * static_cast<double>(k));
      if (k == 0) first = size;
      terms.push_back(std::move(term));
    }
    const auto count = std::ssize(terms);
    parts_.resize(count + gain_.size());
    for (Index c = 0; c < wanted_; ++c) {
      auto& basis = basis_.emplace_back(parts_.size(), outside.rows());
      for (Index k = 0; k < count; ++k) {
        basis.row(k) = terms[static_cast<std::size_t>(k)].col(c).transpose();
      }
      basis.bottomRows(gain_.size()) = motion.shapes.transpose();
    }
  }

  void solve_jointly(Complex s) {
    const MotionModes& motion = *equations_.motion;
    dynamic_.values() = motion.stiffness.values().cast<Complex>() + s * s * motion.mass.values();
    if (joint_) dynamic_.values() += s * equations_.damping.values();
    factor_.factor(dynamic_);
    MatrixXcd all = right_;
    factor_.solve_in_place(all);
    solution_ = all.leftCols(wanted_);
    const Index dampers = gain_.size();
    if (dampers == 0 || s == Complex(0)) return;
    // (D + B G B')^-1 = D^-1 - D^-1 B (I + G B' D^-1 B)^-1 G B' D^-1.
    const auto b = right_.rightCols(dampers);
    const auto db = all.rightCols(dampers);
    small_ = gain_.asDiagonal() * (b.transpose() * db);
    small_.diagonal().array() += Complex(1);
    const MatrixXcd part = gain_.asDiagonal() * (b.transpose() * solution_);
    solution_ -= db * small_.partialPivLu().solve(part);
  }

  void solve_by_modes(Complex s) {
    const auto dampers = gain_.size();
    parts_[0] = 1;
    for (Index k = 1; k < parts_.size() - dampers; ++k) parts_[k] = -s * s * parts_[k - 1];
    for (Index c = 0; c < wanted_; ++c) {
      for (Index r = 0; r < dampers; ++r) {
        parts_.tail(dampers)[r] = modal_(r, c) / (equations_.motion->omega2[r] + s * s + gain_[r]);
      }
      real_rows(solution_.col(c)).noalias() =
          real_rows(parts_) * basis_[static_cast<std::size_t>(c)];
    }
  }

  const FrfEquations& equations_;
  Index wanted_;
  bool joint_;  ///< there are joint dampers
  MatrixXcd right_, solution_, small_;
  ComplexEnvelopeMatrix dynamic_;
  ComplexEnvelopeFactor factor_;
  VectorXcd gain_;
  MatrixXd modal_;  ///< the right sides' part along the damped modes
  /// By right side: the series' vectors, by power of -s^2, and the modes' shapes, row by row.
  std::vector<MatrixXd> basis_;
  VectorXcd parts_;  ///< their factors at a line
};

/// The rig at rest with what its FRFs at these lines need: its motions' matrices and, where a
/// member has a modal damping ratio, all modes up to twice the highest line.
ChainModes frf_modes(const Scene& scene, const VectorXd& frequency_hz,
                     const ModesOptions& options) {
  ModesOptions wanted = options;
  const bool ratios = std::any_of(scene.members.begin(), scene.members.end(),
                                  [](const Member& m) { return m.damping_ratio.value_or(0) > 0; });
  const double highest = frequency_hz.size() > 0 ? frequency_hz.maxCoeff() : 0;
  wanted.band_hz = {0.0, 2 * highest};
  std::vector<int> segments;
  bool choose = false;
  for (const Member& member : scene.members) {
    segments.push_back(options.segments ? *options.segments : member.segments);
    choose = choose || segments.back() <= 0;
  }
  if (choose && highest > 0) {
    ModesOptions asked = options;
    asked.band_hz = {0.0, highest};
    const ResolvedModes choice = choose_segments(scene, asked);
    // Without a mode among the lines there is nothing to choose by: the default.
    if (!choice.modes.order.empty()) segments = choice.modes.chain->segment_counts();
  }
  return ratios && highest > 0 ? find_modes(scene, wanted, segments)
                               : prepare_motions(scene, wanted, segments);
}

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
