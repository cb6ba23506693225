// Recordings, tests, fits and models as figures: for the report and for --plot of every verb.
#pragma once

#include <Eigen/Core>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "apps/campaign_file/campaign.h"
#include "apps/campaign_file/recording_group.h"
#include "apps/report/drawing/plot.h"
#include "apps/report/page/report_part.h"
#include "ident/campaign/modal/hammer_campaign.h"
#include "ident/campaign/modal/model_answers.h"
#include "ident/campaign/single_tests/axial_campaign.h"
#include "ident/campaign/single_tests/bending_campaign.h"
#include "ident/tension/cable_tension.h"
#include "ident/update/problem/update_data.h"
#include "ident/update/problem/update_result.h"
#include "ident/update/update_checks.h"
#include "model/linear/modal_analysis.h"
#include "model/response/response.h"
#include "model/scene/scene.h"
#include "signal/decay/decay.h"
#include "signal/modal/modal_identification.h"
#include "signal/quality/quality.h"
#include "signal/recording/recording.h"
#include "signal/spectra/frf_set.h"

namespace rigfit::apps {

// The recordings of a test as a reader sees them: what each holds, what is wrong with it, and those
// that could not be used in their place.

/// Adds the table of recordings, their notes as warnings, unusable ones as refusals, and the JSON
/// list `recordings` to the part.
void add_recordings(ReportPart& part, const CampaignTest& test,
                    const std::vector<LoadedRecording>& loaded);

/// Puts a refusal on the part: warning, summary line, paragraph in its place.
void refuse(ReportPart& part, const std::string& code, const std::string& message,
            const std::string& where);

/// Name of a file without its folders.
[[nodiscard]] std::string short_name(const std::string& file);

// A recording as figures: every channel over time, with what its quality check found.

/// The channels of a recording over time, linked. Clipped samples are points, other findings marks
/// where they begin and words in the caption. Long channels keep the extremes of short stretches.
/// Empty for what is not over time.
[[nodiscard]] std::vector<Plot> recording_plots(const std::string& id,
                                                const signal::Recording& recording,
                                                const signal::QualityResult& quality,
                                                Origin origin);

/// Samples over time with at most about `most` points: the extremes of equal stretches, in order.
void add_samples(PlotSeries& series, const Eigen::Ref<const Eigen::VectorXd>& samples,
                 double start_s, double rate_hz, std::size_t most = 6000);

// A free decay as figures: the record with its fit and what is left, damping against amplitude.

/// A decay of a record, as it was analysed.
struct AnalysedDecay {
  std::string file, channel, unit;
  Origin origin = Origin::measured;
  double rate_hz = 0;
  double start_s = 0;       ///< time of the first sample given
  Eigen::VectorXd samples;  ///< as given to the estimator
  signal::DecayResult result;
};

/// The record, the fitted decay over its window, and the residual.
[[nodiscard]] Plot decay_plot(const std::string& id, const AnalysedDecay& decay);

/// Damping ratio of the strongest mode against amplitude, a series a decay, with 95 % bars. Empty
/// series when no decay has two points.
[[nodiscard]] Plot damping_plot(const std::string& id, const std::vector<AnalysedDecay>& decays);

/// "m/s^2" as people write it.
[[nodiscard]] std::string unit_words(const std::string& unit);

// The model laid over a free decay: its answer to the same release or tap in time, the spectra of
// both, and what the same estimator finds in both.

using ident::ReleaseAnswer;

/// Record and answers over the first half second, and their spectra up to `high_hz` (0: all).
[[nodiscard]] std::vector<Plot> release_plots(const std::string& id, const AnalysedDecay& decay,
                                              const std::vector<ReleaseAnswer>& answers,
                                              double high_hz);

/// Amplitudes over frequency up to `high_hz` (0: all) under a Hann window, added to `series`.
[[nodiscard]] PlotSeries amplitude_spectrum(const Eigen::Ref<const Eigen::VectorXd>& samples,
                                            double rate_hz, double high_hz, PlotSeries series);

// Every hit of a hammer test as its force pulse, the rejected ones broken.

/// `places` and `test` belong together and hold their recordings. Force over the time from the
/// begin of each pulse, offset removed and the pulse upwards; all rejected hits and the first
/// accepted ones, `most` in all. No series without hits.
[[nodiscard]] Plot hits_plot(const std::string& id, const std::vector<ident::StruckPlace>& places,
                             const ident::HammerTest& test, Origin origin, std::size_t most = 24);

// FRFs as figures: magnitude with its error band, phase, coherence, stabilisation diagram.

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
  std::string test, state;  ///< parts of the ids: "cable-frf-200N"
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

// An axial test as figures: EA by length, the decays, where the uncertainty of EA comes from.

/// A value to compare with.
struct ReferenceValue {
  std::string name;  ///< "published", "truth"
  Origin origin = Origin::published;
  double value = 0;
};

/// EA at each length, of each record, and the result with its 95 % band.
[[nodiscard]] Plot axial_length_plot(const std::string& id, const ident::AxialTestResult& result,
                                     Origin origin,
                                     const std::optional<ReferenceValue>& reference = std::nullopt);

/// The first decay of each length with its fit and residual, a tab a length, and damping over
/// amplitude. `origins` by recording. Ids are `id` with "-decays", "-decay-0.7m", "-damping".
[[nodiscard]] std::vector<Block> axial_decay_blocks(const std::string& id,
                                                    const ident::AxialInputs& inputs,
                                                    const ident::AxialCampaignResult& result,
                                                    const std::vector<Origin>& origins);

// A bending test as figures: load over deflection, EI over tension with the laws that compete.

/// The records of every point that was analysed; `origins` by source.
[[nodiscard]] Plot load_deflection_plot(const std::string& id,
                                        const ident::BendingCampaign& campaign,
                                        const std::vector<Origin>& origins,
                                        const ident::BendingCampaignResult& result);

/// EI of the usable points with 95 % intervals, a series for each origin.
[[nodiscard]] std::vector<PlotSeries> stiffness_series(const ident::BendingCampaignResult& result,
                                                       const std::vector<Origin>& origins);

/// Laws that converged (the closest full, with its 95 % band), bounds and points.
[[nodiscard]] Plot stiffness_plot(const std::string& id, const std::vector<PlotSeries>& points,
                                  const ident::BendingCampaignResult& result);

// A tension from frequencies as figures.

/// Measured and modelled frequencies over mode number, a series a candidate; the errors of the
/// candidates; the tension of each candidate with its 95 % interval beside that of all and the
/// formulas.
[[nodiscard]] std::vector<Plot> tension_plots(const std::string& id,
                                              const ident::TensionResult& result);

// A fit of a model to measured modes as figures: model against test, errors mode by mode, where
// each parameter's uncertainty comes from.

/// What a fit was made of and gave.
struct FitFigures {
  const std::vector<ident::UpdateState>& states;
  const ident::UpdateResult& result;
  const std::vector<ident::HeldOut>& held;  ///< empty: nothing was held out
};

/// How far the model lies above the test, per cent over frequency, with the test's 95 % bars.
[[nodiscard]] Plot error_by_mode_plot(const std::string& id, const FitFigures& fit);
/// Shares of variance of the identifiable parameters; none when there is no budget.
[[nodiscard]] std::optional<ReportTable> budget_table(const std::string& id,
                                                      const ident::UpdateResult& result);

// A segment model as figures: mode shapes about the equilibrium, frequencies, time responses.

/// A measured mode to lay over a modelled one.
struct MeasuredShape {
  std::size_t mode = 0;  ///< index in the analysis
  double frequency_hz = 0;
  Eigen::VectorXcd shape;  ///< at the scene's sensors; empty: frequency only
  double mac = 0;          ///< NaN: not known
  Origin origin = Origin::measured;
};

/// The modes of the analysis (at most `most`) in a parallel projection, six a picture: at rest
/// (broken), moved, with supports, sensors and the nodes of the shape; measured shapes as points,
/// scaled to the model's by least squares, with their MAC. `state` stands in the titles where there
/// is one. None without shapes.
[[nodiscard]] std::vector<Picture> shapes_pictures(const std::string& id, const std::string& state,
                                                   const model::Scene& scene,
                                                   const model::ModalAnalysis& analysis,
                                                   const std::vector<MeasuredShape>& measured = {},
                                                   std::size_t most = 16);

/// Natural frequencies over mode number, a series a plane.
[[nodiscard]] Plot mode_frequencies_plot(const std::string& id,
                                         const model::ModalAnalysis& analysis);

/// Every sensor over time, linked, and the amplitude spectra of all of one unit together.
[[nodiscard]] std::vector<Plot> response_plots(const std::string& id, const model::Scene& scene,
                                               const model::ResponseResult& response);

}  // namespace rigfit::apps
