#include "signal/spectra/frf_checks.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace rigfit::signal {
namespace {
using Eigen::Index;

bool within(double f, const std::optional<std::pair<double, double>>& band) {
  return !band || (f >= band->first && f <= band->second);
}

/// Local maxima of the power that stand out `factor`-fold from the lowest point on either side up
/// to the next such maximum.
std::vector<Index> prominent_peaks(const Eigen::ArrayXd& power, double factor) {
  std::vector<Index> peaks;
  Index top = -1;
  double dip = power.size() > 0 ? power[0] : 0;
  for (Index k = 0; k < power.size(); ++k) {
    if (top < 0) {
      dip = std::min(dip, power[k]);
      if (power[k] > factor * dip) top = k;
    } else if (power[k] > power[top]) {
      top = k;
    } else if (power[k] * factor < power[top]) {
      peaks.push_back(top);
      top = -1;
      dip = power[k];
    }
  }
  return peaks;
}

}  // namespace

const char* name_of(DrivingPointVerdict verdict) {
  constexpr const char* kNames[] = {"consistent", "inverted", "inconsistent", "unclear"};
  return kNames[static_cast<std::size_t>(verdict)];
}

DrivingPointCheck check_driving_point(const FrfSet& frfs, Index response, Index input,
                                      std::optional<std::pair<double, double>> band_hz) {
  DrivingPointCheck check;
  const FrfSet mobility = converted(frfs, FrfForm::mobility);
  const Index column = mobility.column(response, input);
  std::vector<Index> lines;
  for (Index k = 0; k < mobility.frequency_hz.size(); ++k) {
    if (mobility.frequency_hz[k] > 0 && within(mobility.frequency_hz[k], band_hz)) {
      lines.push_back(k);
    }
  }
  const Eigen::ArrayXcd Y(mobility.H.col(column)(lines));
  Eigen::ArrayXd std = Eigen::ArrayXd::Zero(Y.size());
  if (mobility.H_std.size() > 0) std = mobility.H_std.col(column)(lines);
  const Eigen::ArrayXd real = (Y.real().abs() > 3 * std).select(Y.real(), 0.0);
  const double total = real.abs().sum();
  if (!(total > 0)) return check;
  check.wrong_sign_share = -real.min(0.0).sum() / total;
  check.verdict = check.wrong_sign_share <= 0.05   ? DrivingPointVerdict::consistent
                  : check.wrong_sign_share >= 0.95 ? DrivingPointVerdict::inverted
                                                   : DrivingPointVerdict::inconsistent;

  // The imaginary mobility is positive below a resonance and negative above it; from one resonance
  // to the next it has to turn back, at an antiresonance.
  const double sign = check.verdict == DrivingPointVerdict::inverted ? -1 : 1;
  // At a 25th of the power of both resonances each is 78 degrees or more past its own, so that the
  // turn shows; closer ones may merge.
  // What is below three standard deviations is a dip of no depth.
  const std::vector<Index> peaks = prominent_peaks(Y.abs2().max((3 * std).square()), 25);
  check.resonances = static_cast<int>(peaks.size());
  for (std::size_t i = 1; i < peaks.size(); ++i) {
    const Index first = peaks[i - 1], last = peaks[i];
    bool after = false, turned = false;
    for (Index k = first; k <= last; ++k) {
      const double imaginary = sign * Y[k].imag();
      if (imaginary < -std[k]) after = true;
      if (after && imaginary > std[k]) turned = true;
    }
    if (!turned) ++check.missing_antiresonances;
  }
  return check;
}

std::optional<Note> note_of(const DrivingPointCheck& check) {
  if (check.verdict == DrivingPointVerdict::inverted) {
    return Note{"driving_point",
                "force and response point in opposite directions at the driving point; "
                "turn one of them round",
                ""};
  }
  if (check.verdict == DrivingPointVerdict::inconsistent) {
    return Note{
        "driving_point",
        fmt::format("{:.0f} % of the mobility's real part has the wrong sign for a driving point: "
                    "the response is elsewhere or in another direction, or a channel is delayed",
                    100 * check.wrong_sign_share),
        ""};
  }
  if (check.missing_antiresonances > 0) {
    return Note{"driving_point",
                fmt::format("{} of {} resonances are not followed by the antiresonance that a "
                            "driving point has",
                            check.missing_antiresonances, check.resonances),
                ""};
  }
  return {};
}

std::vector<ReciprocityCheck> check_reciprocity(const FrfSet& frfs,
                                                std::optional<std::pair<double, double>> band_hz) {
  std::vector<ReciprocityCheck> checks;
  const auto response_of = [&](const std::string& name) {
    const auto found = std::find_if(frfs.responses.begin(), frfs.responses.end(),
                                    [&](const MeasuredPoint& point) { return point.name == name; });
    return found == frfs.responses.end() ? Index{-1} : Index{found - frfs.responses.begin()};
  };
  for (std::size_t a = 0; a < frfs.inputs.size(); ++a) {
    for (std::size_t b = a + 1; b < frfs.inputs.size(); ++b) {
      const Index ra = response_of(frfs.inputs[a].name), rb = response_of(frfs.inputs[b].name);
      if (ra < 0 || rb < 0) continue;
      const Index ab = frfs.column(ra, static_cast<Index>(b));
      const Index ba = frfs.column(rb, static_cast<Index>(a));
      double difference = 0, mean = 0, noise = 0;
      for (Index k = 0; k < frfs.frequency_hz.size(); ++k) {
        if (!within(frfs.frequency_hz[k], band_hz)) continue;
        difference += std::norm(frfs.H(k, ab) - frfs.H(k, ba));
        mean += std::norm(0.5 * (frfs.H(k, ab) + frfs.H(k, ba)));
        if (frfs.H_std.size() > 0) {
          noise += 2 * (std::pow(frfs.H_std(k, ab), 2) + std::pow(frfs.H_std(k, ba), 2));
        }
      }
      if (!(mean > 0)) continue;
      checks.push_back({{frfs.inputs[a].name, frfs.inputs[b].name},
                        std::sqrt(difference / mean),
                        std::sqrt(noise / mean)});
    }
  }
  return checks;
}

}  // namespace rigfit::signal
