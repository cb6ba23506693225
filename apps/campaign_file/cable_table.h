// A table of cables, one a row, for their tensions.
//
//   name, length, mass_per_length [, EI, EA, inclination, ends, plane, mass_of], f1, f2, ...
//   and, of each: length_std, mass_per_length_std, EI_std, EA_std; frequency_std of all frequencies
//
// Lengths in m, mass in kg/m, EI in N m2, EA in N, frequencies in Hz, inclination in degrees; other
// units in brackets, "EA (kN)" (text_table.h). `ends` is compare, pinned, clamped or springs,
// `plane` in, out or any, `mass_of` installed or unstretched. Frequencies in columns f1, f2 ..., or
// several in one cell "frequencies" with blanks between. Blank: not known. A row that cannot be
// used is named with its line and reason; the others are read all the same.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "ident/campaign/single_tests/tension_campaign.h"

namespace rigfit::apps {

struct CableTableRow {
  long line = 0;
  ident::TensionInputs test;
  std::string error;  ///< why the row cannot be used; empty: it can
};

/// Throws model::SceneError for a table without a needed column or without rows.
[[nodiscard]] std::vector<CableTableRow> read_cable_table(const std::filesystem::path& path);

}  // namespace rigfit::apps
