#include "signal/readers/csv/csv_time.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string_view>

#include "signal/recording/recording_error.h"
#include "signal/recording/time_axis.h"
#include "signal/recording/units.h"

namespace rigfit::signal {
namespace {

std::string decimal_text(double value) { return fmt::format("{:.9g}", value); }

bool is_index_name(const std::string& name) {
  const std::string word = lower_case(name);
  static constexpr std::string_view kWords =
      "|sample|samples|index|no|no.|nr|nr.|#|n|scan|point|row|record|sample no|sample no.|"
      "sample number|count|";
  return is_listed(kWords, word);
}

/// 0, 1, 2 ... (or from 1), in steps of exactly one.
bool counts_samples(const Eigen::VectorXd& values) {
  if (values.size() < 2 || std::abs(values[0]) > 1 || values[0] != std::floor(values[0])) {
    return false;
  }
  for (Eigen::Index k = 1; k < values.size(); ++k) {
    if (values[k] - values[k - 1] != 1) return false;
  }
  return true;
}

/// Rows of a table without titles from which on a column that rises in equal steps is taken as
/// time: tables of loads and masses have fewer.
constexpr Eigen::Index kLeastTimes = 24;

/// Seconds per number that a person probably meant by times without a unit; 0: seconds. Whole
/// numbers in steps of one or more are seldom seconds.
double suspected_unit(const Channel& column, int decimals, double rate_hz) {
  if (!column.source_unit.empty() || decimals > 0 || column.samples.size() < 20) return 0;
  if (!(rate_hz > 0) || rate_hz > 1) return 0;
  return rate_hz >= 0.01 ? 1e-3 : 1e-6;
}

/// The unit in which the times give the stated rate; 0: in none but seconds.
double unit_by_rate(double rate_hz, double stated_hz) {
  for (const double unit : {1e-3, 1e-6, 1e-9, 60.0}) {
    if (rate_hz > 0 && stated_hz > 0 && std::abs(rate_hz / unit / stated_hz - 1) < 1e-2) {
      return unit;
    }
  }
  return 0;
}

const char* name_of_unit(double unit) {
  return unit == 1e-3 ? "ms" : unit == 1e-6 ? "us" : unit == 1e-9 ? "ns" : "min";
}

void note_time_faults(const TimeAxis& axis, const CsvLayout& layout, double resolution,
                      Recording& recording) {
  const auto line = [&](Eigen::Index sample) {
    return "near line " + std::to_string(layout.body_line + static_cast<long>(sample));
  };
  if (axis.backward > 0 || axis.repeated > 0) {
    recording.notes.push_back({"time_axis",
                               "times go back " + std::to_string(axis.backward) +
                                   " times and repeat " + std::to_string(axis.repeated) + " times",
                               line(axis.first_fault)});
  }
  if (axis.gaps > 0) {
    recording.notes.push_back({"time_axis",
                               std::to_string(axis.gaps) + " gaps in the times, the longest " +
                                   decimal_text(axis.longest_gap_s) + " s",
                               line(axis.longest_gap_at)});
  }
  if (axis.missing > 0) {
    recording.notes.push_back(
        {"time_missing", std::to_string(axis.missing) + " times are missing", ""});
  }
  if (!axis.uniform && axis.rate_hz > 0) {
    recording.notes.push_back(
        {"time_axis",
         "sampling is not uniform (rms departure " + decimal_text(axis.jitter_s) + " s)", ""});
  } else if (axis.rate_hz > 0 && resolution * axis.rate_hz > 1) {
    recording.notes.push_back({"read_as",
                               "times are rounded to " + decimal_text(resolution) +
                                   " s, coarser than the sampling step; the rate is that of the "
                                   "whole record",
                               ""});
  }
}

/// The column's numbers in seconds by the unit a person gives. Returns the factor applied.
double give_unit(double unit_s, Channel& column, Recording& recording) {
  const double factor = unit_s / column.si_per_source;
  if (factor == 1) return 1;
  if (!column.source_unit.empty()) {
    recording.notes.push_back(
        {"read_as",
         "the file says \"" + column.source_unit + "\" of the times; the unit asked for is taken",
         column.name});
  }
  column.samples *= factor;
  return factor;
}

/// Titles that stand a column beside their numbers: there is one more or one less than columns, and
/// the times stand beside the column that is called so.
void refuse_shifted_titles(const CsvTable& table, const std::optional<std::size_t>& time,
                           const std::string& file) {
  const CsvLayout& layout = table.layout;
  const bool fewer = layout.has_names && !layout.columns.empty() &&
                     layout.columns.back().name.empty() && layout.columns.back().filled >= 0.5;
  if (!fewer && !layout.more_titles) return;
  const auto is_time = [&](std::size_t k) {
    return k < table.channels.size() && !counts_samples(table.channels[k].samples) &&
           looks_like_time(table.channels[k].samples, table.decimals[k]);
  };
  const std::size_t at = time.value_or(0);
  const bool beside = time ? !is_time(at) && (is_time(at + 1) || (at > 0 && is_time(at - 1)))
                           : is_time(0) && !layout.columns[table.column[0]].name.empty();
  if (!beside) return;
  throw RecordingError({file, layout.body_line, 0, table.channels[at].name, ""},
                       "the titles seem to stand a column beside their numbers: there are " +
                           std::string(fewer ? "fewer" : "more") +
                           " of them than columns, and the times are under " +
                           (time ? "another" : "this one"),
                       "give each column its title");
}

}  // namespace

bool looks_like_time(const Eigen::VectorXd& values, int decimals) {
  const Eigen::Index n = values.size();
  if (n < kLeastTimes || !values.allFinite() || !(values[n - 1] > values[0])) return false;
  TimeAxisOptions options;
  options.printed_resolution_s = std::pow(10.0, -decimals);
  options.printed_resolution_s =
      std::max(options.printed_resolution_s, clock_tick(values, options.printed_resolution_s));
  const TimeAxis axis = time_axis(values, options);
  return axis.uniform && axis.rate_hz > 0 && axis.backward == 0;
}

std::vector<std::size_t> take_csv_times(CsvTable& table, const std::string& file,
                                        Recording& recording, const ReadOptions& options) {
  const CsvLayout& layout = table.layout;
  // Which column is the time?
  std::optional<std::size_t> time;
  const auto kind = [&](std::size_t k) { return layout.columns[table.column[k]].kind; };
  for (std::size_t k = 0; k < table.channels.size() && !time; ++k) {
    const Channel& channel = table.channels[k];
    if (kind(k) == ColumnKind::empty) continue;
    if (kind(k) == ColumnKind::clock ||
        (is_time_name(channel.name) &&
         (channel.source_unit.empty() || channel.quantity == Quantity::time))) {
      time = k;
    }
  }
  refuse_shifted_titles(table, time, file);
  const bool first_unnamed = !table.channels.empty() &&
                             layout.columns[table.column[0]].name.empty() && table.column[0] == 0;
  std::vector<std::size_t> left_out;
  if (!time && table.channels.size() > 1) {
    Channel& first = table.channels[0];
    if ((first_unnamed || is_index_name(first.name)) && counts_samples(first.samples)) {
      left_out.push_back(0);
      recording.notes.push_back({"left_out", "ignored: it is a row counter", first.name});
    } else if ((first_unnamed || first.quantity == Quantity::time) &&
               (looks_like_time(first.samples, table.decimals[0]) || options.time_unit_s > 0)) {
      time = 0;
      if (first.source_unit.empty() && !layout.has_names) {
        recording.notes.push_back({"read_as",
                                   options.time_unit_s > 0
                                       ? "column 1 is taken as time in the unit given"
                                       : "column 1 rises in equal steps: taken as time in seconds",
                                   ""});
      }
    } else if (first_unnamed && first.samples.size() > 2 && first.samples.allFinite() &&
               (first.samples.tail(first.samples.size() - 1).array() >
                first.samples.head(first.samples.size() - 1).array())
                   .all()) {
      recording.notes.push_back({"assumed",
                                 "Give titles or --time-unit s if column 1 is time: it rises but "
                                 "has no title, and is kept as a channel (loads, masses?)",
                                 first.name});
    }
  }

  double printed = 0;
  if (time) {
    Channel& column = table.channels[*time];
    TimeAxisOptions axis_options;
    printed = std::pow(10.0, -table.decimals[*time]) * std::abs(column.si_per_source);
    if (options.time_unit_s > 0 && kind(*time) != ColumnKind::clock) {
      printed *= give_unit(options.time_unit_s, column, recording);
    }
    axis_options.stated_rate_hz = layout.stated_rate_hz;
    if (kind(*time) == ColumnKind::clock) {
      // Midnight inside the record.
      for (Eigen::Index k = 1; k < column.samples.size(); ++k) {
        if (column.samples[k] - column.samples[k - 1] < -43200) {
          column.samples.tail(column.samples.size() - k).array() += 86400;
        }
      }
      const double start = column.samples[0];
      if (std::isfinite(start)) column.samples.array() -= start;
    }
    const auto axis_of = [&] {
      axis_options.printed_resolution_s = std::max(printed, clock_tick(column.samples, printed));
      return time_axis(column.samples, axis_options);
    };
    TimeAxis axis = axis_of();
    if (options.time_unit_s == 0 && column.source_unit.empty() &&
        kind(*time) != ColumnKind::clock) {
      if (const double unit = unit_by_rate(axis.rate_hz, layout.stated_rate_hz); unit > 0) {
        column.samples *= unit;
        printed *= unit;
        axis = axis_of();
        recording.notes.push_back({"assumed",
                                   "the times have no unit; in " + std::string(name_of_unit(unit)) +
                                       " they give the rate that the header states: so taken",
                                   column.name});
      } else if (const double suspected =
                     suspected_unit(column, table.decimals[*time], axis.rate_hz);
                 suspected > 0) {
        recording.notes.push_back(
            {"time_axis",
             "Give --time-unit " + std::string(name_of_unit(suspected)) +
                 " (key time_unit) if the times are not in seconds: they are whole numbers without "
                 "a unit; in seconds the rate is " +
                 decimal_text(axis.rate_hz) + " Hz, in " + name_of_unit(suspected) + " " +
                 decimal_text(axis.rate_hz / suspected) + " Hz",
             column.name});
      }
    }
    recording.sample_rate_hz = axis.rate_hz;
    recording.start_time_s = axis.start_s;
    recording.time_jitter_s = axis.jitter_s;
    note_time_faults(axis, layout, axis_options.printed_resolution_s, recording);
    if (!axis.agrees_with_stated && axis.rate_hz > 0) {
      recording.notes.push_back({"rates_disagree",
                                 "the times give " + decimal_text(axis.rate_hz) +
                                     " Hz, the header says " + decimal_text(layout.stated_rate_hz) +
                                     " Hz (\"" + layout.rate_text + "\"): the times are taken",
                                 "line " + std::to_string(layout.rate_line)});
    }
    if (!axis.uniform && axis.rate_hz > 0) {
      if (axis.missing > 0) {
        Eigen::Index at = 0;
        while (at < column.samples.size() && std::isfinite(column.samples[at])) ++at;
        throw RecordingError({file, layout.body_line + static_cast<long>(at), 0, column.name, ""},
                             "the time is missing and sampling is not uniform",
                             "fix the times, or delete that column and give the sample rate");
      }
      recording.time_s = column.samples;
    }
    if (axis.rate_hz == 0 && column.samples.size() > 1) {
      recording.notes.push_back(
          {"time_axis", "Give the sample rate: the times do not rise", column.name});
    }
    left_out.push_back(*time);
    // LabVIEW and others repeat the time for each channel.
    for (std::size_t k = 0; k < table.channels.size(); ++k) {
      if (k == *time || kind(k) == ColumnKind::empty) continue;
      Channel& other = table.channels[k];
      const std::string& title = layout.columns[table.column[k]].name;
      if (other.quantity != Quantity::time && !is_time_name(title)) continue;
      if ((other.samples - column.samples).cwiseAbs().maxCoeff() <= printed) {
        left_out.push_back(k);
        recording.notes.push_back({"read_as", "the same times once more: left out", other.name});
      }
    }
  }
  return left_out;
}

}  // namespace rigfit::signal
