// Recordings, tests, fits and models as figures: for the report and for --plot of every verb. What
// is drawn in both is one function here.
#pragma once

#include <Eigen/Core>
#include <numbers>

#include "apps/campaign/campaign.h"
#include "apps/report/drawing/html_text.h"
#include "apps/report/drawing/plot.h"
#include "apps/report/page/report_part.h"
#include "ident/campaign/modal/modal_model.h"
#include "ident/campaign/single_tests/axial_campaign.h"
#include "ident/campaign/single_tests/bending_campaign.h"
#include "ident/tension/cable_tension.h"
#include "ident/update/problem/update_data.h"
#include "ident/update/problem/update_result.h"
#include "model/linear/modal_analysis.h"
#include "model/response/response.h"
#include "model/scene/scene.h"
#include "signal/ambient/ambient_modes.h"
#include "signal/decay/decay.h"
#include "signal/modal/modal_identification.h"
#include "signal/quality/quality.h"
#include "signal/recording/recording.h"
#include "signal/spectra/frf_set.h"

namespace rigfit::apps {

/// Name of a file without its folders.
[[nodiscard]] std::string short_name(const std::string& file);
/// "m/s^2" as people write it.
[[nodiscard]] std::string unit_words(const std::string& unit);

/// The channels of a recording over time, linked. Clipped samples are points, other findings marks
/// where they begin and words in the caption. Empty for what is not over time.
[[nodiscard]] std::vector<Plot> recording_plots(const std::string& id,
                                                const signal::Recording& recording,
                                                const std::vector<signal::ChannelQuality>& quality);

// Free decays

/// The record, the fitted decay over its window, and the residual.
[[nodiscard]] Plot decay_plot(const std::string& id, const ident::RecordedDecay& decay);

/// Damping ratio of the strongest mode against amplitude, a series a decay, with 95 % bars. Empty
/// series when no decay has two points.
[[nodiscard]] Plot damping_plot(const std::string& id,
                                const std::vector<ident::RecordedDecay>& decays);

/// The model's response to the same release or tap: record and responses over the first half
/// second. Empty series where nothing could be computed.
[[nodiscard]] Plot release_plot(const std::string& id, const ident::ChannelDecays& decay);

// Hammer tests

struct HammerFigures {
  const std::vector<signal::StruckPoint>& places;  ///< none: FRFs from a file
  const ident::HammerTest& test;                   ///< then its FRFs only
  double low_hz = 0, high_hz = 0;                  ///< without modes; 0: to the last line
  const signal::ModalResult* modal = nullptr;      ///< shown in their band; null: no modes
  std::string name = "test", state = {};           ///< parts of the ids: "cable-frf-200N"
  Origin origin = Origin::measured;
};
/// Hits; magnitude with the modes' own curve, phase and coherence (where there is one) over one
/// abscissa, with the identified modes marked; stabilisation diagram. Ids are `name` and `state`
/// with "-hits", "-frf", "-phase", "-coherence", "-stabilisation" in between.
[[nodiscard]] std::vector<Plot> hammer_plots(const HammerFigures& of);

/// Ambient motion: singular values of the spectral matrix with the modes, stabilisation diagram,
/// shapes of the sure modes. Ids are `id` with "-spectrum", "-stabilisation", "-shapes".
[[nodiscard]] std::vector<Plot> ambient_plots(const std::string& id,
                                              const signal::AmbientResult& found, Origin origin);

/// Magnitudes of the test with their band, and of every version under the test's exponential
/// window; empty series when nothing could be computed.
[[nodiscard]] Plot frf_overlay_plot(const std::string& id, const ident::ModalTestState& recorded,
                                    const ident::Instrumented& rig,
                                    const std::vector<ident::ModelVersion>& versions);

// Tests: all that is shown of one, figures and tables

/// EA at each length, of each record, and the result with its 95 % band (beside it what `test`
/// knows otherwise); tables; the first decay of each length with its fit and residual, a tab a
/// length, and damping over amplitude. Ids are `id` with "-EA", "-lengths",
/// "-decays", "-decay-0.7m" ...
[[nodiscard]] std::vector<Block> axial_blocks(const std::string& id,
                                              const ident::AxialCampaignResult& result,
                                              const CampaignTest* test = nullptr);

/// EI of the usable points with 95 % intervals, laws that converged (the closest with its 95 %
/// band), bounds; the records of every point; tables. Ids are `id` with "-EI", "-results",
/// "-load-deflection" ...
[[nodiscard]] std::vector<Block> bending_blocks(const std::string& id,
                                                const ident::BendingCampaign& campaign,
                                                const ident::BendingCampaignResult& result);

/// A tension: measured and modelled frequencies over mode number, a series a kind of ends; their
/// errors; tables. Ids are `id` with "-frequencies", "-ends" ...
[[nodiscard]] std::vector<Block> tension_blocks(const std::string& id,
                                                const ident::TensionResult& result);

/// A fit: how far the model lies above the test, per cent over frequency, with the test's 95 %
/// bars; shares of variance of the identifiable parameters.
[[nodiscard]] std::vector<Block> fit_blocks(const std::string& id,
                                            const std::vector<ident::UpdateState>& states,
                                            const ident::UpdateResult& result);

// Models

/// A scene to scale, seen from the side: members, supports, masses, sensors and where it is struck
/// or released. The caption names the marks; the data are the places.
[[nodiscard]] Picture rig_picture(const model::Scene& scene);

/// The first 16 modes of the analysis in a parallel projection, six a picture: at rest (broken),
/// moved, with supports, sensors and the nodes of the shape; the shapes of measured rows paired
/// with them as points, scaled to the model's by least squares, with their MAC. `state` stands in
/// the titles where there is one. None without shapes.
[[nodiscard]] std::vector<Picture> shapes_pictures(
    const std::string& id, const std::string& state, const model::Scene& scene,
    const model::ModalAnalysis& analysis, const std::vector<ident::MeasuredRow>& rows = {});

/// Every sensor over time, linked, and the amplitude spectra of all of one unit together.
[[nodiscard]] std::vector<Plot> response_plots(const std::string& id, const model::Scene& scene,
                                               const model::ResponseResult& response);

}  // namespace rigfit::apps
