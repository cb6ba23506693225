#include "model/motion/node_mass.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <cmath>

#include "model/chain/index.h"

namespace rigfit::model {
template <int D>
NodeMass<D>::NodeMass(std::vector<Member> members, std::vector<Shared> shared, int entries)
    : members_(std::move(members)), shared_(std::move(shared)), entries_(entries) {
  plans_.resize(members_.size());
  for (std::size_t m = 0; m < members_.size(); ++m) plans_[m].plain = factor(members_[m], 0);
  first_free_.assign(shared_.size(), -1);
  for (std::size_t k = 0; k < shared_.size(); ++k) {
    for (int c = 0; c < D; ++c) {
      if (shared_[k].held[c]) continue;
      if (first_free_[k] < 0) first_free_[k] = static_cast<int>(free_.size());
      free_.push_back({static_cast<int>(k), c});
    }
  }
  force_.resize(free_.size());
  motion_.resize(free_.size());
  reduce();
}

template <int D>
typename NodeMass<D>::Inner NodeMass<D>::factor(const Member& member, double kappa) {
  const int n = member.segments;
  std::vector<double> diagonal = member.diagonal, off = member.off;
  for (int i = 0; kappa > 0 && i < n; ++i) {
    const double added = kappa * member.axial[at(i)];
    diagonal[at(i)] += added;
    diagonal[at(i + 1)] += added;
    off[at(i)] -= added;
  }
  Inner out;
  out.first_off = off.front();
  out.last_off = off.back();
  out.own_first = diagonal.front();
  out.own_last = diagonal.back();
  out.toward.assign(at(n + 1), 0);
  out.inverse.assign(at(n + 1), 0);
  out.from_first.assign(at(n + 1), 0);
  out.from_last.assign(at(n + 1), 0);
  if (n == 1) {
    out.both = off[0];
    return out;
  }
  const int k = out.middle = n / 2;
  for (int i = 1; i < k; ++i) {
    const double before = i > 1 ? off[at(i - 1)] * out.toward[at(i - 1)] : 0;
    out.inverse[at(i)] = 1 / (diagonal[at(i)] - before);
    out.toward[at(i)] = off[at(i)] * out.inverse[at(i)];
  }
  for (int i = n - 1; i > k; --i) {
    const double before = i < n - 1 ? off[at(i)] * out.toward[at(i)] : 0;
    out.inverse[at(i)] = 1 / (diagonal[at(i)] - before);
    out.toward[at(i - 1)] = off[at(i - 1)] * out.inverse[at(i)];
  }
  double pivot = diagonal[at(k)];
  if (k > 1) pivot -= off[at(k - 1)] * out.toward[at(k - 1)];
  if (k < n - 1) pivot -= off[at(k)] * out.toward[at(k)];
  out.inverse[at(k)] = 1 / pivot;
  out.from_first[1] = out.first_off;
  out.from_last[at(n - 1)] = out.last_off;
  solve_twisted(out.factors(n), out.from_first.data());
  solve_twisted(out.factors(n), out.from_last.data());
  out.own_first -= out.first_off * out.from_first[1];
  out.own_last -= out.last_off * out.from_last[at(n - 1)];
  out.both = -out.first_off * out.from_last[1];
  return out;
}

template <int D>
void NodeMass<D>::slow_axial(double kappa, const double* positions) {
  kappa_ = kappa;
  for (std::size_t m = 0; m < members_.size(); ++m) {
    Plan& plan = plans_[m];
    const Member& member = members_[m];
    plan.along = -1;
    plan.rotated = false;
    if (!(kappa > 0)) continue;
    plan.slowed = factor(member, kappa);
    Eigen::Matrix<double, D, 1> chord;
    for (int c = 0; c < D; ++c) {
      const double* x = positions + c * entries_ + member.offset;
      chord(c) = x[member.segments] - x[0];
    }
    chord.normalize();
    for (int c = 0; c < D; ++c) {
      if (std::abs(chord(c)) > 1 - 1e-12) plan.along = c;
    }
    if (plan.along >= 0) continue;
    plan.along = 0;
    plan.rotated = true;
    if constexpr (D == 2) {
      plan.axes << chord(0), -chord(1), chord(1), chord(0);
    } else {
      Eigen::Vector3d other = Eigen::Vector3d::Unit(std::abs(chord(2)) < 0.7 ? 2 : 0);
      other = (other - chord * chord.dot(other)).normalized();
      plan.axes << chord, other, chord.cross(other);
    }
  }
  reduce();
}

// The mass of the components of shared nodes that move, the inner nodes following them.
template <int D>
void NodeMass<D>::reduce() {
  const auto count = static_cast<Eigen::Index>(free_.size());
  std::vector<int> row(shared_.size() * D, -1);
  for (Eigen::Index i = 0; i < count; ++i) {
    const Free& f = free_[static_cast<std::size_t>(i)];
    row[at(f.node * D + f.component)] = static_cast<int>(i);
  }
  Eigen::MatrixXd mass = Eigen::MatrixXd::Zero(count, count);
  for (std::size_t m = 0; m < members_.size(); ++m) {
    const Plan& plan = plans_[m];
    Eigen::Matrix<double, D, D> block[3];
    for (int part = 0; part < 3; ++part) {
      const auto value = [&](const Inner& inner) {
        return part == 0 ? inner.own_first : part == 1 ? inner.own_last : inner.both;
      };
      block[part].setIdentity();
      block[part] *= value(plan.plain);
      if (plan.along < 0) continue;
      Eigen::Matrix<double, D, 1> axis = Eigen::Matrix<double, D, 1>::Unit(plan.along);
      if (plan.rotated) axis = plan.axes.col(0);
      block[part] += (value(plan.slowed) - value(plan.plain)) * axis * axis.transpose();
    }
    for (int c = 0; c < D; ++c) {
      for (int d = 0; d < D; ++d) {
        const int a = members_[m].shared[0], b = members_[m].shared[1];
        const auto add = [&](int i, int j, double value) {
          if (i >= 0 && j >= 0) mass(i, j) += value;
        };
        add(row[at(a * D + c)], row[at(a * D + d)], block[0](c, d));
        add(row[at(b * D + c)], row[at(b * D + d)], block[1](c, d));
        add(row[at(a * D + c)], row[at(b * D + d)], block[2](c, d));
        add(row[at(b * D + d)], row[at(a * D + c)], block[2](c, d));
      }
    }
  }
  inverse_ = mass.llt().solve(Eigen::MatrixXd::Identity(count, count));
}

template <int D>
void NodeMass<D>::rotate(const Plan& plan, const Member& member, bool back, double* values) const {
  Eigen::Matrix<double, D, D> turn = plan.axes;
  if (!back) turn.transposeInPlace();
  double* a[D];
  for (int c = 0; c < D; ++c) a[c] = values + c * entries_ + member.offset;
  for (int i = 1; i < member.segments; ++i) {
    Eigen::Matrix<double, D, 1> value;
    for (int c = 0; c < D; ++c) value(c) = a[c][i];
    value = turn * value;
    for (int c = 0; c < D; ++c) a[c][i] = value(c);
  }
}

template <int D>
void NodeMass<D>::solve(double* values) {
  for (std::size_t m = 0; m < members_.size(); ++m) {
    const Plan& plan = plans_[m];
    const Member& member = members_[m];
    if (member.segments < 2) continue;
    if (plan.rotated) rotate(plan, member, false, values);
    const TwistedFactors plain = plan.plain.factors(member.segments);
    const TwistedFactors slowed =
        plan.along >= 0 ? plan.slowed.factors(member.segments) : TwistedFactors{};
    const auto of = [&](int c) -> const TwistedFactors& {
      return c == plan.along ? slowed : plain;
    };
    double* x = values + member.offset;
    if constexpr (D == 2) {
      solve_twisted(of(0), of(1), x, x + entries_);
    } else {
      solve_twisted(of(0), of(1), of(2), x, x + entries_, x + 2 * entries_);
    }
  }

  // Forces on the free end nodes less what the inner nodes' accelerations take.
  for (std::size_t i = 0; i < free_.size(); ++i) {
    const Shared& node = shared_[at(free_[i].node)];
    force_[i] = values[free_[i].component * entries_ + node.entries[0]];
  }
  const auto count = static_cast<int>(free_.size());
  if (count > 0) {
    const auto coupling = [&](std::size_t m, int end) {
      const Plan& plan = plans_[m];
      const Member& member = members_[m];
      Eigen::Matrix<double, D, 1> pull;
      for (int c = 0; c < D; ++c) {
        const Inner& inner = c == plan.along ? plan.slowed : plan.plain;
        pull(c) = end == 0 ? inner.first_off : inner.last_off;
        pull(c) *= values[c * entries_ + member.offset + (end == 0 ? 1 : member.segments - 1)];
      }
      if (plan.rotated) pull = plan.axes * pull;
      return pull;
    };
    // The rows of a node follow each other by component, where they are free.
    for (std::size_t m = 0; m < members_.size(); ++m) {
      if (members_[m].segments < 2) continue;
      for (int end = 0; end < 2; ++end) {
        const int node = members_[m].shared[end];
        const int first = first_free_[at(node)];
        if (first < 0) continue;
        const Eigen::Matrix<double, D, 1> pull = coupling(m, end);
        for (int i = first; i < count && free_[at(i)].node == node; ++i) {
          force_[at(i)] -= pull(free_[at(i)].component);
        }
      }
    }
    for (int i = 0; i < count; ++i) motion_[at(i)] = 0;
    for (int j = 0; j < count; ++j) {
      add_multiple(count, motion_.data(), force_[at(j)],
                   inverse_.data() + static_cast<std::ptrdiff_t>(j) * count, motion_.data());
    }
  }
  for (const Shared& node : shared_) {
    for (int entry : node.entries) {
      for (int c = 0; c < D; ++c) values[c * entries_ + entry] = 0;
    }
  }
  for (int i = 0; i < count; ++i) {
    for (int entry : shared_[at(free_[at(i)].node)].entries) {
      values[free_[at(i)].component * entries_ + entry] = motion_[at(i)];
    }
  }

  // The inner nodes follow their ends.
  for (std::size_t m = 0; m < members_.size(); ++m) {
    const Plan& plan = plans_[m];
    const Member& member = members_[m];
    if (member.segments < 2) continue;
    for (int end = 0; count > 0 && end < 2; ++end) {
      if (first_free_[at(member.shared[end])] < 0) continue;
      Eigen::Matrix<double, D, 1> own;
      const int entry = member.offset + (end == 0 ? 0 : member.segments);
      for (int c = 0; c < D; ++c) own(c) = values[c * entries_ + entry];
      if (plan.rotated) own = plan.axes.transpose() * own;
      for (int c = 0; c < D; ++c) {
        const Inner& inner = c == plan.along ? plan.slowed : plan.plain;
        const std::vector<double>& from = end == 0 ? inner.from_first : inner.from_last;
        double* a = values + c * entries_ + member.offset + 1;
        add_multiple(member.segments - 1, a, -own(c), from.data() + 1, a);
      }
    }
    if (plan.rotated) rotate(plan, member, true, values);
  }
}

template <int D>
double NodeMass<D>::product(const double* x, const double* y) const {
  double sum = 0;
  for (const Member& member : members_) {
    for (int c = 0; c < D; ++c) {
      const double* a = x + c * entries_ + member.offset;
      const double* b = y + c * entries_ + member.offset;
      for (int i = 0; i <= member.segments; ++i) sum += member.diagonal[at(i)] * a[i] * b[i];
      for (int i = 0; i < member.segments; ++i) {
        sum += member.off[at(i)] * (a[i] * b[i + 1] + a[i + 1] * b[i]);
      }
    }
  }
  return sum;
}

template <int D>
double NodeMass<D>::slowed_product(const double* x, const double* y) const {
  double sum = 0;
  for (std::size_t m = 0; kappa_ > 0 && m < members_.size(); ++m) {
    const Plan& plan = plans_[m];
    const Member& member = members_[m];
    Eigen::Matrix<double, D, 1> axis = Eigen::Matrix<double, D, 1>::Unit(plan.along);
    if (plan.rotated) axis = plan.axes.col(0);
    for (int i = 0; i < member.segments; ++i) {
      double dx = 0, dy = 0;
      for (int c = 0; c < D; ++c) {
        const int k = c * entries_ + member.offset + i;
        dx += axis(c) * (x[k + 1] - x[k]);
        dy += axis(c) * (y[k + 1] - y[k]);
      }
      sum += kappa_ * member.axial[at(i)] * dx * dy;
    }
  }
  return product(x, y) + sum;
}

template class NodeMass<2>;
template class NodeMass<3>;

}  // namespace rigfit::model
