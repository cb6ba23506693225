#include "signal/modal/cut_off_records.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "signal/modes/modes_beside.h"
#include "signal/refinement/smooth_background.h"

namespace rigfit::signal {
namespace {
/// As in signal/impact: less does not show beside noise.
constexpr double kLeft = 1e-3, kTone = 0.9;
/// What depends on the place of the hit is smaller by its part of the record.
constexpr double kLeftWhereHitMatters = 1e-2;
/// Longest share of a record before the hit: analysers are set to some percent.
constexpr double kLongestLead = 0.125;
/// Iterations of a search, as counted by its work.
constexpr double kIterations = 40;
/// Standard deviations of noise that a misfit exceeds: for the functions of an unknown place, and
/// for the one in s, which costs little where it is not needed.
constexpr double kSure = 4, kLikely = 2;

/// Background terms, at most 60, with which so many iterations stay within `max_work`.
double affordable_terms(const ModalBand& band, Eigen::Index poles, double max_work) {
  const auto frfs = static_cast<double>(band.lines.H.cols());
  const double product =
      max_work / (4 * kIterations * static_cast<double>(band.frequency_hz.size()));
  // x (x + FRFs) = product, x columns.
  const double columns = std::sqrt(product + 0.25 * frfs * frfs) - 0.5 * frfs;
  return std::clamp(0.5 * columns - static_cast<double>(poles) - 2, 0.0, 60.0);
}
}  // namespace

double left_at_the_end(const ModalBand& band, std::complex<double> raw) {
  return std::exp(raw.real() / band.spacing_hz);
}

bool misfit_shows(const Eigen::Ref<const Eigen::MatrixXcd>& background,
                  const Eigen::Ref<const Eigen::MatrixXcd>& misfit,
                  const Eigen::Ref<const Eigen::VectorXd>& line, double deviations) {
  const double mean = background.rowwise().squaredNorm().dot(line);  // for noise of variance `line`
  double found = 0, frfs = 0;
  for (const auto& column : misfit.colwise()) {
    const double variance = (column.cwiseAbs2().array() / line.array()).mean();
    if (!(variance > 0)) continue;
    found += (background.adjoint() * column).squaredNorm() / variance;
    ++frfs;
  }
  return found >
         mean * (frfs + deviations * std::sqrt(frfs / static_cast<double>(background.cols())));
}

bool allow_for_cut_off(const FrfSet& frfs, const Eigen::Ref<const Eigen::VectorXcd>& poles,
                       const Eigen::Ref<const Eigen::MatrixXcd>& misfit, const FrfNoise& noise,
                       double max_work, ModalBand& band) {
  double most = 0;
  for (const std::complex<double> pole : poles) {
    const double left = left_at_the_end(band, pole - band.window);
    if (left < kTone) most = std::max(most, left);
  }
  if (!(most > kLeft)) return false;
  const double width = band.frequency_hz[band.frequency_hz.size() - 1] - band.frequency_hz[0];
  const double terms = affordable_terms(band, poles.size(), max_work);
  const double unknown = std::min(kLongestLead / band.spacing_hz, terms / width);
  const double before = frfs.pre_trigger_s > 0        ? frfs.pre_trigger_s
                        : most > kLeftWhereHitMatters ? unknown
                                                      : 0;
  const double span = frfs.force_noise_span_s;
  Eigen::MatrixXcd background =
      cut_off_background(band.lines.s, band.lines.power, std::max(before, span), span);
  if (!(span > 0) && misfit.size() > 0 && !misfit_shows(background, misfit, noise.line, kSure)) {
    background = cut_off_background(band.lines.s, band.lines.power, 0, 0);
    if (!misfit_shows(background, misfit, noise.line, kLikely)) return false;
  }
  set_background(background, band);
  return true;
}

}  // namespace rigfit::signal
