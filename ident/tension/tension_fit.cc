#include "ident/tension/tension_posterior.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

namespace rigfit::ident {
namespace {

constexpr double kFar = std::numeric_limits<double>::infinity();
constexpr double kFloor = 1e-14;      // least variance of ln f: frequencies without an uncertainty
constexpr double kSlopeStep = 1e-5;   // in ln of an unknown
constexpr double kSlopeReach = 0.02;  // in ln T: how far slopes serve
constexpr double kLongWay = 2.5;      // in ln T
constexpr double kHopeless = 40;      // in ln of a weight

bool differ_in_ln(double a, double b, double reach) {
  return a != b && !(a > 0 && b > 0 && std::abs(std::log(a / b)) < reach);
}

}  // namespace

double ln_prior_of_model_std(std::size_t index, bool stated) {
  if (!stated) return index == 0 ? -kFar : std::log(0.2);
  return index == 0 ? std::log(0.95) : std::log(0.01);
}

TensionFit::TensionFit(const CableModel& model, const TensionData& data,
                       const std::vector<AssignedMode>& modes, bool springs)
    : model_(model), data_(data), modes_(modes), inputs_(uncertain_inputs(model.cable(), springs)) {
  for (const auto& mode : modes) {
    count_ = std::max(count_, mode.order + 1);
    pairs_ += mode.order >= 0;
  }
  variance_.resize(pairs_);
  Eigen::Index row = 0;
  for (std::size_t i = 0; i < modes.size(); ++i) {
    if (modes[i].order >= 0) variance_[row++] = data.variance[i];
  }
}

CableState TensionFit::at(const Eigen::VectorXd& unknowns) const {
  CableState state = state_of(model_.cable(), shape_, std::exp(unknowns[0]));
  for (std::size_t j = 0; j < inputs_.size(); ++j) {
    state.*inputs_[j].factor =
        std::exp(inputs_[j].std * unknowns[static_cast<Eigen::Index>(j) + 1]);
  }
  state.EI_Nm2 *= state.EI;
  state.spring_Nm_rad *= state.spring;
  return state;
}

CableState TensionFit::state() const { return at(unknowns_); }

void TensionFit::residuals(const Eigen::VectorXd& unknowns, Eigen::VectorXd& values) {
  const auto modelled = model_.frequencies(at(unknowns), count_, kFar, &roots_);
  values.resize(pairs_);
  Eigen::Index row = 0;
  for (std::size_t i = 0; i < modes_.size(); ++i) {
    if (modes_[i].order < 0) continue;
    const auto& list = modes_[i].plane == model::ModePlane::in ? modelled.in_hz : modelled.out_hz;
    values[row++] = data_.ln_hz[i] - std::log(list[static_cast<std::size_t>(modes_[i].order)]);
  }
}

void TensionFit::slopes() {
  const auto here = at(unknowns_);
  // Those of a neighbouring cell serve.
  if (slope_at_.size() == unknowns_.size() &&
      std::abs(unknowns_[0] - slope_at_[0]) <= kSlopeReach &&
      (unknowns_ - slope_at_).tail(unknowns_.size() - 1).squaredNorm() < 0.25 &&
      !differ_in_ln(here.EI_Nm2, slope_state_.EI_Nm2, 0.1) &&
      !differ_in_ln(here.spring_Nm_rad, slope_state_.spring_Nm_rad, 0.2)) {
    return;
  }
  slope_.resize(pairs_, unknowns_.size());
  Eigen::VectorXd moved = unknowns_, stepped;
  const double last_step = std::exchange(roots_.last_step, 1);
  for (Eigen::Index j = 0; j < unknowns_.size(); ++j) {
    const double scale = j == 0 ? 1 : inputs_[static_cast<std::size_t>(j) - 1].std;
    moved[j] += kSlopeStep / scale;
    residuals(moved, stepped);
    moved[j] = unknowns_[j];
    slope_.col(j) = (residual_ - stepped) / (kSlopeStep / scale);
  }
  roots_.last_step = last_step;
  slope_at_ = unknowns_;
  slope_state_ = here;
}

TensionFit::Normal TensionFit::normal(double model_variance) const {
  const Eigen::ArrayXd v = variance_.array() + std::max(model_variance, kFloor);
  const Eigen::VectorXd w = v.inverse();
  Normal one;
  one.H = slope_.transpose() * w.asDiagonal() * slope_;
  one.gradient = slope_.transpose() * w.cwiseProduct(residual_);
  one.squares = residual_.dot(w.cwiseProduct(residual_));
  const auto z = unknowns_.tail(unknowns_.size() - 1);
  one.H.diagonal().tail(z.size()).array() += 1;
  one.gradient.tail(z.size()) -= z;
  one.squares += z.squaredNorm();
  one.ln_density = -0.5 * (2 * std::numbers::pi * v).log().sum();
  return one;
}

bool TensionFit::converge(double model_variance, int steps) {
  const double start = unknowns_[0];
  for (int i = 0; i < steps; ++i) {
    residuals(unknowns_, residual_);
    if (!residual_.allFinite()) return false;
    slopes();
    const auto one = normal(model_variance);
    if (!(one.H(0, 0) > 0)) return false;
    Eigen::VectorXd change = one.H.ldlt().solve(one.gradient);
    if (!change.allFinite()) return false;
    // No further than a factor of e in the tension, two standard uncertainties in an input.
    change /= std::max({1.0, std::abs(change[0]), change.tail(change.size() - 1).norm() / 2});
    if (std::abs(change[0]) < 1e-5 && change.tail(change.size() - 1).norm() < 1e-2) {
      return true;  // the cells take the rest of the way
    }
    unknowns_ += change;
    if (std::abs(unknowns_[0] - start) > kLongWay) return false;  // no tension fits
  }
  return false;
}

bool TensionFit::fit(const CableState& start, const CableShape& shape) {
  shape_ = shape;
  unknowns_.resize(static_cast<Eigen::Index>(inputs_.size()) + 1);
  unknowns_[0] = std::log(start.tension_N);
  const auto base = state_of(model_.cable(), shape, start.tension_N);
  CableState factors = start;  // the same EI and springs over another centre
  if (base.EI_Nm2 > 0) factors.EI = start.EI_Nm2 / base.EI_Nm2;
  if (base.spring_Nm_rad > 0) factors.spring = start.spring_Nm_rad / base.spring_Nm_rad;
  for (std::size_t j = 0; j < inputs_.size(); ++j) {
    unknowns_[static_cast<Eigen::Index>(j) + 1] =
        std::log(factors.*inputs_[j].factor) / inputs_[j].std;
  }
  // With the largest t: a misfit then does not drive the inputs off.
  return converge(kModelStd.back() * kModelStd.back(), 15);
}

void TensionFit::add_cells(double ln_prior, std::vector<TensionCell>& cells) {
  if (unknowns_.tail(unknowns_.size() - 1).squaredNorm() > 2 * kHopeless) return;
  double heaviest = -kFar;
  for (std::size_t t = kModelStd.size(); t-- > 0;) {
    const double prior = ln_prior_of_model_std(t, data_.stated);
    if (!std::isfinite(prior)) continue;
    const double extra = kModelStd[t] * kModelStd[t];
    Normal one;
    Eigen::LDLT<Eigen::MatrixXd> factor;
    Eigen::VectorXd change;
    const auto solve = [&] {
      one = normal(extra);
      factor.compute(one.H);
      change = factor.solve(one.gradient);
    };
    solve();
    // Beyond what is linear: a fit with these weights.
    if (!(std::abs(change[0]) < 1e-3 && change.tail(change.size() - 1).norm() < 0.1)) {
      if (!converge(extra, 8)) break;
      solve();
    }
    if (!change.allFinite()) break;
    TensionCell cell;
    cell.shape = shape_;
    const Eigen::VectorXd found = unknowns_ + change, left = residual_ - slope_ * change;
    const Eigen::ArrayXd v = variance_.array() + std::max(extra, kFloor);
    // The column of the covariance, and by how much every frequency moves ln T.
    const Eigen::VectorXd of_tension = factor.solve(Eigen::VectorXd::Unit(found.size(), 0));
    const Eigen::ArrayXd gain = (slope_ * of_tension).array() / v;
    cell.ln_tension = found[0];
    cell.state = at(found);
    cell.variance_frequency = (gain.square() * variance_.array()).sum();
    cell.variance_model = extra * gain.square().sum();
    double chi2 = 0;
    for (std::size_t j = 0; j < inputs_.size(); ++j) {
      const double part = of_tension[static_cast<Eigen::Index>(j) + 1];
      cell.variance_input[inputs_[j].index] = part * part;
      const auto column = Eigen::VectorXd::Unit(found.size(), static_cast<Eigen::Index>(j) + 1);
      cell.variance_ln[inputs_[j].index] =
          inputs_[j].std * inputs_[j].std * column.dot(factor.solve(column));
      if (inputs_[j].measured) chi2 += std::pow(found[static_cast<Eigen::Index>(j) + 1], 2);
    }
    for (Eigen::Index k = 0; k < left.size(); ++k) {
      if (variance_[k] > 0) chi2 += left[k] * left[k] / variance_[k];
    }
    cell.model_std = kModelStd[t];
    cell.chi2_stated = data_.stated ? chi2 : std::numeric_limits<double>::quiet_NaN();
    cell.ln_weight =
        ln_prior + prior + one.ln_density - 0.5 * (one.squares - one.gradient.dot(change)) +
        0.5 * std::log(2 * std::numbers::pi) - 0.5 * factor.vectorD().array().abs().log().sum();
    cells.push_back(cell);
    heaviest = std::max(heaviest, cell.ln_weight);
    if (cell.ln_weight < heaviest - kHopeless) break;  // a misfit: smaller t weigh even less
  }
}

}  // namespace rigfit::ident
