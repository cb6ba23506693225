#include "signal/readers/arrays/array_columns.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "signal/recording/recording_time.h"
#include "signal/recording/units.h"

namespace rigfit::signal {
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

void add_array(Eigen::MatrixXd values, const std::string& name, bool single, CsvTable& table) {
  const bool wide = values.cols() > values.rows();
  const Eigen::Index count = wide ? values.rows() : values.cols();
  if (wide && count > 1) {
    add_note(table.notes, "read_as", name, "an array of {} x {}: its rows are taken as channels",
             values.rows(), values.cols());
  }
  std::vector<Eigen::VectorXd> columns(static_cast<std::size_t>(count));
  for (Eigen::Index k = count; k-- > 0;) {
    Eigen::VectorXd& numbers = columns[static_cast<std::size_t>(k)];
    if (wide) {
      numbers = values.row(k);
    } else {  // a large array takes its memory once
      numbers = values.col(k);
      values.conservativeResize(Eigen::NoChange, k);
    }
  }
  for (Eigen::VectorXd& numbers : columns) {
    const std::size_t place = table.channels.size();
    const std::string own =
        name.empty()
            ? "column " + std::to_string(place + 1)
            : (count == 1 ? name : name + " " + std::to_string(&numbers - columns.data() + 1));
    TitledUnit titled = split_title(to_utf8(own));
    CsvColumn column{std::move(titled.name), std::move(titled.unit)};
    const double largest = numbers.array().isFinite().select(numbers.array().abs(), 0).maxCoeff();
    if (single && largest > 0) {
      column.decimals = -static_cast<int>(std::ceil(std::log10(6e-8 * largest)));
    }
    table.add(std::move(column), place, std::move(numbers));
  }
}

Recording recording_of_arrays(CsvTable table, const std::filesystem::path& path,
                              const std::string& format, const ReadOptions& options,
                              double stated_rate_hz) {
  table.file = path.string();
  table.layout.stated_rate_hz = stated_rate_hz;
  table.layout.rate_text = "in the file";
  table.layout.body_line = 0;
  table.layout.has_names = true;
  CsvColumn& first = table.columns.front();
  if (table.columns.size() > 1 && stated_rate_hz == 0 &&
      looks_like_time(table.channels.front().samples, first.decimals) &&
      std::ranges::none_of(table.columns, [](const auto& c) { return is_time_name(c.name); })) {
    add_note(table.notes, "read_as", first.name, "rises in equal steps: taken as time in seconds");
    table.channels.front().name = first.name = "time";
  }
  return recording_of_table(std::move(table), path, format, options);
}

}  // namespace rigfit::signal
