// The picture on the first page of a report.
#pragma once

#include <string>

#include "apps/campaign/campaign.h"
#include "document/toml_table.h"

namespace rigfit::apps {

/// Refuses, at the key `logo`, a file that is no picture that a browser shows or is over 2 MB.
void check_logo(const std::string& file, const document::TomlTable& table);

/// The picture as a data URI for a page; empty for no file or one that cannot be read any more.
[[nodiscard]] std::string logo_data_uri(const std::string& file);

}  // namespace rigfit::apps
