#include "apps/results/modal_json.h"

#include <algorithm>
#include <limits>
#include <optional>

namespace rigfit::apps {
using Eigen::Index;

Json complex_json(std::complex<double> value) {
  return {{"re", value.real()}, {"im", value.imag()}};
}

Json hits_json(const ident::StruckPlace& place, const signal::ImpactTest& test) {
  Json hits = Json::array();
  for (const signal::Hit& hit : test.search.hits) {
    Json faults = Json::array();
    for (const signal::HitFault fault : hit.faults) faults.push_back(name_of(fault));
    Json one{{"file", place.recordings[hit.recording].path.string()},
             {"time_s", hit.time_s},
             {"peak", hit.peak},
             {"accepted", hit.accepted},
             {"reason", hit.reason},
             {"faults", std::move(faults)},
             {"pulse_samples", hit.pulse_last - hit.pulse_first + 1},
             {"pulse_duration_s", hit.pulse_duration_s},
             {"usable_hz", hit.usable_hz},
             {"end_level", hit.end_level}};
    if (hit.second_hit > 0) {
      one["second_hit"] = {{"ratio", hit.second_hit}, {"delay_s", hit.second_hit_delay_s}};
    }
    hits.push_back(std::move(one));
  }
  return hits;
}

Json force_window_json(const ident::HammerTest& hammer) {
  double kept = 0, left = 0;
  std::optional<double> before;
  bool chosen = false;
  for (const signal::ImpactTest& test : hammer.tests) {
    if (test.frfs.averages == 0) continue;
    kept = std::max(kept, test.force_window_s);
    left = std::max(left, test.force_noise_left);
    chosen = chosen || test.force_window_by_noise;
    if (test.force_noise) before = std::max(before.value_or(0), *test.force_noise);
  }
  return {{"kept_s", kept > 0 ? Json(kept) : Json(nullptr)},
          {"chosen_by", chosen ? "noise" : "option"},
          {"force_noise", before ? Json(*before) : Json(nullptr)},
          {"force_noise_left", before ? Json(left) : Json(nullptr)}};
}

namespace {

Json point_json(const signal::ModeAtPoint& at) {
  return {{"name", at.point.name},
          {"node", at.point.node},
          {"direction", at.point.direction},
          {"order", at.order},
          {"frequency_hz", json_estimate(at.frequency_hz.value, at.frequency_hz.std)},
          {"damping_ratio", json_estimate(at.damping_ratio.value, at.damping_ratio.std)},
          {"misfit", at.misfit}};
}

}  // namespace

Json mode_json(const signal::IdentifiedMode& mode) {
  const bool refused = mode.damping_dominated_by_window;
  Json shape = Json::array(), participation = Json::array();
  for (Index o = 0; o < mode.shape.size(); ++o) {
    shape.push_back({{"re", mode.shape[o].real()},
                     {"im", mode.shape[o].imag()},
                     {"std_re", mode.shape_std(o, 0)},
                     {"std_im", mode.shape_std(o, 1)}});
  }
  for (const auto& value : mode.participation) participation.push_back(complex_json(value));
  Json points = Json::array();
  for (const auto& point : mode.points) points.push_back(point_json(point));
  const double nothing = std::numeric_limits<double>::quiet_NaN();  // null in the document
  return {{"frequency_hz", json_estimate(mode.frequency_hz.value, mode.frequency_hz.std)},
          {"damping_ratio", json_estimate(refused ? nothing : mode.damping_ratio.value,
                                          refused ? nothing : mode.damping_ratio.std)},
          {"damping_ratio_with_window", mode.damping_ratio_with_window},
          {"damping_refused", refused},
          {"pole_rad_s", complex_json(mode.pole_rad_s)},
          {"shape", std::move(shape)},
          {"participation", std::move(participation)},
          {"modal_phase_collinearity", mode.modal_phase_collinearity},
          {"reconstruction_error", mode.reconstruction_error},
          {"presence", mode.presence},
          {"significance", mode.significance},
          {"refinement", mode.refinement},
          {"between_points_std_hz", mode.between_points_std_hz},
          {"between_points_std_damping", mode.between_points_std_damping},
          {"trend_hz_per_point", json_estimate(mode.trend_hz.value, mode.trend_hz.std)},
          {"trend_certain", mode.has_trend},
          {"points", std::move(points)},
          {"between_hits", mode.between_hits.hits > 1
                               ? Json{{"hits", mode.between_hits.hits},
                                      {"frequency_std_hz", mode.between_hits.frequency_std_hz},
                                      {"damping_std", mode.between_hits.damping_std},
                                      {"beyond_noise", mode.between_hits.beyond_noise}}
                               : Json(nullptr)},
          {"doubtful", mode.doubtful},
          {"doubt", mode.doubt}};
}

}  // namespace rigfit::apps
