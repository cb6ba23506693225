// Numbers, vectors and matrices by their short names, with the standard headers that nearly every
// numerical source needs.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <cstddef>
#include <limits>
#include <memory>
#include <numbers>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace rigfit::model {

using Complex = std::complex<double>;
using Eigen::ArrayXd, Eigen::Index, Eigen::Map, Eigen::Matrix3d, Eigen::Matrix3Xd, Eigen::MatrixXcd,
    Eigen::MatrixXd, Eigen::Ref, Eigen::Vector3d, Eigen::VectorXcd, Eigen::VectorXd,
    Eigen::VectorXi;

/// Members, nodes and joints are counted in int, containers in std::size_t.
[[nodiscard]] constexpr std::size_t at(int i) { return static_cast<std::size_t>(i); }

}  // namespace rigfit::model
