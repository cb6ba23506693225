// What tests of the program include: what all tests do, JSON, files and text, runs of the program.
#pragma once

#include <fmt/ranges.h>

#include <nlohmann/json.hpp>

#include "tests/apps/run_program.h"
#include "tests/test.h"

namespace rigfit::apps {
/// What the program wrote as JSON, with its keys in the order of the alphabet.
using Document = nlohmann::json;

/// The report of `Own::kCampaign` in testdata/, made once for all tests of a fixture.
template <class Own>
struct ReportOfACampaign : ::testing::Test {
  static void SetUpTestSuite() {
    folder_ = std::make_unique<TemporaryFolder>();
    run_ = run_line("report $/{} --out {} --threads 2", {Own::kCampaign, folder_->path().string()});
    document_ = parsed(folder_->read("report.json"));
  }
  static void TearDownTestSuite() { folder_.reset(); }
  static inline std::unique_ptr<TemporaryFolder> folder_;
  static inline ProgramRun run_;
  static inline Document document_;
};

/// The first entry of a list in a document that has this under `key`.
inline const Document& named(const Document& list, const std::string& key, const Document& name) {
  for (const auto& one : list) {
    if (one.at(key) == name) return one;
  }
  throw std::out_of_range(key + " " + name.dump());
}

/// The text with the first `from`, which must be there, replaced.
inline std::string replaced(std::string text, const std::string& from, const std::string& to) {
  return text.replace(text.find(from), from.size(), to);
}

/// What `update` writes of one parameter that was fitted.
inline std::string fit_json(const std::string& name, double value, double std) {
  return Document{{"parameters", {{{"name", name}, {"value", value}, {"std", std}}}},
                  {"correlation", {{1.0}}}}
      .dump();
}

/// A scene: a cable of 2.4 m in 12 segments between pinned ends at 200 N.
inline constexpr const char* kCableScene = R"([[node]]
name = "left"
position = [0.0, 0.0, 0.0]
support = "pinned"
[[node]]
name = "right"
position = [2.4, 0.0, 0.0]
support = "pinned"
[[member]]
name = "cable"
kind = "cable"
nodes = ["left", "right"]
segments = 12
mass_per_length = 0.16667
EA = 221780.0
EI = 0.5972
GJ = 0.1
tension = 200.0
)";

}  // namespace rigfit::apps
