#include "apps/cli/plots/verb_figures.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "apps/report/drawing/html_text.h"
#include "apps/report/figures/figures.h"
#include "apps/report/page/shaded_tables.h"
#include "signal/modes/modal_synthesis.h"

namespace rigfit::apps {
namespace {

using Eigen::Index;

template <class Made>
void add(PlotSheet& sheet, std::optional<Made> made) {
  if (made) sheet.add(Block(std::move(*made)));
}

void add_drawn(PlotSheet& sheet, Plot plot) {
  if (!plot.series.empty()) sheet.add(Block(std::move(plot)));
}

}  // namespace

void draw_ambient(PlotSheet& sheet, const signal::AmbientResult& found) {
  signal::ModalResult poles;
  poles.stabilisation = found.stabilisation;
  Plot plot;
  plot.id = "ambient-spectrum";
  plot.title = "Singular values of the spectral matrix";
  plot.caption =
      "Motion of all channels together, each over its standard deviation. A mode is a peak of the "
      "first singular value; where the second rises with it, two modes are close. Lines: modes, "
      "broken where they are uncertain.";
  plot.x_label = "frequency, Hz";
  plot.y_label = "singular value";
  plot.log_y = true;
  plot.link = plot.id;
  for (const auto& one : found.modes) {
    const double f = one.mode.frequency_hz.value;
    plot.marks.push_back({f, fmt::format("{:.4g}", f), Origin::modelled, one.mode.doubtful});
    if (!one.mode.doubtful) poles.model.modes.push_back(one.mode);
  }
  for (Index k = 0; k < std::min<Index>(3, found.singular_values.cols()); ++k) {
    PlotSeries series;
    series.name = fmt::format("singular value {}", k + 1);
    series.origin = Origin::measured;
    series.variant = static_cast<int>(k);
    for (Index i = 0; i < found.spectrum_hz.size(); ++i) {
      series.x.push_back(found.spectrum_hz[i]);
      series.y.push_back(found.singular_values(i, k));
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
  for (auto& plot : recording_plots(id, recording, quality, Origin::measured)) {
    add_drawn(sheet, std::move(plot));
  }
}

void draw_hammer_test(PlotSheet& sheet, const HammerFigures& figures) {
  if (figures.places && figures.test && figures.test->hits() > 0) {
    add_drawn(sheet, hits_plot("hits", *figures.places, *figures.test, Origin::measured));
  }
  const auto& frfs = figures.frfs;
  if (frfs.frequency_hz.size() == 0) return;
  const double last = frfs.frequency_hz[frfs.frequency_hz.size() - 1];
  const LineRange range =
      lines_between(frfs, figures.low_hz, figures.high_hz > 0 ? figures.high_hz : last);
  if (range.last < range.first) return;
  std::optional<signal::FrfSet> rebuilt;
  if (figures.modal && !figures.modal->model.modes.empty()) {
    rebuilt = signal::synthesised(
        *figures.modal, frfs.frequency_hz.segment(range.first, range.last - range.first + 1),
        frfs.form);
  }
  for (auto& plot : frf_figures({"test", "", Origin::measured}, frfs, range, figures.modal,
                                rebuilt ? &*rebuilt : nullptr)) {
    add_drawn(sheet, std::move(plot));
  }
  if (!figures.modal) return;
  const auto& modes = figures.modal->model.modes;
  if (const auto& mac = figures.modal->auto_mac; mac.rows() > 1 && frfs.responses.size() > 1) {
    std::vector<std::string> names;
    names.reserve(modes.size());
    for (const auto& mode : modes)
      names.push_back(fmt::format("{:.5g} Hz", mode.frequency_hz.value));
    sheet.add(Block(matrix_table("mac",
                                 "MAC between the modes: how alike two shapes are at the sensors, "
                                 "near 0 beside the diagonal when there are enough of them.",
                                 mac, names, names)));
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
  add_drawn(sheet, stiffness_plot("EI", stiffness_series(result, origins), result));
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
  const FitFigures fit{states, result, held};
  add_drawn(sheet, error_by_mode_plot("errors-by-mode", fit));
  add(sheet, budget_table("budget", result));
}

void draw_tension(PlotSheet& sheet, const ident::TensionResult& result) {
  for (auto& plot : tension_plots("tension", result)) add_drawn(sheet, std::move(plot));
  Shares shares{"tension", {}};
  for (const auto& term : result.budget) {
    if (std::isfinite(term.std)) shares.parts.emplace_back(term.source, term.std * term.std);
  }
  if (shares.parts.empty()) return;
  sheet.add(Block(share_table("tension-budget",
                              "Where the uncertainty of the tension comes from: shares of its "
                              "variance.",
                              {shares})));
}

void draw_modes(PlotSheet& sheet, const model::Scene& scene, const model::ModalAnalysis& analysis) {
  if (analysis.modes.empty()) return;
  for (auto& picture : shapes_pictures("shapes", "", scene, analysis)) {
    sheet.add(Block(std::move(picture)));
  }
  add_drawn(sheet, mode_frequencies_plot("frequencies", analysis));
}

void draw_response(PlotSheet& sheet, const model::Scene& scene,
                   const model::ResponseResult& response) {
  for (auto& plot : response_plots("response", scene, response)) add_drawn(sheet, std::move(plot));
}

}  // namespace rigfit::apps
