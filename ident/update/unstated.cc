#include "ident/update/unstated.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <utility>

#include "ident/update/posterior.h"
#include "signal/numerics/numbers.h"

namespace rigfit::ident {
namespace {

using Kind = model::Support::Kind;
constexpr double kChange = 1e-2;  // relative

// Numbers of the scenes by the name that a reader knows, as inputs with their changes.
std::vector<UncertainInput> numbers_of(const Likelihood& likelihood) {
  std::vector<UncertainInput> all;
  const auto add = [&](int s, const std::string& name, const std::string& target) {
    const auto& scene = likelihood.states()[static_cast<std::size_t>(s)].scene;
    const double value = model::parameter(scene, target);
    if (value == 0 || !std::isfinite(value) || likelihood.is_stated(s, target)) return;
    auto one = std::find_if(all.begin(), all.end(),
                            [&](const UncertainInput& other) { return other.name == name; });
    if (one == all.end()) one = all.insert(all.end(), {name, {}});
    one->effects.push_back({s, target, kChange * value});
  };
  for (int s = 0; s < static_cast<int>(likelihood.states().size()); ++s) {
    if (!likelihood.takes_part(s)) continue;
    const auto& scene = likelihood.states()[static_cast<std::size_t>(s)].scene;
    for (const auto& node : scene.nodes) {
      for (const char* axis : {".x", ".y", ".z"}) add(s, "lengths", node.name + axis);
    }
    for (const auto& member : scene.members) {
      const std::string& n = member.name;
      std::vector<std::string> names{n + ".mass_per_length", n + ".EA"};
      if (member.tension) names.push_back(n + ".tension");
      if (member.unstretched_length) names.push_back(n + ".unstretched_length");
      const std::string both = n + ".EI", in = both + "_z", out = both + "_y";
      const bool one = member.EI[0] == member.EI[1] && !likelihood.is_stated(s, in) &&
                       !likelihood.is_stated(s, out);
      if (one) names.push_back(both);
      if (!one && !likelihood.is_stated(s, both)) names.insert(names.end(), {in, out});
      for (std::size_t k = 0; k < member.masses.size(); ++k) {
        names.push_back(fmt::format("{}.masses{}.mass", n, k + 1));
      }
      for (const auto& name : names) add(s, name, name);
    }
    for (const auto& node : scene.nodes) add(s, node.name + ".mass", node.name + ".mass");
  }
  return all;
}

// Point masses that the scenes lack, along every member; put into the likelihood's scenes as 0.
std::vector<UncertainInput> masses_of(Likelihood& likelihood) {
  std::vector<UncertainInput> all;
  for (std::size_t s = 0; s < likelihood.states().size(); ++s) {
    auto& scene = likelihood.states()[s].scene;
    for (auto& member : scene.members) {
      double length = 0;
      Eigen::Vector3d along = Eigen::Vector3d::Zero();
      for (const auto& node : scene.nodes) {
        if (node.name == member.nodes[0]) along -= node.position;
        if (node.name == member.nodes[1]) along += node.position;
      }
      length = along.norm();
      for (const double place : {0.05, 0.25, 0.5}) {
        const std::string name = fmt::format("mass at {:g} of {}", place, member.name);
        member.masses.push_back({place, 0});
        auto one = std::find_if(all.begin(), all.end(),
                                [&](const UncertainInput& other) { return other.name == name; });
        if (one == all.end()) one = all.insert(all.end(), {name, {}});
        one->effects.push_back({static_cast<int>(s),
                                fmt::format("{}.masses{}.mass", member.name, member.masses.size()),
                                kChange * member.mass_per_length * length});
      }
    }
  }
  return all;
}

// One fixity of all nodes of a kind, as an input: its change is that of the springs per unit of
// fixity half way between the end as it is and the other.
struct Ends {
  std::string name;
  double taken = 0, at = 0;  // fixity as the scenes say, and where the column is taken
  UncertainInput input;
};

std::optional<Ends> springs_of(Likelihood& likelihood, Kind kind, const Eigen::VectorXd& q) {
  constexpr double kFixed = std::numeric_limits<double>::infinity();
  Ends ends;
  ends.taken = kind == Kind::clamped ? 1 : kind == Kind::pinned ? 0 : 0.5;
  ends.at = kind == Kind::clamped ? 0.75 : kind == Kind::pinned ? 0.25 : 0.5;
  std::vector<std::string> nodes;
  for (int s = 0; s < static_cast<int>(likelihood.states().size()); ++s) {
    if (!likelihood.takes_part(s)) continue;
    const model::Scene fitted = likelihood.scene_at(s, q);
    auto& scene = likelihood.states()[static_cast<std::size_t>(s)].scene;
    for (auto& node : scene.nodes) {
      const EndMember end = member_at(fitted, node.name);
      if (node.support.kind != kind || end.member == nullptr) continue;
      auto& support = node.support;
      if (kind != Kind::elastic) {
        support.kind = Kind::elastic;
        support.translational.setConstant(kFixed);
        support.rotational.setConstant(kFixed);
      }
      for (Eigen::Index i = 0; i < 3; ++i) {
        const std::string target = node.name + ".rotational_" + "xyz"[i];
        const double own = support.rotational[i];
        const bool given = kind == Kind::elastic;
        if (i == end.axis || (given && (!(own > 0) || !std::isfinite(own)))) continue;
        if (given && likelihood.is_stated(s, target)) continue;
        const double half = given ? own : end.half_held(i);
        support.rotational[i] = half * ends.at / (1 - ends.at);
        ends.input.effects.push_back({s, target, half / std::pow(1 - ends.at, 2)});
        if (std::find(nodes.begin(), nodes.end(), node.name) == nodes.end()) {
          nodes.push_back(node.name);
        }
      }
    }
  }
  if (ends.input.effects.empty()) return std::nullopt;
  for (const auto& node : nodes) ends.name += (ends.name.empty() ? "" : ", ") + node;
  ends.name = "ends " + ends.name +
              (kind == Kind::pinned    ? " (pinned)"
               : kind == Kind::clamped ? " (clamped)"
                                       : " (springs)");
  return ends;
}

// The estimator of the parameters and further columns at the answer.
class FurtherColumns {
 public:
  FurtherColumns(const std::vector<UpdateMatch>& matches, const UpdateResult& result)
      : matches_(matches), result_(result) {
    limits_.variance_factor = std::max(result.variance_factor, 1e-12);
  }
  // With further inputs in `wide`: what one of each moves all fitted coordinates by, and the length
  // of what the data see of it beside them. False where there is no model.
  bool solve(const Likelihood& likelihood, Likelihood wide,
             const std::vector<UncertainInput>& inputs) {
    const Eigen::Index n = likelihood.size(), count = static_cast<Eigen::Index>(inputs.size());
    for (const auto& input : inputs) wide.add_input(input);
    Eigen::VectorXd q = Eigen::VectorXd::Zero(n + count);
    q.head(n) = result_.coordinates;
    Eigen::MatrixXd J;
    if (!wide.residuals(q, matches_, UpdateStage::full, r_, &J)) return false;
    const Eigen::VectorXd weights = huber_weights(wide, r_);
    const Eigen::Index rows = r_.size() - count;  // without the new inputs' priors
    r_ = (weights.cwiseProduct(r_)).head(rows).eval();
    J = (weights.asDiagonal() * J).topRows(rows).eval();
    const auto known =
        identifiability(J.leftCols(n), result_.joint.scales.head(n), likelihood.names(), limits_);
    if (known.directions.size() == 0) return false;
    slope.resize(n, count);
    for (Eigen::Index k = 0; k < count; ++k) {
      slope.col(k) = known.shift_by(J.leftCols(n), J.col(n + k), limits_);
    }
    seen = J.rightCols(count) + J.leftCols(n) * slope;
    return true;
  }
  [[nodiscard]] const Eigen::VectorXd& r() const { return r_; }
  Eigen::MatrixXd slope, seen;

