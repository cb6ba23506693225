// A value of the rig that a report gives: on its first page, in the tables for papers and in what
// compares two campaigns.
#pragma once

#include "apps/describe/standard.h"
#include "document/describe.h"
#include "ident/campaign/single_tests/test_recording.h"

namespace rigfit::apps {

struct Answer;
/// "N", "1" of a ratio.
[[nodiscard]] std::string unit_of(const Answer& answer);
/// What the value is worth, in words: how well it is known, and whether it agrees with what is
/// known otherwise (inside the 95 % interval or not).
[[nodiscard]] std::string verdict_words(const Answer& answer);

struct Answer {
  static constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

  std::string key;       ///< the same in every report of this campaign: "fit-beam/beam.EI_z"
  std::string quantity;  ///< "Beam bending stiffness EI_z"
  std::string how;       ///< "fitted to 5 modes"
  std::string unit;      ///< "N m²"; %: a ratio shown in percent; empty: another ratio
  double value = kNone, std = kNone;
  double low = kNone, high = kNone;  ///< 95 %; infinite: open
  bool determined = true;            ///< false: these data cannot tell it
  std::optional<double> reference = std::nullopt;
  std::string reference_name = {};  ///< "published", "truth"
  ident::Origin origin = ident::Origin::modelled;
  std::string anchor = {};     ///< id of the part that says more
  std::string verdict = {};    ///< instead of that of the interval
  int rank = 0;                ///< 0: first page; 1: where there is room
  std::string structure = {};  ///< what it belongs to where tests have several: "rig"
  /// A property of the structure (a mass at a node) rather than of a member that several share.
  bool of_structure = false;
  bool recommended = true;  ///< no other answer for this quantity is known better
  double mode_hz = kNone;   ///< frequency of the mode that it belongs to, where it does

  static constexpr auto fields() {
    using T = Answer;
    return std::tuple{
        field("key", &T::key, "", "", "the same in every report of the campaign"),
        field("quantity", &T::quantity, "", "", ""),
        field("value", &T::value, "", "", "SI; null: not determined"),
        field("std", &T::std, "", "", "standard uncertainty"),
        field("low", &T::low, "", "", "95 %; null: open"),
        field("high", &T::high, "", "", "95 %; null: open"),
        field("unit", &unit_of, "", "", ""),
        field("how", &T::how, "", "", "what it was found from"),
        field("verdict", &verdict_words, "", "", "how well it is known, and agrees"),
        field("determined", &T::determined, "", "", "by these data"),
        field("structure", &T::structure, "", "", "what it belongs to"),
        field("recommended", &T::recommended, "", "", "no other answer is known better"),
        field("mode_hz", &T::mode_hz, "Hz", "", "of the mode that it belongs to"),
        field("reference", &T::reference, "", "", "as known otherwise")};
  }
};

/// "Tip mass, rig".
[[nodiscard]] std::string quantity_words(const Answer& answer);
/// "2.1714 ± 0.0045", in the unit that is shown (describe::shown_unit).
[[nodiscard]] std::string value_words(const Answer& answer);
/// "2.163 to 2.180"; empty where no interval is known.
[[nodiscard]] std::string interval_words(const Answer& answer);
/// True when the verdict is a warning.
[[nodiscard]] bool doubtful(const Answer& answer);

/// Among the answers for one quantity, recommends the one with the smallest standard uncertainty.
/// One that differs from it by more than three standard uncertainties says so in its verdict.
void recommend(std::vector<Answer*>& answers);

/// A table for a spreadsheet.
[[nodiscard]] std::string answers_csv(const std::vector<Answer>& answers);

// Parameters of a scene as a reader calls them: "beam.EI_z" is "Beam bending stiffness EI_z".

/// Name and symbol of a scene's parameter (model/scene/parameters.h). A name of a campaign's own,
/// such as "cable span", stays as it is but for its first letter; so does one that is not known.
[[nodiscard]] std::string parameter_words(std::string_view name);

/// A sentence with the plain names of the parameters in it.
[[nodiscard]] std::string with_parameter_words(std::string sentence);

/// The name of a state without the word for the only one: "beam, as built" is "beam".
[[nodiscard]] std::string state_words(std::string name);

}  // namespace rigfit::apps
