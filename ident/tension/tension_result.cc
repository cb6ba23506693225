#include "ident/tension/tension_result.h"

#include <string>
#include <vector>

namespace rigfit::ident {

const char* name_of(CableEnds ends) {
  switch (ends) {
    case CableEnds::pinned:
      return "pinned";
    case CableEnds::clamped:
      return "clamped";
    case CableEnds::springs:
      return "springs";
    case CableEnds::pinned_clamped:
      return "pinned-clamped";
  }
  return "";
}

std::vector<CableEnds> cable_ends(const std::string& word) {
  std::vector<CableEnds> ends;
  for (const CableEnds one :
       {CableEnds::pinned, CableEnds::clamped, CableEnds::springs, CableEnds::pinned_clamped}) {
    if (word == "compare" || word == name_of(one)) ends.push_back(one);
  }
  return ends;
}

}  // namespace rigfit::ident
