#include "apps/campaign/campaign.h"

#include <set>
#include <stdexcept>

#include "apps/campaign_file/measured_modes.h"
#include "apps/campaign_file/recordings.h"
#include "apps/results/text_table.h"
#include "document/toml_table.h"
#include "model/linear/modal_analysis.h"
#include "model/scene/read_scene.h"
#include "signal/numerics/numbers.h"

namespace rigfit::apps {
namespace fs = std::filesystem;
namespace {

using document::TomlTable;

std::string name_in(TomlTable& table, std::set<std::string>& taken) {
  std::string name = table.string("name");
  // Names become file names and anchors in the report.
  const auto plain = [](unsigned char c) { return std::isalnum(c) || c == '-' || c == '_'; };
  if (name.empty() || !std::ranges::all_of(name, plain)) {
    throw table.error("name", "\"" + name + "\" cannot name a file of the report",
                      "use letters, digits, - and _ only; put words into title");
  }
  if (!taken.insert(name).second) {
    throw table.error("name", "\"" + name + "\" is used twice", "give each one a name of its own");
  }
  return name;
}

/// The place of a name among those known, or an error with the nearest; `what`: as in "there is no
/// scene".
std::size_t place_of(const std::string& name, const std::vector<std::string>& names,
                     const TomlTable& table, const std::string& key, const std::string& what,
                     const std::string& remedy) {
  const auto at = std::ranges::find(names, name);
  if (at != names.end()) return static_cast<std::size_t>(at - names.begin());
  const auto nearest = document::nearest_word(name, names);
  throw table.error(key, "there is no " + what + " \"" + name + "\"",
                    nearest ? "did you mean \"" + *nearest + "\"?" : remedy);
}

template <class Named>
std::vector<std::string> names_of(const std::vector<Named>& all) {
  std::vector<std::string> names;
  names.reserve(all.size());
  for (const auto& one : all) names.push_back(one.name);
  return names;
}

/// Refuses a parameter name that the scene does not have, at the key that gives it.
void check_parameter(const model::Scene& scene, const std::string& parameter,
                     const TomlTable& table, const std::string& key) {
  const auto names = model::parameter_names(scene);
  place_of(parameter, names, table, key, "parameter",
           fmt::format("use one of: {}", fmt::join(names, ", ")));
}

/// The keys of a table inside, if it is there.
void read_inside(TomlTable& table, const std::string& key, const describe::Options& keys) {
  if (!table.has(key)) return;
  TomlTable inside = table.table(key);
  read_keys(inside, keys);
  inside.finish();
}

/// The column that a key names; an error at the key where the table has none.
std::string column_in(TomlTable& table, const std::string& key, const TextTable& results) {
  std::string title = table.string(key);
  try {
    static_cast<void>(results.column(title));
  } catch (const model::SceneError& error) {
    throw table.error(key, results.file + " " + error.problem(), error.remedy());
  }
  return title;
}

describe::Option needed(const std::string& column, double& value) {
  return option(column, value, "a number in this column of every row").required().positive();
}

/// The published EI values of a bending test, with their uncertainty where a column has it.
ident::BendingSource published_values(TomlTable& table, const TextTable& results) {
  const auto tension = column_in(table, "tension", results), EI = column_in(table, "EI", results);
  ident::BendingSource source{results.file, {}, {}, Origin::published};
  for (const auto& row : results.rows) {
    auto& point = source.values.emplace_back(ident::StiffnessPoint());
    describe::Options columns{needed(tension, point.tension_N), needed(EI, point.EI_Nm2)};
    for (const auto& [beginning, value] :
         {std::pair{"std", &point.std}, {"low", &point.low}, {"high", &point.high}}) {
      const auto first = std::ranges::find_if(
          results.columns,
          [word = beginning](const auto& column) { return column.name.starts_with(word); });
      if (first != results.columns.end()) columns.push_back(option(first->name, *value, ""));
    }
    fill_row(results, row, columns);
  }
  return source;
}

class Reader {
 public:
  Reader(TomlTable root, const fs::path& path)
      : root_(std::move(root)), folder_(path.parent_path()) {
    campaign_.inputs = {campaign_.file = path.string()};
  }

