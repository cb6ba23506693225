// libmatio reads files: the bytes are put into one in memory.
#include <sys/mman.h>
#include <unistd.h>

#include <cstddef>
#include <cstdint>
#include <string>

#include "signal/readers/files/read_formats.h"
#include "tests/fuzz/require_sound.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace rigfit::signal;
  const int file = ::memfd_create("fuzz", 0);
  if (file < 0 || ::write(file, data, size) != static_cast<ssize_t>(size)) return 0;
  const std::string path = "/proc/self/fd/" + std::to_string(file);
  read_or_refuse([&] { require_sound(read_mat(path)); });
  ::close(file);
  return 0;
}
