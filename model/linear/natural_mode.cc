#include "model/linear/natural_mode.h"

namespace rigfit::model {

const char* name_of(ModePlane plane) {
  constexpr const char* kNames[] = {"in", "out", "mixed", "axial", "torsion"};
  return kNames[static_cast<std::size_t>(plane)];
}

const char* name_of(ModeFamily family) {
  constexpr const char* kNames[] = {"cable", "beam", "hybrid"};
  return kNames[static_cast<std::size_t>(family)];
}

}  // namespace rigfit::model
