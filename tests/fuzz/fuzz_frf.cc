#include <cstddef>
#include <cstdint>

#include "signal/readers/csv/frequency_table.h"
#include "tests/fuzz/require_sound.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace rigfit::signal;
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  read_or_refuse([&] {
    const auto table = read_frequency_table(bytes, "fuzz");
    if (!table || !holds_frfs(*table)) return;
    const FrfSet set = frfs_of({*table});
    if (!set.H.allFinite() || !set.frequency_hz.allFinite() ||
        set.H.rows() != set.frequency_hz.size()) {
      throw std::logic_error("FRFs that are no numbers");
    }
  });
  return 0;
}
