#include <fmt/ranges.h>

#include <iterator>

#include "signal/readers/frequency_table.h"
#include "signal/readers/read_recording.h"
#include "signal/readers/uff58.h"
#include "signal/recording/recording_time.h"

namespace rigfit::signal {
namespace {

using Functions = std::vector<const Uff58*>;

bool is_time_history(const Uff58& f) {
  return !f.complex && (f.function_type == uff58_function::time_response ||
                        (f.function_type == uff58_function::general &&
                         uff58_quantity(f.abscissa.data_type) == Quantity::time));
}

std::string point_text(const MeasuredPoint& point) {
  return std::to_string(point.node) + uff58_direction(point.direction);
}

std::string name_of_response(const Uff58& f) {
  if (!f.remark.empty() && !f.id[0].empty()) return f.id[0];
  for (const std::string& name : {f.response.name, f.id[0], f.ordinate.label}) {
    if (!name.empty()) return name;
  }
  return f.response.node != 0 ? point_text(f.response) : "channel";
}

/// The exact number of our own remark, where the number that a field gives with its six digits is
/// it.
double exact(const Uff58& f, const char* key, double printed) {
  const double noted = f.noted(key, printed);
  return std::abs(noted - printed) <= 1e-5 * std::abs(printed) ? noted : printed;
}

Channel channel_of(const Uff58& f, std::vector<Note>& notes) {
  Channel channel;
  channel.name = name_of_response(f);
  const int axis = std::abs(f.response.direction);
  if (axis >= 1 && axis <= 3) {
    channel.direction[static_cast<std::size_t>(axis - 1)] = f.response.direction > 0 ? 1 : -1;
  }
  channel.quantity = uff58_quantity(f.ordinate.data_type);
  take_unit(f.ordinate.unit, channel, notes);
  channel.nominal_range = std::max(0.0, f.noted("range"));
  take_samples(f.real, channel);
  return channel;
}

/// Words for a function type.
const char* name_of_type(int type) {
  constexpr const char* kNames[] = {"general function",
                                    "time response",
                                    "auto spectrum",
                                    "cross spectrum",
                                    "frequency response function",
                                    "transmissibility",
                                    "coherence",
                                    "auto correlation",
                                    "cross correlation",
                                    "power spectral density",
                                    "energy spectral density",
                                    "probability density",
                                    "spectrum"};
  return type >= 0 && type < std::ssize(kNames) ? kNames[type] : "function of another type";
}

std::string kinds_in(const std::vector<Uff58>& functions) {
  std::set<std::string> kinds;
  for (const auto& f : functions) kinds.insert(name_of_type(f.function_type));
  return fmt::format("{}", fmt::join(kinds, ", "));
}

/// Whether two functions are of the same times.
bool same_times(const Uff58& a, const Uff58& b) {
  if (&a == &b) return true;  // also where times are missing, which equal nothing
  if (a.even != b.even || a.real.size() != b.real.size()) return false;
  if (a.even) return a.abscissa_start == b.abscissa_start && a.abscissa_step == b.abscissa_step;
  return (a.x.array() == b.x.array()).all();
}

/// Functions as channels with names of their own. Those of other times than the first are left out,
/// with a note.
void take_channels(const Functions& functions, Recording& recording) {
  recording.format = functions.front()->binary ? "uff58-binary" : "uff58-ascii";
  Functions taken;
  std::map<std::string, int> times;
  std::vector<std::string> left;
  for (const auto* f : functions) {
    if (!same_times(*functions.front(), *f)) {
      left.push_back(fmt::format("{} (line {})", name_of_response(*f), f->line));
      continue;
    }
    taken.push_back(f);
    recording.channels.push_back(channel_of(*f, recording.notes));
    ++times[recording.channels.back().name];
  }
  if (!left.empty()) {
    add_note(recording.notes, "data_left_out", listed(left),
             "other start, rate, times or length than the first channel: left out");
  }
  std::set<std::string> used;
  for (std::size_t k = 0; k < taken.size(); ++k) {
    std::string& name = recording.channels[k].name;
    // Several channels of one name are told apart by their node and direction, where these differ.
    const MeasuredPoint& point = taken[k]->response;
    if (times[name] > 1 && point.node != 0) name += " " + point_text(point);
    name = unused_name(name, used);
  }
  note_unitless(recording);
}

void take_abscissa(const Uff58& first, Recording& recording) {
  const auto unit = parse_unit(first.abscissa.unit);
  const bool known = unit && unit->quantity == Quantity::time;
  const double to_seconds = known ? unit->factor : 1;
  if (!first.abscissa.unit.empty() && !known) {
    add_note(recording.notes, "time_unit", "",
             "the abscissa's unit \"{}\" is no unit of time: taken as seconds",
             first.abscissa.unit);
  }
  if (first.even) {
    const RateOfStep stated = rate_of_step(first.abscissa_step, first.abscissa_step_half_digit);
    recording.sample_rate_hz = exact(first, "rate", stated.rate_hz) / to_seconds;
    recording.sample_rate_relative_std = first.noted("rate") > 0 ? 0 : stated.relative_std;
    recording.start_time_s = exact(first, "start", first.abscissa_start) * to_seconds;
    return;
  }
  const VectorXd time = first.x * to_seconds;
  // Single-precision times carry seven digits of the latest one.
  const double latest = time.cwiseAbs().maxCoeff();
  const double digits = first.binary && !first.single_precision ? 1e-15 : 1e-5;
  take_times(time_axis(time, std::isfinite(latest) ? latest * digits : 0), time,
             first.abscissa.label, 0, recording);
  recording.sample_rate_hz = first.noted("rate", recording.sample_rate_hz);
}

/// "(m/s^2)/N" fits the ordinate's label of 20 characters; else the force has a line of its own.
FrfUnit scale_of(const Uff58& f) {
  const std::string force =
      f.denominator.unit.empty() && f.denominator.data_type == 13 ? "N" : f.denominator.unit;
  auto scale = parse_frf_unit(f.ordinate.unit);
  if (!scale) scale = parse_frf_unit(f.ordinate.unit + "/" + force);
  if (!scale) scale.emplace();
  if (scale->form == FrfForm::unknown) scale->form = form_of(uff58_quantity(f.ordinate.data_type));
  return *scale;
}

/// `full_name`: of our own files.
MeasuredPoint measured_point(const MeasuredPoint& point, const std::string& full_name) {
  std::string name = full_name.empty() ? point.name : full_name;
  if (full_name.empty() && (point.node != 0 || name.empty())) {
    name += (name.empty() ? "" : " ") + point_text(point);
  }
  return {name, point.node, point.direction};
}

/// A function of an FRF set, in SI; its values are those of H, of the coherence or of the std.
FrfPart part_of(const Uff58& f, const std::string& file) {
  const bool ours = !f.remark.empty();
  FrfPart part;
  part.response = measured_point(f.response, ours ? f.id[0] : "");
  part.input = measured_point(f.reference, ours ? f.id[1] : "");
  part.unit = scale_of(f);
  part.file = file;
  part.line = f.line;
  const Index n = f.real.size();
  part.frequency_hz = f.x;
  if (f.even) {
    part.frequency_hz =
        exact(f, "x0", f.abscissa_start) +
        exact(f, "dx", f.abscissa_step) * ArrayXd::LinSpaced(n, 0, static_cast<double>(n - 1));
  }
  const auto unit = parse_unit(f.abscissa.unit);
  if (unit && unit->si == "rad/s") part.frequency_hz *= unit->factor / kTwoPi;
  if (unit && unit->si == "Hz") part.frequency_hz *= unit->factor;
  return part;
}

/// Adds the coherences or the standard deviations to the FRFs between the same points.
void add_to_parts(const Uff58& f, const std::string& file, VectorXd FrfPart::*values,
                  std::vector<FrfPart>& parts) {
  const FrfPart own = part_of(f, file);
  for (auto& part : parts) {
    if (part.response != own.response || part.input != own.input) continue;
    if (!same_lines(own.frequency_hz, part.frequency_hz)) {
      throw RecordingError({file, f.line}, "has other frequencies than its FRF",
                           "give functions over the same lines");
    }
    part.*values = f.real * (values == &FrfPart::H_std ? own.unit.factor : 1.0);
  }
}

}  // namespace

Recording read_uff(std::string_view bytes, const std::filesystem::path& path,
                   const ReadOptions& options) {
  const std::string name = path.string();
  const std::vector<Uff58> functions = read_uff58(bytes, name, options.done_with);
  Recording recording;
  recording.path = path;
  Functions histories;
  for (const auto& f : functions) {
    if (is_time_history(f)) histories.push_back(&f);
  }
  if (histories.empty()) {
    const bool any = !functions.empty();
    throw RecordingError(
        {name, any ? functions.front().line : 1},
        any ? "holds no time history, but: " + kinds_in(functions) : "holds no dataset 58",
        "give a recording over time (`modal` takes FRFs, `update` mode shapes)");
  }
  const double written = histories.front()->noted("channels");
  if (written > static_cast<double>(histories.size())) {
    throw RecordingError({name, histories.back()->line},
                         fmt::format("breaks off: it was written with {} channels and holds {}",
                                     written, histories.size()),
                         "copy the file again");
  }
  if (const std::size_t others = functions.size() - histories.size(); others > 0) {
    add_note(recording.notes, "left_out", "",
             "{} functions that are no time histories are left out (the file holds: {})", others,
             kinds_in(functions));
  }
  take_channels(histories, recording);
  take_abscissa(*histories.front(), recording);
  take_stated_rate(options.sample_rate_hz, recording);
  return recording;
}

FrfSet read_uff_frfs(std::string_view bytes, const std::filesystem::path& path) {
  const std::string name = path.string();
  const std::vector<Uff58> functions = read_uff58(bytes, name);
  const Uff58* first = nullptr;
  std::vector<FrfPart> parts;
  for (const auto& f : functions) {
    if (f.function_type != uff58_function::frf || !f.complex) continue;
    if (first == nullptr) first = &f;
    FrfPart part = part_of(f, name);
    part.H.resize(f.real.size());
    part.H.real() = part.unit.factor * f.real;
    part.H.imag() = part.unit.factor * f.imag;
    parts.push_back(std::move(part));
  }
  if (first == nullptr) {
    throw RecordingError(
        {name, functions.empty() ? 1 : functions.front().line},
        "holds no frequency response function (dataset 58, function type 4, complex)",
        "estimate them with `frf`, or give the recordings themselves");
  }
  for (const auto& f : functions) {
    const auto what = f.remark.find("what");
    if (f.function_type == uff58_function::coherence && !f.complex) {
      add_to_parts(f, name, &FrfPart::coherence, parts);
    } else if (f.function_type == uff58_function::general && what != f.remark.end() &&
               what->second == "std") {
      add_to_parts(f, name, &FrfPart::H_std, parts);
    }
  }
  FrfSet set = set_of_parts(parts);
  const auto unit = parse_unit(first->abscissa.unit);
  if (!first->abscissa.unit.empty() && (!unit || (unit->si != "Hz" && unit->si != "rad/s"))) {
    add_note(set.notes, "no_unit", name,
             "the abscissa's unit \"{}\" is no unit of frequency: taken as Hz",
             first->abscissa.unit);
  }
  const auto positive = [&](const char* key) { return std::max(0.0, first->noted(key)); };
  set.averages = static_cast<int>(std::min(positive("averages"), 1e9));
  set.sample_rate_hz = positive("rate");
  set.exponential_decay_rate_1_s = positive("decay");
  set.pre_trigger_s = positive("pre");
  set.force_noise_span_s = positive("span");
  set.sample_rate_relative_std = positive("rate_u");
  return set;
}

}  // namespace rigfit::signal
