#include "signal/spectra/coherence_errors.h"

#include "signal/estimation/robust.h"
#include "signal/recording/add_note.h"
#include "signal/spectra/line_means.h"

namespace rigfit::signal {
namespace {

void note_low(FrfSet& frfs, const std::optional<std::pair<double, double>>& band_hz) {
  std::vector<double> values;
  for (Index k = 0; k < frfs.frequency_hz.size(); ++k) {
    const double f = frfs.frequency_hz[k];
    if (!(f > 0) || (band_hz && (f < band_hz->first || f > band_hz->second))) continue;
    for (Index c = 0; c < frfs.coherence.cols(); ++c) values.push_back(frfs.coherence(k, c));
  }
  const double middle = median(std::move(values));
  constexpr double kGood =
      0.8;  // from there on noise is less than half of the response's amplitude
  if (middle >= kGood) return;
  add_note(frfs.notes, "low_coherence", "",
           "the median coherence is {:.2f}: {:.0f} % of the response's power does not come from "
           "the force; error bars allow for what is noise, not for a structure that changes, other "
           "sources or leakage",
           middle, 100 * (1 - middle));
}

}  // namespace

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
