// Tensions of several cables from their frequencies: what a laboratory or a bridge survey did, and
// what follows. One cable that cannot be solved does not keep the others from it.
#pragma once

#include <string>
#include <vector>

#include "ident/campaign/single_tests/finding.h"
#include "ident/tension/cable_tension.h"

namespace rigfit::ident {

struct CableTest {
  std::string name;
  CableDescription cable;
  std::vector<MeasuredMode> modes;
  TensionOptions options = {};
};

struct CableTestResult {
  std::string name;
  TensionResult tension;          ///< `solved` false: see its message
  std::vector<Finding> findings;  ///< refusals and warnings, for a person
};

/// One cable. Numbers that make no sense are a refusal, not an exception.
[[nodiscard]] CableTestResult analyse_cable_test(const CableTest& test);
/// Several at a time on `threads`; the same numbers whatever their count.
[[nodiscard]] std::vector<CableTestResult> analyse_cable_tests(const std::vector<CableTest>& tests,
                                                               int threads = 1);

/// Why a result is not what it seems, in words.
[[nodiscard]] std::vector<Finding> tension_findings(const TensionResult& result,
                                                    const CableDescription& cable);

}  // namespace rigfit::ident
