#include "apps/report/fit/fit_figures.h"

#include <fmt/format.h>

#include "apps/report/modal/model_overlay.h"
#include "apps/results/modal_files.h"

namespace rigfit::apps {

PlotGroup fit_overlays(const FitOutcome& of) {
  PlotGroup group{of.fit.name + "-overlays", "Test and model, laid over each other", {}};
  for (std::size_t s = 0; s < of.states.size(); ++s) {
    const auto& modal = *of.states[s].modal;
    if (!modal.recorded || modal.rig.response.empty() || modal.rig.input.empty() ||
        !modal.recorded->hammer.amplitudes) {
      continue;
    }
    std::vector<ModelVersion> versions{{"before", of.updates[s].scene}};
    for (const auto& held : of.held) {
      if (held.state == static_cast<int>(s) && held.scene) {
        versions.push_back({"held out", *held.scene});
      }
    }
    versions.push_back({"fitted", of.result.scenes[s]});
    const std::string id = fmt::format("{}-{}", of.fit.name, file_word(of.updates[s].name));
    PlotTab tab{of.updates[s].name, {}};
    tab.plots.push_back(frf_overlay_plot(id + "-frf", *modal.recorded, modal.rig, versions));
    group.tabs.push_back(std::move(tab));
  }
  return group;
}

}  // namespace rigfit::apps
