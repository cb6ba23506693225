#include "model/motion/node_mass.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>

#include "model/algebra/envelope_matrix.h"

namespace rigfit::model {

LaneFactors lane_factors(const std::vector<double>& diagonal, const std::vector<double>& off,
                         int first, int last, int rows) {
  LaneFactors out;
  out.rows = rows;
  for (LaneVector* all : {&out.toward, &out.inverse, &out.from_before, &out.from_behind}) {
    all->assign(at(kLanes * rows), 0);
  }
  const auto inside = [&](int node) { return node >= first && node <= last; };
  const auto coupling = [&](int node) {  // to the node behind
    return inside(node) && inside(node + 1) ? off[at(node)] : 0;
  };
  const int rest = rows - 1;  // rows that are eliminated in each lane
  for (int lane = 0; lane < kLanes; ++lane) {
    const int node = lane * rows;
    const auto slot = [&](int row) { return at(kLanes * row + lane); };
    for (int r = 0; r < rest; ++r) {
      if (!inside(node + r)) continue;
      double pivot = diagonal[at(node + r)];
      if (r > 0) {
        out.toward[slot(r)] = coupling(node + r - 1) * out.inverse[slot(r - 1)];
        pivot -= coupling(node + r - 1) * out.toward[slot(r)];
      }
      out.inverse[slot(r)] = 1 / pivot;
    }
    // Columns of the inverse for the first row and the last.
    std::vector<double> of_first(at(rest), 0), of_last(at(rest), 0);
    for (int column = 0; column < 2 && rest > 0; ++column) {
      std::vector<double>& y = column == 0 ? of_first : of_last;
      y[column == 0 ? 0 : at(rest - 1)] = 1;
      for (int r = 1; r < rest; ++r) y[at(r)] -= out.toward[slot(r)] * y[at(r - 1)];
      for (int r = rest - 1; r >= 0; --r) {
        y[at(r)] *= out.inverse[slot(r)];
        if (r + 1 < rest) y[at(r)] -= out.toward[slot(r + 1)] * y[at(r + 1)];
      }
    }
    const double from_before = lane > 0 && rest > 0 ? coupling(node - 1) : 0;
    for (int r = 0; r < rest; ++r) {
      out.from_before[slot(r)] = from_before * of_first[at(r)];
      out.from_behind[slot(r)] = coupling(node + rest - 1) * of_last[at(r)];
    }
  }
  // The inverse of the separators' Schur complement is their part of the whole inverse.
  std::vector<int> begin(at(kLanes * rows), 0);
  for (int node = 1; node < kLanes * rows; ++node) begin[at(node)] = node - 1;
  EnvelopeMatrix whole(Envelope::from_rows(std::move(begin)));
  for (int node = 0; node < kLanes * rows; ++node) {
    whole.add(node, node, inside(node) ? diagonal[at(node)] : 1);
    if (node > 0) whole.add(node, node - 1, coupling(node - 1));
  }
  EnvelopeFactor factor;
  factor.factor(whole);
  out.separators.assign(at(kLanes * kLanes), 0);
  for (int lane = 0; lane < kLanes; ++lane) {
    const int own = lane * rows + rest;
    VectorXd column = VectorXd::Unit(kLanes * rows, own);
    factor.solve_in_place(column);
    for (int k = 0; k < kLanes; ++k) {
      const int other = (lane + k) % kLanes * rows + rest;
      if (inside(own) && inside(other)) out.separators[at(kLanes * k + lane)] = column(other);
    }
  }
  return out;
}

template <int D>
NodeMass<D>::NodeMass(const std::vector<Member>& members, std::vector<Shared> shared, int entries)
    : shared_(std::move(shared)), entries_(entries) {
  for (const Member& member : members) plans_.push_back({member, factor(member, 0), {}});
  first_free_.assign(shared_.size(), -1);
  for (std::size_t k = 0; k < shared_.size(); ++k) {
    for (int c = 0; c < D; ++c) {
      if (shared_[k].held[c]) continue;
      if (first_free_[k] < 0) first_free_[k] = static_cast<int>(free_.size());
      free_.push_back({static_cast<int>(k), c});
    }
  }
  force_.resize(std::ssize(free_));
  motion_.resize(std::ssize(free_));
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
  const int rows = member.rows, slots = kLanes * rows;
  out.factors = lane_factors(diagonal, off, 1, n - 1, rows);
  const int node[2] = {lane_slot(0, rows), lane_slot(n, rows)};
  const int neighbour[2] = {lane_slot(1, rows), lane_slot(n - 1, rows)};
  LaneVector both(at(2 * slots), 0);  // two right-hand sides, as components
  for (int end = 0; end < 2; ++end) {
    out.off[end] = end == 0 ? off.front() : off.back();
    both[at(end * slots + neighbour[end])] = out.off[end];
  }
  const LaneFactors* const factors[2] = {&out.factors, &out.factors};
  lane_loops<2>().solve(factors, slots, both.data());
  out.both = -out.off[0] * both[at(slots + neighbour[0])];
  for (int end = 0; end < 2; ++end) {
    LaneVector& from = out.from[end];
    from.assign(both.begin() + end * slots, both.begin() + (end + 1) * slots);
    out.own[end] =
        (end == 0 ? diagonal.front() : diagonal.back()) - out.off[end] * from[at(neighbour[end])];
    from[at(node[end])] = -1;
  }
  return out;
}

template <int D>
void NodeMass<D>::slow_axial(double kappa, const double* positions) {
  kappa_ = kappa;
  any_rotated_ = false;
  for (Plan& plan : plans_) {
    plan.along = -1;
    plan.rotated = false;
    plan.axes.setIdentity();
    if (!(kappa > 0)) continue;
    plan.slowed = factor(plan, kappa);
    Eigen::Matrix<double, D, 1> chord;
    for (int c = 0; c < D; ++c) {
      const double* x = positions + std::ptrdiff_t{c} * entries_;
      chord(c) = x[plan.entry.back()] - x[plan.entry.front()];
    }
    chord.normalize();
    for (int c = 0; c < D; ++c) {
      if (std::abs(chord(c)) > 1 - 1e-12) plan.along = c;
    }
    if (plan.along >= 0) continue;
    plan.along = 0;
    plan.rotated = any_rotated_ = true;
    Vector3d to = Vector3d::Zero();
    to.head<D>() = chord;
    plan.axes = Eigen::Quaterniond::FromTwoVectors(Vector3d::UnitX(), to)
                    .toRotationMatrix()
                    .template topLeftCorner<D, D>();
  }
  reduce();
}

// The mass of the components of shared nodes that move, the inner nodes following them.
template <int D>
void NodeMass<D>::reduce() {
  const auto count = static_cast<Index>(free_.size());
  std::vector<int> row(shared_.size() * D, -1);
  for (Index i = 0; i < count; ++i) {
    const Free& f = free_[static_cast<std::size_t>(i)];
    row[at(f.node * D + f.component)] = static_cast<int>(i);
  }
  MatrixXd mass = MatrixXd::Zero(count, count);
  for (const Plan& plan : plans_) {
    Eigen::Matrix<double, D, D> block[3];
    for (int part = 0; part < 3; ++part) {
      const auto value = [&](const Inner& inner) {
        return part < 2 ? inner.own[part] : inner.both;
      };
      block[part].setIdentity();
      block[part] *= value(plan.plain);
      if (plan.along < 0) continue;
      const Eigen::Matrix<double, D, 1> axis = plan.axes.col(plan.along);
      block[part] += (value(plan.slowed) - value(plan.plain)) * axis * axis.transpose();
    }
    for (int c = 0; c < D; ++c) {
      for (int d = 0; d < D; ++d) {
        const int a = plan.shared[0], b = plan.shared[1];
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
  inverse_ = mass.llt().solve(MatrixXd::Identity(count, count));
}

template <int D>
void NodeMass<D>::rotate(const Plan& plan, bool back, double* values) const {
  Eigen::Matrix<double, D, D> turn = plan.axes;
  if (!back) turn.transposeInPlace();
  const int slots = kLanes * plan.rows;
  double* a[D];
  for (int c = 0; c < D; ++c) a[c] = values + std::ptrdiff_t{c} * entries_ + plan.offset;
  for (int i = 0; i < slots; ++i) {
    Eigen::Matrix<double, D, 1> value;
    for (int c = 0; c < D; ++c) value(c) = a[c][i];
    value = turn * value;
    for (int c = 0; c < D; ++c) a[c][i] = value(c);
  }
}

template <int D>
void NodeMass<D>::solve(double* values) {
  // Forces on the free end nodes, before the solution of inner nodes puts zeros there.
  for (std::size_t i = 0; i < free_.size(); ++i) {
    const Shared& node = shared_[at(free_[i].node)];
    double sum = 0;
    for (const int entry : node.entries) sum += values[free_[i].component * entries_ + entry];
    force_(static_cast<Index>(i)) = sum;
  }
  for (const Plan& plan : plans_) {
    if (plan.rotated) rotate(plan, false, values);
    const LaneFactors* factors[D];
    for (int c = 0; c < D; ++c) {
      factors[c] = c == plan.along ? &plan.slowed.factors : &plan.plain.factors;
    }
    loops_->solve(factors, entries_, values + plan.offset);
  }
  if (!free_.empty()) solve_ends(values);
  for (const Plan& plan : plans_) {
    if (plan.rotated) rotate(plan, true, values);
  }
  if (!any_rotated_) return;
  // Without the rounding of their members' turns: a node's entries stay the same.
  for (std::size_t i = 0; i < free_.size(); ++i) {
    for (const int entry : shared_[at(free_[i].node)].entries) {
      values[free_[i].component * entries_ + entry] = motion_(static_cast<Index>(i));
    }
  }
}

// The free end nodes' accelerations, and what the inner nodes follow of them; in members' axes.
template <int D>
void NodeMass<D>::solve_ends(double* values) {
  // Forces on the free end nodes less what the inner nodes' accelerations take.
  const auto count = static_cast<int>(free_.size());
  for (const Plan& plan : plans_) {
    for (int end = 0; end < 2; ++end) {
      const int node = plan.shared[end], first = first_free_[at(node)];
      if (first < 0) continue;
      const int entry = plan.entry[end == 0 ? 1 : at(plan.segments - 1)];
      Eigen::Matrix<double, D, 1> pull;
      for (int c = 0; c < D; ++c) {
        const Inner& inner = c == plan.along ? plan.slowed : plan.plain;
        pull(c) = inner.off[end] * values[c * entries_ + entry];
      }
      if (plan.rotated) pull = plan.axes * pull;
      // The rows of a node follow each other by component, where they are free.
      for (int i = first; i < count && free_[at(i)].node == node; ++i) {
        force_(i) -= pull(free_[at(i)].component);
      }
    }
  }
  motion_.noalias() = inverse_ * force_;
  // The inner nodes follow their ends.
  for (const Plan& plan : plans_) {
    for (int end = 0; end < 2; ++end) {
      const int node = plan.shared[end], first = first_free_[at(node)];
      if (first < 0) continue;
      Eigen::Matrix<double, D, 1> own = Eigen::Matrix<double, D, 1>::Zero();
      for (int i = first; i < count && free_[at(i)].node == node; ++i) {
        own(free_[at(i)].component) = motion_(i);
      }
      if (plan.rotated) own = plan.axes.transpose() * own;
      for (int c = 0; c < D; ++c) {
        const LaneVector& from = (c == plan.along ? plan.slowed : plan.plain).from[end];
        double* a = values + std::ptrdiff_t{c} * entries_ + plan.offset;
        const Index slots = std::ssize(from);
        Map<VectorXd>(a, slots) -= own(c) * Map<const VectorXd>(from.data(), slots);
      }
    }
  }
}

template <int D>
double NodeMass<D>::product(const double* x, const double* y, double kappa) const {
  double sum = 0;
  for (const Plan& plan : plans_) {
    const int* entry = plan.entry.data();
    for (int c = 0; c < D; ++c) {
      const double* a = x + std::ptrdiff_t{c} * entries_;
      const double* b = y + std::ptrdiff_t{c} * entries_;
      for (int i = 0; i <= plan.segments; ++i) {
        sum += plan.diagonal[at(i)] * a[entry[i]] * b[entry[i]];
      }
      for (int i = 0; i < plan.segments; ++i) {
        sum += plan.off[at(i)] * (a[entry[i]] * b[entry[i + 1]] + a[entry[i + 1]] * b[entry[i]]);
      }
    }
    if (!(kappa > 0)) continue;
    const Eigen::Matrix<double, D, 1> axis = plan.axes.col(plan.along);
    for (int i = 0; i < plan.segments; ++i) {
      double dx = 0, dy = 0;
      for (int c = 0; c < D; ++c) {
        const int here = c * entries_ + entry[i], next = c * entries_ + entry[i + 1];
        dx += axis(c) * (x[next] - x[here]);
        dy += axis(c) * (y[next] - y[here]);
      }
      sum += kappa * plan.axial[at(i)] * dx * dy;
    }
  }
  return sum;
}

template class NodeMass<2>;
template class NodeMass<3>;

}  // namespace rigfit::model
