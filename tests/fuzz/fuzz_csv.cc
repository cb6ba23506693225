#include <cstddef>
#include <cstdint>

#include "signal/readers/files/read_formats.h"
#include "tests/fuzz/require_sound.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace rigfit::signal;
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  read_or_refuse([&] { require_sound(read_csv(bytes, "fuzz")); });
  return 0;
}
