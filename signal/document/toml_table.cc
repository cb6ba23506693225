#include "document/toml_table.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <toml++/toml.h>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <iterator>
#include <limits>
#include <numeric>
#include <set>
#include <sstream>
#include <utility>

namespace rigfit::document {
namespace {

/// Edits (insert, delete, replace) from one word to the other, whatever their case.
std::size_t edit_distance(std::string_view a, std::string_view b) {
  const auto lower = [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c; };
  std::vector<std::size_t> row(b.size() + 1);  // distances from the beginning of `a`
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t replaced = std::exchange(row[0], i + 1);
    for (std::size_t j = 0; j < b.size(); ++j) {
      if (lower(a[i]) != lower(b[j])) ++replaced;
      replaced = std::exchange(row[j + 1], std::min({row[j] + 1, row[j + 1] + 1, replaced}));
    }
  }
  return row.back();
}

std::string in_unit(const std::string& unit) { return unit.empty() ? "" : " in " + unit; }

/// What a value is, for messages: `a table`, or as it is written.
std::string described(const toml::node& node) {
  if (node.is_table()) return "a table";
  if (const auto* list = node.as_array()) return fmt::format("a list of {}", list->size());
  if (const auto* string = node.as_string(); string && string->get().size() > 60) {
    return "the string \"" + string->get().substr(0, 57) + "...\"";
  }
  std::ostringstream text;
  text << (node.is_string() ? "the string " : "") << toml::node_view<const toml::node>(node);
  return text.str();
}

}  // namespace

std::optional<std::string> nearest_word(const std::string& word,
                                        const std::vector<std::string>& words) {
  std::optional<std::string> best;
  std::size_t best_distance = std::max<std::size_t>(2, word.size() / 3) + 1;
  for (const auto& candidate : words) {
    const std::size_t distance = edit_distance(word, candidate);
    if (distance < best_distance && distance < std::max(word.size(), candidate.size())) {
      best_distance = distance;
      best = candidate;
    }
  }
  return best;
}

struct TomlTable::Node {
  std::shared_ptr<const toml::table> root;  // keeps `table` alive; copies would lose their lines
  const toml::table* table = nullptr;
  std::string file;
  std::set<std::string> asked;

  const toml::node* find(const std::string& key) {
    asked.insert(key);
    return table->get(key);
  }
  std::shared_ptr<Node> child(const toml::table& of) const {
    return std::make_shared<Node>(Node{root, &of, file, {}});
  }
};

TomlTable::TomlTable(std::shared_ptr<Node> node, std::string path)
    : node_(std::move(node)), path_(std::move(path)) {}

TomlTable TomlTable::parse(std::string_view text, const std::string& file) {
  auto node = std::make_shared<Node>();
  node->file = file;
  try {
    auto root = std::make_shared<toml::table>(toml::parse(text, file));
    node->table = root.get();
    node->root = std::move(root);
  } catch (const toml::parse_error& error) {
    const auto& begin = error.source().begin;
    throw DocumentError(
        {file, static_cast<long>(begin.line), static_cast<long>(begin.column), ""},
        "this is not TOML: " + std::string(error.description()),
        "mend this line (strings in quotes, a decimal point, one `key = value` a line)");
  }
  return {std::move(node), ""};
}

TomlTable TomlTable::read_file(const std::filesystem::path& path) {
  constexpr std::uintmax_t kLargest = 64u << 20;  // no person writes more; keeps a wrong path cheap
  std::error_code error;
  const auto fail = [&](const std::string& why, const char* remedy) {
    throw DocumentError({path.string(), 0, 0, ""}, why, remedy);
  };
  if (!std::filesystem::is_regular_file(path, error)) {
    fail(std::filesystem::exists(path, error) ? "this is not a file" : "there is no such file",
         "check the path; relative paths start at the file that names them");
  }
  if (std::filesystem::file_size(path, error) > kLargest) {
    fail("the file is too large to be a description", "name the TOML file, not a recording");
  }
  std::ifstream stream(path, std::ios::binary);
  const std::string text(std::istreambuf_iterator<char>(stream), {});
  if (!stream) fail("cannot be read", "check its permissions");
  return parse(text, path.string());
}

bool TomlTable::has(const std::string& key) const { return node_->find(key) != nullptr; }