 private:
  const std::vector<UpdateMatch>& matches_;
  const UpdateResult& result_;
  IdentifiabilityOptions limits_;
  Eigen::VectorXd r_;
};

}  // namespace

void state_exact_inputs(const Likelihood& likelihood, const std::vector<UpdateMatch>& matches,
                        UpdateResult& result) {
  const Eigen::Index n = likelihood.parameters();
  result.exact_inputs.clear();
  if (result.identifiability.std.size() != n) return;
  const auto add = [&](const std::string& name, double change, const Eigen::VectorXd& shift) {
    Eigen::VectorXd values(n);
    for (Eigen::Index j = 0; j < n; ++j) {
      const auto p = static_cast<std::size_t>(j);
      values[j] = result.parameters[p].identifiable
                      ? likelihood.coordinates()[p].derivative(result.coordinates[j]) * shift[j]
                      : signal::kNaN;
    }
    result.exact_inputs.push_back({name, change, std::move(values)});
  };
  FurtherColumns rows(matches, result);
  const auto list = [&](const Likelihood& wide, const std::vector<UncertainInput>& inputs) {
    if (inputs.empty() || !rows.solve(likelihood, wide, inputs)) return;
    for (std::size_t k = 0; k < inputs.size(); ++k) {
      add(inputs[k].name, kChange, rows.slope.col(static_cast<Eigen::Index>(k)));
    }
  };
  list(likelihood, numbers_of(likelihood));
  if (!likelihood.modes_only()) return;
  Likelihood wide = likelihood;
  const auto masses = masses_of(wide);
  list(wide, masses);
  for (const Kind kind : {Kind::pinned, Kind::clamped, Kind::elastic}) {
    Likelihood loose = likelihood;
    const auto ends = springs_of(loose, kind, result.coordinates);
    if (!ends || !rows.solve(likelihood, loose, {ends->input})) continue;
    // What the data leave of the fixity: at `at` residuals are r, at the scenes' own end those of
    // the fit.
    const double seen = rows.seen.col(0).norm();
    double low = 0, high = 1;
    if (seen > 1e-9 * rows.r().norm() && seen > 0) {
      const double best = ends->at - rows.seen.col(0).dot(rows.r()) / (seen * seen);
      const double half = result.coverage_factor * std::sqrt(result.variance_factor) / seen;
      low = std::clamp(best - half, 0.0, 1.0), high = std::clamp(best + half, 0.0, 1.0);
    }
    const double most = std::abs(high - ends->taken) > std::abs(low - ends->taken)
                            ? high - ends->taken
                            : low - ends->taken;
    add(ends->name, 0, most * rows.slope.col(0));
  }
}

}  // namespace rigfit::ident
