// Numbers from 0 to 1 as tables whose fields are the darker the larger they are: where an
// uncertainty comes from, MAC.
#pragma once

#include <Eigen/Core>
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
                                       const std::vector<std::string>& rows,
                                       const std::vector<std::string>& columns);

}  // namespace rigfit::apps
