// What the campaign reader owes for any bytes: a campaign whose parts are there, or a SceneError
// with a reason and a remedy.
#pragma once

#include <cmath>
#include <filesystem>
#include <stdexcept>
#include <string_view>

#include "apps/campaign_file/campaign.h"
#include "tests/fuzz/require_scene.h"

namespace rigfit::apps {

/// Throws std::logic_error when a campaign breaks what campaign.h promises.
inline void require_sound(const Campaign& campaign) {
  const auto require = [](bool good, const char* what) {
    if (!good) throw std::logic_error(what);
  };
  require(!campaign.tests.empty(), "a campaign without tests");
  for (const auto& test : campaign.tests) {
    require(!test.name.empty(), "a test without a name");
    require(!test.scene || *test.scene < campaign.scenes.size(), "a scene that is not there");
    require(test.kind != CampaignTest::Kind::modal || test.scene, "a modal test without a scene");
    require(test.results || !test.recordings.empty(), "a test without data");
    require(std::isfinite(test.span_m) && test.span_m >= 0, "span");
    if (test.band_hz) require(test.band_hz->first < test.band_hz->second, "band");
    if (test.direction) require(std::abs(test.direction->norm() - 1) < 1e-9, "direction");
    for (const auto& group : test.recordings) {
      require(!group.files.empty() || !group.missing.empty(), "a recording that names nothing");
    }
  }
  for (const auto& fit : campaign.fits) {
    require(!fit.tests.empty() && !fit.parameters.empty(), "a fit of nothing");
    for (const std::size_t test : fit.tests) {
      require(test < campaign.tests.size(), "a test that is not there");
    }
    for (const auto& parameter : fit.parameters) {
      const auto& free = parameter.free;
      require(!free.targets.empty() && free.low < free.high, "a parameter to fit");
      require(free.factors.empty() || free.factors.size() == free.targets.size(), "factors");
    }
  }
}

inline void require_campaign_or_reason(std::string_view bytes, const std::filesystem::path& path) {
  model::read_or_refuse([&] { require_sound(parse_campaign(bytes, path)); });
}

}  // namespace rigfit::apps
