#include "model/linear/natural_mode.h"

namespace rigfit::model {

const char* name_of(ModePlane plane) {
  switch (plane) {
    case ModePlane::in:
      return "in";
    case ModePlane::out:
      return "out";
    case ModePlane::mixed:
      return "mixed";
    case ModePlane::axial:
      return "axial";
    case ModePlane::torsion:
      break;
  }
  return "torsion";
}

const char* name_of(ModeFamily family) {
  switch (family) {
    case ModeFamily::cable:
      return "cable";
    case ModeFamily::beam:
      return "beam";
    case ModeFamily::hybrid:
      break;
  }
  return "hybrid";
}

}  // namespace rigfit::model
