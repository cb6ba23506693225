#pragma once

#include <algorithm>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace rigfit::apps {

/// What of a document does not fit a schema of ours (type, properties, required, items, anyOf),
/// with its place. A keyword that is not known is an error: a schema that is not checked says
/// nothing.
inline std::vector<std::string> schema_errors(const nlohmann::json& value,
                                              const nlohmann::json& schema,
                                              const std::string& at = "") {
  std::vector<std::string> errors;
  const auto add = [&](const std::vector<std::string>& more) {
    errors.insert(errors.end(), more.begin(), more.end());
  };
  for (const auto& [key, rule] : schema.items()) {
    if (key == "type") {
      const std::string type = value.is_number() ? "number" : value.type_name();
      const auto fits = [&](const nlohmann::json& one) {
        return one == type || (one == "integer" && value.is_number_integer());
      };
      if (rule.is_array() ? std::none_of(rule.begin(), rule.end(), fits) : !fits(rule)) {
        errors.push_back(at + ": is " + type + ", not " + rule.dump());
      }
    } else if (key == "properties") {
      for (const auto& [name, child] : value.items()) {
        if (rule.contains(name)) add(schema_errors(child, rule[name], at + "/" + name));
      }
    } else if (key == "required") {
      for (const auto& name : rule) {
        if (!value.contains(name)) errors.push_back(at + ": lacks " + name.dump());
      }
    } else if (key == "items") {
      for (const auto& child : value) add(schema_errors(child, rule, at + "/"));
    } else if (key == "anyOf") {
      if (std::none_of(rule.begin(), rule.end(),
                       [&](const auto& one) { return schema_errors(value, one).empty(); })) {
        errors.push_back(at + ": fits none of its forms");
      }
    } else if (key != "description") {
      errors.push_back(at + ": the schema's \"" + key + "\" is not checked here");
    }
  }
  return errors;
}

}  // namespace rigfit::apps
