#include "signal/spectra/frf_set.h"

#include <cmath>
#include <complex>
#include <numbers>
#include <stdexcept>

namespace rigfit::signal {
namespace {
using Eigen::Index;

/// Time derivatives of displacement that the response is.
int derivatives(FrfForm form) {
  switch (form) {
    case FrfForm::receptance:
      return 0;
    case FrfForm::mobility:
      return 1;
    case FrfForm::accelerance:
      return 2;
    case FrfForm::unknown:
      break;
  }
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
  switch (form) {
    case FrfForm::receptance:
      return "receptance";
    case FrfForm::mobility:
      return "mobility";
    case FrfForm::accelerance:
      return "accelerance";
    case FrfForm::unknown:
      break;
  }
  return "unknown";
}

const char* unit_of(FrfForm form) {
  switch (form) {
    case FrfForm::receptance:
      return "m/N";
    case FrfForm::mobility:
      return "(m/s)/N";
    case FrfForm::accelerance:
      return "(m/s^2)/N";
    case FrfForm::unknown:
      break;
  }
  return "";
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
  for (Index k = 0; k < result.frequency_hz.size(); ++k) {
    const std::complex<double> s(frfs.exponential_decay_rate_1_s,
                                 2 * std::numbers::pi * result.frequency_hz[k]);
    std::complex<double> factor = 1;
    for (int i = 0; i < std::abs(power); ++i) factor = power > 0 ? factor * s : factor / s;
    result.H.row(k) *= factor;
    if (result.H_std.size() > 0) result.H_std.row(k) *= std::abs(factor);
    for (Eigen::MatrixXcd& hit : result.by_hit) {
      if (k < hit.rows()) hit.row(k) *= factor;
    }
  }
  return result;
}

}  // namespace rigfit::signal
