// Files written whole or not at all.
#pragma once

#include <filesystem>
#include <stdexcept>
#include <string_view>

namespace rigfit::apps {

/// Ends a verb whose output cannot be written: path, reason and remedy.
class OutputError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Writes beside the target under a temporary name, flushes to disk, then renames. Links are
/// followed; a device or pipe is written through (a pipe's reader is waited for up to 10 s). Throws
/// OutputError with path, reason and remedy; a regular target is then as it was.
void write_whole_file(const std::filesystem::path& path, std::string_view content);

/// Creates the folder (and parents); throws UsageError when the path is a file, OutputError when it
/// cannot be made.
void make_output_folder(const std::filesystem::path& folder);

/// Removes what a run that was killed left half written in a folder (not below it).
void sweep_parts(const std::filesystem::path& folder);

}  // namespace rigfit::apps
