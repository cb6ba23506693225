// What a fit takes as exact, and what 1 % of it changes.
#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "ident/update/uncertainty/update_uncertainty.h"
#include "signal/numerics/numbers.h"

namespace rigfit::ident {
namespace {

constexpr double kChange = 1e-2;  // relative

// A number of the scenes by the name that a reader knows, with its scene parameters by state.
struct Exact {
  std::string name;
  std::vector<std::pair<int, FreeParameter>> by_state;  // value 1, factors: the parameters' values
};

class ExactNumbers {
 public:
  explicit ExactNumbers(const UpdateProblem& problem) : problem_(problem) {
    for (int s = 0; s < static_cast<int>(problem.states().size()); ++s) {
      if (problem.takes_part(s)) add_state(s);
    }
  }
  [[nodiscard]] std::vector<Exact> take() { return std::move(all_); }
  [[nodiscard]] std::vector<std::string> take_ends() { return std::move(ends_); }

 private:
  void add_state(int state) {
    const auto& scene = problem_.states()[static_cast<std::size_t>(state)].scene;
    for (const auto& node : scene.nodes) {
      for (const char* axis : {".x", ".y", ".z"}) add(state, "lengths", node.name + axis);
    }
    for (const auto& member : scene.members) {
      const std::string& n = member.name;
      add(state, n + ".mass_per_length", n + ".mass_per_length");
      if (member.tension) add(state, n + ".tension", n + ".tension");
      if (member.unstretched_length) {
        add(state, n + ".unstretched_length", n + ".unstretched_length");
      }
      add(state, n + ".EA", n + ".EA");
      add_stiffness(state, member);
      for (std::size_t k = 0; k < member.masses.size(); ++k) {
        const std::string mass = n + ".masses" + std::to_string(k + 1) + ".mass";
        add(state, mass, mass);
      }
    }
    for (const auto& node : scene.nodes) {
      add(state, node.name + ".mass", node.name + ".mass");
      add_end(state, node);
    }
  }

  void add_end(int state, const model::SceneNode& node) {
    using Kind = model::Support::Kind;
    const Kind kind = node.support.kind;
    if (kind != Kind::pinned && kind != Kind::clamped && kind != Kind::elastic) return;
    for (const char* axis : {"x", "y", "z"}) {
      if (problem_.is_stated(state, node.name + ".rotational_" + axis)) return;
    }
    const std::string end = node.name + (kind == Kind::pinned    ? " (pinned)"
                                         : kind == Kind::clamped ? " (clamped)"
                                                                 : " (springs)");
    if (std::find(ends_.begin(), ends_.end(), end) == ends_.end()) ends_.push_back(end);
  }

  void add_stiffness(int state, const model::Member& member) {
    const std::string both = member.name + ".EI", in = both + "_z", out = both + "_y";
    if (problem_.is_stated(state, both)) return;
    if (member.EI[0] == member.EI[1] && !problem_.is_stated(state, in) &&
        !problem_.is_stated(state, out)) {
      add(state, both, both);
      return;
    }
    add(state, in, in);
    add(state, out, out);
  }

  void add(int state, const std::string& name, const std::string& target) {
    const double value =
        model::parameter(problem_.states()[static_cast<std::size_t>(state)].scene, target);
    if (value == 0 || !std::isfinite(value) || problem_.is_stated(state, target)) return;
    auto one = std::find_if(all_.begin(), all_.end(),
                            [&](const Exact& other) { return other.name == name; });
    if (one == all_.end()) one = all_.insert(all_.end(), Exact{name, {}});
    if (one->by_state.empty() || one->by_state.back().first != state) {
      one->by_state.emplace_back(state, FreeParameter{.name = name});
    }
    auto& parameter = one->by_state.back().second;
    parameter.targets.push_back(target);
    parameter.factors.push_back(value);
  }

  const UpdateProblem& problem_;
  std::vector<Exact> all_;
  std::vector<std::string> ends_;
};

}  // namespace

void state_exact_inputs(const UpdateProblem& problem, const UpdateOptions& options,
                        const std::vector<UpdateMatch>& matches, UpdateResult& result) {
  ExactNumbers numbers(problem);
  const auto exact = numbers.take();
  result.exact_ends = numbers.take_ends();
  const Eigen::Index n = problem.size(), count = problem.parameter_count();
  result.exact_inputs.clear();
  std::vector<std::pair<int, FreeParameter>> scaled;
  for (const auto& one : exact) {
    result.exact_inputs.push_back(
        {one.name, kChange, Eigen::VectorXd::Constant(count, signal::kNaN)});
    scaled.insert(scaled.end(), one.by_state.begin(), one.by_state.end());
  }
  if (exact.empty() || result.identifiability.std.size() != n) return;
  const UpdateProblem wide = problem.with_scaled(scaled);
  Eigen::VectorXd q = Eigen::VectorXd::Zero(wide.size()), r;  // ln 1
  q.head(n) = result.coordinates;
  Eigen::MatrixXd J;
  if (!wide.residuals(q, matches, r, &J)) return;
  J = residual_weights(problem, options, r, result.variance_factor).asDiagonal() * J;
  IdentifiabilityOptions limits;
  limits.relative_rank_tolerance = kRankTolerance;
  Eigen::Index column = n;
  for (std::size_t k = 0; k < exact.size(); ++k) {
    Eigen::VectorXd change = Eigen::VectorXd::Zero(r.size());
    for (std::size_t s = 0; s < exact[k].by_state.size(); ++s) change += kChange * J.col(column++);
    const Eigen::VectorXd shift = result.identifiability.shift_by(J.leftCols(n), change, limits);
    for (Eigen::Index j = 0; j < count; ++j) {
      const auto& coordinate = problem.coordinates()[static_cast<std::size_t>(j)];
      if (!result.parameters[static_cast<std::size_t>(j)].identifiable) continue;
      result.exact_inputs[k].shift[j] = coordinate.derivative(q[j]) * shift[j];
    }
  }
}

}  // namespace rigfit::ident
