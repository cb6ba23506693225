// A campaign: what was tested on a rig, how, which scenes stand for it, what to fit and which
// published or earlier results to compare with. One TOML file; paths in it are relative to it.
//
// Here is what it says, in plain structs, and its keys, described once: the reader
// (apps/campaign_file/campaign.cc), its messages and `rigfit help campaign` are walks over the
// tables that `keys_of` gives. To add a key: a member of the struct, a line in its table.
#pragma once

#include <Eigen/Core>
#include <variant>

#include "apps/describe/option.h"
#include "document/describe.h"
#include "document/toml_table.h"
#include "ident/campaign/campaign.h"
#include "ident/stiffness/stiffness_law.h"
#include "model/linear/modal_analysis.h"
#include "model/scene/scene.h"
#include "signal/readers/recording_description.h"

namespace rigfit::apps {

using ident::Origin;

/// What stands on the first page of a report besides its results.
struct ReportDetails {
  std::string author, organisation, client, project, revision;
  std::string date;  ///< as given; empty: the day the page is made
};

/// How a value of a scene is known.
struct ValueOrigin {
  enum class Kind { published, inferred, assumed };
  std::string parameter;  ///< such as "cable.EI"
  Kind kind = Kind::assumed;
  std::string how;
  double value = 0;
  std::string unit;

  static constexpr auto fields() {
    using T = ValueOrigin;
    return std::tuple{field("parameter", &T::parameter, "", "value of", "of the scene"),
                      field("value", &T::value, "", "value", "SI"),
                      field("unit", &T::unit, "", "unit", "1: a ratio"),
                      field("known", &T::kind, "", "known", "published, inferred or assumed"),
                      field("how", &T::how, "", "how", "")};
  }
};
[[nodiscard]] const char* name_of(ValueOrigin::Kind kind);

struct CampaignScene {
  std::string name;
  std::string file;
  model::Scene scene;
  std::vector<ValueOrigin> origins;
};

/// Recordings of a test that were taken alike. A file that is missing or cannot be read is no error
/// of the campaign: the report says so in its place and goes on.
struct RecordingGroup {
  std::vector<std::string> files;    ///< as written (patterns); once read: sorted, each once
  std::vector<std::string> missing;  ///< names and patterns that match no file
  std::optional<double> tension_N, length_m;
  std::string load;  ///< name of the scene's load; empty: the test's
  bool synthetic = false;
  signal::RecordingDescription description;

  [[nodiscard]] Origin origin() const { return synthetic ? Origin::synthetic : Origin::measured; }
};

/// "in" or "out"; others: none.
[[nodiscard]] std::optional<model::ModePlane> plane_named(const std::string& word);

// The kinds of tests: what the analysis takes (ident/campaign) without the recordings, and keys
// that the analysis has in another form.

/// The channels of a load-deflection table or record.
struct LoadDeflection {
  std::string tension, load, deflection;  ///< tension: empty where there is none
  bool operator==(const LoadDeflection&) const = default;
};

struct BendingTest : ident::BendingCampaign {  // its sources: the published EI values, if any
  LoadDeflection channels;                     ///< empty: as load_deflection finds them
  std::optional<double> tension_N;             ///< 0: a beam without tension
  std::string ends = "clamped";                ///< how the beam is held

  BendingTest() { test.span_m = {0, 0}; }
  /// Takes the ends of a beam over into `test`.
  void complete();
  [[nodiscard]] bool beam() const { return tension_N.has_value(); }
  [[nodiscard]] bool published() const { return !sources.empty(); }
};

using AxialTest = ident::AxialInputs;
using DecayTest = ident::DecayInputs;

struct ModalTest : ident::ModalInputs {
  std::vector<std::string> models;  ///< labels of the published models, as in `published`
  std::string load;
  std::vector<std::string> planes{"in"};
  std::vector<double> direction_xyz;
};

struct TensionTest : ident::TensionInputs {
  std::string ends = "compare";
  std::optional<double> EI_Nm2, EA_N;
  double EI_std_Nm2 = 0, EA_std_N = 0;
  std::vector<double> frequencies_hz, orders;
  double frequency_std_hz = 0;  ///< 0: not known
  std::string measured, column;

