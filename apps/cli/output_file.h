// Files written whole or not at all.
#pragma once

#include <filesystem>
#include <string_view>

namespace rigfit::apps {

/// Writes beside the target under a temporary name, flushes to disk, then renames. Throws
/// std::system_error with the path and the reason; the target is then as it was.
void write_whole_file(const std::filesystem::path& path, std::string_view content);

/// Creates the folder (and parents); throws UsageError when the path is a file or cannot be made.
void make_output_folder(const std::filesystem::path& folder);

/// Removes what a run that was killed left half written in a folder (not below it).
void sweep_parts(const std::filesystem::path& folder);

}  // namespace rigfit::apps
