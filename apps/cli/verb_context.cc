#include "apps/cli/verb_context.h"

#include <openssl/evp.h>

#include <iostream>
#include <system_error>

#include "apps/cli/progress.h"
#include "apps/describe/json_of.h"
#include "document/document_error.h"
#include "signal/readers/read_recording.h"
#include "signal/recording/recording.h"

namespace rigfit::apps {
namespace fs = std::filesystem;
namespace {

/// As the file is now.
Input input_of(const std::string& path) {
  std::error_code none;
  return {path, sha256_of_file(path), fs::last_write_time(path, none)};
}

}  // namespace

std::string sha256(std::string_view bytes) {
  std::array<unsigned char, EVP_MAX_MD_SIZE> digest{};
  unsigned size = 0;
  EVP_Digest(bytes.data(), bytes.size(), digest.data(), &size, EVP_sha256(), nullptr);
  return fmt::format("{:02x}", fmt::join(digest.begin(), digest.begin() + size, ""));
}

std::string sha256_of_file(const fs::path& path) {
  std::error_code none;
  if (!fs::is_regular_file(path, none)) return "";
  if (fs::file_size(path, none) == 0) return sha256("");
  try {
    return sha256(signal::MappedFile(path).bytes());
  } catch (const signal::RecordingError&) {
    return "";
  }
}

ExitCode exit_code_of(const std::exception& error) {
  if (const auto* ended = dynamic_cast<const Ended*>(&error)) return ended->exit_code;
  if (dynamic_cast<const signal::RecordingError*>(&error)) return ExitCode::bad_input;
  if (dynamic_cast<const document::DocumentError*>(&error)) return ExitCode::bad_input;
  if (dynamic_cast<const std::invalid_argument*>(&error)) return ExitCode::wrong_usage;
  return ExitCode::fault;
}

void VerbContext::say_warnings() const {
  if (quiet || silent) return;
  if (!unsaid_.empty()) Progress::erase();
  for (const auto& line : warning_lines(unsaid_, verbose)) std::cerr << "warning: " << line << '\n';
  if (!verbose) return;
  for (const auto& line : warning_lines(notes_, true)) std::cerr << "note: " << line << '\n';
}

void VerbContext::tell(const std::vector<Finding>& findings) {
  for (const auto& one : findings) {
    const bool ends = one.refused || one.code == "not_converged",
               note = !ends && level_of(one.code) == Level::note;
    (note ? notes_ : warnings_).push_back(one);
    if (!ends && !note) unsaid_.push_back(one);
    if (!ends) continue;
    if (!silent) {
      Progress::erase();
      std::cerr << (one.refused ? "refused: " : "error: ")
                << (one.where.empty() ? "" : one.where + ": ") << one.message << '\n';
    }
    const auto code = one.refused ? ExitCode::refused : ExitCode::not_converged;
    if (exit_code != code) ended_by_ = one;
    exit_code = code;
  }
}

void VerbContext::input(const std::string& path) {
  if (std::ranges::count(inputs_, path, &Input::path) > 0) return;
  Input one = hashes_inputs ? input_of(path) : Input{path, "", {}};
  const auto twin = std::ranges::find(inputs_, one.sha256, &Input::sha256);
  if (!one.sha256.empty() && twin != inputs_.end() && !path.ends_with(".toml")) {
    warn("same_data",
         "Leave it out: it holds what " + twin->path + " holds, and counts as new data", path);
  }
  inputs_.push_back(std::move(one));
}

void VerbContext::check_inputs() const {
  if (!hashes_inputs) return;
  for (const auto& input : inputs_) {
    std::error_code none;
    if (fs::last_write_time(input.path, none) == input.time) continue;
    const Input now = input_of(input.path);
    if (now.sha256 == input.sha256) continue;
    throw InputChanged(input.path + ": " + (now.sha256.empty() ? "was removed" : "changed") +
                       " while it was being used; run again when nothing writes to it");
  }
}

void VerbContext::write(const fs::path& path, std::string_view content) const {
  check_inputs();
  for (const auto& input : inputs_) {
    std::error_code none;
    if (fs::equivalent(path, input.path, none)) {
      throw UsageError(path.string() + " is an input of this run, which stays as it is; name " +
                       "another file to write to");
    }
  }
  write_whole_file(path, content);
}

Json VerbContext::document(const std::string& verb, const Json& result) const {
  check_inputs();
  Json document{{"rigfit", RIGFIT_VERSION}, {"command", verb}, {"inputs", Json::array()}};
  for (const auto& input : inputs_) {
    document["inputs"].push_back({{"path", input.path}, {"sha256", input.sha256}});
  }
  document["warnings"] = describe::json_of(warnings_);
  document["notes"] = describe::json_of(notes_);
  if (exit_code != ExitCode::done) {
    document["error"] = {{"exit_code", static_cast<int>(exit_code)}};
    document["error"].update(describe::json_of(ended_by_));
  }
  document.update(result);
  return document;
}

}  // namespace rigfit::apps
