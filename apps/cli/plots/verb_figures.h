// What verbs draw with --plot: the report's figures of one kind of test, gathered.
#pragma once

#include <string>
#include <vector>

#include "apps/cli/plots/plot_option.h"
#include "apps/report/figures/figures.h"
#include "ident/campaign/modal/hammer_campaign.h"
#include "ident/campaign/single_tests/axial_campaign.h"
#include "ident/campaign/single_tests/bending_campaign.h"
#include "ident/campaign/single_tests/decay_campaign.h"
#include "ident/tension/cable_tension.h"
#include "ident/update/update_checks.h"
#include "model/linear/modal_analysis.h"
#include "model/response/response.h"
#include "signal/ambient/ambient_result.h"
#include "signal/quality/quality.h"

namespace rigfit::apps {

/// Every channel of a recording.
void draw_recording(PlotSheet& sheet, const signal::Recording& recording,
                    const signal::QualityResult& quality);

/// Hits, FRFs and, where there are any, modes.
void draw_hammer_test(PlotSheet& sheet, const HammerFigures& figures);

/// Singular values of the spectral matrix with the modes, stabilisation diagram.
void draw_ambient(PlotSheet& sheet, const signal::AmbientResult& found);

/// The strongest decay of a channel, and damping over amplitude.
void draw_decay(PlotSheet& sheet, const std::string& file, const ident::ChannelDecays& decays);

void draw_bending(PlotSheet& sheet, const ident::BendingCampaign& campaign,
                  const ident::BendingCampaignResult& result);

/// EA by length, decays, budget.
void draw_axial(PlotSheet& sheet, const ident::AxialInputs& inputs,
                const ident::AxialCampaignResult& result);

/// Pairs, errors, MAC, budget.
void draw_update(PlotSheet& sheet, const std::vector<ident::UpdateState>& states,
                 const ident::UpdateResult& result, const std::vector<ident::HeldOut>& held);

/// Measured and modelled frequencies by mode, tension by candidate, budget.
void draw_tension(PlotSheet& sheet, const ident::TensionResult& result);

/// Frequencies, and shapes over the equilibrium with supports and sensors.
void draw_modes(PlotSheet& sheet, const model::Scene& scene, const model::ModalAnalysis& analysis);

/// Every sensor over time and its spectrum.
void draw_response(PlotSheet& sheet, const model::Scene& scene,
                   const model::ResponseResult& response);

}  // namespace rigfit::apps
