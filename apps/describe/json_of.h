// Described results (signal/document/describe.h) as JSON, and the JSON schema of their types.
#pragma once

#include <Eigen/Core>
#include <complex>
#include <nlohmann/json.hpp>
#include <type_traits>

#include "apps/describe/standard.h"
#include "document/describe.h"

namespace rigfit::describe {

using Json = nlohmann::ordered_json;

template <class M>
concept estimate = requires(const M& m) {
  m.value;
  m.std;
}
&&!described<M>;
template <class M>
concept named = requires(const M& m) {
  name_of(m);
};
template <class M>
concept list = requires(const M& m) {
  typename M::value_type;
  m.begin();
}
&&!std::is_convertible_v<M, std::string_view>;

template <class M>
concept matrix = requires {
  M::ColsAtCompileTime;
}
&&!M::IsVectorAtCompileTime;

/// What an optional value holds, or the value's own type.
template <class M>
struct Held {
  using type = M;
};
template <class M>
struct Held<std::optional<M>> {
  using type = M;
};

/// Numbers that are not finite and empty optionals are null: a document of a kind has all its keys.
template <class M>
[[nodiscard]] Json json_of(const M& x) {
  if constexpr (described<M>) {
    Json all = Json::object();
    each_field<M>([&](const auto& f) {
      if (!f.key.empty()) all[std::string(f.key)] = json_of(std::invoke(f.get, x));
    });
    return all;
  } else if constexpr (requires { x.has_value(); }) {
    return x ? json_of(*x) : Json(nullptr);
  } else if constexpr (estimate<M>) {
    Json one{{"value", json_of(x.value)}, {"std", json_of(x.std)}};
    if constexpr (requires { x.low; }) {
      one["low"] = json_of(x.low), one["high"] = json_of(x.high);
    }
    if constexpr (requires { x.one_sided; }) {
      if (x.one_sided) one["bound"] = "lower";
    }
    return one;
  } else if constexpr (std::is_base_of_v<Ends, M>) {
    return {json_of(x.low), json_of(x.high)};
  } else if constexpr (std::is_floating_point_v<M>) {
    return std::isfinite(x) ? Json(x) : Json(nullptr);
  } else if constexpr (std::is_same_v<M, std::complex<double>>) {
    return {{"re", json_of(x.real())}, {"im", json_of(x.imag())}};
  } else if constexpr (std::is_same_v<M, ByName>) {
    Json all = Json::object();
    for (const auto& [name, value] : x.all) all[name] = json_of(value);
    return all;
  } else if constexpr (matrix<M>) {
    Json rows = Json::array();
    for (Eigen::Index i = 0; i < x.rows(); ++i) rows.push_back(json_of(x.row(i).eval()));
    return rows;
  } else if constexpr (list<M>) {
    Json all = Json::array();
    for (const auto& one : x) all.push_back(json_of(one));
    return all;
  } else if constexpr (named<M>) {
    return name_of(x);
  } else {
    return x;
  }
}

/// What `row` makes of each of a list.
template <class List, class Row>
[[nodiscard]] Json json_list(const List& list, Row row) {
  Json all = Json::array();
  for (const auto& one : list) all.push_back(row(one));
  return all;
}

/// The JSON schema of what is like `sample`; numbers that are not whole may be null.
[[nodiscard]] inline Json schema_like(const Json& sample) {
  if (sample.is_number_float() || sample.is_null()) return {{"type", {"number", "null"}}};
  Json all{{"type", sample.is_number() ? "integer" : sample.type_name()}};
  if (!sample.is_object()) return all;
  for (const auto& [key, value] : sample.items()) {
    all["properties"][key] = schema_like(value);
    all["required"].push_back(key);
  }
  return all;
}

/// The type's JSON schema, with meanings and units.
template <class M>
[[nodiscard]] Json schema_of() {
  if constexpr (described<M>) {
    Json all{{"type", "object"}, {"properties", Json::object()}, {"required", Json::array()}};
    each_field<M>([&](const auto& f) {
      using Value = std::remove_cvref_t<decltype(std::invoke(f.get, std::declval<const M&>()))>;
      Json one = schema_of<Value>();
      if (f.key.empty()) return;
      all["required"].push_back(f.key);
      const std::string_view unit = f.unit == "%" ? "1" : f.unit;
      one["description"] =
          std::string(f.meaning) + (unit.empty() ? "" : " (" + std::string(unit) + ")");
      all["properties"][std::string(f.key)] = std::move(one);
    });
    return all;
  } else if constexpr (requires(M m) { m.has_value(); }) {
    return {{"anyOf", {schema_of<typename M::value_type>(), Json{{"type", "null"}}}}};
  } else if constexpr (list<M> && !matrix<M>) {
    return {{"type", "array"}, {"items", schema_of<typename M::value_type>()}};
  } else if constexpr (std::is_convertible_v<M, std::string_view>) {
    return {{"type", "string"}};
  } else {
    return schema_like(json_of(M{}));
  }
}

/// The schema of an object that has at least these keys.
[[nodiscard]] inline Json schema_of_keys(Json properties) {
  Json all{{"type", "object"}, {"required", Json::array()}};
  for (const auto& [key, schema] : properties.items()) all["required"].push_back(key);
  all["properties"] = std::move(properties);
  return all;
}

}  // namespace rigfit::describe
