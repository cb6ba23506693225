// Shares of a whole as bars, one below the other: where an uncertainty comes from. And matrices of
// numbers from 0 to 1 as shaded fields: MAC.
#pragma once

#include <Eigen/Core>
#include <string>
#include <utility>
#include <vector>

#include "apps/report/page/report_part.h"

namespace rigfit::apps {

struct ShareBar {
  std::string name;   ///< of the quantity
  std::string value;  ///< written behind the bar, such as "0.38 ± 0.02"
  std::vector<std::pair<std::string, double>> parts;  ///< source and its size; not negative
};

/// Every bar is as long as the others; its parts are as long as their shares of their sum. A source
/// has one colour in all bars. The CSV has names, sources, sizes and shares.
[[nodiscard]] Picture share_bars(const std::string& id, const std::string& title,
                                 const std::string& caption, const std::vector<ShareBar>& bars);

/// `values`: rows x columns, 0..1; darker is more, every field carries its number.
[[nodiscard]] Picture matrix_picture(const std::string& id, const std::string& title,
                                     const std::string& caption, const Eigen::MatrixXd& values,
                                     const std::vector<std::string>& rows,
                                     const std::vector<std::string>& columns);

}  // namespace rigfit::apps
