// The targets of the readers of recordings; RIGFIT_FUZZED names the one that is built.
#include <sys/mman.h>
#include <unistd.h>

#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <string_view>

#include "signal/readers/frequency_table.h"
#include "signal/readers/read_recording.h"
#include "signal/readers/read_uff_modes.h"
#include "tests/fuzz/require_sound.h"

namespace rigfit::signal::fuzzed {

using Bytes = std::string_view;

/// For readers whose libraries read files: the bytes are put into one in memory.
template <typename Read>
void read_file(Bytes bytes, Read&& read) {
  const int file = ::memfd_create("fuzz", 0);
  if (file < 0 || ::write(file, bytes.data(), bytes.size()) != static_cast<ssize_t>(bytes.size())) {
    return;
  }
  const std::string path = "/proc/self/fd/" + std::to_string(file);
  read_or_refuse([&] { require_sound(read(path)); });
  ::close(file);
}

void require_numbers(const FrfSet& set) {
  if (!set.H.allFinite() || !set.frequency_hz.allFinite() ||
      set.H.rows() != set.frequency_hz.size()) {
    throw std::logic_error("FRFs that are no numbers");
  }
}

void csv(Bytes bytes) { require_sound(read_csv(bytes, "fuzz")); }
void lvm(Bytes bytes) { require_sound(read_lvm(bytes, "fuzz")); }
void npy(Bytes bytes) { require_sound(read_npy(bytes, "fuzz")); }
void wav(Bytes bytes) {
  read_file(bytes, [&](const std::string& path) { return read_wav(bytes, path); });
}
void uff_modes(Bytes bytes) { require_sound(read_uff_modes(bytes, "fuzz")); }
void uff(Bytes bytes) {
  read_or_refuse([&] { require_sound(read_uff(bytes, "fuzz")); });
  require_numbers(read_uff_frfs(bytes, "fuzz"));
}
void frf(Bytes bytes) {
  const auto table = frequency_table_in(bytes, "fuzz");
  if (table) require_numbers(frfs_of({*table}));
}
void mat(Bytes bytes) {
  read_file(bytes, [&](const std::string& path) { return read_mat(bytes, path); });
}

}  // namespace rigfit::signal::fuzzed

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  rigfit::signal::read_or_refuse([&] { rigfit::signal::fuzzed::RIGFIT_FUZZED(bytes); });
  return 0;
}
