// What the campaign reader owes for any bytes: a campaign whose parts are there, or a SceneError
// with a reason and a remedy.
#pragma once

#include <cmath>
#include <filesystem>
#include <stdexcept>
#include <string_view>

#include "apps/campaign/campaign.h"
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
    bool published = false;
    if (test.is<BendingTest>()) {
      const auto& bending = test.as<BendingTest>();
      const double span = bending.test.span_m.value;
      require(std::isfinite(span) && span > 0, "span");
      published = bending.published();
    } else if (test.is<ModalTest>()) {
      const auto& modal = test.as<ModalTest>();
      published = !modal.published.empty();
      require(!published || modal.scene, "published modes without a scene");
      const auto& band = modal.options.hammer.impact.hits.band_hz;
      require(!band || band->first < band->second, "band");
      const auto& direction = modal.direction;
      require(!direction || std::abs(direction->norm() - 1) < 1e-9, "direction");
    } else if (test.is<TensionTest>()) {
      published = !test.as<TensionTest>().modes.empty();
    }
    require(published || !test.recordings.empty(), "a test without data");
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
      const auto& [targets, factors] = std::tie(parameter.targets, parameter.factors);
      require(!targets.empty() && parameter.low < parameter.high, "a parameter to fit");
      require(factors.empty() || factors.size() == targets.size(), "factors");
    }
  }
}

inline void require_campaign_or_reason(std::string_view bytes, const std::filesystem::path& path) {
  model::read_or_refuse([&] { require_sound(parse_campaign(bytes, path)); });
}

}  // namespace rigfit::apps
