// Two campaigns beside each other, before and after: what changed beyond its uncertainty.
//
// Values of the same key (apps/report/page/answer.h) are compared; of several, such as the modes of
// a state, the nearest ones. A difference has the variance of both values; what both campaigns
// share (a span, a load cell) makes its real uncertainty smaller than that.
#pragma once

#include <string>
#include <vector>

#include "apps/report/page/report_part.h"

namespace rigfit::apps {

struct ComparedReport {
  std::string title;
  std::string file, date, revision;  ///< the campaign's file, date and revision
  std::vector<Answer> answers;
};

/// The comparison as a part: a table, a figure, JSON under "comparison" with, by value,
/// `before, after {value, std}, change, change_std, verdict`. A verdict says "changed" from three
/// standard uncertainties of the difference on, "perhaps changed" from 1.96 on.
[[nodiscard]] ReportPart compare_reports(const ComparedReport& before, const ComparedReport& after);

}  // namespace rigfit::apps
