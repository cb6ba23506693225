// Samples of another owner as a channel of a recording, without a copy.
//
// A channel owns its samples (Eigen::VectorXd). Here a vector is made to point at memory that a
// NumPy array or another recording owns; who borrows gives back before the vector would free it.
// That relies on the storage of Eigen 3's dynamic vectors, a pointer and a length, which is
// asserted; the vector is only read, never resized, and its memory is aligned as Eigen's packets
// need it.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "signal/recording/recording.h"

namespace rigfit::python {

/// Whether an Eigen vector may point there.
[[nodiscard]] bool can_borrow(const double* data);
/// `vector`, empty before, points at `count` numbers of another owner. Call give_back before it is
/// destroyed.
void borrow(Eigen::VectorXd& vector, const double* data, Eigen::Index count);
/// Empties a vector that borrowed.
void give_back(Eigen::VectorXd& vector);

/// All of a recording but its samples, which are those of `recording`: it must live longer.
/// `recordings` are given back by give_back.
[[nodiscard]] signal::Recording borrowed(const signal::Recording& recording);
void give_back(signal::Recording& recording);

}  // namespace rigfit::python
