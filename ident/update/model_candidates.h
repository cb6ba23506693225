// Model choice: several models of the same measured modes (such as pinned ends, clamped ends and
// springs) are fitted and weighted by their evidence, and their parameters are averaged.
//
//   w_k = Z_k / sum Z,   p(theta | data) = sum_k w_k p_k(theta | data)
//
// with Z_k the evidence of a fit, all its answers together (update_alternatives.h: Laplace, with
// the model's own error integrated over). Parameters without a prior have the same broad prior in
// every model, so that one more parameter costs about ln(ln(10) sqrt(2 pi) / its standard
// uncertainty) and must reduce the misfit by more. The interval of a parameter is that of the
// mixture. Candidates are equally probable before the test. Sources: Hoeting et al., Statistical
// Science 14 (1999) 382; Kass and Raftery, JASA 90 (1995) 773.
#pragma once

#include "ident/update/problem/update_data.h"
#include "ident/update/problem/update_result.h"

namespace rigfit::ident {

/// A named model: the rig's states with its scenes, and the fitted parameters.
struct ModelCandidate {
  std::string name;
  std::vector<UpdateState> states;  ///< the same measured modes in every candidate
  std::vector<FreeParameter> free;
};

struct FittedCandidate {
  std::string name;
  UpdateResult result;
  double weight = 0;  ///< 0 without a model

  static constexpr auto fields() {
    using namespace describe;
    using T = FittedCandidate;
    using Result = UpdateResult;
    constexpr auto of_fit = [](auto get) {  // nothing without a fit
      return where([](const T& c) { return c.result.status != UpdateStatus::no_model; },
                   within(&T::result, get));
    };
    return std::tuple{
        field("name", &T::name, "", "candidate", ""),
        field("weight", &T::weight, "", "weight", "of all candidates", 3),
        field("log_evidence", of_fit(&Result::log_evidence), "", "ln evidence", "", 5),
        field("chi2", of_fit(within(&Result::fit, &UpdateFit::chi2)), "", "chi-square", "", 4),
        field("degrees_of_freedom", of_fit(within(&Result::fit, &UpdateFit::degrees_of_freedom)),
              "", "degrees of freedom", "", 4),
        field("p_value", of_fit(within(&Result::fit, &UpdateFit::p_value)), "", "probability",
              "of such a misfit", 3),
        field("status", within(&T::result, &Result::status)),
        field("message", within(&T::result, &Result::message), "", "remark", ""),
        field("parameters", within(&T::result, &Result::parameters))};
  }
};

struct CandidateComparison {
  std::vector<FittedCandidate> candidates;  ///< in the order given
  int heaviest = -1;                        ///< -1: no candidate could be fitted
  /// Parameters that all candidates of weight above 0 have by name: value (mean), std and 95 %
  /// interval of the mixture of all their answers. Value and std are of what lies in the interval
  /// or within half its width beside it: an improbable answer far off would otherwise make the std
  /// larger than the interval. `start` is the heaviest candidate's.
  std::vector<UpdatedParameter> averaged;
};

/// The answers of all candidates, weights of all together 1.
[[nodiscard]] std::vector<UpdateAlternative> answers_of(const CandidateComparison& comparison);

/// Fits of modes alone (throws std::invalid_argument for FRFs, candidates without a
/// name of their own, other numbers of measured modes, or none).
[[nodiscard]] CandidateComparison compare_candidates(const std::vector<ModelCandidate>& candidates,
                                                     const UpdateOptions& options);

/// The parameter of that name; null: there is none.
[[nodiscard]] const UpdatedParameter* find(const std::vector<UpdatedParameter>& all,
                                           const std::string& name);

}  // namespace rigfit::ident