  Campaign read() {
    read_keys(root_, keys_of(campaign_));
    read_inside(root_, "report", keys_of(campaign_.report));
    if (root_.has("strand")) read_strand();
    std::set<std::string> scene_names, names;
    for (TomlTable& table : root_.tables_or_empty("scene")) read_scene_entry(table, scene_names);
    for (TomlTable& table : root_.tables_or_empty("test")) read_test(table, names);
    for (TomlTable& table : root_.tables_or_empty("fit")) read_fit(table, names);
    if (campaign_.tests.empty()) {
      throw root_.error("test", "is missing", "a campaign needs at least one [[test]]");
    }
    root_.finish();
    return std::move(campaign_);
  }

 private:
  /// The file that a table names, which becomes an input.
  std::string file_of(TomlTable& table, const std::string& what) {
    const fs::path path = folder_ / table.string("file");
    std::error_code error;
    if (!fs::is_regular_file(path, error)) {
      throw table.error("file", "there is no file " + path.string(),
                        "name " + what + "; the path starts at the campaign's folder");
    }
    auto& inputs = campaign_.inputs;
    if (std::ranges::count(inputs, path.string()) == 0) inputs.push_back(path.string());
    return path.string();
  }

  void read_strand() {
    auto& strand = campaign_.strand.emplace();
    read_inside(root_, "strand", keys_of(strand));
    if (strand.element_diameter_m > strand.strand_diameter_m) {
      throw root_.table("strand").error("wire_diameter", "is larger than the strand's diameter",
                                        "give both in metres");
    }
  }

  void read_scene_entry(TomlTable& table, std::set<std::string>& taken) {
    CampaignScene scene;
    scene.name = name_in(table, taken);
    scene.file = file_of(table, "a scene");
    scene.scene = model::read_scene(scene.file);
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
        const auto known = model::parameters_named(scene.scene, {parameter}).front();
        scene.origins.push_back({parameter, kind, origins.string(parameter),
                                 model::parameter(scene.scene, parameter), known.unit});
      }
    }
    table.finish();
    campaign_.scenes.push_back(std::move(scene));
  }

  void read_test(TomlTable& table, std::set<std::string>& taken) {
    CampaignTest test;
    test.name = name_in(table, taken);
    test.title = table.string_or("title", test.name);
    static_cast<void>(table.string("kind"));
    const std::string kind = table.choice_or("kind", kinds_of_tests(), "");
    if (kind == "bending") test.kind = BendingTest{};
    if (kind == "axial") test.kind = AxialTest{};
    if (kind == "decay") test.kind = DecayTest{};
    if (kind == "modal") test.kind = ModalTest{};
    if (kind == "tension") test.kind = TensionTest{};
    std::visit([&](auto& of_kind) { read_kind(table, test, of_kind); }, test.kind);
    table.finish();
    campaign_.tests.push_back(std::move(test));
  }

  void read_recordings(TomlTable& table, CampaignTest& test) const {
    test.recordings = read_recording_groups(table, folder_);
    if (test.recordings.empty()) {
      throw table.error("recording", "is missing",
                        "name recordings in a [[test.recording]] with files = [\"...\"]");
    }
  }

  void read_kind(TomlTable& table, CampaignTest& test, BendingTest& bending) {
    read_keys(table, keys_of(bending));
    if (bending.beam()) {
      if (*bending.tension_N > 0) {
        throw table.error("tension", "is not 0",
                          "recordings of a cable under tension hold a channel of it; tension = 0 "
                          "is for a beam without");
      }
      bending.complete();
    } else {
      bending.strand = campaign_.strand;
    }
    if (!bending.beam() && !table.has("recording")) {
      TomlTable results = table.table("table");
      bending.sources.push_back(
          published_values(results, read_text_table(file_of(results, "a CSV table"))));
      results.finish();
      return;
    }
    if (table.has("table")) {
      throw table.error("table", "is given beside recordings", "keep one of them");
    }
    read_inside(table, "channels", channel_keys_of(bending));
    read_recordings(table, test);
  }

