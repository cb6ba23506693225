#include <cstddef>
#include <cstdint>

#include "signal/readers/uff/read_uff.h"
#include "tests/fuzz/require_sound.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace rigfit::signal;
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  read_or_refuse([&] { require_sound(read_uff(bytes, "fuzz")); });
  read_or_refuse([&] { require_sound(read_uff_functions(bytes, "fuzz")); });
  read_or_refuse([&] {
    const FrfSet set = read_uff_frfs(bytes, "fuzz");
    if (!set.H.allFinite()) throw std::logic_error("an FRF that is no number");
  });
  return 0;
}
