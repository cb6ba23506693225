#include "apps/cli/plots/verb_figures.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "apps/report/page/tables.h"

namespace rigfit::apps {
namespace {

using Eigen::Index;

void add_drawn(PlotSheet& sheet, Plot plot) {
  if (!plot.series.empty()) sheet.add(Block(std::move(plot)));
}

}  // namespace

void draw_ambient(PlotSheet& sheet, const signal::AmbientResult& found) {
  signal::ModalResult poles;
  poles.stabilisation = found.stabilisation;
  Plot plot{"ambient-spectrum",
            "Singular values of the spectral matrix",
            "Motion of all channels together, each over its standard deviation. A mode is a peak "
            "of the first singular value; where the second rises with it, two modes are close. "
            "Lines: modes, broken where they are uncertain.",
            "frequency, Hz",
            "singular value",
            false,
            true};
  plot.link = plot.id;
  for (const auto& one : found.modes) {
    const double f = one.mode.frequency_hz.value;
    plot.marks.push_back({f, fmt::format("{:.4g}", f), Origin::modelled, one.mode.doubtful});
    if (!one.mode.doubtful) poles.model.modes.push_back(one.mode);
  }
  for (Index k = 0; k < std::min<Index>(3, found.singular_values.cols()); ++k) {
    PlotSeries series{fmt::format("singular value {}", k + 1), Origin::measured,
                      static_cast<int>(k)};
    for (Index i = 0; i < found.spectrum_hz.size(); ++i) {
      series.add(found.spectrum_hz[i], found.singular_values(i, k));
    }
    plot.series.push_back(std::move(series));
  }
  add_drawn(sheet, std::move(plot));
  if (poles.stabilisation.poles.empty()) return;
  Plot diagram = stabilisation_plot("ambient-stabilisation", poles, Origin::measured);
  diagram.link = "ambient-spectrum";
  add_drawn(sheet, std::move(diagram));
}

void draw_recording(PlotSheet& sheet, const signal::Recording& recording,
                    const signal::QualityResult& quality) {
  const std::string id = fmt::format("recording-{}", sheet.blocks.size() + 1);
  for (auto& plot : recording_plots(id, recording, quality)) {
    add_drawn(sheet, std::move(plot));
  }
}

void draw_hammer_test(PlotSheet& sheet, const HammerFigures& figures) {
  for (auto& plot : hammer_plots(figures)) add_drawn(sheet, std::move(plot));
  if (!figures.modal || figures.frfs.responses.size() < 2) return;
  if (const auto& mac = figures.modal->auto_mac; mac.rows() > 1) {
    std::vector<std::string> names;
    for (const auto& mode : figures.modal->model.modes)
      names.push_back(fmt::format("{:.5g} Hz", mode.frequency_hz.value));
    sheet.add(Block(matrix_table("mac",
                                 "MAC between the modes: how alike two shapes are at the sensors, "
                                 "near 0 beside the diagonal when there are enough of them.",
                                 mac, names)));
  }
}

void draw_decay(PlotSheet& sheet, const std::string& file, const ident::ChannelDecays& decays) {
  std::vector<AnalysedDecay> drawn{{file, decays.channel, decays.unit, Origin::measured,
                                    decays.sample_rate_hz, decays.start_time_s, decays.samples,
                                    decays.strongest}};
  add_drawn(sheet, decay_plot("decay", drawn.front()));
  add_drawn(sheet, damping_plot("damping", drawn));
}

void draw_bending(PlotSheet& sheet, const ident::BendingCampaign& campaign,
                  const ident::BendingCampaignResult& result) {
  const std::vector<Origin> origins(campaign.sources.size(), Origin::measured);
  add_drawn(sheet, load_deflection_plot("load-deflection", campaign, origins, result));
  add_drawn(sheet, stiffness_plot("EI", origins, result));
}

void draw_axial(PlotSheet& sheet, const ident::AxialInputs& inputs,
                const ident::AxialCampaignResult& result) {
  if (result.test) {
    add_drawn(sheet, axial_length_plot("EA", *result.test, Origin::measured));
  }
  const std::vector<Origin> origins(inputs.recordings.size(), Origin::measured);
  sheet.add(axial_decay_blocks("axial", inputs, result, origins));
}

void draw_update(PlotSheet& sheet, const std::vector<ident::UpdateState>& states,
                 const ident::UpdateResult& result, const std::vector<ident::HeldOut>& held) {
  sheet.add(fit_blocks("fit", states, result, held));
}

void draw_tension(PlotSheet& sheet, const ident::TensionResult& result) {
  sheet.add(tension_blocks("tension", result));
}

void draw_modes(PlotSheet& sheet, const model::Scene& scene, const model::ModalAnalysis& analysis) {
  sheet.add(modes_blocks("shapes", scene, analysis));
}

void draw_response(PlotSheet& sheet, const model::Scene& scene,
                   const model::ResponseResult& response) {
  for (auto& plot : response_plots("response", scene, response)) add_drawn(sheet, std::move(plot));
}

}  // namespace rigfit::apps
