#include "signal/spectra/frf_set.h"

#include <cmath>
#include <complex>
#include <numbers>
#include <stdexcept>

namespace rigfit::signal {
namespace {
using Eigen::Index;

/// Time derivatives of displacement that the response is: the order of the forms.
int derivatives(FrfForm form) {
  if (form != FrfForm::unknown) return static_cast<int>(form);
  throw std::invalid_argument(
      "an FRF of unknown form cannot be converted: it is not known whether the response is a "
      "displacement, a velocity or an acceleration");
}

template <typename Matrix>
void drop_first_row(Matrix& matrix) {
  if (matrix.rows() > 0) matrix = Matrix(matrix.bottomRows(matrix.rows() - 1));
}

}  // namespace

const char* name_of(FrfForm form) {
  constexpr const char* kNames[] = {"receptance", "mobility", "accelerance", "unknown"};
  return kNames[static_cast<std::size_t>(form)];
}

const char* unit_of(FrfForm form) {
  constexpr const char* kNames[] = {"m/N", "(m/s)/N", "(m/s^2)/N", ""};
  return kNames[static_cast<std::size_t>(form)];
}

FrfSet converted(const FrfSet& frfs, FrfForm form) {
  const int power = derivatives(form) - derivatives(frfs.form);
  FrfSet result = frfs;
  result.form = form;
  result.unit = unit_of(form);
  if (power < 0 && frfs.frequency_hz.size() > 0 && frfs.frequency_hz[0] == 0) {
    result.frequency_hz = frfs.frequency_hz.tail(frfs.frequency_hz.size() - 1).eval();
    drop_first_row(result.H);
    drop_first_row(result.H_std);
    drop_first_row(result.coherence);
    for (Eigen::MatrixXcd& hit : result.by_hit) drop_first_row(hit);
    result.notes.push_back({"left_out",
                            std::string("a ") + name_of(frfs.form) + " has no " + name_of(form) +
                                " at 0 Hz; that line is left out",
                            ""});
  }
  for (Index c = 0; c < result.H.cols(); ++c) multiply_by_s(result, c, power);
  return result;
}

void multiply_by_s(FrfSet& frfs, Index column, int power) {
  Eigen::ArrayXcd s(frfs.frequency_hz.size());
  s.real().setConstant(frfs.exponential_decay_rate_1_s);
  s.imag() = 2 * std::numbers::pi * frfs.frequency_hz.array();
  Eigen::ArrayXcd factor = Eigen::ArrayXcd::Ones(s.size());
  for (int i = 0; i < power; ++i) factor *= s;
  for (int i = 0; i > power; --i) factor /= s;
  frfs.H.col(column).array() *= factor;
  if (frfs.H_std.size() > 0) frfs.H_std.col(column).array() *= factor.abs();
  for (Eigen::MatrixXcd& hit : frfs.by_hit) {
    if (hit.rows() > 0) hit.col(column).array() *= factor.head(hit.rows());
  }
}

}  // namespace rigfit::signal
