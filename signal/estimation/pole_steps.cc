#include "signal/estimation/pole_steps.h"

#include "signal/numerics/factorisations.h"

namespace rigfit::signal {
namespace {

constexpr double kMostDamping = 1e8;  // no downhill step is left: a minimum to rounding

/// Whether a part moves: it is not held, nor pressed against a bound.
bool moves(const PoleStage& stage, Index part, const PoleStepOptions& options) {
  const auto& pole = stage.poles[part / 2];
  const bool real = part % 2 == 0;
  const double at = real ? pole.real() : pole.imag(), pull = stage.gradient[part];
  return stage.information(part, part) > 0 &&
         !(pull > 0 && at >= (real ? options.slowest : options.high)) &&
         !(pull < 0 && at <= (real ? options.fastest : options.low));
}

}  // namespace

const char* name_of(StepsEnd end) {
  constexpr const char* kNames[] = {"converged", "iteration limit", "rank deficient"};
  return kNames[static_cast<std::size_t>(end)];
}

void PoleStage::set_analytic(const VectorXcd& complex_gradient,
                             const MatrixXcd& complex_information) {
  const Index n = complex_gradient.size();
  gradient.resize(2 * n);
  information.resize(2 * n, 2 * n);
  const auto real = Eigen::seqN(0, n, 2), imaginary = Eigen::seqN(1, n, 2);
  gradient(real) = complex_gradient.real(), gradient(imaginary) = complex_gradient.imag();
  information(real, real) = information(imaginary, imaginary) = complex_information.real();
  information(imaginary, real) = complex_information.imag();
  information(real, imaginary) = -complex_information.imag();
}

void PoleSteps::judge(bool better) {
  damping_ = better ? std::max(damping_ / 10, 1e-12) : std::max(damping_ * 10, 1e-6);
  if (gain_ <= options_.rounding || damping_ > kMostDamping) end_ = StepsEnd::converged;
}

bool PoleSteps::next(const PoleStage& stage, VectorXcd& poles) {
  const auto stop = [&](StepsEnd end) {
    end_ = end;
    return false;
  };
  if (end_ == StepsEnd::converged) return false;
  if (!stage.usable || stage.information.size() < 2 * stage.poles.size()) {
    return stop(StepsEnd::rank_deficient);
  }
  std::vector<Index> parts;
  for (Index k = 0; k < stage.gradient.size(); ++k) {
    if (moves(stage, k, options_)) parts.push_back(k);
  }
  if (parts.empty()) return stop(StepsEnd::converged);
  if (iterations_ == options_.max_iterations) return false;
  const VectorXd gradient = stage.gradient(parts);
  const MatrixXd plain = stage.information(parts, parts);
  MatrixXd damped = plain;
  damped.diagonal() *= 1 + damping_;
  const ScaledGram factor(damped);
  if (!ScaledGram(plain).usable() || !factor.usable()) return stop(StepsEnd::rank_deficient);
  const VectorXd delta = factor.solve_vector(gradient);
  if (!delta.allFinite()) return stop(StepsEnd::rank_deficient);
  gain_ = delta.dot(plain * delta);
  const double in_std = options_.step_in_std;
  if (gain_ <= in_std * in_std * stage.cost / options_.freedom) return stop(StepsEnd::converged);
  ++iterations_;
  VectorXd step = VectorXd::Zero(2 * stage.poles.size());
  step(parts) = delta;
  poles = stage.poles;
  for (Index r = 0; r < poles.size(); ++r) {
    const double reach = options_.resolution + 0.5 * std::abs(poles[r].real() - options_.undamped);
    const double share = std::min(1.0, reach / std::max(step.segment<2>(2 * r).norm(), 1e-300));
    poles[r] += share * std::complex(step[2 * r], step[2 * r + 1]);
  }
  for (const Index part : parts) {
    auto& pole = poles[part / 2];
    if (part % 2 == 0) {
      pole.real(std::clamp(pole.real(), options_.fastest, options_.slowest));
    } else {
      pole.imag(std::clamp(pole.imag(), options_.low, options_.high));
    }
  }
  return true;
}

}  // namespace rigfit::signal
