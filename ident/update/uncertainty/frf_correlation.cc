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

// Sum over lines that far apart, and how many: first line in `a`, the other in `b`.
struct Product {
  double sum = 0;
  Eigen::Index count = 0;
  [[nodiscard]] double mean() const { return count > 0 ? sum / static_cast<double>(count) : 0; }
};
void add_product(const Rows& a, const Rows& b, Eigen::Index lag, const Eigen::VectorXd& r,
                 Product& product) {
  const Eigen::Index last = std::min(lines_of(a), lines_of(b) - lag);
  for (Eigen::Index i = 0; i < last; ++i) {
    product.sum += r.segment<2>(a.first + 2 * i).dot(r.segment<2>(b.first + 2 * (i + lag))) / 2;
    ++product.count;
  }
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
    Product product;
    for (const auto& rows : all) add_product(rows, rows, lag, r, product);
    const double value = product.mean();
    if (lag == 0 && !(value > 0)) return {};
    if (lag > 0 && value / R[0] < 2 / std::sqrt(2 * static_cast<double>(lines))) break;
    R.push_back(value);
  }
  return R;
}

bool noise_in_common(const Rows& a, const Rows& b) {
  return a.state == b.state && a.load == b.load && lines_of(a) == lines_of(b);
}

// J_k' J_(k + lag), summed over the lines.
void add_meat(const Rows& a, const Rows& b, Eigen::Index lag, double R, const Eigen::MatrixXd& J,
              Eigen::MatrixXd& meat) {
  const Eigen::Index last = 2 * std::min(lines_of(a), lines_of(b) - lag);
  if (last <= 0) return;
  meat += R * J.middleRows(a.first, last).transpose() * J.middleRows(b.first + 2 * lag, last);
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

}  // namespace

double correlated_lines_of(const UpdateProblem& problem, const std::vector<UpdateMatch>& matches,
                           const Eigen::VectorXd& r) {
  if (!problem.has_frfs()) return 1;
  const auto R = autocorrelation(problem.frf_rows(matches), r);
  double time = 1;
  for (std::size_t lag = 1; lag < R.size(); ++lag) time += 2 * R[lag] / R[0];
  return time;
}

double correlated_variance_factor(const UpdateProblem& problem,
                                  const std::vector<UpdateMatch>& matches, const Eigen::VectorXd& q,
                                  const Eigen::VectorXd& r, const Eigen::MatrixXd& J) {
  if (!problem.has_frfs()) return 0;
  const auto all = problem.frf_rows(matches);
  const auto R = autocorrelation(all, r);
  if (R.empty()) return 0;
  Eigen::MatrixXd meat = J.transpose() * J;  // all other data count unchanged
  for (const auto& rows : all) {
    const auto own = J.middleRows(rows.first, 2 * lines_of(rows));
    meat += (R[0] - 1) * own.transpose() * own;
    for (std::size_t l = 1; l < R.size(); ++l) {
      Eigen::MatrixXd half = Eigen::MatrixXd::Zero(J.cols(), J.cols());
      add_meat(rows, rows, static_cast<Eigen::Index>(l), R[l], J, half);
      meat += half + half.transpose();
    }
  }
  for (std::size_t l = 0; l < R.size(); ++l) {
    const auto lag = static_cast<Eigen::Index>(l);
    Product product;
    Eigen::MatrixXd pairs = Eigen::MatrixXd::Zero(J.cols(), J.cols());
    for (std::size_t a = 0; a < all.size(); ++a) {
      for (std::size_t b = 0; b < all.size(); ++b) {
        if (a == b || !noise_in_common(all[a], all[b])) continue;
        add_product(all[a], all[b], lag, r, product);
        add_meat(all[a], all[b], lag, 1, J, pairs);
      }
    }
    // Pairs are there in both orders: at lag 0 that is all, else the other sign of the lag is left.
    meat += product.mean() * (lag == 0 ? pairs : Eigen::MatrixXd(pairs + pairs.transpose()));
  }
  const Eigen::MatrixXd bread =
      (J.transpose() * J).completeOrthogonalDecomposition().pseudoInverse();
  Eigen::VectorXd sandwich = (bread * meat * bread).diagonal();
  double time = 1;
  for (std::size_t lag = 1; lag < R.size(); ++lag) time += 2 * R[lag] / R[0];
  const Blocks blocks = blocks_of(all, static_cast<Eigen::Index>(std::ceil(2 * time)), r, J);
  if (blocks.count > 2 * J.cols()) {
    const double few = static_cast<double>(blocks.count) / static_cast<double>(blocks.count - 1);
    sandwich = sandwich.cwiseMax((bread * blocks.meat * bread).diagonal() * few);
  }
  double factor = R[0] * time;  // the least: as if every derivative reached as far as the errors
  Eigen::VectorXd plain_r;
  Eigen::MatrixXd plain_J;
  if (problem.has_sources() &&
      problem.with_sources(nullptr).residuals(q, matches, UpdateStage::full, plain_r, &plain_J)) {
    constexpr double kFarApart = 3.84;  // chi-square of one, 5 %
    const auto solve = plain_J.completeOrthogonalDecomposition();
    const Eigen::VectorXd apart = solve.solve(plain_r).cwiseAbs2();
    const Eigen::MatrixXd gain = solve.pseudoInverse();  // coordinates x residuals
    const Eigen::MatrixXd spread = gain * problem.covariance_times(gain.transpose());
    for (Eigen::Index j = 0; j < J.cols(); ++j) {
      const double expected = std::max(0.0, spread(j, j) - bread(j, j)) * std::max(1.0, R[0]);
      if (apart[j] > kFarApart * expected) sandwich[j] = std::max(sandwich[j], apart[j]);
    }
  }
  for (Eigen::Index j = 0; j < J.cols(); ++j) {
    if (bread(j, j) > 0) factor = std::max(factor, sandwich[j] / bread(j, j));
  }
  return factor;
}

}  // namespace rigfit::ident
