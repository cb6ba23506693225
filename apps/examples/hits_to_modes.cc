// Recordings of hammer hits -> FRFs -> modes with their standard uncertainties.
//   hits_to_modes FORCE LOW_HZ HIGH_HZ FILE...
// FORCE is the hammer's channel; every other acceleration channel is a response.
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <string>
#include <vector>

#include "signal/impact/impact_frfs.h"
#include "signal/modal/modal_identification.h"
#include "signal/readers/read_recording.h"

int main(int argc, char** argv) try {
  using namespace rigfit;
  if (argc < 5) {
    std::fprintf(stderr, "usage: hits_to_modes FORCE LOW_HZ HIGH_HZ FILE...\n");
    return 2;
  }
  std::vector<signal::Recording> recordings;
  for (int i = 4; i < argc; ++i) recordings.push_back(signal::read_recording(argv[i]));
  std::vector<std::string> responses;
  for (const signal::Channel& channel : recordings.front().channels) {
    if (channel.quantity == signal::Quantity::acceleration) responses.push_back(channel.name);
  }

  signal::ImpactTestOptions hitting;
  hitting.exponential_end_level = 0.05;  // the window's value at a block's end; poles come without
  const signal::ImpactTest test =
      signal::analyse_impact_test(recordings, argv[1], responses, hitting);
  for (const signal::Hit& hit : test.search.hits) {
    std::printf("hit: %s\n", hit.accepted ? "accepted" : hit.reason.c_str());
  }
  if (test.frfs.frequency_hz.size() == 0) return 4;

  signal::ModalOptions options;
  options.low_hz = std::atof(argv[2]), options.high_hz = std::atof(argv[3]);
  for (const signal::IdentifiedMode& mode :
       signal::identify_modes(test.frfs, options).model.modes) {
    std::printf("%9.4f Hz (std %.1e), damping ratio %.5f (std %.1e)%s\n", mode.frequency_hz.value,
                mode.frequency_hz.std, mode.damping_ratio.value, mode.damping_ratio.std,
                mode.doubtful ? " doubtful" : "");
  }
  return 0;
} catch (const std::exception& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 3;
}
