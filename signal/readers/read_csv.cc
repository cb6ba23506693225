#include "signal/readers/read_recording.h"

#include "signal/readers/frequency_table.h"
#include "signal/recording/recording_time.h"

namespace rigfit::signal {
namespace {

constexpr double kDay = 86400;  // s

bool is_index_name(const std::string& name) {
  static constexpr std::string_view kWords =
      "|sample|samples|index|no|no.|nr|nr.|s/no|#|n|scan|point|row|record|sample no|sample no.|"
      "sample number|count|packetcounter|";
  return is_listed(kWords, lower_case(name));
}

VectorXd steps_of(const VectorXd& values) {
  const Index n = std::max<Index>(values.size(), 1) - 1;
  return values.tail(n) - values.head(n);
}

/// 0, 1, 2 ... (or from 1), in steps of exactly one.
bool counts_samples(const VectorXd& values) {
  return values.size() >= 2 && std::abs(values[0]) <= 1 && values[0] == std::floor(values[0]) &&
         (steps_of(values).array() == 1).all();
}

bool rises_evenly(const CsvTable& table, std::size_t k) {
  const auto& channel = table.channels[k];
  return looks_like_time(channel.samples, table.columns[k].decimals,
                         channel.quantity == Quantity::time ? 3 : 24);
}

/// Refuses a last column without a title, and more titles than columns where the times do not stand
/// below theirs: titles that stand a column beside their numbers.
void refuse_shifted_titles(const CsvTable& table, std::optional<std::size_t> time) {
  const CsvColumn& last = table.layout.columns.empty() ? CsvColumn{} : table.layout.columns.back();
  const auto is_time = [&](std::size_t k) {
    return !counts_samples(table.channels[k].samples) && rises_evenly(table, k);
  };
  const bool fewer = table.layout.has_names && last.name.empty() && last.filled >= 0.5;
  const std::size_t at = time.value_or(0);
  const bool more =
      table.layout.more_titles && (time ? at > 0 && !is_time(at) && is_time(at - 1) : is_time(at));
  if (!fewer && !more) return;
  throw RecordingError({table.file, table.layout.body_line, 0, table.channels.back().name},
                       fmt::format("there are {} titles than columns of numbers: they may stand a "
                                   "column beside their numbers",
                                   fewer ? "fewer" : "more"),
                       "give each column its title");
}

/// The channel that holds the times; empty: none does. Of the others those that are no channels of
/// the recording go to `left_out`.
std::optional<std::size_t> find_times(const CsvTable& table, const ReadOptions& options,
                                      std::vector<Note>& notes,
                                      std::vector<std::size_t>& left_out) {
  std::optional<std::size_t> time;
  for (const bool any : {false, true}) {  // "Elapsed Cycles" are no times beside those in seconds
    for (std::size_t k = 0; k < table.channels.size() && !time; ++k) {
      const Channel& channel = table.channels[k];
      const bool named = is_time_name(channel.name) && (channel.quantity == Quantity::time ||
                                                        (any && channel.source_unit.empty()));
      if (table.columns[k].kind == FieldKind::clock ||
          (named && table.columns[k].kind != FieldKind::empty))
        time = k;
    }
  }
  refuse_shifted_titles(table, time);
  const std::size_t channels = table.channels.size();
  if (channels < 2) return time;
  const auto unnamed = [&](std::size_t k) {
    return table.columns[k].name.empty() &&
           (!table.layout.has_names || table.columns[k].place == k);
  };
  const auto counts = [&](std::size_t k) { return counts_samples(table.channels[k].samples); };
  std::size_t at = 0;
  const std::string& first = table.channels[0].name;
  const bool is_x = lower_case(first) == "x" && rises_evenly(table, 0);
  if (time != 0 && (unnamed(0) || is_index_name(first) || is_x) && counts(0)) {
    left_out.push_back(at++);
    add_note(notes, "left_out", first, "ignored: it is a row counter");
  }
  if (time || at + 1 >= channels) return time;
  const bool given = options.time_unit_s > 0;
  for (std::size_t k = at; k < channels && !time; ++k) {
    const bool is_time = table.channels[k].quantity == Quantity::time;
    if ((is_time || (k == at && unnamed(k))) && ((given && k == 0) || rises_evenly(table, k)))
      time = k;
  }
  const Channel& channel = table.channels[time.value_or(at)];
  if (time) {
    if (!channel.source_unit.empty() || table.layout.has_names) return time;
    add_note(notes, "read_as", "", "column {} {}", table.columns[*time].place + 1,
             given ? "is taken as time in the unit given"
                   : "rises in equal steps: taken as time in seconds");
  } else if (at == 0 && unnamed(0) && channel.samples.size() > 2 && channel.samples.allFinite() &&
             steps_of(channel.samples).minCoeff() > 0) {
    add_note(notes, "assumed", channel.name,
             "Give titles or --time-unit s if column 1 is time: it rises but has no title, and is "
             "kept as a channel (loads, masses?)");
  }
  return time;
}

/// Leaves out columns of the times taken again, and those of others with the channels behind them;
/// notes what rises and may be times.
void leave_out_other_times(const CsvTable& table, std::size_t time, std::vector<Note>& notes,
                           std::vector<std::size_t>& left_out) {
  const auto since = [&](std::size_t k) {
    const ArrayXd times = table.channels[k].samples;
    return ArrayXd(times - (table.columns[k].kind == FieldKind::clock ? times[0] : 0));
  };
  for (std::size_t k = 0; k < table.channels.size(); ++k) {
    if (k == time || !table.is_time(k) || since(k).size() < 2) continue;
    const ArrayXd steps = steps_of(since(k)), apart = (since(k) - since(time)).abs();
    const double least = steps.isNaN().select(1, steps).minCoeff();
    const double most = apart.isNaN().select(0, apart).maxCoeff();
    const bool others = least > 0 && most > 0.01 * least;
    std::size_t end = k + 1;
    while (others && end < table.channels.size() && !table.is_time(end)) ++end;
    const std::size_t behind = end - k - 1;
    // Behind other times without a channel of their own, as seconds behind a clock, they are one.
    const bool of_others = behind > 0 && k > time && !table.is_time(k - 1);
    if (table.channels[k].quantity == Quantity::time && least > 0 && rises_evenly(table, k) &&
        (!others || of_others)) {
      for (std::size_t c = k; c < end; ++c) left_out.push_back(c);
      if (!others) {
        add_note(notes, "left_out", table.channels[k].name,
                 "ignored: they are the times once more");
        continue;
      }
      add_note(notes, "data_left_out", table.channels[k].name,
               "Export a file for each rate: the {} channel{} behind these times, which are not "
               "those of \"{}\", {} left out",
               behind, behind == 1 ? "" : "s", table.channels[time].name,
               behind == 1 ? "is" : "are");
      continue;
    }
    if (!others) continue;
    add_note(notes, "time_axis", table.channels[k].name,
             "Split the file if channels have these times: they differ from those of \"{}\", which "
             "are taken for all, by up to {:.6g} s",
             table.channels[time].name, most);
  }
}

/// Takes rate, start, jitter and notes from the times in a channel. Throws RecordingError when
/// sampling is not uniform and times are missing.
void take_times_in(std::size_t time, const ReadOptions& options, CsvTable& table,
                   Recording& recording) {
  Channel& column = table.channels[time];
  const bool is_clock = table.columns[time].kind == FieldKind::clock;
  const int decimals = table.columns[time].decimals;
  double printed = std::pow(10.0, -decimals) * std::abs(column.si_per_source);
  const auto axis_in = [&](double unit_s) {
    column.samples *= unit_s;
    printed *= unit_s;
    return time_axis(column.samples, printed, table.layout.stated_rate_hz);
  };
  double unit_s = 1;
  if (is_clock) {
    const double start = column.samples[0];
    if (std::isfinite(start)) column.samples.array() -= start;
    // Without a date a clock falls at midnight.
    for (Index k = column.samples.size() - 1; start < kDay && k > 0; --k) {
      if (!(column.samples[k] - column.samples[k - 1] < -kDay / 2)) continue;
      column.samples.tail(column.samples.size() - k).array() += kDay;
      add_note(recording.notes, "read_as", column.name, "time without a date: goes on at midnight");
    }
  } else if (options.time_unit_s > 0) {
    unit_s = options.time_unit_s / column.si_per_source;
    if (unit_s != 1 && !column.source_unit.empty()) {
      add_note(recording.notes, "read_as", column.name,
               "the file says \"{}\" of the times; the unit asked for is taken",
               column.source_unit);
    }
  }
  TimeAxis axis = axis_in(unit_s);
  if (options.time_unit_s == 0 && column.source_unit.empty() && !is_clock && axis.rate_hz > 0) {
    if (column.name.ends_with(')')) {
      add_note(recording.notes, "time_axis", column.name,
               "Give --time-unit (key time_unit): the title has no unit of time that is known, and "
               "the times are taken as seconds");
    }
    if (axis.start_s > 1e12) {
      // Since 1970, by clocks of the years 2001 to 2286.
      double unit = 1e-3;
      while (axis.start_s * unit > 1e10) unit *= 1e-3;
      axis = axis_in(unit);
      add_note(recording.notes, "assumed", column.name,
               "the times have no unit; in {:g} s they count from 1970: so taken", unit);
    } else if (axis.rate_hz > 1e6 && axis.start_s > 2e4 && axis.start_s < 1e6) {
      add_note(recording.notes, "time_axis", column.name,
               "Export seconds or clock times: from {:.9g} on they look like days since 1900 or "
               "year 0, in which the rate is {:.9g} Hz; {:.9g} Hz is taken",
               axis.start_s, axis.rate_hz / kDay, axis.rate_hz);
    } else if (decimals <= 0 && column.samples.size() >= 20 && axis.rate_hz <= 1) {
      // Whole numbers in steps of one or more are seldom seconds.
      const bool is_milli = axis.rate_hz >= 0.01;
      add_note(recording.notes, "time_axis", column.name,
               "Give --time-unit {0} (key time_unit) if the times are not in seconds: they are "
               "whole numbers without a unit; in seconds the rate is {1:.9g} Hz, in {0} {2:.9g} Hz",
               is_milli ? "ms" : "us", axis.rate_hz, axis.rate_hz * (is_milli ? 1e3 : 1e6));
    }
  }
  take_times(axis, column.samples, column.name, table.layout.body_line, recording);
  if (axis.rate_hz > 0 && !axis.agrees_with_stated) {
    add_note(recording.notes, "rates_disagree",
             table.layout.rate_line > 0 ? fmt::format("line {}", table.layout.rate_line) : "",
             "the times give {:.9g} Hz, the header says {:.9g} Hz (\"{}\"): the times are taken",
             axis.rate_hz, table.layout.stated_rate_hz, table.layout.rate_text);
  }
}

}  // namespace

bool looks_like_time(const VectorXd& values, int decimals, Index fewest) {
  const Index n = values.size();
  if (n < fewest || !values.allFinite() || !(values[n - 1] > values[0])) return false;
  const TimeAxis axis = time_axis(values, std::pow(10.0, -decimals));
  return axis.uniform && axis.rate_hz > 0 && axis.backward == 0;
}

Recording recording_of_table(CsvTable table, const std::filesystem::path& path,
                             const std::string& format, const ReadOptions& options) {
  const CsvLayout& layout = table.layout;
  const auto refusal = [&](const std::string& channel, const char* problem, std::string remedy) {
    return RecordingError({path.string(), layout.body_line, 0, channel}, problem,
                          std::move(remedy));
  };
  if (const auto column = frequency_column(table)) {
    throw refusal(table.channels[*column].name,
                  "is a spectrum or FRF over frequency, not a recording over time",
                  "rigfit modal takes FRFs; for a decay or hits export the time signal. Where the "
                  "first column is time after all, title it so");
  }
  const std::string spectrum = spectrum_without_frequencies(table);
  if (!spectrum.empty() && options.format.empty()) {
    throw refusal(
        spectrum,
        "is a spectrum by its title, without a column of frequencies; not taken as a recording "
        "over time",
        "export the time signal; where it is a time signal after all: --format " + format);
  }

  Recording recording;
  recording.path = path;
  recording.format = format;
  recording.notes = std::move(table.notes);
  std::vector<std::size_t> left_out;
  if (const auto time = find_times(table, options, recording.notes, left_out)) {
    leave_out_other_times(table, *time, recording.notes, left_out);
    take_times_in(*time, options, table, recording);
    left_out.push_back(*time);
  }
  if (recording.sample_rate_hz == 0) recording.sample_rate_hz = layout.stated_rate_hz;
  take_stated_rate(options.sample_rate_hz, recording);
  for (std::size_t k = 0; k < table.channels.size(); ++k) {
    if (std::ranges::find(left_out, k) != left_out.end()) continue;
    if (layout.has_names && table.columns[k].name.empty()) {
      add_note(recording.notes, "titles_not_matched", table.channels[k].name,
               "Give it a title: the header has none for column {}", table.columns[k].place + 1);
    }
    recording.channels.push_back(std::move(table.channels[k]));
  }
  if (recording.channels.empty()) {
    throw refusal("", "holds times but no channel beside them",
                  "give a recording with at least one channel");
  }
  note_unitless(recording);
  return recording;
}

Recording read_csv(std::string_view bytes, const std::filesystem::path& path,
                   const ReadOptions& options) {
  return recording_of_table(read_csv_columns(bytes, path.string(), options), path, "csv", options);
}

}  // namespace rigfit::signal
