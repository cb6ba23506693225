// Numbers, vectors and matrices by their short names, as in signal, with the headers that nearly
// every source of ident needs.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <functional>
#include <limits>
#include <map>
#include <numbers>
#include <optional>
#include <set>
#include <stdexcept>
#include <string>
#include <string_view>
#include <tuple>
#include <utility>
#include <vector>

#include "document/describe.h"
#include "signal/numerics/numbers.h"

namespace rigfit::ident {

using Eigen::ArrayXd, Eigen::Index, Eigen::Map, Eigen::MatrixXd, Eigen::Ref, Eigen::Vector3d,
    Eigen::VectorXcd, Eigen::VectorXd;
using signal::Estimate, signal::kNaN, signal::kTwoPi;

}  // namespace rigfit::ident
