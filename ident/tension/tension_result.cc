#include "ident/tension/tension_result.h"

#include <array>
#include <string>
#include <vector>

namespace rigfit::ident {

const char* name_of(CableEnds ends) {
  constexpr std::array names{"pinned", "clamped", "springs", "pinned-clamped"};
  return names[static_cast<std::size_t>(ends)];
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
