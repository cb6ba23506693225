// Texts of options that name something: "cable.EI=0.6,0.02", "tip.mass=5%", "left.EI,-right.EI".
#pragma once

#include "apps/describe/standard.h"

namespace rigfit::apps {

/// Name and text of "NAME=TEXT"; throws UsageError with the option's name and `form`, how it is to
/// be written, where the name, or TEXT unless it `may_be_empty`, is empty.
[[nodiscard]] std::pair<std::string, std::string> named_text(const std::string& option,
                                                             const std::string& text,
                                                             const std::string& form,
                                                             bool may_be_empty = false);

struct NamedNumbers {
  std::string name;
  std::vector<double> numbers;
  bool relative = false;  ///< the only number was in percent, and is given as a ratio
};

/// "NAME=NUMBER,NUMBER ..." with `fewest` to `most` numbers, or "NAME=NUMBER%" where `percent`
/// allows it. Numbers are finite, the last one positive. Throws UsageError as above.
[[nodiscard]] NamedNumbers named_numbers(const std::string& option, const std::string& text,
                                         const std::string& form, std::size_t fewest,
                                         std::size_t most, bool percent = false);

struct SignedNames {
  std::vector<std::string> names;
  std::vector<double> signs;  ///< 1; -1 where the name stands behind a minus
};

/// "NAME,-NAME". Throws UsageError for an empty name.
[[nodiscard]] SignedNames signed_names(const std::string& option, const std::string& text);

}  // namespace rigfit::apps