  void read_kind(TomlTable& table, CampaignTest& test, AxialTest& axial) {
    read_keys(table, keys_of(axial));
    read_recordings(table, test);
    for (const auto& group : test.recordings) {
      if (group.length_m) continue;
      throw table.error("recording", "a recording of an axial test has no length",
                        "give every [[test.recording]] the length of cable in m");
    }
    read_inside(table, "reference", reference_keys_of(test));
  }

  void read_kind(TomlTable& table, CampaignTest& test, DecayTest& decay) {
    read_keys(table, keys_of(decay));
    if (table.has("scene")) {
      decay.scene = scene_use(table, test, decay.sensors);
      const auto loads = names_of(decay.scene->scene.loads);
      if (decay.load.empty() && loads.size() == 1) decay.load = loads.front();
      if (decay.load.empty()) {
        throw table.error(
            "load", "is missing although the scene has " + std::to_string(loads.size()) + " loads",
            "name the load that sets it free, or leave scene out");
      }
      place_of(decay.load, loads, table, "load", "load of the scene", "add it to the scene");
    }
    read_recordings(table, test);
    check_tensions(table, test, decay.scene, {});
  }

  void read_kind(TomlTable& table, CampaignTest& test, TensionTest& tension) {
    read_keys(table, keys_of(tension));
    tension.name = test.name;
    if (!tension.measured.empty()) {
      const std::string file = (folder_ / tension.measured).string();
      campaign_.inputs.push_back(file);
      std::ostream nothing(nullptr);
      VerbContext context(nothing);  // its remarks are on shapes, of which a tension takes none
      context.silent = true;
      const auto rows = measured_modes(file, tension.column, tension.plane, {}, context);
      tension.modes.assign(rows.begin(), rows.end());
    }
    try {
      tension.complete();
    } catch (const std::invalid_argument& error) {
      throw table.error("orders", error.what(), "give one for each of frequencies");
    }
    if (table.has("recording")) {
      read_recordings(table, test);
    } else if (tension.modes.empty()) {
      throw table.error("frequencies", "is missing, and there is no recording",
                        "give frequencies = [...], measured = \"table.csv\" or [[test.recording]]");
    }
    read_inside(table, "reference", reference_keys_of(test));
  }

  void read_kind(TomlTable& table, CampaignTest& test, ModalTest& modal) {
    const bool recorded = table.has("recording");
    if (table.has("scene") || !recorded || table.has("table")) {
      modal.scene = scene_use(table, test, modal.sensors);
    }
    read_keys(table, keys_of(modal));
    // In both planes: any mode may lie in either.
    if (std::ranges::count(modal.planes, modal.planes[0]) == std::ssize(modal.planes)) {
      modal.plane = plane_named(modal.planes[0]);
    }
    if (recorded && !modal.options.ambient && modal.options.hammer.force.empty()) {
      throw table.error("force", "is missing", "name the hammer's channel, or say ambient = true");
    }
    if (recorded) read_hits(table, test, modal);
    if (!recorded || table.has("table")) read_published(table, recorded, modal);
    check_tensions(table, test, modal.scene, modal.published);
    modal.name = test.name;
  }

