// Every reader under libFuzzer: RIGFIT_FUZZED names the one that is fed, `seeds` has a folder for
// each; campaigns name the files of `campaign_folder`.
#include <sys/mman.h>
#include <unistd.h>

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <stdexcept>
#include <string>
#include <string_view>

#include "signal/readers/frequency_table.h"
#include "signal/readers/read_recording.h"
#include "tests/fuzz/require_campaign.h"
#include "tests/fuzz/require_scene.h"
#include "tests/fuzz/require_sound.h"

namespace rigfit {
namespace {

using Bytes = std::string_view;

template <auto* Read>
void read(Bytes bytes) {
  signal::require_sound(Read(bytes, "fuzz", {}));
}

/// For readers whose libraries read files: the bytes are put into one in memory.
template <auto* Read>
void read_file(Bytes bytes) {
  const int file = ::memfd_create("fuzz", 0);
  if (::write(file, bytes.data(), bytes.size()) != std::ssize(bytes)) return;
  const std::string path = "/proc/self/fd/" + std::to_string(file);
  signal::read_or_refuse([&] { signal::require_sound(Read(bytes, path, {})); });
  ::close(file);
}

void require_numbers(const signal::FrfSet& set) {
  if (!set.H.allFinite() || !set.frequency_hz.allFinite() ||
      set.H.rows() != set.frequency_hz.size()) {
    throw std::logic_error("FRFs that are no numbers");
  }
}

void uff(Bytes bytes) {
  signal::read_or_refuse([&] { signal::require_sound(signal::read_uff(bytes, "fuzz")); });
  require_numbers(signal::read_uff_frfs(bytes, "fuzz"));
}
void frf(Bytes bytes) {
  const auto table = signal::frequency_table_in(bytes, "fuzz");
  if (table) require_numbers(signal::frfs_of({*table}));
}

const std::map<std::string, void (*)(Bytes), std::less<>> kReaders{
    {"csv", read<signal::read_csv>},
    {"lvm", read<signal::read_lvm>},
    {"npy", read<signal::read_npy>},
    {"wav", read_file<signal::read_wav>},
    {"mat", read_file<signal::read_mat>},
    {"uff", uff},
    {"uff_modes", [](Bytes b) { signal::require_sound(signal::read_uff_modes(b, "fuzz")); }},
    {"frf", frf},
    {"scene", [](Bytes b) { model::require_scene_or_reason(b); }},
    {"campaign", [](Bytes b) { apps::require_campaign_or_reason(b, "campaign.toml"); }},
};
void (*fuzzed)(Bytes) = nullptr;

}  // namespace
}  // namespace rigfit

extern "C" int LLVMFuzzerInitialize(int*, char***) {
  const char* reader = std::getenv("RIGFIT_FUZZED");
  const auto found = rigfit::kReaders.find(reader == nullptr ? "" : reader);
  if (found == rigfit::kReaders.end()) {
    std::fputs("fuzz: set RIGFIT_FUZZED to the reader to feed, such as csv\n", stderr);
    std::exit(2);
  }
  rigfit::fuzzed = found->second;
  if (::chdir(RIGFIT_FUZZ "/campaign_folder") != 0) std::abort();
  return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  rigfit::signal::read_or_refuse([&] {
    rigfit::fuzzed({reinterpret_cast<const char*>(data), size});
  });
  return 0;
}
