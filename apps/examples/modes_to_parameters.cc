// Measured frequencies -> fitted parameters of a scene with their uncertainty.
//   modes_to_parameters SCENE.toml PARAMETER... -- FREQUENCY_HZ...
// Frequencies are of in-plane modes and known to 0.1 %.
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <string>
#include <vector>

#include "ident/update/model_update.h"
#include "model/scene/read_scene.h"

int main(int argc, char** argv) try {
  using namespace rigfit;
  ident::UpdateState state;
  std::vector<ident::FreeParameter> free;
  bool measured = false;
  for (int i = 2; i < argc; ++i) {
    if (std::string(argv[i]) == "--") {
      measured = true;
    } else if (!measured) {
      free.push_back({.name = argv[i]});
    } else {
      const double hz = std::atof(argv[i]);
      state.measured.push_back({.frequency_hz = {hz, 1e-3 * hz},
                                .damping_ratio = {std::nan(""), std::nan("")},
                                .plane = model::ModePlane::in});
    }
  }
  if (free.empty() || state.measured.empty()) {
    std::fprintf(stderr, "usage: modes_to_parameters SCENE PARAMETER... -- FREQUENCY_HZ...\n");
    return 2;
  }
  state.scene = model::read_scene(argv[1]);
  const ident::UpdateResult fit = ident::update_model({state}, free);
  for (const ident::UpdatedParameter& p : fit.parameters) {
    std::printf("%s: %.5g at the start, fitted %.5g (std %.2g)\n", p.name.c_str(), p.start, p.value,
                p.std);
  }
  for (const std::string& what : fit.open) std::printf("not separated: %s\n", what.c_str());
  std::printf("rms error of frequencies: %.3f %% before, %.3f %% fitted\n",
              100 * fit.rms_relative_error_before, 100 * fit.rms_relative_error);
  return fit.status == ident::UpdateStatus::converged ? 0 : 5;
} catch (const std::exception& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 3;
}
