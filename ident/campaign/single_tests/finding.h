// What an analysis has to say beside its numbers: warnings, and what was refused and why.
#pragma once

#include <string>

namespace rigfit::ident {

struct Finding {
  std::string code;      ///< stable, for programs
  std::string message;   ///< for a person, with figures
  std::string where;     ///< file, channel, place struck, mode ...; empty: the whole
  bool refused = false;  ///< part of what was asked cannot be had
};

}  // namespace rigfit::ident
