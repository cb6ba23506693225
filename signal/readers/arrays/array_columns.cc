#include "signal/readers/arrays/array_columns.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

#include "signal/readers/csv/csv_table.h"
#include "signal/recording/recording_time.h"
#include "signal/recording/units.h"

namespace rigfit::signal {
namespace {

constexpr int kAllDigits = 400;

int decimals_of(const ArrayColumn& column) {
  if (!column.single) return kAllDigits;
  double largest = 0;
  for (const double x : column.values) {
    if (std::isfinite(x)) largest = std::max(largest, std::abs(x));
  }
  return largest > 0 ? -static_cast<int>(std::ceil(std::log10(6e-8 * largest))) : kAllDigits;
}

}  // namespace

Eigen::MatrixXd matrix_of(char kind, std::size_t size, const void* data, Eigen::Index rows,
                          Eigen::Index cols) {
  Eigen::MatrixXd numbers;
  const auto take = [&](char own, auto number) {
    using Matrix = Eigen::Matrix<decltype(number), Eigen::Dynamic, Eigen::Dynamic>;
    if (kind != own || size != sizeof number) return;
    numbers = Eigen::Map<const Matrix>(static_cast<const decltype(number)*>(data), rows, cols)
                  .template cast<double>();
  };
  take('f', float{});
  take('f', double{});
  take('i', std::int8_t{});
  take('i', std::int16_t{});
  take('i', std::int32_t{});
  take('i', std::int64_t{});
  take('u', std::uint8_t{});
  take('u', std::uint16_t{});
  take('u', std::uint32_t{});
  take('u', std::uint64_t{});
  return numbers;
}

std::vector<ArrayColumn> columns_of(const Eigen::Ref<const Eigen::MatrixXd>& values,
                                    const std::string& name, bool single,
                                    std::vector<Note>& notes) {
  const bool wide = values.cols() > values.rows();
  const Eigen::Index count = wide ? values.rows() : values.cols();
  if (wide && count > 1) {
    add_note(notes, "read_as", name, "an array of {} x {}: its rows are taken as channels",
             values.rows(), values.cols());
  }
  std::vector<ArrayColumn> columns;
  for (Eigen::Index k = 0; k < count; ++k) {
    ArrayColumn column;
    column.name =
        count == 1 ? name : (name.empty() ? "column " : name + " ") + std::to_string(k + 1);
    column.values =
        wide ? Eigen::VectorXd(values.row(k).transpose()) : Eigen::VectorXd(values.col(k));
    column.single = single;
    columns.push_back(std::move(column));
  }
  return columns;
}

Recording recording_of_columns(std::vector<ArrayColumn> columns, const std::filesystem::path& path,
                               const std::string& format, const ReadOptions& options,
                               double stated_rate_hz, std::vector<Note> notes) {
  CsvTable table;
  table.file = path.string();
  table.notes = std::move(notes);
  table.layout.stated_rate_hz = stated_rate_hz;
  table.layout.rate_text = "in the file";
  table.layout.body_line = 0;
  table.layout.has_names = true;
  for (std::size_t k = 0; k < columns.size(); ++k) {
    ArrayColumn& column = columns[k];
    const TitledUnit titled = split_title(to_utf8(column.name));
    CsvColumn entry;
    entry.name = titled.name.empty() ? "column " + std::to_string(k + 1) : titled.name;
    entry.unit = titled.unit;
    entry.filled = 1;
    entry.decimals = decimals_of(column);
    if (k == 0 && columns.size() > 1 && stated_rate_hz == 0 &&
        looks_like_time(column.values, entry.decimals) &&
        std::none_of(columns.begin(), columns.end(),
                     [](const auto& other) { return is_time_name(other.name); })) {
      add_note(table.notes, "read_as", entry.name,
               "rises in equal steps: taken as time in seconds");
      entry.name = "time";
    }
    table.layout.columns.push_back(entry);
    table.add(std::move(entry), k, std::move(column.values));
  }
  return recording_of_table(std::move(table), path, format, options);
}

}  // namespace rigfit::signal
