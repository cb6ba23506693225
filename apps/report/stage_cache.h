// Results of a report's stages kept between runs, by the content of all that goes into them: a run
// after a change redoes what the change reaches and reads back the rest, bit by bit.
//
// A stage's key is SHA-256 of the program, the stage's name and its inputs. Every result, fresh or
// kept, has gone through the same bytes. What cannot be read is computed anew.
#pragma once

#include <filesystem>
#include <functional>
#include <mutex>
#include <optional>
#include <set>
#include <string>

#include "apps/cli/sha256.h"
#include "apps/report/part_archive.h"

namespace rigfit::apps {

class StageCache {
 public:
  /// Keeps its files in `folder` (made when the first is written).
  explicit StageCache(std::filesystem::path folder);

  /// The result of `compute`, or the one kept under `key`, which must hold all that it depends on.
  template <class T>
  [[nodiscard]] T stage(const std::string& key, const std::function<T()>& compute) {
    const std::string name = sha256(program_ + key);
    if (const auto bytes = read(name)) {
      try {
        ArchiveReader reader(*bytes);
        T value;
        reader(value);
        if (reader.at_end()) return count(value, true);
      } catch (const std::exception&) {  // cut short or of another build: compute it
      }
    }
    T value = compute();
    ArchiveWriter writer;
    writer(value);
    write(name, writer.take());
    return count(value, false);
  }

  /// Removes what this run did not use.
  void prune() const;
  [[nodiscard]] int reused() const { return reused_; }
  [[nodiscard]] int computed() const { return computed_; }

 private:
  [[nodiscard]] std::optional<std::string> read(const std::string& name);
  void write(const std::string& name, const std::string& bytes);
  template <class T>
  T count(T& value, bool kept) {
    const std::lock_guard lock(mutex_);
    ++(kept ? reused_ : computed_);
    return std::move(value);
  }

  std::filesystem::path folder_;
  std::string program_;
  std::mutex mutex_;
  std::set<std::string> used_;
  int reused_ = 0, computed_ = 0;
};

}  // namespace rigfit::apps
