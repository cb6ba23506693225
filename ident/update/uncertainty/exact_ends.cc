#include "ident/update/uncertainty/exact_ends.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <string>

#include "ident/update/problem/update_solver.h"
#include "ident/update/uncertainty/update_uncertainty.h"
#include "signal/numerics/numbers.h"

namespace rigfit::ident {
namespace {

using Kind = model::Support::Kind;
constexpr double kLeast = 1e-3, kMost = 1 - 1e-3;  // range of the fixity
constexpr double kMatters = 1;  // standard uncertainties, to first order, from which it is fitted

// Springs that one fixity holds: their scene parameters with what is half way.
struct Springs {
  ExactEnds ends;
  FreeParameter parameter;
  double start = 0;                  // fixity as it is taken
  std::vector<model::Scene> scenes;  // with springs, by state
};

const char* name_of(Kind kind) {
  return kind == Kind::pinned ? "pinned" : kind == Kind::clamped ? "clamped" : "springs";
}

// Turns the node's support into springs and lists them; false where it has none to be freed.
bool free_node(const UpdateProblem& problem, int state, model::SceneNode& node, Springs& springs) {
  const auto& scene = springs.scenes[static_cast<std::size_t>(state)];
  const EndMember end = member_at(scene, node.name);
  if (end.member == nullptr) return false;
  const bool given = node.support.kind == Kind::elastic;
  constexpr double kFixed = std::numeric_limits<double>::infinity();
  bool any = false;
  model::Support support = node.support;
  if (!given) {
    support.kind = Kind::elastic;
    support.translational.setConstant(kFixed);
    support.rotational.setConstant(kFixed);
  }
  for (Eigen::Index i = 2; i >= 0; --i) {  // bending in the plane first
    if (i == end.axis) continue;
    const std::string target = node.name + ".rotational_" + "xyz"[i];
    const double own = node.support.rotational[i];
    if (given && (!(own > 0) || !std::isfinite(own) || problem.is_stated(state, target))) continue;
    const double half = given ? own : end.half_held(i);
    auto& targets = springs.parameter.targets;
    auto at = std::find(targets.begin(), targets.end(), target);
    if (at == targets.end()) {
      targets.push_back(target);
      springs.parameter.factors.push_back(half);
      at = targets.end() - 1;
    }
    const double factor = springs.parameter.factor(static_cast<std::size_t>(at - targets.begin()));
    support.rotational[i] = factor * springs.start / (1 - springs.start);
    any = true;
  }
  if (any) node.support = support;
  return any;
}

std::optional<Springs> springs_of(const UpdateProblem& problem, Kind kind,
                                  const Eigen::VectorXd& q) {
  Springs springs;
  springs.start = kind == Kind::pinned ? kLeast : kind == Kind::clamped ? kMost : 0.5;
  springs.ends.taken_as = name_of(kind);
  springs.parameter.name = "springs at the ends";
  for (int s = 0; s < static_cast<int>(problem.states().size()); ++s) {
    springs.scenes.push_back(problem.states()[static_cast<std::size_t>(s)].scene);
    if (!problem.takes_part(s)) continue;
    const model::Scene fitted = problem.scene_at(s, q);
    auto& scene = springs.scenes.back();
    for (std::size_t k = 0; k < scene.members.size(); ++k) {  // what is half way is the answer's
      scene.members[k].EI = fitted.members[k].EI;
      scene.members[k].tension = fitted.members[k].tension;
    }
    for (auto& node : scene.nodes) {
      auto& names = springs.ends.nodes;
      if (node.support.kind != kind || !free_node(problem, s, node, springs)) continue;
      if (std::find(names.begin(), names.end(), node.name) == names.end()) {
        names.push_back(node.name);
      }
    }
  }
  if (springs.parameter.targets.empty()) return std::nullopt;
  return springs;
}

// Answers beside a point of the problem with springs, to first order in the fixity.
struct NearPoint {
  Eigen::VectorXd q, slope;   // the point; of the other coordinates by the fixity
  double best = 0, half = 0;  // fixity that the data want, half its 95 % interval

  [[nodiscard]] double limited(double fixity) const { return std::clamp(fixity, kLeast, kMost); }
  [[nodiscard]] Eigen::VectorXd with(double fixity) const {
    return q.head(slope.size()) + (limited(fixity) - q[slope.size()]) * slope;
  }
};

std::optional<NearPoint> near(const UpdateProblem& wide, const UpdateProblem& problem,
                              const UpdateOptions& options, const std::vector<UpdateMatch>& matches,
                              const UpdateResult& result, const Eigen::VectorXd& q) {
  const Eigen::Index n = problem.size();
  Eigen::VectorXd r;
  Eigen::MatrixXd J;
  if (!wide.residuals(q, matches, UpdateStage::full, r, &J)) return std::nullopt;
  const Eigen::VectorXd weights = huber_weights(wide, options, r);
  r = weights.cwiseProduct(r).eval();
  J = (weights.asDiagonal() * J).eval();
  IdentifiabilityOptions limits;
  limits.relative_rank_tolerance = kRankTolerance;
  limits.variance_factor = std::max(result.variance_factor, 1e-12);
  const auto known =
      identifiability(J.leftCols(n), result.identifiability.scales, problem.names(), limits);
  NearPoint point{q, known.shift_by(J.leftCols(n), J.col(n), limits), q[n], 0};
  const Eigen::VectorXd own = J.col(n) + J.leftCols(n) * point.slope;
  const double norm = own.norm();
  if (!(norm > 1e-9 * J.col(n).norm())) {  // the data say nothing of the ends, all are possible
    point.half = 1;
    return point;
  }
  point.best = point.limited(q[n] - own.dot(r) / (norm * norm));
  point.half = result.coverage_factor * std::sqrt(limits.variance_factor) / norm;
  return point;
}

class EndChanges {
 public:
  EndChanges(const UpdateProblem& problem, const UpdateResult& result)
      : problem_(problem), result_(result) {}

