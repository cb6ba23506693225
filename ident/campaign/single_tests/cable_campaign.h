// Identifies the tensions of several cables from their frequencies, as in a laboratory or a bridge
// survey. A cable that cannot be solved does not affect the others.
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

/// Analyses one cable. Invalid numbers lead to a refusal, not to an exception.
[[nodiscard]] CableTestResult analyse_cable_test(const CableTest& test);
/// Analyses several cables on `threads` threads; the numbers do not depend on their count.
[[nodiscard]] std::vector<CableTestResult> analyse_cable_tests(const std::vector<CableTest>& tests,
                                                               int threads = 1);

/// Warnings and refusals of a result, in words.
[[nodiscard]] std::vector<Finding> tension_findings(const TensionResult& result,
                                                    const CableDescription& cable);

}  // namespace rigfit::ident