  void read_hits(TomlTable& table, CampaignTest& test, ModalTest& modal) const {
    if (!modal.direction_xyz.empty()) {
      const Eigen::Vector3d direction(modal.direction_xyz.data());
      if (!(direction.norm() > 0)) {
        throw table.error("direction", "is zero", "give the direction struck and measured along");
      }
      modal.direction = direction.normalized();
    }
    std::vector<std::string> impacts;
    if (modal.scene) {
      for (const auto& load : modal.scene->scene.loads) {
        if (load.kind == model::Load::Kind::impact) impacts.push_back(load.name);
      }
      if (modal.load.empty() && impacts.size() == 1) modal.load = impacts.front();
    }
    read_recordings(table, test);
    for (auto& group : test.recordings) {
      const bool own = !group.load.empty();
      if (!own) group.load = modal.load;
      // Without a scene, places struck have any names.
      if (group.load.empty() || !modal.scene) continue;
      place_of(group.load, impacts, table, own ? "recording" : "load", "impact of the scene",
               "add it to the scene");
    }
  }

  /// A table of frequencies.
  void read_published(TomlTable& table, bool recorded, ModalTest& modal) {
    TomlTable results = table.table("table");
    const TextTable found = read_text_table(file_of(results, "a CSV table"));
    std::string tension, measured;
    if (results.has("tension")) tension = column_in(results, "tension", found);
    if (!recorded || results.has("measured")) measured = column_in(results, "measured", found);
    std::vector<std::string> theirs;
    if (results.has("models")) {
      TomlTable models = results.table("models");
      modal.models = models.keys();
      for (const auto& label : modal.models) theirs.push_back(column_in(models, label, found));
    }
    for (const auto& row : found.rows) {
      auto& one = modal.published.emplace_back();
      one.models_hz.assign(theirs.size(), signal::kNaN);
      describe::Options columns;
      if (!tension.empty()) columns.push_back(needed(tension, one.tension_N.emplace()));
      if (!measured.empty()) columns.push_back(option(measured, one.measured_hz, "").positive());
      for (std::size_t k = 0; k < theirs.size(); ++k) {
        columns.push_back(option(theirs[k], one.models_hz[k], "").positive());
      }
      fill_row(found, row, columns);
    }
    results.finish();
  }

  /// The scene that stands for a test, the parameters that take a state's values, sensors.
  ident::SceneUse scene_use(TomlTable& table, CampaignTest& test,
                            std::map<std::string, std::string>& sensors) const {
    test.scene = place_of(table.string("scene"), names_of(campaign_.scenes), table, "scene",
                          "scene", "add it under [[scene]] with name and file");
    ident::SceneUse use{campaign_.scenes[*test.scene].scene, {}, {}, {}, {}};
    read_keys(table, keys_of(use));
    for (const auto& [key, names] : {std::pair{"tension_of", &use.tension_of},
                                     {"EI_of", &use.EI_of},
                                     {"EA_of", &use.EA_of},
                                     {"damping_of", &use.damping_of}}) {
      for (const auto& name : *names) check_parameter(use.scene, name, table, key);
    }
    if (table.has("sensors")) {
      TomlTable channels = table.table("sensors");
      for (const auto& channel : channels.keys()) {
        sensors[channel] = channels.string(channel);
        place_of(sensors[channel], names_of(use.scene.sensors), channels, channel,
                 "sensor of the scene", "add it to the scene");
      }
    }
    return use;
  }

  /// What goes by tension says so in all its places.
  static void check_tensions(const TomlTable& table, const CampaignTest& test,
                             const std::optional<ident::SceneUse>& use,
                             const std::vector<ident::PublishedMode>& published) {
    const auto with = std::ranges::count_if(
        test.recordings, [](const auto& group) { return group.tension_N.has_value(); });
    if (with > 0 && with < std::ssize(test.recordings)) {
      throw table.error("recording", "some recordings have a tension and some have none",
                        "give every [[test.recording]] its tension, or none");
    }
    if (!use) return;
    const bool by_table = !published.empty() && published.front().tension_N;
    if (!published.empty() && !test.recordings.empty() && by_table != (with > 0)) {
      throw table.error("table", "only one of table and recordings goes by tension",
                        "give both their tensions, or neither");
    }
    const bool by_tension = by_table || with > 0;
    const char* const none =
        "is given although there is no tension column and no recording with a tension";
    if (by_tension == use->tension_of.empty()) {
      throw table.error(
          "tension_of", by_tension ? "is missing although the test goes by tension" : none,
          "name the scene's parameters that take it, such as \"cable.tension\", and "
          "give the tension of the table and of every [[test.recording]]; or neither");
    }
    if (!use->EI_of.empty() && !by_tension) {
      throw table.error("EI_of", none, "EI follows the tension; leave EI_of out");
    }
  }

