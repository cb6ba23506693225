#include "ident/update/uncertainty/frf_correlation.h"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

namespace rigfit::ident {
namespace {

using Rows = UpdateProblem::FrfRows;

Eigen::Index lines_of(const Rows& rows) {
  return static_cast<Eigen::Index>(rows.relative_std.size());
}

// R_l of each FRF with itself, R_0 first, up to the first that chance explains.
std::vector<double> autocorrelation(const std::vector<Rows>& all, const Eigen::VectorXd& r) {
  Eigen::Index most = 0, lines = 0;
  for (const auto& rows : all) {
    most = std::max(most, lines_of(rows) / 3);
    lines += lines_of(rows);
  }
  std::vector<double> R;
  for (Eigen::Index lag = 0; lag <= most; ++lag) {
    double value = 0;
    Eigen::Index count = 0;
    for (const auto& rows : all) {
      const Eigen::Index pairs = std::max<Eigen::Index>(0, lines_of(rows) - lag);
      count += pairs;
      value += r.segment(rows.first, 2 * pairs).dot(r.segment(rows.first + 2 * lag, 2 * pairs)) / 2;
    }
    if (count > 0) value /= static_cast<double>(count);
    if (lag == 0 && !(value > 0)) return {};
    if (lag > 0 && value / R[0] < 2 / std::sqrt(2 * static_cast<double>(lines))) break;
    R.push_back(value);
  }
  return R;
}

// Sum of s s', s = J' r of a block of neighbouring lines of all responses of a load.
struct Blocks {
  Eigen::MatrixXd meat;
  Eigen::Index count = 0;
};
Blocks blocks_of(const std::vector<Rows>& all, Eigen::Index length, const Eigen::VectorXd& r,
                 const Eigen::MatrixXd& J) {
  std::map<std::tuple<int, std::size_t, Eigen::Index>, Eigen::VectorXd> scores;
  for (const auto& rows : all) {
    for (Eigen::Index i = 0; i < lines_of(rows); ++i) {
      auto& score =
          scores.try_emplace({rows.state, rows.load, i / length}, Eigen::VectorXd::Zero(J.cols()))
              .first->second;
      const Eigen::Index row = rows.first + 2 * i;
      score += J.middleRows(row, 2).transpose() * r.segment<2>(row);
    }
  }
  Blocks blocks{Eigen::MatrixXd::Zero(J.cols(), J.cols()),
                static_cast<Eigen::Index>(scores.size())};
  for (const auto& [block, score] : scores) blocks.meat += score * score.transpose();
  return blocks;
}

// t of the header.
double integrated_time(const std::vector<double>& R) {
  double time = 1;
  for (std::size_t lag = 1; lag < R.size(); ++lag) time += 2 * R[lag] / R[0];
  return time;
}

}  // namespace

double correlated_lines_of(const UpdateProblem& problem, const std::vector<UpdateMatch>& matches,
                           const Eigen::VectorXd& r) {
  return problem.has_frfs() ? integrated_time(autocorrelation(problem.frf_rows(matches), r)) : 1;
}

double correlated_variance_factor(const UpdateProblem& problem,
                                  const std::vector<UpdateMatch>& matches, const Eigen::VectorXd& r,
                                  const Eigen::MatrixXd& J) {
  if (!problem.has_frfs()) return 0;
  const auto all = problem.frf_rows(matches);
  const auto R = autocorrelation(all, r);
  if (R.empty()) return 0;
  const double time = integrated_time(R);
  double factor = R[0] * time;  // the least: as if every derivative reached as far as the errors
  const Eigen::MatrixXd bread =
      (J.transpose() * J).completeOrthogonalDecomposition().pseudoInverse();
  Eigen::VectorXd variance = Eigen::VectorXd::Zero(J.cols());
  const Blocks blocks = blocks_of(all, static_cast<Eigen::Index>(std::ceil(2 * time)), r, J);
  if (blocks.count > 2 * J.cols()) {
    Eigen::MatrixXd meat = J.transpose() * J;  // all other data count unchanged
    for (const auto& rows : all) {
      const auto own = J.middleRows(rows.first, 2 * lines_of(rows));
      meat -= own.transpose() * own;
    }
    const double few = static_cast<double>(blocks.count) / static_cast<double>(blocks.count - 1);
    variance = (bread * (meat + few * blocks.meat) * bread).diagonal();
  }
  for (Eigen::Index j = 0; j < problem.parameter_count(); ++j) {
    if (bread(j, j) > 0) factor = std::max(factor, variance[j] / bread(j, j));
  }
  return factor;
}

}  // namespace rigfit::ident
