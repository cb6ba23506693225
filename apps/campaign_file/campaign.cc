#include "apps/campaign_file/campaign.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "apps/campaign_file/campaign_tests.h"
#include "model/linear/modal_analysis.h"
#include "model/scene/read_scene.h"
#include "model/scene/toml_table.h"

namespace rigfit::apps {
namespace fs = std::filesystem;
using model::Bound;
using model::TomlTable;

const char* name_of(ValueOrigin::Kind kind) {
  switch (kind) {
    case ValueOrigin::Kind::published:
      return "published";
    case ValueOrigin::Kind::inferred:
      return "inferred";
    case ValueOrigin::Kind::assumed:
      return "assumed";
  }
  return "";
}

std::string name_in(TomlTable& table, std::set<std::string>& taken) {
  std::string name = table.string("name");
  // Names become file names and anchors in the report.
  const bool plain = !name.empty() && std::all_of(name.begin(), name.end(), [](unsigned char c) {
    return std::isalnum(c) || c == '-' || c == '_';
  });
  if (!plain) {
    throw table.error("name", "\"" + name + "\" cannot name a file of the report",
                      "use letters, digits, - and _ only; put words into title");
  }
  if (!taken.insert(name).second) {
    throw table.error("name", "\"" + name + "\" is used twice", "give each one a name of its own");
  }
  return name;
}

/// Refuses a parameter name that the scene does not have, at the key that gives it.
void check_parameter(const model::Scene& scene, const std::string& parameter,
                     const TomlTable& table, const std::string& key) {
  const auto known = model::parameter_names(scene);
  if (std::find(known.begin(), known.end(), parameter) != known.end()) return;
  try {
    static_cast<void>(model::parameter(scene, parameter));  // aliases such as EI_z
  } catch (const model::SceneError&) {
    const auto nearest = model::nearest_word(parameter, known);
    std::string remedy = nearest ? "did you mean \"" + *nearest + "\"?" : "its parameters:";
    if (!nearest) {
      for (const auto& name : known) remedy += " " + name;
    }
    throw table.error(key, "the scene has no parameter \"" + parameter + "\"", remedy);
  }
}

namespace {

void read_origins(TomlTable& table, CampaignScene& scene) {
  std::set<std::string> said;
  for (const auto kind :
       {ValueOrigin::Kind::published, ValueOrigin::Kind::inferred, ValueOrigin::Kind::assumed}) {
    const std::string key = name_of(kind);
    if (!table.has(key)) continue;
    TomlTable origins = table.table(key);
    for (const auto& parameter : origins.keys()) {
      check_parameter(scene.scene, parameter, origins, parameter);
      if (!said.insert(parameter).second) {
        throw origins.error(parameter, "its origin is given twice", "keep one");
      }
      scene.origins.push_back({parameter, kind, origins.string(parameter)});
    }
    origins.finish();
  }
}

class Reader {
 public:
  Reader(TomlTable root, const fs::path& path) : root_(std::move(root)) {
    campaign_.file = path.string();
    campaign_.inputs.push_back(campaign_.file);
    folder_ = path.parent_path();
  }

  Campaign read() {
    campaign_.title = root_.string("title");
    campaign_.source = root_.string_or("source", "");
    campaign_.description = root_.string_or("description", "");
    if (root_.has("report")) {
      TomlTable report = root_.table("report");
      campaign_.report = read_report_details(report, folder_);
      if (!campaign_.report.logo.empty()) add_input(campaign_.report.logo);
    }
    if (root_.has("strand")) read_strand();
    std::set<std::string> scene_names, test_names;
    for (TomlTable& table : root_.tables_or_empty("scene")) read_campaign_scene(table, scene_names);
    CampaignTestReader tests(campaign_, folder_);
    for (TomlTable& table : root_.tables_or_empty("test")) {
      const std::string name = name_in(table, test_names);
      campaign_.tests.push_back(tests.read(table, name));
    }
    for (TomlTable& table : root_.tables_or_empty("fit")) read_fit(table, test_names);
    if (campaign_.tests.empty()) {
      throw root_.error("test", "is missing", "a campaign needs at least one [[test]]");
    }
    root_.finish();
    return std::move(campaign_);
  }