DocumentError TomlTable::error(const std::string& key, std::string problem,
                               std::string remedy) const {
  const toml::node* at = key.empty() ? nullptr : node_->table->get(key);
  const auto& begin = (at ? *at : static_cast<const toml::node&>(*node_->table)).source().begin;
  const bool root = !at && path_.empty();
  const bool short_key = key.size() < 3;  // of its letters one is alike by chance, as in EA and EI
  const auto like = at || short_key ? std::nullopt : nearest_word(key, keys(true));
  if (like) remedy = fmt::format("rename \"{}\" if it is meant, or {}", *like, remedy);
  return {{node_->file, root ? 0 : static_cast<long>(begin.line),
           root ? 0 : static_cast<long>(begin.column), key.empty() ? path_ : path_of(key)},
          std::move(problem),
          std::move(remedy)};
}

namespace {

/// The bound that a number breaks, in words; empty: none.
std::string broken(double value, Bound bound, bool infinite_allowed) {
  if (std::isnan(value) || (std::isinf(value) && !(infinite_allowed && value > 0))) {
    return fmt::format("must be a finite number, got {}", value);
  }
  if (bound == Bound::not_negative && value < 0) {
    return fmt::format("must not be negative, got {}", value);
  }
  if (bound == Bound::positive && value <= 0) {
    return fmt::format("must be greater than zero, got {}", value);
  }
  return "";
}

}  // namespace

template <typename Kind>
const auto* TomlTable::typed(const std::string& key, const char* kind, const std::string& remedy,
                             bool needed) const {
  const toml::node* node = node_->find(key);
  if (!node && needed) throw error(key, "is missing", remedy);
  const auto* value = node ? node->as<Kind>() : nullptr;
  if (!node || value) return value;
  throw error(key, fmt::format("must be {}, got {}", kind, described(*node)), remedy);
}

template <typename Item>
void TomlTable::each(const std::string& key, const char* kind, const char* item_kind,
                     const std::string& remedy, Item&& take) const {
  const auto* list = typed<toml::array>(key, kind, remedy);
  for (std::size_t k = 0; list && k < list->size(); ++k) {
    if (take((*list)[k])) continue;
    throw error(key,
                fmt::format("value {} must be {}, got {}", k + 1, item_kind, described((*list)[k])),
                remedy);
  }
}

double TomlTable::number(const std::string& key, Bound bound, const std::string& unit) {
  if (auto value = optional_number(key, bound, unit)) return *value;
  throw error(key, "is missing", "add `" + key + " = ...`, a number" + in_unit(unit));
}

double TomlTable::number_or(const std::string& key, Bound bound, const std::string& unit,
                            double fallback) {
  return optional_number(key, bound, unit).value_or(fallback);
}

std::optional<double> TomlTable::optional_number(const std::string& key, Bound bound,
                                                 const std::string& unit) {
  const toml::node* node = node_->find(key);
  if (!node) return std::nullopt;
  if (!node->is_number()) {
    throw error(key, "must be a number, got " + described(*node),
                "write the number alone" + in_unit(unit) + ", without quotes or unit");
  }
  const double value = *node->value<double>();
  if (const auto problem = broken(value, bound, false); !problem.empty()) {
    throw error(key, problem, "give a number" + in_unit(unit));
  }
  return value;
}

int TomlTable::integer_or(const std::string& key, int low, int high, int fallback) {
  const std::string remedy = fmt::format("give a whole number from {} to {}", low, high);
  const auto* value = typed<std::int64_t>(key, "a whole number", remedy);
  if (!value) return fallback;
  if (value->get() >= low && value->get() <= high) return static_cast<int>(value->get());
  throw error(key, fmt::format("must be from {} to {}, got {}", low, high, value->get()), remedy);
}

bool TomlTable::boolean_or(const std::string& key, bool fallback) {
  const auto* value = typed<bool>(key, "true or false", "write true or false, without quotes");
  return value ? value->get() : fallback;
}

std::string TomlTable::string(const std::string& key) {
  if (!has(key)) throw error(key, "is missing", "add `" + key + " = \"...\"`");
  return typed<std::string>(key, "a string", "put it in double quotes")->get();
}

