#include "signal/recording/recording_time.h"

#include <charconv>

#include "signal/estimation/robust.h"

namespace rigfit::signal {

Index Recording::channel_index(const std::string& name) const {
  const auto lower = [](const std::string& text) { return lower_case(text); };
  const auto at = [&](const std::string& wanted, auto&& as) {
    return std::ranges::find(channels, as(wanted), [&](const Channel& c) { return as(c.name); });
  };
  // As it is written, in any case, and as the title in the file, "Force [N]", names "Force".
  auto found = at(name, std::identity{});
  if (found == channels.end()) found = at(name, lower);
  if (found == channels.end()) found = at(split_title(name).name, lower);
  // "acc" of "run.acc", where there is one.
  const auto ends = [&](const Channel& c) { return c.name.ends_with("." + name); };
  if (found == channels.end() && std::ranges::count_if(channels, ends) == 1) {
    found = std::ranges::find_if(channels, ends);
  }
  if (found != channels.end()) return found - channels.begin();
  long number = 0;
  const char* const end = name.data() + name.size();
  if (name.starts_with('#') && std::from_chars(name.data() + 1, end, number).ptr == end &&
      number >= 1 && number <= std::ssize(channels)) {
    return number - 1;
  }
  const std::string known = listed_names(channels);
  throw RecordingError({path.string(), 0, 0, name}, "no channel of that name",
                       "the recording has " + (known.empty() ? "none" : known) +
                           "; a channel may also be given by its place as \"#1\", \"#2\" ...");
}

std::string listed(const std::vector<std::string>& names) {
  std::string text;
  for (std::size_t k = 0; k < std::min(names.size(), kMostListed); ++k) {
    text += (k == 0 ? "\"" : ", \"") + names[k] + "\"";
  }
  return names.size() > kMostListed ? text + ", ... (" + std::to_string(names.size()) + " in all)"
                                    : text;
}

std::string listed_names(const std::vector<Channel>& channels) {
  std::vector<std::string> names;
  names.reserve(channels.size());
  for (const auto& channel : channels) names.push_back(channel.name);
  return listed(names);
}

void take_stated_rate(double rate_hz, Recording& recording) {
  const double of_file = std::isfinite(recording.sample_rate_hz) ? recording.sample_rate_hz : 0;
  recording.sample_rate_hz = rate_hz > 0 ? rate_hz : of_file;
  if (!(recording.sample_rate_hz > 0)) {
    add_note(recording.notes, "no_sample_rate", "",
             "neither times nor a sample rate in the file: give it (--sample-rate, or "
             "sample_rate_hz in the TOML file beside the recording)");
  }
  if (!(rate_hz > 0)) return;
  recording.sample_rate_relative_std = 0;
  const bool is_uneven = recording.time_s.size() > 0;
  if (is_uneven || (of_file > 0 && std::abs(of_file / rate_hz - 1) > 1e-4)) {
    add_note(recording.notes, "read_as", "",
             "the file gives {}{:.9g} Hz; {:.9g} Hz is taken as asked",
             is_uneven ? "uneven times, which are left out, and " : "", of_file, rate_hz);
    recording.time_s.resize(0);
  }
}

void take_unit(const std::string& text, Channel& channel, std::vector<Note>& notes) {
  channel.source_unit = text;
  if (const auto unit = parse_unit(text)) {
    channel.unit = unit->si;
    channel.si_per_source = unit->factor;
    channel.si_offset = unit->offset;
    if (unit->quantity != Quantity::unknown) channel.quantity = unit->quantity;
  } else if (!text.empty()) {
    add_note(notes, "unknown_unit", channel.name,
             "unit \"{}\" is not known: the numbers are kept as they are", text);
  }
}

void take_samples(VectorXd numbers, Channel& channel) {
  channel.samples = std::move(numbers);
  channel.samples.array() = channel.samples.array() * channel.si_per_source + channel.si_offset;
  for (double& x : channel.samples) x = std::isfinite(x) ? x : kNaN;
  channel.missing_samples = channel.samples.array().isNaN().count();
}

std::string unused_name(const std::string& name, std::set<std::string>& used) {
  std::string own = name;
  for (int k = 2; !used.insert(own).second; ++k) own = name + "_" + std::to_string(k);
  return own;
}

double round_rate(double rate_hz, double tolerance) {
  if (!(rate_hz > 0) || !std::isfinite(rate_hz)) return rate_hz;
  const double decade = std::floor(std::log10(rate_hz));
  for (int digits = 0; digits < 9; ++digits) {
    const double unit = std::pow(10.0, decade - digits);
    // A multiple of a negative power of ten is formed by dividing: 0.1 has no exact double.
    const double rounded = unit >= 1 ? std::round(rate_hz / unit) * unit
                                     : std::round(rate_hz / unit) / std::round(1 / unit);
    if (std::abs(rounded - rate_hz) <= tolerance * rate_hz) return rounded;
  }
  return rate_hz;
}

namespace {
// A hundred times the interval of a rate known worse than this holds several round rates.
constexpr double kRounded = 3e-4;

/// The least step (`side` 1) or the largest (-1) of a line that leaves all times within one digit,
/// from a step beyond it. What a line leaves has a range that is convex in its step: Newton's
/// method comes from outside. Where no line does, the least comes out above the largest.
double outermost_step(const ArrayXd& t, const ArrayXd& place, double digit, double side,
                      double step) {
  for (;;) {
    const ArrayXd left = t - step * place;
    Index top = 0, low = 0;
    const double beyond = left.maxCoeff(&top) - left.minCoeff(&low) - digit;
    const double run = place[top] - place[low];
    if (!(beyond > 1e-3 * digit && side * run > 0)) return step;
    step += beyond / run;
  }
}

/// Whether stamps of whole digits that resolve about one step show rows that are lost or doubled:
/// they get ahead of the rows or fall behind, not for one row only (jitter). Where they do so many
/// times, one way and at even distances but for ties of rounding, or in more than a fiftieth of the
/// rows, the step is no whole digit; where they go both ways, that is jitter.
bool has_slips(const ArrayXd& t, const ArrayXd& place, double digit) {
  const ArrayXd exact = (t - t[0]) / digit - (place - place[0]), ahead = exact.round();
  if ((exact - ahead).abs().maxCoeff() > 1e-3) return false;
  const Index n = t.size();
  std::vector<Index> at, apart;
  for (Index k = 1; k < n; ++k) {
    if (ahead[k] == ahead[k - 1]) continue;
    if (k + 1 < n && ahead[k + 1] == ahead[k - 1]) {
      ++k;
      continue;
    }
    if (!at.empty()) apart.push_back(k - at.back());
    at.push_back(k);
  }
  if (at.size() < 3) return !at.empty();
  const auto [least, most] = std::ranges::minmax(apart);
  const auto slips = static_cast<double>(at.size());
  return most - least > 2 && std::abs(ahead[n - 1]) == slips && 50 * slips < static_cast<double>(n);
}
}  // namespace

TimeAxis time_axis(const Ref<const VectorXd>& time_s, double printed_resolution_s,
                   double stated_rate_hz) {
  TimeAxis axis;
  axis.printed_resolution_s = printed_resolution_s;
  const Index n = time_s.size();
  ArrayXd place(n), t(n);  // at the times that are there
  Index count = 0;
  for (Index k = 0; k < n; ++k) {
    if (std::isfinite(time_s[k])) place[count] = static_cast<double>(k), t[count++] = time_s[k];
  }
  axis.missing = n - count;
  if (count < 2) return axis;
  place.conservativeResize(count);
  t.conservativeResize(count);
  // Centred sums: times of 1e9 s (clocks) keep their digits.
  const double k_mean = place.mean(), t_mean = t[0] + (t - t[0]).mean();
  place -= k_mean;
  double step = (place * (t - t_mean)).sum() / place.square().sum();

  const double resolution = printed_resolution_s;
  axis.uniform =
      step > 0 && (t - t_mean - step * place).abs().maxCoeff() <= 0.75 * resolution + 0.01 * step;
  const bool slips = std::round(step / resolution) == 1 && has_slips(t, place, resolution);
  if (!axis.uniform || slips) {
    const ArrayXd all = time_s.tail(n - 1) - time_s.head(n - 1);  // NaN beside missing times
    std::vector<double> steps = finite_values(all.matrix());
    if (steps.empty()) return axis;
    const double usual = median(steps);
    // Gaps bias the line. The mean of the steps that are no gaps does not see them, and printing,
    // which may make most steps zero, averages out of it.
    const double near = std::max(slips ? 0 : 1.5 * resolution, 0.5 * std::abs(usual));
    const Eigen::Array<bool, Eigen::Dynamic, 1> regular = (all - usual).abs() <= near;
    step = regular.select(all, 0.0).sum() / std::max(1.0, static_cast<double>(regular.count()));
    // Printed steps differ by a digit, unless the step is a whole number of them.
    const double digits = resolution > 0 ? step / resolution : 1;
    const bool whole = digits > 0.5 && std::abs(digits - std::round(digits)) < 1e-3;
    const double slack = whole ? 0 : resolution;
    double worst_step = 0;
    for (Index k = 1; k < n; ++k) {
      const double h = all[k - 1];
      if (!std::isfinite(h)) continue;
      const bool back = h < 0, again = h == 0 && !(resolution > 1.01 * step);
      const bool gap = step > 0 && h > 1.5 * step + slack;
      axis.backward += back ? 1 : 0;
      axis.repeated += again ? 1 : 0;
      axis.gaps += gap ? 1 : 0;
      if ((back || again || gap) && axis.first_fault < 0) axis.first_fault = k;
      if (gap && h > worst_step) worst_step = h, axis.longest_gap_at = k, axis.longest_gap_s = h;
    }
  }
  if (!(step > 0) || !std::isfinite(1 / step)) return axis;

  const double span_s = std::max(1.0, static_cast<double>(n - 1)) * step;
  // A step that is a whole number of printed digits throughout is exact.
  const double whole = resolution > 0 ? std::round(step / resolution) * resolution : 0;
  const bool exact = axis.uniform && whole > 0 &&
                     (t - t_mean - whole * place).abs().maxCoeff() <= 1e-3 * resolution;
  double half = exact ? 0 : resolution / span_s;  // of the interval it is in, relative
  if (exact) {
    step = whole;
  } else if (axis.uniform && !slips && half > 1e-9) {
    const ArrayXd since = t - t_mean;
    const double beyond = (4 * resolution + 0.02 * step) * step / span_s;
    const double least = outermost_step(since, place, resolution, 1, step - beyond);
    const double most = outermost_step(since, place, resolution, -1, step + beyond);
    if (least <= most) {
      step = (least + most) / 2;
      half = (most - least) / 2 / step;
    } else {  // Jitter: sqrt(3) deviations of the line's slope, of samples with own stamps.
      const double own = std::min(static_cast<double>(count), span_s / resolution);
      half = 6 * std::sqrt((since - step * place).square().mean() / own) / span_s;
    }
  }
  half += 1e-9;
  axis.rate_hz = 1 / step;
  axis.start_s = time_s[0];
  const auto off = [&](double rate) { return std::abs(axis.rate_hz / rate - 1); };
  // "Agrees": not further off than the clock errors of ordinary loggers (100 ppm) and printing.
  axis.agrees_with_stated = !(stated_rate_hz > 0) || off(stated_rate_hz) <= std::max(half, 1e-4);
  // The roundest rate of an interval 100 times as wide is in this one by chance once in 100 times.
  const double round = half < kRounded ? round_rate(axis.rate_hz, 100 * half) : 0;
  const double usual = off(stated_rate_hz) <= half ? stated_rate_hz : round;
  if (off(usual) <= half) {
    axis.rate_hz = usual;
  } else if (half > 2e-9) {
    axis.rate_relative_std = half / std::sqrt(3.0);
  }
  if (axis.uniform && !std::isfinite(axis.start_s)) axis.start_s = t_mean - step * k_mean;
  const ArrayXd departure = t - t_mean - (axis.uniform ? 1 / axis.rate_hz : step) * place;
  axis.jitter_s = std::sqrt((departure - departure.mean()).square().mean());
  // Times near the largest double: sums over them are no numbers, nor is a rate from them.
  const bool is_finite = std::isfinite(axis.jitter_s + axis.start_s + axis.rate_hz);
  return is_finite ? axis : TimeAxis{.missing = axis.missing};
}

RateOfStep rate_of_step(double step_s, double half_digit) {
  RateOfStep result;
  if (!(step_s > 0) || !std::isfinite(1 / step_s)) return result;
  result.rate_hz = 1 / step_s;
  const double tolerance = std::min(0.1, half_digit / step_s);
  // A round rate (four digits or fewer) whose step is this very decimal: printed in full.
  const double round = round_rate(result.rate_hz, 1e-12);
  const double four = std::pow(10.0, std::floor(std::log10(round)) - 3);
  if (std::abs(round / four - std::round(round / four)) < 1e-9) {
    result.rate_hz = round;
    return result;
  }
  result.relative_std = tolerance / std::sqrt(3.0);
  const double power = std::exp2(std::round(std::log2(result.rate_hz)));
  const double decade = std::pow(10.0, std::floor(std::log10(result.rate_hz)) - 1);
  // Powers of two, those times 25 (51200 Hz and its parts), and rates of two digits.
  const double times25 = 25 * std::exp2(std::round(std::log2(result.rate_hz / 25)));
  const auto prints_so = [&](double rate) {
    return std::abs(1 / rate - step_s) <= half_digit * (1 + 1e-9);
  };
  std::set<double> usual;
  for (const double rate : {power, times25, std::round(result.rate_hz / decade) * decade}) {
    if (prints_so(rate)) usual.insert(rate);
  }
  // Whole hertz, where the digits tell them apart.
  const double whole = std::round(result.rate_hz);
  const bool told = tolerance * result.rate_hz < 0.25;
  if (usual.empty() && told && prints_so(whole)) usual.insert(whole);
  if (usual.size() == 1) result.rate_hz = *usual.begin();
  return result;
}

void take_times(const TimeAxis& axis, const VectorXd& time_s, const std::string& name,
                long first_line, Recording& recording) {
  auto& notes = recording.notes;
  const auto line = [&](Index sample) {
    return first_line == 0 ? fmt::format("near sample {}", sample + 1)
                           : fmt::format("near line {}", first_line + sample);
  };
  recording.sample_rate_hz = axis.rate_hz;
  recording.sample_rate_relative_std = axis.rate_relative_std;
  recording.start_time_s = std::isfinite(axis.start_s) ? axis.start_s : 0;
  recording.time_jitter_s = axis.jitter_s;
  const bool is_known = axis.rate_hz > 0, is_uneven = is_known && !axis.uniform;
  if (axis.backward > 0 || axis.repeated > 0) {
    add_note(notes, "time_axis", line(axis.first_fault),
             "times go back {} times and repeat {} times", axis.backward, axis.repeated);
  }
  if (axis.gaps > 0) {
    add_note(notes, "time_axis", line(axis.longest_gap_at),
             "{} gaps in the times, the longest {:.9g} s", axis.gaps, axis.longest_gap_s);
  }
  if (axis.missing > 0) add_note(notes, "time_missing", "", "{} times are missing", axis.missing);
  if (is_uneven) {
    add_note(notes, "time_axis", "", "sampling is not uniform (rms departure {:.9g} s)",
             axis.jitter_s);
  } else if (is_known && axis.printed_resolution_s * axis.rate_hz > 1) {
    const bool is_sure = axis.rate_relative_std == 0;
    add_note(notes, is_sure ? "read_as" : "time_axis", "",
             "{}times are rounded to {:.9g} s, coarser than the sampling step; the rate is that of "
             "the whole record",
             is_sure ? "" : "Give the sample rate: ", axis.printed_resolution_s);
  }
  if (is_uneven && axis.missing > 0) {
    Index at = 0;
    while (std::isfinite(time_s[at])) ++at;
    const bool by_line = first_line > 0;
    throw RecordingError({recording.path.string(), by_line ? first_line + at : 0, 0, name,
                          by_line ? "" : fmt::format("sample {}", at + 1)},
                         "the time is missing and sampling is not uniform",
                         "fix the times, or delete that column and give the sample rate");
  }
  if (is_uneven) recording.time_s = time_s;
  if (!is_known && time_s.size() > 1) {
    add_note(notes, "time_axis", name, "Sort the rows, or give the rate: the times do not rise");
  }
}

void note_unitless(Recording& recording) {
  std::vector<std::string> names;
  for (const auto& channel : recording.channels) {
    if (channel.source_unit.empty() && channel.unit.empty()) names.push_back(channel.name);
  }
  const auto known = std::ranges::find(recording.notes, "no_unit", &Note::code);
  if (known != recording.notes.end()) {
    known->where = listed(names);
    if (names.empty()) recording.notes.erase(known);
  } else if (!names.empty()) {
    add_note(recording.notes, "no_unit", listed(names),
             "no unit in the file: the numbers are kept as they are");
  }
}

void shorten(std::vector<Note>& notes) {
  std::map<std::string, std::size_t> count, seen;
  for (const auto& note : notes) ++count[note.code];
  std::erase_if(notes, [&](Note& note) {
    const std::size_t place = ++seen[note.code], all = count[note.code];
    if (place == kMostListed && all > kMostListed) {
      note.message += " (and " + std::to_string(all - kMostListed) + " more of this kind)";
    }
    return place > kMostListed;
  });
}

}  // namespace rigfit::signal
