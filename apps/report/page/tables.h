// Tables of the report: numbers from 0 to 1 whose cells are the darker the larger they are, and
// what a page of thousands of recordings carries of a long table. The rest is in data/ beside the
// page.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "apps/report/page/report_part.h"

namespace rigfit::apps {

struct Shares {
  std::string name;                                   ///< name of the quantity
  std::vector<std::pair<std::string, double>> parts;  ///< source and its size; not negative
};

/// A row a source, a column a quantity: the source's share of the quantity's sum in percent; the
/// largest first, those under 0.5 % of every quantity left out.
[[nodiscard]] ReportTable share_table(const std::string& id, const std::string& caption,
                                      const std::vector<Shares>& quantities);

/// `values`: rows x columns, 0..1.
[[nodiscard]] ReportTable matrix_table(const std::string& id, const std::string& caption,
                                       const Eigen::MatrixXd& values,
                                       const std::vector<std::string>& names);

inline constexpr std::size_t kMostRows = 300;  ///< rows of a table on the page
inline constexpr std::size_t kMostTabs = 60;   ///< states of a group of figures on the page

/// Indices of the rows on the page: all, or those with a doubtful cell first, in their order.
[[nodiscard]] std::vector<std::size_t> rows_on_page(const ReportTable& table);

/// The whole table for a spreadsheet, as it is shown.
[[nodiscard]] std::string table_csv(const ReportTable& table);

}  // namespace rigfit::apps
