// Evaluates a whole campaign on a rig: its tests and the fits to them, in the order in which they
// depend on each other.
//
//   bending tests -> EI(T) ------+
//   axial tests -> EA, damping --+-> scenes of the modal tests -> their modes against the test
//   hits -> FRFs -> modes -------+                            -> fits -> answers to recorded decays
//
// The report calls this. A caller fills in the tests that were made and leaves the others empty.
#pragma once

#include <variant>

#include "ident/campaign/modal/modal_model.h"
#include "ident/campaign/single_tests/axial_campaign.h"
#include "ident/campaign/single_tests/bending_campaign.h"
#include "ident/campaign/single_tests/decay_campaign.h"
#include "ident/campaign/single_tests/tension_campaign.h"
#include "ident/update/problem/update_result.h"

namespace rigfit::ident {

/// Free decays; with a scene, they are compared with the responses of the model and of `fits` to
/// the same release or tap.
struct DecayInputs {
  std::vector<TestRecording> recordings;
  DecayTestOptions options;
  std::optional<SceneUse> scene;
  std::map<std::string, std::string> sensors;  ///< channel -> sensor, where names differ
  std::string load;                            ///< the scene's load that set the rig free
  std::vector<std::size_t> fits;               ///< indices of fits that predict these decays
};

using TestInputs =
    std::variant<BendingCampaign, AxialInputs, TensionInputs, ModalInputs, DecayInputs>;

/// A fit to the modes of modal tests that have a scene.
struct FitInputs {
  std::string title;
  std::vector<std::size_t> tests;  ///< indices in CampaignInputs::tests
  std::vector<FreeParameter> free;
  UpdateOptions options;  ///< inputs for EI, EA and damping are added
};

struct CampaignInputs {
  std::vector<TestInputs> tests;
  std::vector<FitInputs> fits;
  int threads = 1;
  /// Called, from any thread, as each test and fit is done.
  std::function<void()> advance = [] {};
};

struct ModalOutcome {
  ModalTest test;                 ///< analysis of the recordings
  std::vector<ModalState> model;  ///< by rising tension; empty: no scene
};

/// By the kind of the inputs, in their order; decays: the channels of all recordings.
using TestResult = std::variant<BendingCampaignResult, AxialCampaignResult, TensionCampaignResult,
                                ModalOutcome, DecayTest>;

struct CampaignFitOutcome {
  std::vector<const ModalState*> states;  ///< in the result's modal tests
  std::vector<UpdateState> given;         ///< to the fit, in the order of `states`
  UpdateResult result;                    ///< without states: nothing was fitted
};

/// Contains its inputs. Its parts point to each other, so it can be moved but not copied.
struct CampaignResult {
  CampaignResult() = default;
  CampaignResult(CampaignResult&&) = default;  // and so no copy

  CampaignInputs inputs;          ///< recordings of hits are moved to the results
  std::vector<TestResult> tests;  ///< as inputs.tests
  std::vector<CampaignFitOutcome> fits;
  KnownValues known;  ///< from the first bending and axial tests with a result
  /// Time that each took, s; on several threads that of work beside it as well.
  std::vector<double> test_s, fit_s;
};

/// Works through tests and fits on `threads` threads; the numbers do not depend on their count.
/// Throws std::invalid_argument for invalid options, std::out_of_range for an index of a missing
/// test or fit, std::bad_variant_access for a fit to a test that is not modal, model::SceneError
/// for parameters that a scene does not have. Unsuitable recordings become findings.
[[nodiscard]] CampaignResult run_campaign(CampaignInputs inputs);

}  // namespace rigfit::ident
