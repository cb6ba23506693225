#include "signal/readers/uff/read_uff.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <tuple>

#include "signal/readers/files/mapped_file.h"
#include "signal/readers/uff/uff58.h"
#include "signal/readers/uff/uff58_remark.h"
#include "signal/recording/recording_error.h"
#include "signal/recording/recording_time.h"
#include "signal/recording/time_axis.h"
#include "signal/recording/units.h"

namespace rigfit::signal {
namespace {

constexpr int kTimeAxis = 17, kFrequencyAxis = 18;

bool is_time_history(const Uff58& f) {
  return !f.complex &&
         (f.function_type == uff58_function::kTimeResponse ||
          (f.function_type == uff58_function::kGeneral && f.abscissa.data_type == kTimeAxis));
}

Quantity quantity_of(int data_type) {
  switch (data_type) {
    case 3:
      return Quantity::strain;
    case 5:
      return Quantity::temperature;
    case 8:
      return Quantity::displacement;
    case 9:
    case 13:
      return Quantity::force;
    case 11:
      return Quantity::velocity;
    case 12:
      return Quantity::acceleration;
    case 15:
      return Quantity::pressure;
    case 17:
      return Quantity::time;
    default:
      return Quantity::unknown;
  }
}

std::string direction_text(int direction) {
  static constexpr const char* kAxes[] = {"", "X", "Y", "Z", "RX", "RY", "RZ"};
  if (direction == 0 || std::abs(direction) > 6) return "";
  return std::string(direction > 0 ? "+" : "-") + kAxes[std::abs(direction)];
}

std::string point_text(const Uff58Point& point) {
  return std::to_string(point.node) + direction_text(point.direction);
}

std::array<double, 3> direction_vector(int direction) {
  std::array<double, 3> out{0, 0, 0};
  const int axis = std::abs(direction);
  if (axis >= 1 && axis <= 3) out[static_cast<std::size_t>(axis - 1)] = direction > 0 ? 1 : -1;
  return out;
}

std::string name_of_response(const Uff58& f) {
  if (!parse_uff58_remark(f.id[3]).empty() && !f.id[0].empty()) return f.id[0];
  if (!f.response.entity.empty()) return f.response.entity;
  if (!f.id[0].empty()) return f.id[0];
  if (!f.ordinate.label.empty()) return f.ordinate.label;
  return f.response.node != 0 ? point_text(f.response) : "channel";
}

/// One over the step, taken for a whole number of hertz where the printed digits allow it.
double rate_of(const Uff58& f) {
  const auto remark = parse_uff58_remark(f.id[3]);
  if (!(f.abscissa_step > 0)) return 0;
  const double rate = 1 / f.abscissa_step;
  const double tolerance = f.abscissa_step_half_digit / f.abscissa_step;
  const double exact = remark_number(remark, "rate", 0);
  // 1e-5: our own step field is printed with six digits.
  if (exact > 0 && std::abs(exact / rate - 1) < std::max(1e-5, 2 * tolerance)) return exact;
  const double whole = std::round(rate);
  if (whole > 0 && std::abs(1 / whole - f.abscissa_step) <= f.abscissa_step_half_digit) {
    return whole;
  }
  return rate;
}

double start_of(const Uff58& f) {
  const double exact = remark_number(parse_uff58_remark(f.id[3]), "start", f.abscissa_start);
  return std::abs(exact - f.abscissa_start) <= 1e-5 * std::abs(f.abscissa_start) ? exact
                                                                                 : f.abscissa_start;
}

void unique_names(Recording& recording, const std::vector<const Uff58*>& functions) {
  // Several channels of one name are told apart by their node and direction, where these differ.
  std::map<std::string, int> times;
  for (const auto& channel : recording.channels) ++times[channel.name];
  for (std::size_t k = 0; k < recording.channels.size(); ++k) {
    auto& name = recording.channels[k].name;
    if (times[name] > 1 && functions[k]->response.node != 0) {
      name += " " + point_text(functions[k]->response);
    }
  }
  std::set<std::string> used;
  for (auto& channel : recording.channels) {
    const std::string first = channel.name;
    for (int k = 2; !used.insert(channel.name).second; ++k) {
      channel.name = first + "_" + std::to_string(k);
    }
  }
}

Channel channel_of(const Uff58& f, std::vector<Note>& notes) {
  Channel channel;
  channel.name = name_of_response(f);
  channel.source_unit = f.ordinate.unit;
  channel.direction = direction_vector(f.response.direction);
  channel.quantity = quantity_of(f.ordinate.data_type);
  if (const auto unit = parse_unit(f.ordinate.unit)) {
    channel.unit = unit->si;
    channel.si_per_source = unit->factor;
    channel.si_offset = unit->offset;
    if (unit->quantity != Quantity::unknown) channel.quantity = unit->quantity;
  } else if (!f.ordinate.unit.empty()) {
    notes.push_back(
        {"unknown_unit",
         "unit \"" + f.ordinate.unit + "\" is not known: the numbers are kept as they are",
         channel.name});
  }
  const double range = remark_number(parse_uff58_remark(f.id[3]), "range", 0);
  channel.nominal_range = range > 0 ? range : 0;
  channel.samples =
      f.complex ? Eigen::VectorXd((f.real.array().square() + f.imag.array().square()).sqrt())
                : f.real;
  if (channel.si_per_source != 1) channel.samples *= channel.si_per_source;
  if (channel.si_offset != 0) channel.samples.array() += channel.si_offset;
  for (double& x : channel.samples) {
    if (!std::isfinite(x)) {
      x = std::numeric_limits<double>::quiet_NaN();
      ++channel.missing_samples;
    }
  }
  return channel;
}

void copy_remarks(const Uff58File& file, Recording& recording) {
  for (const auto& remark : file.remarks) recording.notes.push_back({"uff_remark", remark, ""});
  if (file.other_datasets.empty()) return;
  std::set<int> numbers(file.other_datasets.begin(), file.other_datasets.end());
  std::string text;
  for (const int number : numbers) text += (text.empty() ? "" : ", ") + std::to_string(number);
  recording.notes.push_back(
      {"datasets_left_out", "datasets other than 58 are not read: " + text, ""});
}

void pad(Recording& recording, std::size_t file_size) {
  Eigen::Index longest = 0;
  for (const auto& channel : recording.channels) {
    longest = std::max(longest, channel.samples.size());
  }
  if (static_cast<double>(longest) * static_cast<double>(recording.channels.size()) >
      4.0 * static_cast<double>(file_size) + 4096) {
    throw RecordingError({recording.path.string(), 0, 0, "", ""},
                         "its channels differ too much in length (the longest has " +
                             std::to_string(longest) + " samples) to be one recording",
                         "split the file");
  }
  for (auto& channel : recording.channels) {
    const Eigen::Index had = channel.samples.size();
    if (had == longest) continue;
    channel.samples.conservativeResize(longest);
    channel.samples.tail(longest - had).setConstant(std::numeric_limits<double>::quiet_NaN());
    channel.missing_samples += longest - had;
    recording.notes.push_back({"shorter_channel",
                               "has " + std::to_string(had) + " samples of " +
                                   std::to_string(longest) + "; the rest counts as missing",
                               channel.name});
  }
}

std::string kinds_in(const Uff58File& file) {
  std::set<std::string> kinds;
  for (const auto& f : file.functions) kinds.insert(uff58_function_name(f.function_type));
  std::string text;
  for (const auto& kind : kinds) text += (text.empty() ? "" : ", ") + kind;
  return text;
}

void note_unitless(Recording& recording) {
  std::string unitless;
  for (const auto& channel : recording.channels) {
    if (channel.source_unit.empty()) {
      unitless += (unitless.empty() ? "\"" : ", \"") + channel.name + "\"";
    }
  }
  if (!unitless.empty()) {
    recording.notes.push_back(
        {"no_unit", "no unit in the file: the numbers are kept as they are", unitless});
  }
}

}  // namespace

Recording read_uff(std::string_view bytes, const std::filesystem::path& path,
                   const ReadOptions& options, const std::function<void(std::size_t)>& done_with) {
  const std::string name = path.string();
  const Uff58File file = read_uff58(bytes, name, done_with);
  Recording recording;
  recording.path = path;
  std::vector<const Uff58*> chosen;
  for (const auto& f : file.functions) {
    if (is_time_history(f)) chosen.push_back(&f);
  }
  if (chosen.empty()) {
    const bool any = !file.functions.empty();
    throw RecordingError(
        {name, any ? file.functions.front().line : 1, 0, "", ""},
        any ? "holds no time history, but: " + kinds_in(file) : "holds no dataset 58",
        "give a recording over time (FRFs are taken by `modal`)");
  }
  if (chosen.size() < file.functions.size()) {
    recording.notes.push_back({"functions_left_out",
                               std::to_string(file.functions.size() - chosen.size()) +
                                   " functions that are no time histories are left out (the file "
                                   "holds: " +
                                   kinds_in(file) + ")",
                               ""});
  }
  // All channels share their times: the largest group of the same form is taken.
  using Form = std::tuple<bool, double, double>;
  const auto form = [](const Uff58& f) {
    return f.even ? Form{true, f.abscissa_start, f.abscissa_step} : Form{false, 0, 0};
  };
  const auto same_times = [&](const Uff58& a, const Uff58& b) {
    if (form(a) != form(b)) return false;
    if (a.even) return true;
    return a.x.size() == b.x.size() && (a.x.array() == b.x.array()).all();
  };
  std::size_t best = 0, best_count = 0;
  for (std::size_t k = 0; k < chosen.size() && best_count < chosen.size(); ++k) {
    if (k > 0 && same_times(*chosen[k], *chosen[k - 1])) continue;
    std::size_t count = 0;
    for (const auto* f : chosen) count += same_times(*chosen[k], *f) ? 1 : 0;
    if (count > best_count) best = k, best_count = count;
    if (k > 64) break;  // as many forms as that: the largest among the first
  }
  const Uff58& first = *chosen[best];
  std::vector<const Uff58*> taken;
  std::string left;
  for (const auto* f : chosen) {
    if (same_times(first, *f)) {
      taken.push_back(f);
    } else if (left.size() < 200) {
      left += (left.empty() ? "\"" : ", \"") + name_of_response(*f) + "\" (line " +
              std::to_string(f->line) + ")";
    }
  }
  if (!left.empty()) {
    recording.notes.push_back(
        {"channels_left_out", "other start, rate or times than the rest: left out", left});
  }
  recording.format = first.binary ? "uff58-binary" : "uff58-ascii";
  for (const auto* f : taken) recording.channels.push_back(channel_of(*f, recording.notes));
  unique_names(recording, taken);
  pad(recording, bytes.size());
  copy_remarks(file, recording);

  const auto time_unit = parse_unit(first.abscissa.unit);
  const double to_seconds =
      time_unit && time_unit->quantity == Quantity::time ? time_unit->factor : 1;
  if (!first.abscissa.unit.empty() && !(time_unit && time_unit->quantity == Quantity::time)) {
    recording.notes.push_back(
        {"time_unit",
         "the abscissa's unit \"" + first.abscissa.unit + "\" is no unit of time: taken as seconds",
         ""});
  }
  if (first.even) {
    recording.sample_rate_hz = rate_of(first) / to_seconds;
    recording.start_time_s = start_of(first) * to_seconds;
  } else {
    const Eigen::VectorXd time = first.x * to_seconds;
    TimeAxisOptions axis_options;
    // Single-precision times carry seven digits of the latest one.
    const double latest = time.cwiseAbs().maxCoeff();
    axis_options.printed_resolution_s =
        std::isfinite(latest) ? latest * (first.binary && !first.single_precision ? 1e-15 : 1e-5)
                              : 0;
    const TimeAxis axis = time_axis(time, axis_options);
    recording.sample_rate_hz = remark_number(parse_uff58_remark(first.id[3]), "rate", axis.rate_hz);
    recording.start_time_s = axis.start_s;
    recording.time_jitter_s = axis.jitter_s;
    if (axis.missing > 0) {
      throw RecordingError({name, first.line, 0, "", ""}, "some times are missing",
                           "export the recording again");
    }
    if (!axis.uniform) {
      recording.time_s = time;
      recording.notes.push_back(not_uniform_note(axis));
    }
  }
  take_stated_rate(options.sample_rate_hz, recording);
  if (!(recording.sample_rate_hz > 0) || !std::isfinite(recording.sample_rate_hz)) {
    recording.sample_rate_hz = 0;
    recording.notes.push_back(
        {"no_sample_rate", "the file gives no sample rate (step of zero): give it", ""});
  }
  note_unitless(recording);
  return recording;
}

Recording read_uff_functions(std::string_view bytes, const std::filesystem::path& path) {
  const Uff58File file = read_uff58(bytes, path.string());
  if (file.functions.empty()) {
    throw RecordingError({path.string(), 1, 0, "", ""}, "holds no dataset 58",
                         "give measured functions");
  }
  if (std::any_of(file.functions.begin(), file.functions.end(), is_time_history)) {
    return read_uff(bytes, path);
  }
  Recording recording;
  recording.path = path;
  recording.format = file.functions.front().binary ? "uff58-binary" : "uff58-ascii";
  std::vector<const Uff58*> all;
  for (const auto& f : file.functions) {
    all.push_back(&f);
    recording.channels.push_back(channel_of(f, recording.notes));
  }
  unique_names(recording, all);
  pad(recording, bytes.size());
  copy_remarks(file, recording);
  recording.notes.push_back({"not_a_time_history", "holds: " + kinds_in(file), ""});
  if (std::any_of(all.begin(), all.end(), [](const Uff58* f) { return f->complex; })) {
    recording.notes.push_back({"magnitudes", "complex functions are given by magnitude", ""});
  }
  note_unitless(recording);
  return recording;
}

}  // namespace rigfit::signal
