#include "signal/spectra/frf_set.h"

#include "signal/estimation/robust.h"
#include "signal/recording/add_note.h"
#include "signal/spectra/line_means.h"

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

void note_low(FrfSet& frfs, const std::optional<std::pair<double, double>>& band_hz) {
  std::vector<double> values;
  for (Index k = 0; k < frfs.frequency_hz.size(); ++k) {
    const double f = frfs.frequency_hz[k];
    if (!(f > 0) || (band_hz && (f < band_hz->first || f > band_hz->second))) continue;
    for (Index c = 0; c < frfs.coherence.cols(); ++c) values.push_back(frfs.coherence(k, c));
  }
  const double middle = median(std::move(values));
  // From 0.8 on noise is less than half of the response's amplitude.
  if (middle >= 0.8) return;
  add_note(frfs.notes, "low_coherence", "",
           "the median coherence is {:.2f}: {:.0f} % of the response's power does not come from "
           "the force; error bars allow for what is noise, not for a structure that changes, other "
           "sources or leakage",
           middle, 100 * (1 - middle));
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
    add_note(result.notes, "left_out", "", "a {} has no {} at 0 Hz; that line is left out",
             name_of(frfs.form), name_of(form));
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

void error_bars_from_coherence(FrfSet& frfs, int averages,
                               const std::optional<std::pair<double, double>>& band_hz) {
  if (frfs.coherence.size() == 0) return;
  const auto unusable = [&](const std::string& why) {
    frfs.notes.push_back({"coherence_unusable", why + ": it gives no error bars", ""});
  };
  const double least = frfs.coherence.minCoeff(), largest = frfs.coherence.maxCoeff();
  if (!frfs.coherence.allFinite() || least < -0.001 || largest > 1.001) {
    unusable(fmt::format("the coherence lies between {:.4g} and {:.4g}, not between 0 and 1", least,
                         largest));
    return;
  }
  note_low(frfs, band_hz);
  if (frfs.H_std.size() > 0) return;
  if (averages > 0) frfs.averages = averages;
  if (frfs.averages == 1) {
    unusable("the coherence of one average is one whatever the noise");
    return;
  }
  if (frfs.averages == 0) {
    add_note(frfs.notes, "assumed", "",
             "the coherence weighs the lines; the file does not say of how many averages it is, so "
             "that the error bars of the FRFs are those of two, the largest possible");
  }
  const int n = frfs.averages > 0 ? frfs.averages : 2;
  const double smallest = std::numeric_limits<float>::epsilon();  // single precision
  frfs.H_std.resize(frfs.H.rows(), frfs.H.cols());
  for (Index c = 0; c < frfs.H.cols(); ++c) {
    const ArrayXd g2 = frfs.coherence.col(c).array().max(smallest).min(1 - smallest);
    const ArrayXd noise = frfs.H.col(c).array().abs2() * (1 - g2) / g2;
    const ArrayXd wide = mean_over_lines(noise, kSmoothingLines),
                  narrow = mean_over_lines(noise, kNarrow);
    frfs.H_std.col(c) =
        (narrow_where_raised(narrow, wide, 2.0 * (n - 1) * (2 * kNarrow + 1)) / (2.0 * (n - 1)))
            .sqrt();
  }
}

}  // namespace rigfit::signal
