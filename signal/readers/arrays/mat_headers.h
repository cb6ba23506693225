// The headers of a MATLAB file of version 5, walked before libmatio reads them: libmatio reserves
// memory by the sizes that they state, and loops over them.
#pragma once

#include <filesystem>

namespace rigfit::signal {

/// Throws RecordingError when the file is of another version than 5 to 7.3, when a struct, cell or
/// function handle cannot hold as many elements as its header states, or when a name or a list of
/// dimensions is longer than its variable. Of version 7.3 (HDF5) only the version is looked at.
///
/// Each element of a struct or cell takes 8 bytes at least (its own tag). Packed variables are
/// unpacked in pieces; nothing is kept.
void check_mat_headers(const std::filesystem::path& path);

}  // namespace rigfit::signal
