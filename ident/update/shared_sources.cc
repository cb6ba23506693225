#include "ident/update/shared_sources.h"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <Eigen/SVD>
#include <algorithm>
#include <memory>
#include <utility>

namespace rigfit::ident {

SharedChanges shared_changes(const UpdateProblem& problem, bool segments,
                             const std::vector<UpdateMatch>& matches, const Eigen::VectorXd& q) {
  SharedChanges shared;
  std::vector<Eigen::VectorXd> columns;
  const auto residuals = [&](const UpdateProblem& moved, Eigen::VectorXd& r) {
    return moved.residuals(q, matches, UpdateStage::full, r, nullptr);
  };
  Eigen::VectorXd change;
  const auto add = [&](const std::string& name) {
    shared.names.push_back(name);
    columns.push_back(change);
  };
  if (segments) {
    if (change_by_segments(problem, residuals, change)) {
      add("segments");
    } else {
      shared.message += "what the segments cost is not known: no model with twice as many; ";
    }
  }
  const Eigen::Index inputs = problem.inputs_off().size();
  for (Eigen::Index i = 0; i < inputs; ++i) {
    const auto& name = problem.inputs()[static_cast<std::size_t>(i)].name;
    if (change_by_input(problem, i, residuals, change)) {
      add(name);
      shared.inputs.push_back(i);
    } else {
      shared.message += fmt::format(
          "{} is not in the uncertainties: no model within half of its standard uncertainty; ",
          name);
    }
  }
  const Eigen::Index count = problem.residual_count(matches, UpdateStage::full);
  shared.changes.resize(count, static_cast<Eigen::Index>(columns.size()));
  for (std::size_t k = 0; k < columns.size(); ++k) {
    shared.changes.col(static_cast<Eigen::Index>(k)) = columns[k];
  }
  return shared;
}

UpdateProblem with_shared_sources(const UpdateProblem& problem,
                                  const std::vector<UpdateMatch>& matches,
                                  const Eigen::VectorXd& q) {
  constexpr double kMost = 6;  // standard uncertainties that an estimate may be off
  const UpdateProblem plain = problem.with_sources(nullptr);
  const SharedChanges shared = shared_changes(plain, false, matches, q);
  const Eigen::MatrixXd& C = shared.changes;
  Eigen::VectorXd r;
  if (C.cols() == 0 || C.rows() == 0 || !C.allFinite() ||
      !plain.residuals(q, matches, UpdateStage::full, r, nullptr)) {
    return plain;
  }
  // The estimates d of the inputs minimise |r + C (d - d0)|^2 + |d|^2 about those of before.
  Eigen::VectorXd off = plain.inputs_off();
  Eigen::VectorXd d(C.cols());
  for (Eigen::Index i = 0; i < d.size(); ++i) {
    d[i] = off[shared.inputs[static_cast<std::size_t>(i)]];
  }
  const Eigen::MatrixXd normal = Eigen::MatrixXd::Identity(C.cols(), C.cols()) + C.transpose() * C;
  const Eigen::VectorXd estimate = -normal.ldlt().solve(C.transpose() * (r - C * d));
  for (Eigen::Index i = 0; i < d.size(); ++i) {
    d[i] = off[shared.inputs[static_cast<std::size_t>(i)]] = std::clamp(estimate[i], -kMost, kMost);
  }
  const Eigen::BDCSVD<Eigen::MatrixXd> svd(C, Eigen::ComputeThinU);
  auto sources = std::make_shared<UpdateProblem::Sources>();
  sources->U = svd.matrixU();
  sources->less = 1 - (1 + svd.singularValues().array().square()).rsqrt();
  sources->off = C * d;
  return plain.with_inputs(off).with_sources(std::move(sources));
}

}  // namespace rigfit::ident
