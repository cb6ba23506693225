#include "signal/spectra/frf_set.h"

namespace rigfit::signal {
namespace {

struct FormEntry {
  const char *name, *unit;
  Quantity response;
};
/// In the order of FrfForm: the place is the number of time derivatives of displacement.
constexpr FormEntry kForms[] = {{"receptance", "m/N", Quantity::displacement},
                                {"mobility", "(m/s)/N", Quantity::velocity},
                                {"accelerance", "(m/s^2)/N", Quantity::acceleration},
                                {"unknown", "", Quantity::unknown}};

const FormEntry& entry_of(FrfForm form) { return kForms[static_cast<std::size_t>(form)]; }

template <typename Matrix>
void drop_first_row(Matrix& matrix) {
  if (matrix.rows() > 0) matrix = Matrix(matrix.bottomRows(matrix.rows() - 1));
}

}  // namespace

const char* name_of(FrfForm form) { return entry_of(form).name; }

const char* unit_of(FrfForm form) { return entry_of(form).unit; }

FrfForm form_of(Quantity response) {
  int form = 0;
  while (form < static_cast<int>(FrfForm::unknown) && kForms[form].response != response) ++form;
  return static_cast<FrfForm>(form);
}

Quantity response_of(FrfForm form) { return entry_of(form).response; }

FrfSet converted(const FrfSet& frfs, FrfForm form) {
  if (form == FrfForm::unknown || frfs.form == FrfForm::unknown) {
    throw std::invalid_argument(
        "an FRF of unknown form cannot be converted: it is not known whether the response is a "
        "displacement, a velocity or an acceleration");
  }
  const int power = static_cast<int>(form) - static_cast<int>(frfs.form);
  FrfSet result = frfs;
  result.form = form;
  result.unit = unit_of(form);
  if (power < 0 && frfs.frequency_hz.size() > 0 && frfs.frequency_hz[0] == 0) {
    result.frequency_hz = frfs.frequency_hz.tail(frfs.frequency_hz.size() - 1).eval();
    drop_first_row(result.H);
    drop_first_row(result.H_std);
    drop_first_row(result.coherence);
    for (MatrixXcd& hit : result.by_hit) drop_first_row(hit);
    result.notes.push_back({"left_out",
                            std::string("a ") + name_of(frfs.form) + " has no " + name_of(form) +
                                " at 0 Hz; that line is left out",
                            ""});
  }
  for (Index c = 0; c < result.H.cols(); ++c) multiply_by_s(result, c, power);
  return result;
}

void multiply_by_s(FrfSet& frfs, Index column, int power) {
  ArrayXcd s(frfs.frequency_hz.size());
  s.real().setConstant(frfs.exponential_decay_rate_1_s);
  s.imag() = 2 * std::numbers::pi * frfs.frequency_hz.array();
  ArrayXcd factor = ArrayXcd::Ones(s.size());
  for (int i = 0; i < power; ++i) factor *= s;
  for (int i = 0; i > power; --i) factor /= s;
  frfs.H.col(column).array() *= factor;
  if (frfs.H_std.size() > 0) frfs.H_std.col(column).array() *= factor.abs();
  for (MatrixXcd& hit : frfs.by_hit) {
    if (hit.rows() > 0) hit.col(column).array() *= factor.head(hit.rows());
  }
}

}  // namespace rigfit::signal