std::string TomlTable::string_or(const std::string& key, const std::string& fallback) {
  return has(key) ? string(key) : fallback;
}

std::string TomlTable::choice_or(const std::string& key, const std::vector<std::string>& words,
                                 const std::string& fallback) {
  if (!has(key)) return fallback;
  std::string value = string(key);
  if (std::ranges::find(words, value) != words.end()) return value;
  const auto nearest = nearest_word(value, words);
  throw error(key, "does not know \"" + value + "\"",
              (nearest ? "did you mean \"" + *nearest + "\"? It" : "it") +
                  fmt::format(" must be \"{}\"", fmt::join(words, "\" or \"")));
}

std::vector<double> TomlTable::numbers(const std::string& key, std::size_t min_size,
                                       std::size_t max_size, Bound bound, const std::string& unit,
                                       bool infinite_allowed) {
  const bool open = max_size == std::numeric_limits<std::size_t>::max();
  const std::string remedy = fmt::format("give a list of {}{} numbers{}", min_size,
                                         open                   ? " or more"
                                         : min_size == max_size ? std::string()
                                                                : fmt::format(" to {}", max_size),
                                         in_unit(unit));
  const std::size_t size = typed<toml::array>(key, "a list of numbers", remedy, true)->size();
  if (size < min_size || size > max_size) {
    throw error(key, fmt::format("has {} values", size), remedy);
  }
  std::vector<double> values;
  each(key, "a list of numbers", "a number", remedy, [&](const toml::node& item) {
    if (!item.is_number()) return false;
    values.push_back(*item.value<double>());
    if (const auto problem = broken(values.back(), bound, infinite_allowed); !problem.empty()) {
      throw error(key, fmt::format("value {} {}", values.size(), problem), remedy);
    }
    return true;
  });
  return values;
}

std::vector<std::string> TomlTable::strings(const std::string& key) {
  const std::string remedy = "write " + key + " = [\"...\", \"...\"]";
  if (!has(key)) throw error(key, "is missing", remedy);
  if (is_string(key)) return {string(key)};
  std::vector<std::string> values;
  each(key, "a list of strings", "a string", remedy, [&](const toml::node& item) {
    if (const auto* value = item.as_string()) values.push_back(value->get());
    return item.is_string();
  });
  return values;
}

TomlTable TomlTable::table(const std::string& key) {
  const auto* table = typed<toml::table>(key, "a table", "write " + key + " = { ... }", true);
  return {node_->child(*table), path_of(key)};
}

std::vector<TomlTable> TomlTable::tables_or_empty(const std::string& key) {
  std::vector<TomlTable> tables;
  const std::string path = path_of(key);
  each(key, "a list of tables", "a table", "write each one under a line [[" + path + "]]",
       [&](const toml::node& item) {
         if (const auto* table = item.as_table()) {
           tables.push_back({node_->child(*table), fmt::format("{}[{}]", path, tables.size())});
         }
         return item.is_table();
       });
  return tables;
}

bool TomlTable::is_string(const std::string& key) const { return (*node_->table)[key].is_string(); }
bool TomlTable::is_table(const std::string& key) const { return (*node_->table)[key].is_table(); }
bool TomlTable::is_array(const std::string& key) const { return (*node_->table)[key].is_array(); }

std::vector<std::string> TomlTable::keys(bool unasked) const {
  std::vector<toml::key> found;
  for (const auto& [key, value] : *node_->table) {
    if (!unasked || !node_->asked.contains(std::string(key))) found.push_back(key);
  }
  std::ranges::sort(found, {}, [](const toml::key& key) { return key.source().begin; });
  return {found.begin(), found.end()};
}

void TomlTable::finish() const {
  for (const auto& key : keys(true)) {
    const std::vector<std::string> known(node_->asked.begin(), node_->asked.end());
    const auto nearest = nearest_word(key, known);
    const auto& begin = node_->table->find(key)->first.source().begin;
    throw DocumentError(
        {node_->file, static_cast<long>(begin.line), static_cast<long>(begin.column), path_of(key)},
        "this key is not known here",
        nearest ? "did you mean \"" + *nearest + "\"?"
                : fmt::format("known keys: {}", fmt::join(known, ", ")));
  }
}

}  // namespace rigfit::document
