#include "model/algebra/bordered_solver.h"

namespace rigfit::model {

void BorderedSolver::factor(const EnvelopeMatrix& k, MatrixXd border, const MatrixXd& gradient,
                            const VectorXd& diagonal) {
  factor_.factor(k);
  border_ = std::move(border);
  if (diagonal.size() == 0) return;
  factor_.solve_in_place(border_);
  gradient_ = gradient.sparseView();
  MatrixXd small = diagonal.asDiagonal();
  small -= gradient_.transpose() * border_;
  small_.setThreshold(1e-9);
  small_.compute(small);
}

void BorderedSolver::solve_in_place(VectorXd& q, VectorXd& l) const {
  factor_.solve_in_place(q);
  if (l.size() == 0) return;
  l = small_.solve(l - gradient_.transpose() * q);
  q.noalias() -= border_ * l;
}

}  // namespace rigfit::model
