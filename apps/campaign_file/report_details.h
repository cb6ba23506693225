// What stands on the first page of a report besides its results: who made it, for whom, when.
//
//   [report]   author, organisation, client, date (such as 2026-05-18), revision, project, logo
//              (PNG, JPEG or SVG, relative to the campaign)
#pragma once

#include <filesystem>
#include <string>

#include "model/scene/toml_table.h"

namespace rigfit::apps {

struct ReportDetails {
  std::string author, organisation, client, project, revision;
  std::string date;  ///< as given; empty: the day the page is made
  std::string logo;  ///< file; empty: none
};

/// Reads the table [report]; `folder` is the campaign's. Throws model::SceneError for a logo that
/// is not there, is no picture or is over 2 MB.
[[nodiscard]] ReportDetails read_report_details(model::TomlTable& table,
                                                const std::filesystem::path& folder);

/// The picture as a data URI for a page; empty for no file or one that cannot be read any more.
[[nodiscard]] std::string logo_data_uri(const std::string& file);

}  // namespace rigfit::apps