  /// Indices of the tests named, of a kind and with a scene.
  template <class Kind>
  std::vector<std::size_t> tests_named(const std::vector<std::string>& names,
                                       const TomlTable& table, const std::string& key,
                                       const std::string& kind) const {
    std::vector<std::string> known;
    std::vector<std::size_t> places, found;
    for (std::size_t i = 0; i < campaign_.tests.size(); ++i) {
      const auto& test = campaign_.tests[i];
      if (test.is<Kind>() && test.scene) known.push_back(test.name), places.push_back(i);
    }
    for (const auto& name : names) {
      found.push_back(places[place_of(name, known, table, key, kind + " test with a scene",
                                      "name tests of kind \"" + kind + "\" that have a scene")]);
    }
    return found;
  }

  const model::Scene& scene_of(std::size_t test) const {
    return campaign_.scenes[*campaign_.tests[test].scene].scene;
  }

  void read_fit(TomlTable& table, std::set<std::string>& taken) {
    CampaignFit fit;
    fit.title = fit.name = name_in(table, taken);
    read_keys(table, keys_of(fit));
    fit.tests = tests_named<ModalTest>(fit.test_names, table, "tests", "modal");
    for (TomlTable& entry : table.tables_or_empty("parameter")) {
      fit.parameters.push_back(read_parameter(entry, fit));
      fit.free.push_back(fit.parameters.back());
    }
    if (fit.parameters.empty()) {
      throw table.error("parameter", "is missing", "a fit needs at least one [[fit.parameter]]");
    }
    for (const std::size_t test :
         tests_named<DecayTest>(fit.predicted_names, table, "predicts", "decay")) {
      std::get<DecayTest>(campaign_.tests[test].kind).fits.push_back(campaign_.fits.size());
      for (const auto& parameter : fit.parameters) {  // the test's scene has all of them
        for (const auto& target : parameter.targets) {
          check_parameter(scene_of(test), target, table, "predicts");
        }
      }
    }
    table.finish();
    campaign_.fits.push_back(std::move(fit));
  }

  FitParameter read_parameter(TomlTable& table, const CampaignFit& fit) const {
    FitParameter free;
    read_keys(table, keys_of(free));
    const std::string key = free.targets.empty() ? "name" : "of";
    if (free.targets.empty()) free.targets = {free.name};
    if (!free.factors.empty() && free.factors.size() != free.targets.size()) {
      throw table.error("factors", fmt::format("has {} values", free.factors.size()),
                        "give one for each parameter");
    }
    if (free.prior_value) free.prior = signal::Estimate{*free.prior_value, *free.prior_std};
    free.prior_relative_std = free.prior_std_percent / 100;
    if (!(free.low < free.high)) {
      throw table.error("high", "is not above low", "give a lower and a higher bound");
    }
    // Every target is in one of the scenes; one that differs from state to state is in all.
    for (const auto& target : free.targets) {
      const auto has = [&](std::size_t test) {
        return std::ranges::count(model::parameter_names(scene_of(test)), target) > 0;
      };
      const bool enough = free.per_state ? std::ranges::all_of(fit.tests, has)
                                         : std::ranges::any_of(fit.tests, has);
      for (const std::size_t test : fit.tests) {
        if (!enough) check_parameter(scene_of(test), target, table, key);
      }
    }
    table.finish();
    return free;
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
