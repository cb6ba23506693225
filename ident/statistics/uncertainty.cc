#include "ident/statistics/uncertainty.h"

#include <fmt/format.h>

#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <stdexcept>

#include "signal/numerics/numbers.h"

namespace rigfit::ident {
namespace {

using signal::kNaN;

std::string describe(const OpenDirection& open, const std::vector<std::string>& names) {
  const auto name = [&](int j) { return names[static_cast<std::size_t>(j)]; };
  if (open.parameters.size() == 1) {
    return fmt::format("the data do not determine {}", name(open.parameters[0]));
  }
  std::string list, combination;
  const double strongest = open.direction[open.parameters[0]];
  for (std::size_t i = 0; i < open.parameters.size(); ++i) {
    const int j = open.parameters[i];
    list += (i == 0 ? "" : i + 1 == open.parameters.size() ? " and " : ", ") + name(j);
    combination += fmt::format("{}{} by {:+.2g} %", i == 0 ? "" : ", ", name(j),
                               open.direction[j] / strongest);
  }
  return fmt::format("the data cannot separate {} (changing {} together changes nothing measured)",
                     list, combination);
}

}  // namespace

Identifiability identifiability(const Eigen::Ref<const Eigen::MatrixXd>& jacobian,
                                const Eigen::Ref<const Eigen::VectorXd>& scales,
                                const std::vector<std::string>& names, double max_relative_std) {
  const Eigen::Index n = jacobian.cols();
  if (scales.size() != n || static_cast<Eigen::Index>(names.size()) != n ||
      !(scales.array() > 0).all()) {
    throw std::invalid_argument("identifiability: one positive scale and one name a parameter");
  }
  Identifiability result;
  result.identifiable.resize(static_cast<std::size_t>(n));
  if (n == 0) return result;

  Eigen::MatrixXd scaled = jacobian * scales.asDiagonal();
  if (!scaled.allFinite()) scaled.setZero();
  // Fewer residuals than parameters: rows of zeros complete V to the null space.
  if (scaled.rows() < n) scaled.conservativeResizeLike(Eigen::MatrixXd::Zero(n, n));
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(scaled, Eigen::ComputeThinV);
  const Eigen::VectorXd& s = svd.singularValues();
  const Eigen::MatrixXd& V = svd.matrixV();
  // Smaller singular values are zero as far as a Jacobian's accuracy goes.
  const double floor = s[0] * std::sqrt(std::numeric_limits<double>::epsilon());
  result.directions = V;
  result.singular_values = s;
  result.scales = scales;
  result.null_below = floor;

  // A direction that is zero to the Jacobian's accuracy keeps the floor, which makes every
  // parameter in it hopeless without spoiling those that merely touch it by rounding.
  const double smallest = std::max(floor, std::numeric_limits<double>::min() * 1e20);
  const Eigen::VectorXd inverse = s.cwiseMax(smallest).cwiseInverse();
  const Eigen::MatrixXd relative =
      V * inverse.array().square().matrix().asDiagonal() * V.transpose();

  for (Eigen::Index i = n - 1; i >= 0; --i) {
    if (inverse[i] <= max_relative_std) continue;
    OpenDirection open;
    open.direction = V.col(i);
    std::vector<int> order(static_cast<std::size_t>(n));
    std::iota(order.begin(), order.end(), 0);
    std::stable_sort(order.begin(), order.end(), [&](int a, int b) {
      return std::abs(open.direction[a]) > std::abs(open.direction[b]);
    });
    // Named are those that this direction alone makes undetermined, and that matter in it.
    for (int j : order) {
      if (std::abs(open.direction[j]) >= 0.05 * std::abs(open.direction[order[0]])) {
        open.parameters.push_back(j);
      }
    }
    open.message = describe(open, names);
    result.open.push_back(std::move(open));
  }

  const Eigen::VectorXd own = relative.diagonal().cwiseSqrt();
  const auto kept = own.array() <= max_relative_std;
  const Eigen::VectorXd unit = kept.select(scales, kNaN);  // NaN for what is not determined
  for (Eigen::Index j = 0; j < n; ++j) result.identifiable[static_cast<std::size_t>(j)] = kept[j];
  result.std = unit.cwiseProduct(own);
  result.covariance = unit.asDiagonal() * relative * unit.asDiagonal();
  return result;
}

double Identifiability::std_of(const Eigen::Ref<const Eigen::VectorXd>& gradient) const {
  if (gradient.size() != scales.size() || !gradient.allFinite()) return kNaN;
  const Eigen::VectorXd by = directions.transpose() * scales.cwiseProduct(gradient);
  double variance = 0;
  for (Eigen::Index i = 0; i < by.size(); ++i) {
    if (singular_values[i] > null_below) {
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

std::string p_text(double p) { return (p < 1e-6 ? "p " : "p = ") + probability_text(p); }

}  // namespace rigfit::ident
