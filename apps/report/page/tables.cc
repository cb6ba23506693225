#include "apps/report/page/tables.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "apps/report/drawing/html_text.h"

namespace rigfit::apps {
namespace {

Cell shaded(std::string text, double share) {
  Cell cell(std::move(text));
  if (std::isfinite(share)) cell.shade = std::clamp(share, 0.0, 1.0);
  return cell;
}

}  // namespace

ReportTable share_table(const std::string& id, const std::string& caption,
                        const std::vector<Shares>& quantities) {
  constexpr double kShown = 0.005;
  struct Row {
    std::string source;
    std::vector<double> shares;
    double largest = 0;
  };
  std::vector<Row> rows;
  for (std::size_t q = 0; q < quantities.size(); ++q) {
    double sum = 0;
    for (const auto& part : quantities[q].parts) sum += part.second;
    for (const auto& [source, size] : quantities[q].parts) {
      auto at = std::find_if(rows.begin(), rows.end(),
                             [&](const Row& row) { return row.source == source; });
      if (at == rows.end()) {
        at = rows.insert(at, {source, std::vector<double>(quantities.size(), 0.0), 0});
      }
      at->shares[q] += sum > 0 ? size / sum : 0;
      at->largest = std::max(at->largest, at->shares[q]);
    }
  }
  std::stable_sort(rows.begin(), rows.end(),
                   [](const Row& a, const Row& b) { return a.largest > b.largest; });
  ReportTable table{id, caption, {{"source", {}, false}}};
  for (const auto& one : quantities) table.columns.push_back({one.name + ", %"});
  for (const auto& row : rows) {
    if (row.largest < kShown) break;
    std::vector<Cell> cells{row.source};
    for (const double share : row.shares) {
      cells.push_back(shaded(share < kShown ? "" : fmt::format("{:.0f}", 100 * share), share));
    }
    table.rows.push_back(std::move(cells));
  }
  return table;
}

ReportTable matrix_table(const std::string& id, const std::string& caption,
                         const Eigen::MatrixXd& values, const std::vector<std::string>& names) {
  ReportTable table{id, caption, {{"", {}, false}}};
  for (const auto& name : names) table.columns.push_back({name});
  for (Eigen::Index i = 0; i < values.rows(); ++i) {
    std::vector<Cell> cells{names[static_cast<std::size_t>(i)]};
    for (Eigen::Index j = 0; j < values.cols(); ++j) {
      const double value = values(i, j);
      cells.push_back(shaded(std::isfinite(value) ? fmt::format("{:.2f}", value) : "–", value));
    }
    table.rows.push_back(std::move(cells));
  }
  return table;
}

std::vector<std::size_t> rows_on_page(const ReportTable& table) {
  std::vector<std::size_t> rows(table.rows.size());
  for (std::size_t i = 0; i < rows.size(); ++i) rows[i] = i;
  if (rows.size() <= kMostRows) return rows;
  const auto says_something = [&](std::size_t row) {
    return std::any_of(table.rows[row].begin(), table.rows[row].end(),
                       [](const Cell& cell) { return cell.doubtful; });
  };
  std::stable_partition(rows.begin(), rows.end(), says_something);
  rows.resize(kMostRows);
  std::sort(rows.begin(), rows.end());
  return rows;
}

std::string table_csv(const ReportTable& table) {
  std::string text;
  for (std::size_t i = 0; i < table.columns.size(); ++i) {
    text += (i > 0 ? "," : "") + csv_quoted(table.columns[i].name);
  }
  text += '\n';
  for (const auto& row : table.rows) {
    for (std::size_t i = 0; i < row.size(); ++i)
      text += (i > 0 ? "," : "") + csv_quoted(row[i].text);
    text += '\n';
  }
  return text;
}

}  // namespace rigfit::apps
