// A TOML table read key by key, each key once: what is left over at the end is an unknown key.
//
// Shared by every TOML reader (scenes, campaigns, descriptions beside recordings), so that a wrong
// file is refused in the same words everywhere.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string_view>
#include <vector>

#include "document/document_error.h"

namespace rigfit::document {

/// Bounds a number must keep; refused with the remedy otherwise. Non-finite is always refused.
enum class Bound { any, not_negative, positive };

/// The word most like the given one (few typing errors away), if any is; for "did you mean".
[[nodiscard]] std::optional<std::string> nearest_word(const std::string& word,
                                                      const std::vector<std::string>& words);

class TomlTable {
 public:
  /// Parses a file's text; throws DocumentError with line and column.
  static TomlTable parse(std::string_view text, const std::string& file);
  /// The same from a file; a missing or unreadable one is a DocumentError too.
  static TomlTable read_file(const std::filesystem::path& path);

  [[nodiscard]] bool has(const std::string& key) const;
  [[nodiscard]] const std::string& path() const {
    return path_;
  }  ///< such as "member[1]", for messages

  // Each throws DocumentError for a wrong type or a broken bound; without a fallback a missing key
  // is an error.
  double number(const std::string& key, Bound bound, const std::string& unit);
  double number_or(const std::string& key, Bound bound, const std::string& unit, double fallback);
  std::optional<double> optional_number(const std::string& key, Bound bound,
                                        const std::string& unit);
  int integer_or(const std::string& key, int low, int high, int fallback);
  bool boolean_or(const std::string& key, bool fallback);
  std::string string(const std::string& key);
  std::string string_or(const std::string& key, const std::string& fallback);
  /// One of the words; the remedy lists them.
  std::string choice_or(const std::string& key, const std::vector<std::string>& words,
                        const std::string& fallback);
  /// `infinite_allowed`: plus infinity (`inf`) passes too, as a stiffness that is fixed.
  std::vector<double> numbers(const std::string& key, std::size_t min_size, std::size_t max_size,
                              Bound bound, const std::string& unit, bool infinite_allowed = false);
  /// Strings given as one string or as a list of them.
  std::vector<std::string> strings(const std::string& key);
  TomlTable table(const std::string& key);
  std::vector<TomlTable> tables_or_empty(const std::string& key);
  [[nodiscard]] bool is_string(const std::string& key) const;
  [[nodiscard]] bool is_table(const std::string& key) const;
  [[nodiscard]] bool is_array(const std::string& key) const;
  /// All keys of this table, or those never asked for, in file order.
  [[nodiscard]] std::vector<std::string> keys(bool unasked = false) const;

  /// Throws DocumentError for the first key that was never asked for, with the nearest known key.
  void finish() const;
  /// An error at a key of this table (at the table itself when the key is absent or empty; the
  /// remedy of an absent one names a key like it that nothing has asked for).
  [[nodiscard]] DocumentError error(const std::string& key, std::string problem,
                                    std::string remedy) const;

 private:
  struct Node;
  TomlTable(std::shared_ptr<Node> node, std::string path);
  /// A key of this table by the names of the tables that it stands in.
  [[nodiscard]] std::string path_of(const std::string& key) const {
    return path_.empty() ? key : path_ + "." + key;
  }
  /// The key's value of this kind ("a table", for messages); where the key is absent, null, or an
  /// error if it is `needed`.
  template <typename Kind>
  const auto* typed(const std::string& key, const char* kind, const std::string& remedy,
                    bool needed = false) const;
  /// Calls `take` with every item of a list; false from it is an item of a wrong kind.
  template <typename Item>
  void each(const std::string& key, const char* kind, const char* item_kind,
            const std::string& remedy, Item&& take) const;
  std::shared_ptr<Node> node_;
  std::string path_;
};

}  // namespace rigfit::document
