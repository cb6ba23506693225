#include "apps/cli/verb_context.h"

#include <fmt/format.h>
#include <sys/stat.h>

#include <iostream>
#include <system_error>

#include "apps/cli/output_file.h"
#include "apps/cli/progress.h"
#include "apps/cli/sha256.h"
#include "apps/cli/terminal.h"

namespace rigfit::apps {
namespace {

/// Size, time and identity of a file; zeros when there is none.
Input stamp_of(const std::string& path) {
  Input input;
  input.path = path;
  struct stat file {};
  if (::stat(path.c_str(), &file) != 0 || !S_ISREG(file.st_mode)) return input;
  input.size = file.st_size;
  input.changed_ns = file.st_mtim.tv_sec * 1'000'000'000LL + file.st_mtim.tv_nsec;
  input.file_id = file.st_ino;
  return input;
}

}  // namespace

void VerbContext::warn(std::string code, std::string message, std::string where) {
  const bool note = is_note(code);
  if (!note) unsaid_.push_back(warnings_.size());
  (note ? notes_ : warnings_).push_back({std::move(code), std::move(message), std::move(where)});
}

void VerbContext::end(ExitCode code, const char* word, Warning why) {
  if (!silent) {
    Progress::erase();
    std::cerr << on_terminal(TerminalColour::red, word) << ' '
              << (why.where.empty() ? "" : why.where + ": ") << why.message << '\n';
  }
  warnings_.push_back(std::move(why));
  exit_code = code;
}

void VerbContext::refuse(std::string code, std::string message, std::string where) {
  end(ExitCode::refused, "refused:", {std::move(code), std::move(message), std::move(where), true});
}

void VerbContext::fail(std::string message, std::string where) {
  end(ExitCode::not_converged, "error:", {"not_converged", std::move(message), std::move(where)});
}

void VerbContext::say_warnings() const {
  if (quiet || silent) return;
  std::vector<Warning> unsaid;
  unsaid.reserve(unsaid_.size());
  for (const std::size_t k : unsaid_) unsaid.push_back(warnings_[k]);
  if (!unsaid.empty()) Progress::erase();
  for (const auto& line : warning_lines(unsaid, verbose ? unsaid.size() : 5)) {
    std::cerr << on_terminal(TerminalColour::yellow, "warning:") << ' ' << line << '\n';
  }
  if (!verbose) return;
  for (const auto& line : warning_lines(notes_, notes_.size()))
    std::cerr << "note: " << line << '\n';
}

void VerbContext::tell(const std::vector<ident::Finding>& findings) {
  for (const auto& finding : findings) {
    if (finding.refused) {
      refuse(finding.code, finding.message, finding.where);
    } else {
      warn(finding.code, finding.message, finding.where);
    }
  }
}

void VerbContext::input(const std::string& path) {
  if (!known_.insert(path).second) return;
  Input input;
  input.path = path;
  if (hashes_inputs) {
    input = stamp_of(path);
    try {
      input.sha256 = sha256_of_file(path);
    } catch (const std::system_error&) {
      // Whoever reads it says why it cannot be read.
    }
  }
  inputs_.push_back(std::move(input));
}

void VerbContext::check_inputs() const {
  if (!hashes_inputs) return;
  for (const auto& input : inputs_) {
    const Input now = stamp_of(input.path);
    if (now.size == input.size && now.changed_ns == input.changed_ns &&
        now.file_id == input.file_id) {
      continue;
    }
    std::string sha256;
    try {
      sha256 = sha256_of_file(input.path);
    } catch (const std::system_error&) {
    }
    if (sha256 == input.sha256) continue;
    throw InputChanged(input.path + ": " + (sha256.empty() ? "was removed" : "changed") +
                       " while it was being used; run again when nothing writes to it");
  }
}

void VerbContext::write(const std::filesystem::path& path, std::string_view content) const {
  check_inputs();
  for (const auto& input : inputs_) {
    std::error_code none;
    if (std::filesystem::equivalent(path, input.path, none)) {
      throw UsageError(path.string() + " is an input of this run, which stays as it is; name " +
                       "another file to write to");
    }
  }
  write_whole_file(path, content);
}

}  // namespace rigfit::apps