  // Changes of the parameters' values at q; NaN where they are not identifiable.
  [[nodiscard]] Eigen::VectorXd at(const Eigen::VectorXd& q) const {
    Eigen::VectorXd change(problem_.size());
    for (Eigen::Index j = 0; j < change.size(); ++j) {
      const auto& coordinate = problem_.coordinates()[static_cast<std::size_t>(j)];
      change[j] = result_.parameters[static_cast<std::size_t>(j)].identifiable
                      ? coordinate.value(std::clamp(q[j], coordinate.low, coordinate.high)) -
                            coordinate.value(result_.coordinates[j])
                      : signal::kNaN;
    }
    return change;
  }
  // Largest change of each parameter within the fixity's interval, to first order.
  [[nodiscard]] Eigen::VectorXd largest(const NearPoint& point) const {
    Eigen::VectorXd most = at(point.with(point.best));
    for (const double side : {-1.0, 1.0}) {
      const Eigen::VectorXd end = at(point.with(point.best + side * point.half));
      most = (end.array().abs() > most.array().abs()).select(end, most);
    }
    return most;
  }
  [[nodiscard]] bool matter(const Eigen::VectorXd& change) const {
    for (Eigen::Index j = 0; j < change.size(); ++j) {
      const double std = result_.parameters[static_cast<std::size_t>(j)].std;
      if (std::abs(change[j]) > kMatters * std) return true;
    }
    return false;
  }

 private:
  const UpdateProblem& problem_;
  const UpdateResult& result_;
};

double chi2_at(const UpdateProblem& problem, const std::vector<UpdateMatch>& matches,
               const Eigen::VectorXd& q) {
  Eigen::VectorXd r;
  return problem.with_model_std(0).residuals(q, matches, UpdateStage::full, r, nullptr)
             ? r.squaredNorm()
             : signal::kNaN;
}

// The fit with springs, from a fifth of the way inside; empty: it is no better than the answer.
std::optional<NearPoint> fitted_springs(const UpdateProblem& wide, const UpdateProblem& problem,
                                        const UpdateOptions& given,
                                        const std::vector<UpdateMatch>& matches,
                                        const UpdateResult& result, const NearPoint& from) {
  constexpr double kInside = 0.2;
  const Eigen::Index n = problem.size();
  UpdateOptions options = given;
  options.function_tolerance = std::max(given.function_tolerance, 1e-5);
  Eigen::VectorXd q(n + 1);
  q[n] = std::clamp(from.q[n], kInside, 1 - kInside);
  q.head(n) = from.with(q[n]);
  double cost = 0, least = 0;
  (void)minimise(wide, matches, UpdateStage::full, options, q, cost);
  if (!robust_cost(wide, matches, UpdateStage::full, options, from.q, least) ||
      !robust_cost(wide, matches, UpdateStage::full, options, q, cost) || !(cost < least)) {
    return std::nullopt;
  }
  auto fitted = near(wide, problem, options, matches, result, q);
  if (fitted) fitted->best = q[n];
  return fitted;
}

}  // namespace

void state_exact_ends(const UpdateProblem& problem, const UpdateOptions& options,
                      const std::vector<UpdateMatch>& matches, UpdateResult& result) {
  result.exact_ends.clear();
  const Eigen::Index n = problem.size();
  if (!options.exact_ends || !problem.modes_only() || result.identifiability.std.size() != n) {
    return;
  }
  const EndChanges changes(problem, result);
  for (const Kind kind : {Kind::pinned, Kind::clamped, Kind::elastic}) {
    auto springs = springs_of(problem, kind, result.coordinates);
    if (!springs) continue;
    UpdateCoordinate fixity;
    fixity.logarithmic = false, fixity.fixity = true;
    fixity.low = kLeast, fixity.high = kMost, fixity.start = springs->start;
    const UpdateProblem wide = problem.with_scenes(springs->scenes, springs->parameter, fixity);
    Eigen::VectorXd q(n + 1);
    q << result.coordinates, springs->start;
    auto point = near(wide, problem, options, matches, result, q);
    if (!point) continue;
    ExactEnds ends = std::move(springs->ends);
    ends.largest_shift = changes.largest(*point);
    if (changes.matter(ends.largest_shift)) {
      auto fitted = fitted_springs(wide, problem, options, matches, result, *point);
      if (fitted) {
        point = std::move(fitted);
      } else {
        point->best = springs->start;
      }
      ends.largest_shift = changes.largest(*point);
    }
    ends.shift = changes.at(point->with(point->best));
    ends.stiffness = springs->parameter.factor(0) * fixity.value(point->best);
    ends.chi2_less =
        chi2_at(problem, matches, result.coordinates) - chi2_at(wide, matches, point->q);
    result.exact_ends.push_back(std::move(ends));
  }
}

}  // namespace rigfit::ident
