#include "ident/campaign/single_tests/cable_campaign.h"

#include <fmt/format.h>

#include <stdexcept>
#include <utility>

#include "ident/statistics/in_parallel.h"
#include "ident/statistics/probability_text.h"

namespace rigfit::ident {

CableTestResult analyse_cable_test(const CableTest& test) {
  CableTestResult result;
  result.name = test.name;
  try {
    result.tension = identify_tension(test.cable, test.modes, test.options);
  } catch (const std::invalid_argument& error) {
    result.tension.message = error.what();
  }
  if (!result.tension.solved) {
    result.findings.push_back({"no_tension", result.tension.message, test.name, true});
    return result;
  }
  result.findings = tension_findings(result.tension, test.cable);
  for (auto& finding : result.findings) finding.where = test.name;
  return result;
}

std::vector<CableTestResult> analyse_cable_tests(const std::vector<CableTest>& tests, int threads) {
  std::vector<CableTestResult> results(tests.size());
  in_parallel(tests.size(), threads,
              [&](std::size_t i) { results[i] = analyse_cable_test(tests[i]); });
  return results;
}

std::vector<Finding> tension_findings(const TensionResult& result, const CableDescription& cable) {
  std::vector<Finding> findings;
  const auto warn = [&](const char* code, std::string message) {
    findings.push_back({code, std::move(message), "", false});
  };
  const auto& best = result.candidates.front();
  if (result.ruled_out) {
    findings.push_back(
        {"model_ruled_out",
         fmt::format("Check that this is one cable between two ends: its frequencies are {:.2g} % "
                     "off (rms), {:.2g} % at most, with the best of {} kinds of ends. State other "
                     "ends (--ends), orders (--order), masses or EI, or fit a scene (update)",
                     100 * best.rms_error, 100 * best.worst_error, result.candidates.size()),
         "", true});
  } else if (best.fit.ruled_out()) {
    warn("systematic_misfit",
         fmt::format("Enlarge the uncertainties of the frequencies, or name what the cable lacks "
                     "here (masses, ends): chi-square is {:.4g} for {:.3g} degrees of freedom "
                     "({}). The interval counts a model error of {:.2g} %",
                     best.fit.chi2, best.fit.degrees_of_freedom, p_text(best.fit.p_value),
                     100 * best.fit.model_std));
  }
  for (const auto& mode : best.modes) {
    if (mode.order > 0) continue;
    warn("unpaired",
         fmt::format("Check {:.5g} Hz: it is no mode of the cable in this answer. State "
                     "its order (--order) if it is one",
                     mode.measured_hz));
  }
  if (result.EA_assumed) {
    warn("EA_assumed",
         "Give EA: a strain of 0.001 is taken, within a factor of 2 or so; this matters where the "
         "cable sags");
  }
  if (result.EI_assumed) {
    warn(
        "EI_assumed",
        "Give EI, or three frequencies: fewer cannot tell it, so that the interval covers L sqrt(T "
        "/ EI) anywhere in 2 to 2000");
  }
  if (result.large_sag) {
    warn("deep_sag_not_corrected",
         "Check length and mass: the segment model has no equilibrium at the best tension, and the "
         "closed forms of a shallow cable are used uncorrected");
  }
  if (result.mass_reference_matters) {
    warn("assumed",
         "Say with mass_of whether the mass per length is that of the installed or of the "
         "unstretched cable: here the answers differ");
  }
  if (cable.length_m.std == 0 || cable.mass_per_length.std == 0) {
    warn("exact_inputs",
         "Give the standard uncertainty of length and mass per length: without it they count as "
         "exact (1 % of length is 2 % of tension)");
  }
  if (!result.decided) {
    findings.push_back({"not_decided",
                        "Say which modes these are (--order), or give a further frequency, --EI or "
                        "--ends (--missed where modes were not excited): no order of the modes has "
                        "90 % of the weight",
                        "", true});
  }
  return findings;
}

}  // namespace rigfit::ident
