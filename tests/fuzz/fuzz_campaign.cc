// The folder it starts at holds a scene, tables and recordings for campaigns to name.
#include <unistd.h>

#include <cstddef>
#include <cstdint>
#include <cstdlib>

#include "tests/fuzz/require_campaign.h"

extern "C" int LLVMFuzzerInitialize(int*, char***) {
  if (::chdir(RIGFIT_FUZZ "/campaign_folder") != 0) std::abort();
  return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  rigfit::apps::require_campaign_or_reason(bytes, "campaign.toml");
  return 0;
}
