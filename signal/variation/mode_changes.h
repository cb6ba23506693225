// Changes of an identified mode that keep its parts together: value, pole, covariance, doubt.
#pragma once

#include <Eigen/Core>
#include <string>

#include "signal/modes/modal_model.h"

namespace rigfit::signal {

/// Frequency and damping ratio with the pole that they make. `window`: decay rate of an exponential
/// window, 1/s.
void set_frequency_and_damping(IdentifiedMode& mode, double frequency_hz, double damping_ratio,
                               double window);

/// Gives a value another standard deviation; its covariances, row and column `row`, go with it.
void set_std(Estimate& value, Eigen::Index row, double std, Eigen::MatrixXd& covariance);

void add_doubt(IdentifiedMode& mode, const std::string& reason);

}  // namespace rigfit::signal
