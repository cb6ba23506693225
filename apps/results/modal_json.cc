#include "apps/results/modal_json.h"

#include <algorithm>
#include <optional>

#include "apps/describe/json_of.h"

namespace rigfit::apps {

Json hits_json(const ident::StruckPlace& place, const signal::ImpactTest& test) {
  Json hits = Json::array();
  for (const signal::Hit& hit : test.search.hits) {
    hits.push_back({{"file", place.recordings[hit.recording].path.string()}});
    hits.back().update(describe::json_of(hit));
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

}  // namespace rigfit::apps
