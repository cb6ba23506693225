// The recordings of a test as a reader sees them: what each holds, what is wrong with it, and those
// that could not be used in their place.
#pragma once

#include "apps/campaign_file/campaign.h"
#include "apps/report/page/report_part.h"

namespace rigfit::apps {

/// Adds the table of recordings, their notes as warnings, unusable ones as refusals, and the JSON
/// list `recordings` to the part.
void add_recordings(ReportPart& part, const CampaignTest& test,
                    const std::vector<LoadedRecording>& loaded);

/// Puts a refusal on the part: warning, summary line, paragraph in its place.
void refuse(ReportPart& part, const std::string& code, const std::string& message,
            const std::string& where);

/// Name of a file without its folders.
[[nodiscard]] std::string short_name(const std::string& file);

}  // namespace rigfit::apps
