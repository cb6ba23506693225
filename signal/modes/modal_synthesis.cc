#include "signal/modes/modal_synthesis.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <stdexcept>

namespace rigfit::signal {

using Complex = std::complex<double>;
using Eigen::Index;

int power_of_s(FrfForm form) {
  switch (form) {
    case FrfForm::mobility:
      return 1;
    case FrfForm::accelerance:
      return 2;
    default:
      return 0;
  }
}

Eigen::VectorXcd laplace_lines(const Eigen::Ref<const Eigen::VectorXd>& frequency_hz,
                               double decay_rate_1_s) {
  Eigen::VectorXcd s(frequency_hz.size());
  s.real().setConstant(decay_rate_1_s);
  s.imag() = 2 * std::numbers::pi * frequency_hz;
  return s;
}

FrfSet synthesised(const ModalModel& model, const Eigen::Ref<const Eigen::VectorXd>& frequency_hz,
                   FrfForm form, double decay_rate_1_s) {
  if (model.fitted_form == FrfForm::unknown && form != FrfForm::unknown) {
    throw std::invalid_argument("synthesised: the form of the fitted FRFs is not known");
  }
  const auto responses = static_cast<Index>(model.responses.size());
  const auto inputs = static_cast<Index>(model.inputs.size());
  FrfSet set;
  set.responses = model.responses;
  set.inputs = model.inputs;
  set.form = form;
  set.exponential_decay_rate_1_s = decay_rate_1_s;
  const bool has_zero = decay_rate_1_s == 0 && (frequency_hz.array() == 0).any();
  if (has_zero) {
    const Index lines = (frequency_hz.array() != 0).count();
    set.frequency_hz.resize(lines);
    std::copy_if(frequency_hz.begin(), frequency_hz.end(), set.frequency_hz.begin(),
                 [](double f) { return f != 0; });
    set.notes.push_back({"line_dropped", "the line at 0 Hz is dropped: lower residual / s^2", ""});
  } else {
    set.frequency_hz = frequency_hz;
  }
  const Eigen::ArrayXcd s = laplace_lines(set.frequency_hz, decay_rate_1_s).array();
  const auto modes = static_cast<Index>(model.modes.size());
  // Functions of frequency beside their factors: each mode's pole and conjugate, then residuals.
  Eigen::MatrixXcd basis(s.size(), 2 * modes + 2);
  Eigen::MatrixXcd factors = Eigen::MatrixXcd::Zero(2 * modes + 2, responses * inputs);
  for (Index r = 0; r < modes; ++r) {
    const IdentifiedMode& mode = model.modes[static_cast<std::size_t>(r)];
    basis.col(2 * r) = (s - mode.pole_rad_s).inverse();
    basis.col(2 * r + 1) = (s - std::conj(mode.pole_rad_s)).inverse();
    for (Index c = 0; c < responses * inputs; ++c) {
      factors(2 * r, c) = mode.shape[c / inputs] * mode.participation[c % inputs];
      factors(2 * r + 1, c) = std::conj(factors(2 * r, c));
    }
  }
  basis.col(2 * modes) = s.square().inverse();
  basis.col(2 * modes + 1).setOnes();
  for (Index c = 0; c < responses * inputs && model.lower_residual.size() > 0; ++c) {
    factors(2 * modes, c) = model.lower_residual(c / inputs, c % inputs);
    factors(2 * modes + 1, c) = model.upper_residual(c / inputs, c % inputs);
  }
  const int power = power_of_s(form);
  set.H = s.pow(power).matrix().asDiagonal() * (basis * factors);
  return set;
}

}  // namespace rigfit::signal
