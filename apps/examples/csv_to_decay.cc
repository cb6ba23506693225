// A recording with a free decay -> frequency and damping ratio with their standard uncertainties.
//   csv_to_decay FILE CHANNEL
// A TOML file beside the recording, if there is one, names and scales its channels.
#include <cstdio>
#include <exception>

#include "signal/decay/decay.h"
#include "signal/readers/read_recording.h"
#include "signal/readers/recording_description.h"

int main(int argc, char** argv) try {
  using namespace rigfit;
  if (argc != 3) {
    std::fprintf(stderr, "usage: csv_to_decay FILE CHANNEL\n");
    return 2;
  }
  signal::Recording recording = signal::read_recording(argv[1]);
  for (const auto& file : signal::descriptions_of(argv[1])) {
    signal::apply_description(signal::read_description(file), recording);
  }
  const signal::Channel& channel = recording.channel(argv[2]);
  const signal::DecayResult decay =
      signal::estimate_decay(channel.samples, recording.sample_rate_hz);
  if (!decay.refusal.empty()) {
    std::fprintf(stderr, "%s\n", decay.refusal.c_str());
    return 4;
  }
  for (const signal::DecayMode& mode : decay.modes) {
    std::printf("%.5f Hz (std %.1e), damping ratio %.6f (std %.1e)\n", mode.frequency_hz.value,
                mode.frequency_hz.std, mode.damping_ratio.value, mode.damping_ratio.std);
  }
  return 0;
} catch (const std::exception& error) {  // file, channel, value and remedy
  std::fprintf(stderr, "%s\n", error.what());
  return 3;
}