 private:
  void read_strand() {
    TomlTable table = root_.table("strand");
    ident::StrandGeometry strand;
    strand.youngs_modulus_Pa = table.number("youngs_modulus", Bound::positive, "Pa");
    if (!table.has("wires")) throw table.error("wires", "is missing", "give their number");
    strand.elements = table.integer_or("wires", 1, 100000, 1);
    strand.element_diameter_m = table.number("wire_diameter", Bound::positive, "m");
    strand.strand_diameter_m = table.number("diameter", Bound::positive, "m");
    if (strand.element_diameter_m > strand.strand_diameter_m) {
      throw table.error("wire_diameter", "is larger than the strand's diameter",
                        "give both in metres");
    }
    table.finish();
    campaign_.strand = strand;
  }

  void read_campaign_scene(TomlTable& table, std::set<std::string>& taken) {
    CampaignScene scene;
    scene.name = name_in(table, taken);
    const fs::path file = folder_ / table.string("file");
    std::error_code error;
    if (!fs::is_regular_file(file, error)) {
      throw table.error("file", "there is no file " + file.string(),
                        "name a scene; the path starts at the campaign's folder");
    }
    scene.file = file.string();
    scene.scene = model::read_scene(file);
    add_input(scene.file);
    read_origins(table, scene);
    table.finish();
    campaign_.scenes.push_back(std::move(scene));
  }

  void read_fit(TomlTable& table, std::set<std::string>& taken) {
    CampaignFit fit;
    fit.name = name_in(table, taken);
    fit.title = table.string_or("title", fit.name);
    fit.hold_out = table.boolean_or("hold_out", false);
    fit.model_std = table.number_or("model_std", Bound::not_negative, "relative", 0);
    fit.starts = table.integer_or("starts", 1, 1000, fit.starts);
    fit.reference_name = table.string_or("reference_name", fit.reference_name);
    std::vector<std::string> known;
    for (const auto& test : campaign_.tests) {
      if (test.kind == CampaignTest::Kind::modal && test.scene) known.push_back(test.name);
    }
    for (const auto& name : table.string_or_strings("tests")) {
      const auto at = std::find_if(campaign_.tests.begin(), campaign_.tests.end(),
                                   [&](const CampaignTest& test) { return test.name == name; });
      if (at == campaign_.tests.end() || at->kind != CampaignTest::Kind::modal || !at->scene) {
        const auto nearest = model::nearest_word(name, known);
        throw table.error("tests", "there is no modal test \"" + name + "\"",
                          nearest ? "did you mean \"" + *nearest + "\"?"
                                  : "name tests of kind \"modal\" that have a scene");
      }
      fit.tests.push_back(static_cast<std::size_t>(at - campaign_.tests.begin()));
    }
    if (fit.tests.empty()) throw table.error("tests", "is empty", "name at least one modal test");
    for (TomlTable& entry : table.tables_or_empty("parameter")) {
      fit.parameters.push_back(read_parameter(entry, fit));
    }
    if (table.has("predicts")) read_predicted(table, fit);
    if (fit.parameters.empty()) {
      throw table.error("parameter", "is missing", "a fit needs at least one [[fit.parameter]]");
    }
    table.finish();
    campaign_.fits.push_back(std::move(fit));
  }

