#include "ident/statistics/uncertainty.h"

#include <fmt/ranges.h>

#include <Eigen/SVD>
#include <numeric>

namespace rigfit::ident {
namespace {

/// Named are those that this direction alone makes undetermined, and that matter in it.
OpenDirection open_direction(const VectorXd& direction, const std::vector<std::string>& names) {
  std::vector<std::size_t> order(names.size());
  std::iota(order.begin(), order.end(), 0);
  const auto size = [&](std::size_t j) { return std::abs(direction[static_cast<Index>(j)]); };
  std::ranges::stable_sort(order, std::greater(), size);
  const double least = 0.05 * size(order[0]);
  OpenDirection open;
  std::vector<std::string> changes;
  std::erase_if(order, [&](std::size_t j) { return size(j) < least; });
  for (const std::size_t j : order) {
    open.parameters.push_back(names[j]);
    changes.push_back(
        fmt::format("{} by {:+.2g} %", names[j],
                    direction[static_cast<Index>(j)] / direction[static_cast<Index>(order[0])]));
  }
  const std::string& last = open.parameters.back();
  open.message = order.size() == 1
                     ? "the data do not determine " + last
                     : fmt::format(
                           "the data cannot separate {} and {} (changing {} together changes "
                           "nothing measured)",
                           fmt::join(open.parameters.begin(), open.parameters.end() - 1, ", "),
                           last, fmt::join(changes, ", "));
  return open;
}

}  // namespace

Identifiability identifiability(const Ref<const MatrixXd>& jacobian,
                                const Ref<const VectorXd>& scales,
                                const std::vector<std::string>& names, double max_relative_std) {
  const Index n = jacobian.cols();
  if (scales.size() != n || static_cast<Index>(names.size()) != n || !(scales.array() > 0).all()) {
    throw std::invalid_argument("identifiability: one positive scale and one name a parameter");
  }
  Identifiability result;
  result.identifiable.resize(static_cast<std::size_t>(n));
  if (n == 0) return result;

  MatrixXd scaled = jacobian * scales.asDiagonal();
  if (!scaled.allFinite()) scaled.setZero();
  // Fewer residuals than parameters: rows of zeros complete V to the null space.
  if (scaled.rows() < n) scaled.conservativeResizeLike(MatrixXd::Zero(n, n));
  const Eigen::JacobiSVD<MatrixXd> svd(scaled, Eigen::ComputeThinV);
  const VectorXd& s = svd.singularValues();
  const MatrixXd& V = svd.matrixV();
  // Smaller singular values are zero as far as a Jacobian's accuracy goes.
  const double floor = s[0] * std::sqrt(std::numeric_limits<double>::epsilon());
  result.directions = scales.asDiagonal() * V;
  result.singular_values = (s.array() > floor).select(s, 0);

  // A direction that is zero to the Jacobian's accuracy keeps the floor, which makes every
  // parameter in it hopeless without spoiling those that merely touch it by rounding.
  const double smallest = std::max(floor, std::numeric_limits<double>::min() * 1e20);
  const VectorXd inverse = s.cwiseMax(smallest).cwiseInverse();
  const MatrixXd relative = V * inverse.array().square().matrix().asDiagonal() * V.transpose();

  for (Index i = n - 1; i >= 0; --i) {
    if (inverse[i] > max_relative_std) result.open.push_back(open_direction(V.col(i), names));
  }

  const VectorXd own = relative.diagonal().cwiseSqrt();
  const auto kept = own.array() <= max_relative_std;
  const VectorXd unit = kept.select(scales, kNaN);  // NaN for what is not determined
  for (Index j = 0; j < n; ++j) result.identifiable[static_cast<std::size_t>(j)] = kept[j];
  result.std = unit.cwiseProduct(own);
  result.covariance = unit.asDiagonal() * relative * unit.asDiagonal();
  return result;
}

double Identifiability::std_of(const Ref<const VectorXd>& gradient) const {
  if (gradient.size() != directions.rows() || !gradient.allFinite()) return kNaN;
  const VectorXd by = directions.transpose() * gradient;
  double variance = 0;
  for (Index i = 0; i < by.size(); ++i) {
    if (singular_values[i] > 0) {
      variance += std::pow(by[i] / singular_values[i], 2);
    } else if (std::abs(by[i]) > 1e-6 * by.norm()) {
      return kNaN;
    }
  }
  return std::sqrt(variance);
}

std::string probability_text(double p) {
  if (std::isnan(p)) return "-";
  return p < 1e-6 ? "below 1e-6" : fmt::format("{:.2g}", p);
}

}  // namespace rigfit::ident
