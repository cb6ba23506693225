// The scene reader is fed with seeds, with regressions of faults found by fuzzing and with
// thousands of mutations of both. It gives a scene that reads back from its own text, or a reason.
#include "tests/fuzz/mutations.h"
#include "tests/fuzz/require_scene.h"
#include "tests/test.h"

namespace rigfit::model::malformed_scene_test {
namespace {

TEST(MalformedScene, SeedsAndMutationsGiveASceneOrAReason) {
  const auto seeds = seeds_of("scene");
  ASSERT_GE(seeds.size(), 3u);
  std::mt19937_64 random(20260402);
  for (const auto& seed : seeds) {
    EXPECT_NO_THROW(require_scene_or_reason(seed.bytes)) << seed.name;
    for (int k = 0; k < 1000; ++k) {
      const std::string bytes = mutated(seed.bytes, toml_words(), random);
      EXPECT_NO_THROW(require_scene_or_reason(bytes)) << seed.name << ", mutation " << k << ":\n"
                                                      << bytes;
    }
  }
}

TEST(MalformedScene, SeedsAreScenes) {
  for (const auto& seed : seeds_of("scene")) {
    if (!std::filesystem::exists(RIGFIT_FUZZ "/seeds/scene/" + seed.name)) continue;
    EXPECT_NO_THROW(require_sound(parse_scene(seed.bytes, seed.name))) << seed.name;
  }
}

}  // namespace
}  // namespace rigfit::model::malformed_scene_test