  /// Free decays of a scene that has all of the fit's parameters.
  void read_predicted(TomlTable& table, CampaignFit& fit) const {
    std::vector<std::string> known;
    for (const auto& test : campaign_.tests) {
      if (test.kind == CampaignTest::Kind::decay && test.scene) known.push_back(test.name);
    }
    for (const auto& name : table.string_or_strings("predicts")) {
      const auto at = std::find_if(campaign_.tests.begin(), campaign_.tests.end(),
                                   [&](const CampaignTest& test) { return test.name == name; });
      if (std::find(known.begin(), known.end(), name) == known.end()) {
        const auto nearest = model::nearest_word(name, known);
        throw table.error("predicts", "there is no decay test \"" + name + "\" with a scene",
                          nearest ? "did you mean \"" + *nearest + "\"?"
                                  : "name tests of kind \"decay\" that have a scene");
      }
      for (const auto& parameter : fit.parameters) {
        for (const auto& target : parameter.free.targets) {
          check_parameter(campaign_.scenes[*at->scene].scene, target, table, "predicts");
        }
      }
      fit.predicts.push_back(static_cast<std::size_t>(at - campaign_.tests.begin()));
    }
  }

  FitParameter read_parameter(TomlTable& table, const CampaignFit& fit) const {
    FitParameter parameter;
    ident::FreeParameter& free = parameter.free;
    free.name = table.string("name");
    if (table.has("of")) free.targets = table.string_or_strings("of");
    const std::string key = free.targets.empty() ? "name" : "of";
    if (free.targets.empty()) free.targets = {free.name};
    if (table.has("factors")) {
      free.factors = table.numbers("factors", free.targets.size(), free.targets.size(), Bound::any,
                                   "1, one for each parameter");
    }
    free.per_state = table.boolean_or("per_state", false);
    free.start = table.optional_number("start", Bound::any, "the parameter's unit");
    const auto prior = table.optional_number("prior", Bound::any, "the parameter's unit");
    const auto prior_std = table.optional_number("prior_std", Bound::positive, "its unit");
    if (prior.has_value() != prior_std.has_value()) {
      throw table.error(prior ? "prior" : "prior_std", "stands alone",
                        "give prior and prior_std together");
    }
    if (prior) free.prior = signal::Estimate{*prior, *prior_std};
    free.prior_relative_std =
        table.number_or("prior_std_percent", Bound::not_negative, "%", 0) / 100;
    if (prior && free.prior_relative_std > 0) {
      throw table.error("prior_std_percent", "stands beside prior",
                        "give prior and prior_std, or prior_std_percent alone: of each state's own "
                        "value, such as a load cell's reading");
    }
    free.low = table.number_or("low", Bound::any, "the parameter's unit", free.low);
    free.high = table.number_or("high", Bound::any, "the parameter's unit", free.high);
    if (!(free.low < free.high)) {
      throw table.error("high", "is not above low", "give a lower and a higher bound");
    }
    parameter.reference = table.optional_number("reference", Bound::any, "the parameter's unit");
    // Every target is in one of the scenes; one that differs from state to state is in all.
    for (const auto& target : free.targets) {
      std::size_t found = 0;
      for (const std::size_t test : fit.tests) {
        const auto names =
            model::parameter_names(campaign_.scenes[*campaign_.tests[test].scene].scene);
        found += std::find(names.begin(), names.end(), target) != names.end();
      }
      if (found == 0 || (free.per_state && found < fit.tests.size())) {
        for (const std::size_t test : fit.tests) {
          check_parameter(campaign_.scenes[*campaign_.tests[test].scene].scene, target, table, key);
        }
        throw table.error(key, "\"" + target + "\" stands for two values of the scene",
                          "name one of them, such as EI_z or EI_y");
      }
    }
    table.finish();
    return parameter;
  }

  void add_input(const std::string& file) {
    if (std::find(campaign_.inputs.begin(), campaign_.inputs.end(), file) ==
        campaign_.inputs.end()) {
      campaign_.inputs.push_back(file);
    }
  }

  TomlTable root_;
  fs::path folder_;
  Campaign campaign_;
};

}  // namespace

Campaign read_campaign(const fs::path& path) {
  return Reader(TomlTable::read_file(path), path).read();
}

Campaign parse_campaign(std::string_view text, const fs::path& path) {
  return Reader(TomlTable::parse(text, path.string()), path).read();
}

}  // namespace rigfit::apps
