// Files written whole or not at all.
#pragma once

#include <filesystem>
#include <string_view>

namespace rigfit::apps {

/// Writes beside the target under a temporary name, flushes to disk, then renames. Links are
/// followed; a device or pipe is written through (a pipe's reader is waited for). Throws
/// OutputError (exit_code.h) with path, reason and remedy; a regular target is then as it was.
void write_whole_file(const std::filesystem::path& path, std::string_view content);

/// Creates the folder (and parents). Throws OutputError.
void make_output_folder(const std::filesystem::path& folder);

}  // namespace rigfit::apps
