// FRFs as figures: magnitude with its error band, phase, coherence, stabilisation diagram.
#pragma once

#include <string>
#include <vector>

#include "apps/report/drawing/plot.h"
#include "signal/modal/modal_identification.h"
#include "signal/spectra/frf_set.h"

namespace rigfit::apps {

/// Lines of a set from low_hz to high_hz.
struct LineRange {
  Eigen::Index first = 0, last = -1;
};
[[nodiscard]] LineRange lines_between(const signal::FrfSet& frfs, double low_hz, double high_hz);

/// Magnitude of every FRF with its 95 % band; `rebuilt` (may be null): from the identified modes,
/// at the lines of the range.
[[nodiscard]] Plot magnitude_plot(const std::string& id, const signal::FrfSet& frfs,
                                  const LineRange& range, Origin origin,
                                  const signal::FrfSet* rebuilt);
/// Unwrapped along the lines whose phase is known to about 20 degrees; the others are gaps.
[[nodiscard]] Plot phase_plot(const std::string& id, const signal::FrfSet& frfs,
                              const LineRange& range, Origin origin);
[[nodiscard]] Plot coherence_plot(const std::string& id, const signal::FrfSet& frfs,
                                  const LineRange& range, Origin origin);
[[nodiscard]] Plot stabilisation_plot(const std::string& id, const signal::ModalResult& found,
                                      Origin origin);

/// The figures of a set together: magnitude, phase and coherence (where there is one) over one
/// abscissa, with the identified modes marked, and the stabilisation diagram. `modal` and `rebuilt`
/// may be null. Ids are `id` with "-frf", "-phase", "-coherence", "-stabilisation" in between.
struct FrfFigures {
  std::string test, state;  ///< of the ids: "cable-frf-200N"
  Origin origin = Origin::measured;
};
[[nodiscard]] std::vector<Plot> frf_figures(const FrfFigures& of, const signal::FrfSet& frfs,
                                            const LineRange& range,
                                            const signal::ModalResult* modal,
                                            const signal::FrfSet* rebuilt);

/// "mid-span", or "mid-span / hammer" where several places were struck.
[[nodiscard]] std::string frf_name(const signal::FrfSet& frfs, Eigen::Index response,
                                   Eigen::Index input);
/// "|H|, (m/s²)/N"
[[nodiscard]] std::string magnitude_label(const std::string& unit);

}  // namespace rigfit::apps
