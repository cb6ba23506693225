#include "tests/apps/json_schema.h"

#include <nlohmann/json.hpp>

namespace rigfit::apps {
namespace {

class Checker {
 public:
  explicit Checker(const nlohmann::json& root) : root_(root) {}

  void check(const nlohmann::json& value, const nlohmann::json& schema, const std::string& at) {
    if (schema.is_boolean()) {
      if (!schema.get<bool>()) fail(at, "is not in the schema");
      return;
    }
    for (const auto& [key, rule] : schema.items()) keyword(value, key, rule, schema, at);
  }

  std::vector<std::string> errors;

 private:
  void fail(const std::string& at, const std::string& what) {
    if (errors.size() < 20) errors.push_back((at.empty() ? "/" : at) + ": " + what);
  }

  static bool is_type(const nlohmann::json& value, const std::string& type) {
    if (type == "object") return value.is_object();
    if (type == "array") return value.is_array();
    if (type == "string") return value.is_string();
    if (type == "boolean") return value.is_boolean();
    if (type == "null") return value.is_null();
    if (type == "integer") return value.is_number_integer();
    return type == "number" && value.is_number();
  }

  void keyword(const nlohmann::json& value, const std::string& key, const nlohmann::json& rule,
               const nlohmann::json& schema, const std::string& at) {
    if (key == "$schema" || key == "$id" || key == "$defs" || key == "title" ||
        key == "description") {
      return;
    }
    if (key == "$ref") {
      check(value, root_.at(nlohmann::json::json_pointer(rule.get<std::string>().substr(1))), at);
    } else if (key == "type") {
      bool fits = rule.is_string() && is_type(value, rule);
      if (rule.is_array()) {
        for (const auto& type : rule) fits = fits || is_type(value, type);
      }
      if (!fits) fail(at, "is " + std::string(value.type_name()) + ", not " + rule.dump());
    } else if (key == "enum") {
      bool fits = false;
      for (const auto& one : rule) fits = fits || one == value;
      if (!fits) fail(at, value.dump() + " is none of " + rule.dump());
    } else if (key == "const") {
      if (value != rule) fail(at, value.dump() + " is not " + rule.dump());
    } else if (key == "minimum") {
      if (value.is_number() && value < rule) fail(at, value.dump() + " is below " + rule.dump());
    } else if (key == "maximum") {
      if (value.is_number() && value > rule) fail(at, value.dump() + " is above " + rule.dump());
    } else if (key == "required") {
      for (const auto& name : rule) {
        if (value.is_object() && !value.contains(name)) fail(at, "lacks " + name.dump());
      }
    } else if (key == "properties") {
      for (const auto& [name, sub] : rule.items()) {
        if (value.is_object() && value.contains(name)) check(value[name], sub, at + "/" + name);
      }
    } else if (key == "additionalProperties") {
      if (!value.is_object()) return;
      for (const auto& [name, child] : value.items()) {
        if (!schema.contains("properties") || !schema["properties"].contains(name)) {
          check(child, rule, at + "/" + name);
        }
      }
    } else if (key == "items") {
      if (!value.is_array()) return;
      for (std::size_t i = 0; i < value.size(); ++i) {
        check(value[i], rule, at + "/" + std::to_string(i));
      }
    } else if (key == "anyOf") {
      for (const auto& one : rule) {
        Checker attempt(root_);
        attempt.check(value, one, at);
        if (attempt.errors.empty()) return;
      }
      fail(at, "fits none of its forms");
    } else {
      fail(at, "the schema's keyword \"" + key + "\" is not checked here");
    }
  }

  const nlohmann::json& root_;
};

}  // namespace

std::vector<std::string> schema_errors(const nlohmann::json& document,
                                       const nlohmann::json& schema) {
  Checker checker(schema);
  checker.check(document, schema, "");
  return checker.errors;
}

}  // namespace rigfit::apps
