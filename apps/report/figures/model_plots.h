// A segment model as figures: mode shapes about the equilibrium, frequencies, time responses.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "apps/report/page/report_part.h"
#include "model/linear/modal_analysis.h"
#include "model/response/response.h"
#include "model/scene/scene.h"

namespace rigfit::apps {

/// A measured mode to lay over a modelled one.
struct MeasuredShape {
  std::size_t mode = 0;  ///< of the analysis
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
