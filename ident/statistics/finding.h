// Warnings and refusals that accompany the numbers of an analysis.
#pragma once

#include <string>

namespace rigfit::ident {

struct Finding {
  std::string code;        ///< stable, for programs
  std::string message;     ///< for a person, with figures
  std::string where = {};  ///< file, channel, point, mode ...; empty: the whole test
  bool refused = false;    ///< true: a result is missing because of it
};

}  // namespace rigfit::ident
