#include <cstddef>
#include <cstdint>

#include "tests/fuzz/require_scene.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  rigfit::model::require_scene_or_reason({reinterpret_cast<const char*>(data), size});
  return 0;
}
