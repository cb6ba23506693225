#include "apps/cli/verbs/fit_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <utility>

#include "apps/cli/exit_code.h"
#include "apps/cli/json_document.h"
#include "apps/cli/named_numbers.h"
#include "model/scene/scene_error.h"

namespace rigfit::apps {
namespace {

[[noreturn]] void refuse_file(const std::string& path, const std::string& what) {
  throw model::SceneError({path, 0, 0, ""}, what,
                          "give the JSON result of `rigfit update SCENE ... --json FIT.json`");
}

/// What the fit ended with.
void read_outcome(const Json& json, const std::string& path, bool accepted, VerbContext& context) {
  const auto object = [](const Json& in, const char* key) {
    return in.contains(key) && in[key].is_object() ? in[key] : Json::object();
  };
  const auto number = [](const Json& in, const char* key) {
    return in.contains(key) && in[key].is_number() ? in[key].get<double>() : 0.0;
  };
  if (json.contains("warnings") && json["warnings"].is_array()) {
    for (const auto& warning : json["warnings"]) {
      if (!warning.is_object()) continue;
      const std::string code = warning.value("code", "");
      if (code != "model_ruled_out" && code != "not_converged" && code != "mode_unpaired") continue;
      context.warn("fit_" + code, "in the fit: " + warning.value("message", ""), path);
    }
  }
  const double exit_code = number(object(json, "error"), "exit_code");
  if (exit_code >= 4 && !accepted) {
    context.refuse("fit_refused",
                   fmt::format("mend the fit, or take it with --accept-fit: it ended with exit "
                               "code {:g}, and its parameters need not be those of the rig",
                               exit_code),
                   path);
  }
}

/// What the fit's own inputs do to its parameters, from their budgets.
void read_input_effects(const Json& rows, const std::vector<std::size_t>& kept,
                        ident::FittedParameters& fitted) {
  for (std::size_t k = 0; k < kept.size(); ++k) {
    const auto& row = rows[kept[k]];
    if (!row.contains("budget") || !row["budget"].is_array()) continue;
    for (const auto& term : row["budget"]) {
      if (!term.is_object() || !term.contains("source") || !term["source"].is_string() ||
          !term.contains("change") || !term["change"].is_number()) {
        continue;
      }
      ident::add_effect(term["source"].get<std::string>(), static_cast<Eigen::Index>(k),
                        term["change"].get<double>(), fitted);
    }
  }
}

}  // namespace

ident::FittedParameters read_fit(const std::string& path, bool accepted, VerbContext& context) {
  std::ifstream file(path, std::ios::binary);
  if (!file || std::filesystem::is_directory(path)) refuse_file(path, "cannot be read");
  const Json json = Json::parse(file, nullptr, false);
  if (json.is_discarded() || !json.is_object()) refuse_file(path, "is no JSON document");
  if (!json.contains("parameters") || !json["parameters"].is_array()) {
    refuse_file(path, "has no \"parameters\"");
  }
  const auto& rows = json["parameters"];
  const auto correlation = [&](std::size_t i, std::size_t j) {
    if (i == j) return 1.0;
    if (!json.contains("correlation") || !json["correlation"].is_array()) return 0.0;
    const auto& matrix = json["correlation"];
    if (i >= matrix.size() || !matrix[i].is_array() || j >= matrix[i].size()) return 0.0;
    return matrix[i][j].is_number() ? matrix[i][j].get<double>() : 0.0;
  };
  ident::FittedParameters fitted;
  std::vector<std::size_t> kept;
  std::vector<double> std;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const auto& row = rows[i];
    if (!row.is_object() || !row.contains("name") || !row["name"].is_string() ||
        !row.contains("value") || !row["value"].is_number()) {
      refuse_file(path, fmt::format("parameter {} has no name or no value", i + 1));
    }
    const auto name = row["name"].get<std::string>();
    const bool known = row.contains("std") && row["std"].is_number();
    if (!known) {
      context.warn("parameter_without_std",
                   name + " is not identified by the fit: the scene's own value stays", path);
      continue;
    }
    fitted.parameters.push_back({name, row["value"].get<double>()});
    std.push_back(row["std"].get<double>());
    kept.push_back(i);
  }
  read_input_effects(rows, kept, fitted);
  read_outcome(json, path, accepted, context);
  const auto n = static_cast<Eigen::Index>(kept.size());
  fitted.covariance.resize(n, n);
  for (std::size_t i = 0; i < kept.size(); ++i) {
    for (std::size_t j = 0; j < kept.size(); ++j) {
      fitted.covariance(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) =
          correlation(kept[i], kept[j]) * std[i] * std[j];
    }
  }
  if (json.contains("alternatives") && json["alternatives"].is_array() &&
      !json["alternatives"].empty() && json["alternatives"][0].value("weight", 1.0) < 0.9) {
    context.warn("not_decided",
                 "the fit has several answers; the prediction is of the heaviest one", path);
  }
  return fitted;
}

void apply_maps(const std::vector<std::string>& maps, ident::FittedParameters& fitted) {
  for (const auto& text : maps) {
    const auto equals = text.find('=');
    if (equals == std::string::npos || equals == 0 || equals + 1 == text.size()) {
      throw UsageError("--map: write NAME=TARGET[,-TARGET...], not \"" + text + "\"");
    }
    const auto name = text.substr(0, equals);
    const auto known = std::find_if(fitted.parameters.begin(), fitted.parameters.end(),
                                    [&](const auto& parameter) { return parameter.name == name; });
    if (known == fitted.parameters.end())
      throw UsageError("--map: the fit has no parameter " + name);
    auto targets = signed_names("--map", text.substr(equals + 1));
    known->targets = std::move(targets.names);
    known->factors = std::move(targets.signs);
  }
}

}  // namespace rigfit::apps
