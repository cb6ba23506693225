#include "apps/cli/verbs/update_candidates.h"

#include <fmt/format.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <set>
#include <utility>

#include "apps/cli/json_document.h"
#include "apps/describe/sheet.h"
#include "apps/results/results_json.h"
#include "document/toml_table.h"
#include "ident/campaign/fit_campaign.h"
#include "ident/update/update_rows.h"
#include "model/scene/actual_state.h"
#include "model/scene/parameters.h"

namespace rigfit::apps {
namespace {

const std::vector<std::string> kSupportWords{"free", "pinned", "clamped", "springs", "own springs"};

// Rotational springs across the member, started at 10 EI / L: between what a member takes for
// pinned and for clamped. Returns their parameters.
std::vector<std::string> put_springs(const model::Scene& scene, model::SceneNode& node) {
  constexpr double kStart = 10;
  const auto end = std::find_if(scene.members.begin(), scene.members.end(), [&](const auto& one) {
    return one.nodes[0] == node.name || one.nodes[1] == node.name;
  });
  const bool any = end != scene.members.end();
  const Eigen::Vector3d along =
      any ? model::chord_of(scene, *end) : Eigen::Vector3d(Eigen::Vector3d::Zero());
  Eigen::Index axis = 0;
  const double length = along.norm();
  if (!any || along.cwiseAbs().maxCoeff(&axis) < 0.95 * length) {
    throw UsageError("springs at node " + node.name +
                     ": its member must lie along an axis; give the candidate a scene of its own");
  }
  constexpr double kFixed = std::numeric_limits<double>::infinity();
  auto& support = node.support;
  if (support.kind != model::Support::Kind::elastic) support.translational.setConstant(kFixed);
  support.kind = model::Support::Kind::elastic;
  support.rotational.setConstant(kStart * std::max(end->EI[0], end->EI[1]) / length);
  support.rotational[axis] = kFixed;
  std::vector<std::string> targets;
  for (Eigen::Index i = 0; i < 3; ++i) {
    if (i == axis) continue;
    targets.push_back(fmt::format("{}.rotational_{}", node.name, "xyz"[i]));
  }
  return targets;
}

// The supports of a candidate, by node; what springs are fitted goes to `free`.
void put_supports(const std::vector<std::pair<std::string, std::string>>& words,
                  model::Scene& scene, std::vector<std::string>* free) {
  std::string shared;
  for (const auto& [name, word] : words) {
    const auto node = std::find_if(scene.nodes.begin(), scene.nodes.end(),
                                   [&name = name](const auto& one) { return one.name == name; });
    if (node == scene.nodes.end()) {
      throw UsageError("candidates: the scene has no node \"" + name + "\"");
    }
    using Kind = model::Support::Kind;
    if (word == "free" || word == "pinned" || word == "clamped") {
      node->support = {};
      node->support.kind = word == "free"     ? Kind::free
                           : word == "pinned" ? Kind::pinned
                                              : Kind::clamped;
      continue;
    }
    std::string own;
    for (const auto& target : put_springs(scene, *node)) {
      std::string& list = word == "springs" ? shared : own;
      if (!list.empty()) list += ',';
      list += target;
    }
    if (!own.empty() && free != nullptr) free->push_back(fmt::format("{}.springs={}", name, own));
  }
  if (!shared.empty() && free != nullptr) free->push_back("springs=" + shared);
}

NamedModel read_candidate(document::TomlTable& table, const UpdateCommand& command,
                          const UpdateStates& states, VerbContext& context) {
  NamedModel one{table.string("name"), states, {}, {}};
  if (table.has("scene")) {
    UpdateData data = command.data;
    const std::filesystem::path path =
        std::filesystem::path(command.candidates).parent_path() / table.string("scene");
    data.scenes = {path.string()};
    one.states = read_update_states(data, context);
  }
  std::vector<std::pair<std::string, std::string>> supports;
  if (table.has("supports")) {
    auto words = table.table("supports");
    for (const auto& node : words.keys()) {
      supports.emplace_back(node, words.choice_or(node, kSupportWords, ""));
    }
    words.finish();
  }
  std::vector<std::pair<std::string, double>> values;
  if (table.has("set")) {
    auto set = table.table("set");
    for (const auto& name : set.keys()) {
      values.emplace_back(name, set.number(name, document::Bound::any, "SI"));
    }
    set.finish();
  }
  bool first = true;
  for (auto& state : one.states.states) {
    put_supports(supports, state.scene, first ? &one.free : nullptr);
    for (const auto& [name, value] : values) model::set_parameter(state.scene, name, value);
    first = false;
  }
  if (table.has("free")) {
    for (auto& text : table.string_or_strings("free")) one.free.push_back(std::move(text));
  }
  if (table.has("prior")) one.priors = table.string_or_strings("prior");
  table.finish();
  return one;
}

// Every node that is held, with this word.
NamedModel with_ends(const std::string& word, const UpdateStates& states) {
  NamedModel one{word, states, {}, {}};
  bool first = true;
  for (auto& state : one.states.states) {
    std::vector<std::pair<std::string, std::string>> supports;
    for (const auto& node : state.scene.nodes) {
      if (node.support.kind != model::Support::Kind::free) supports.emplace_back(node.name, word);
    }
    put_supports(supports, state.scene, first ? &one.free : nullptr);
    first = false;
  }
  return one;
}

}  // namespace

std::vector<NamedModel> candidate_models(const UpdateCommand& command, const UpdateStates& states,
                                         VerbContext& context) {
  std::vector<NamedModel> models;
  for (const auto& word : command.ends) models.push_back(with_ends(word, states));
  if (!command.candidates.empty()) {
    context.input(command.candidates);
    auto root = document::TomlTable::read_file(command.candidates);
    for (auto& table : root.tables_or_empty("candidate")) {
      models.push_back(read_candidate(table, command, states, context));
    }
    root.finish();
  }
  std::set<std::string> names;
  for (const auto& one : models) {
    if (!names.insert(one.name).second) {
      throw UsageError("candidates: \"" + one.name + "\" is there twice");
    }
  }
  if (models.size() < 2) throw UsageError("candidates: two or more are needed to compare");
  return models;
}

Json candidates_json(const ident::CandidateComparison& comparison, VerbContext& context) {
  Json list = Json::array();
  auto& out = context.out;
  out << fmt::format("\n{:<24} {:>8} {:>12}  {}\n", "candidate", "weight", "ln evidence", "fit");
  for (const auto& one : comparison.candidates) {
    const bool fitted = one.result.status != ident::UpdateStatus::no_model;
    const auto& fit = one.result.fit;
    Json entry{{"name", one.name},
               {"weight", one.weight},
               {"log_evidence", fitted ? one.result.log_evidence : std::nan("")},
               {"status", ident::name_of(one.result.status)},
               {"message", one.result.message},
               {"chi2", fitted ? Json(fit.chi2) : Json(nullptr)},
               {"degrees_of_freedom", fitted ? Json(fit.degrees_of_freedom) : Json(nullptr)},
               {"p_value", fit.p_value},
               {"parameters", Json::array()}};
    out << fmt::format("{:<24} {:>8.3f} {:>12}  {}\n", one.name, one.weight,
                       fitted ? fmt::format("{:.2f}", one.result.log_evidence) : "-",
                       fitted ? ident::fit_text(fit) : one.result.message);
    if (fitted) {
      entry["parameters"] = describe::json_of(one.result.parameters);
      describe::print(out, describe::table_of(one.result.parameters));
    }
    list.push_back(std::move(entry));
  }
  Json averaged = Json::array();
  for (const auto& p : comparison.averaged) {
    Json row{{"name", p.name}};
    row.update(describe::json_of(describe::Bounded{p.value, p.std, p.low, p.high}));
    averaged.push_back(std::move(row));
  }
  if (!averaged.empty()) {
    out << "averaged over the candidates by their weights:\n";
    describe::print(out, describe::table_of(comparison.averaged));
  }
  const auto& best = comparison.candidates[static_cast<std::size_t>(comparison.heaviest)];
  if (best.weight < 0.9) {
    context.refuse("several_models",
                   fmt::format("no candidate has 90 % of the weight, the heaviest ({}) has {:.2f}: "
                               "see candidates; the averaged values allow for all of them. More "
                               "modes, shapes or a prior decide",
                               best.name, best.weight));
  }
  return {{"candidates", std::move(list)}, {"averaged", std::move(averaged)}};
}

}  // namespace rigfit::apps
