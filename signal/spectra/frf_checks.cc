#include "signal/spectra/frf_checks.h"

#include <fmt/format.h>

namespace rigfit::signal {
namespace {

bool within(double f, const std::optional<std::pair<double, double>>& band) {
  return !band || (f >= band->first && f <= band->second);
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
  const ArrayXcd Y(mobility.H.col(column)(lines));
  ArrayXd std = ArrayXd::Zero(Y.size());
  if (mobility.H_std.size() > 0) std = mobility.H_std.col(column)(lines);
  const ArrayXd real = (Y.real().abs() > 3 * std).select(Y.real(), 0.0);
  const double total = real.abs().sum();
  if (!(total > 0)) return check;
  check.wrong_sign_share = -real.min(0.0).sum() / total;
  check.verdict = check.wrong_sign_share <= 0.05   ? DrivingPointVerdict::consistent
                  : check.wrong_sign_share >= 0.95 ? DrivingPointVerdict::inverted
                                                   : DrivingPointVerdict::inconsistent;
  return check;
}

std::optional<Note> note_of(const DrivingPointCheck& check) {
  if (check.verdict == DrivingPointVerdict::inverted) {
    return Note{"driving_point",
                "force and response point in opposite directions at the driving point; turn one of "
                "them round",
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
  return {};
}

std::vector<ReciprocityCheck> check_reciprocity(const FrfSet& frfs,
                                                std::optional<std::pair<double, double>> band_hz) {
  std::vector<ReciprocityCheck> checks;
  const auto response_of = [&](const std::string& name) {
    const auto found = std::ranges::find(frfs.responses, name, &MeasuredPoint::name);
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