  TensionTest();
  /// Takes what was read over into the inputs: cable and ends; adds the frequencies to its modes.
  /// Throws std::invalid_argument where orders are no whole number for each of them.
  void complete();
};

struct CampaignTest {
  std::string name, title;
  std::variant<BendingTest, AxialTest, DecayTest, ModalTest, TensionTest> kind;
  std::optional<std::size_t> scene;  ///< modal, decay: index of the scene
  std::vector<RecordingGroup> recordings;
  std::optional<double> EA_N, damping_ratio, tension_N;  ///< as known otherwise
  std::string reference_name = "published";

  template <class Kind>
  [[nodiscard]] bool is() const {
    return std::holds_alternative<Kind>(kind);
  }
  template <class Kind>
  [[nodiscard]] const Kind& as() const {
    return std::get<Kind>(kind);
  }
};

/// Words of `kind`, in the order of the variant.
[[nodiscard]] const std::vector<std::string>& kinds_of_tests();

struct FitParameter : ident::FreeParameter {
  std::optional<double> prior_value, prior_std;
  double prior_std_percent = 0;
  std::optional<double> reference;  ///< an earlier value, shown beside the one found
};

struct CampaignFit : ident::FitInputs {
  std::string name;
  std::vector<FitParameter> parameters;
  std::vector<std::string> test_names, predicted_names;
  std::string reference_name = "earlier value";
};

struct Campaign {
  std::string file;
  std::string title, source, description;
  ReportDetails report;
  std::optional<ident::StrandGeometry> strand;
  std::vector<CampaignScene> scenes;
  std::vector<CampaignTest> tests;
  std::vector<CampaignFit> fits;
  std::vector<std::string> inputs;  ///< every file read
};

/// Reads a campaign, and what it names: every key is checked like a scene's; scenes and tables are
/// read and checked too. Throws model::SceneError.
[[nodiscard]] Campaign read_campaign(const std::filesystem::path& path);
/// The same from text; `path` is named in messages, and what the text names lies beside it.
[[nodiscard]] Campaign parse_campaign(std::string_view text, const std::filesystem::path& path);

// Keys of each table, into the struct.
[[nodiscard]] describe::Options keys_of(Campaign& campaign);
[[nodiscard]] describe::Options keys_of(ReportDetails& details);
[[nodiscard]] describe::Options keys_of(ident::StrandGeometry& strand);
[[nodiscard]] describe::Options keys_of(RecordingGroup& group);
[[nodiscard]] describe::Options keys_of(BendingTest& test);
[[nodiscard]] describe::Options channel_keys_of(BendingTest& test);  ///< channels = { ... }
[[nodiscard]] describe::Options keys_of(AxialTest& test);
[[nodiscard]] describe::Options keys_of(DecayTest& test);
[[nodiscard]] describe::Options keys_of(ident::SceneUse& use);
[[nodiscard]] describe::Options keys_of(ModalTest& test);
[[nodiscard]] describe::Options keys_of(TensionTest& test);
[[nodiscard]] describe::Options reference_keys_of(CampaignTest& test);
[[nodiscard]] describe::Options keys_of(CampaignFit& fit);
[[nodiscard]] describe::Options keys_of(FitParameter& parameter);

/// Fills keys from a table; those that are absent keep their default. Throws DocumentError with
/// file, line and key for what cannot be taken; `rigfit help` of `help` lists them.
void read_keys(document::TomlTable& table, const describe::Options& keys,
               const char* help = "campaign");

/// Every key of a campaign, below the heading of its table, for `rigfit help campaign`.
[[nodiscard]] describe::Options campaign_keys();

}  // namespace rigfit::apps
