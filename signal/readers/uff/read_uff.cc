#include "signal/readers/uff/read_uff.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <tuple>

#include "signal/readers/files/frf_unit.h"
#include "signal/readers/files/mapped_file.h"
#include "signal/readers/uff/uff58.h"
#include "signal/recording/recording_error.h"
#include "signal/recording/recording_time.h"
#include "signal/recording/time_axis.h"
#include "signal/recording/units.h"

namespace rigfit::signal {
namespace {

constexpr int kTimeAxis = 17;

bool is_time_history(const Uff58& f) {
  return !f.complex &&
         (f.function_type == uff58_function::kTimeResponse ||
          (f.function_type == uff58_function::kGeneral && f.abscissa.data_type == kTimeAxis));
}

std::string point_text(const Uff58Point& point) {
  return std::to_string(point.node) + uff58_direction(point.direction);
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
    channel.name = unused_name(channel.name, used);
  }
}

Channel channel_of(const Uff58& f, std::vector<Note>& notes) {
  Channel channel;
  channel.name = name_of_response(f);
  channel.direction = direction_vector(f.response.direction);
  channel.quantity = uff58_quantity(f.ordinate.data_type);
  take_unit(f.ordinate.unit, channel, notes);
  const double range = remark_number(parse_uff58_remark(f.id[3]), "range", 0);
  channel.nominal_range = range > 0 ? range : 0;
  take_samples(f.complex
                   ? Eigen::VectorXd((f.real.array().square() + f.imag.array().square()).sqrt())
                   : f.real,
               channel);
  return channel;
}

void copy_remarks(const Uff58File& file, Recording& recording) {
  for (const auto& remark : file.remarks) recording.notes.push_back({"uff_remark", remark, ""});
  if (file.other_datasets.empty()) return;
  std::set<int> numbers(file.other_datasets.begin(), file.other_datasets.end());
  std::string text;
  for (const int number : numbers) text += (text.empty() ? "" : ", ") + std::to_string(number);
  recording.notes.push_back({"left_out", "datasets other than 58 are not read: " + text, ""});
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
    recording.notes.push_back({"incomplete",
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

FrfUnit scale_of(const Uff58& f) {
  FrfUnit scale;
  const std::string& text = f.ordinate.unit;
  // "(m/s^2)/N" fits the label of 20 characters; brackets around the whole do not matter.
  const auto numerator = parse_unit(text);
  const auto denominator = parse_unit(f.denominator.unit);
  if (const auto whole = parse_frf_unit(text)) {
    scale = *whole;
  } else if (numerator) {
    const double by = denominator ? denominator->factor : 1;
    scale.factor = numerator->factor / by;
    scale.form = frf_form_of(numerator->quantity);
    const bool force = (denominator && denominator->quantity == Quantity::force) ||
                       (!denominator && f.denominator.data_type == 13);
    scale.unit = denominator ? "(" + numerator->si + ")/" + denominator->si
                             : (force ? "(" + numerator->si + ")/N" : numerator->si);
  }
  if (scale.form == FrfForm::unknown) {
    if (f.ordinate.data_type == 8) scale.form = FrfForm::receptance;
    if (f.ordinate.data_type == 11) scale.form = FrfForm::mobility;
    if (f.ordinate.data_type == 12) scale.form = FrfForm::accelerance;
  }
  return scale;
}

std::string name_of_point(const Uff58Point& point, const std::string& full_name) {
  if (!full_name.empty()) return full_name;
  std::string name = point.entity;
  if (point.node != 0 || name.empty()) {
    name += (name.empty() ? "" : " ") + point_text(point);
  }
  return name;
}

/// Place of the point in the list, added when it is new.
std::size_t place(std::vector<MeasuredPoint>& points, const MeasuredPoint& point) {
  for (std::size_t k = 0; k < points.size(); ++k) {
    if (points[k].name == point.name && points[k].node == point.node &&
        points[k].direction == point.direction) {
      return k;
    }
  }
  points.push_back(point);
  return points.size() - 1;
}

struct Placed {
  const Uff58* function = nullptr;
  std::size_t response = 0, input = 0;
};

Eigen::VectorXd frequencies_of(const Uff58& f) {
  if (!f.even) return f.x;
  const auto remark = parse_uff58_remark(f.id[4]);
  double start = f.abscissa_start, step = f.abscissa_step;
  const double exact_start = remark_number(remark, "x0", start);
  const double exact_step = remark_number(remark, "dx", step);
  if (std::abs(exact_step - step) <= 1e-5 * std::abs(step) &&
      std::abs(exact_start - start) <= 1e-5 * std::abs(start)) {
    start = exact_start, step = exact_step;
  }
  Eigen::VectorXd x(f.real.size());
  for (Eigen::Index k = 0; k < x.size(); ++k) x[k] = start + static_cast<double>(k) * step;
  return x;
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
  const double written = remark_number(parse_uff58_remark(chosen.front()->id[3]), "channels", 0);
  if (written > static_cast<double>(chosen.size())) {
    throw RecordingError({name, chosen.back()->line, 0, "", ""},
                         fmt::format("breaks off: it was written with {} channels and holds {}",
                                     written, chosen.size()),
                         "copy the file again");
  }
  if (chosen.size() < file.functions.size()) {
    recording.notes.push_back({"left_out",
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
        {"left_out", "other start, rate or times than the rest: left out", left});
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

FrfSet read_uff_frfs(std::string_view bytes, const std::filesystem::path& path) {
  const std::string file_name = path.string();
  const Uff58File file = read_uff58(bytes, file_name);
  const auto refuse = [&](const Uff58* f, std::string problem, std::string remedy) {
    return RecordingError({file_name, f == nullptr ? 1 : f->line, 0, "", ""}, std::move(problem),
                          std::move(remedy));
  };
  FrfSet set;
  std::vector<Placed> frfs, coherences, deviations;
  for (const auto& f : file.functions) {
    const auto remark = parse_uff58_remark(f.id[3]);
    const auto what = remark.find("what");
    const bool deviation = f.function_type == uff58_function::kGeneral && what != remark.end() &&
                           what->second == "std";
    const bool frf = f.function_type == uff58_function::kFrf && f.complex;
    const bool coherence = f.function_type == uff58_function::kCoherence && !f.complex;
    if (!frf && !coherence && !deviation) continue;
    const bool ours = !remark.empty();
    Placed placed;
    placed.function = &f;
    const MeasuredPoint response{name_of_point(f.response, ours ? f.id[0] : ""), f.response.node,
                                 f.response.direction};
    const MeasuredPoint input{name_of_point(f.reference, ours ? f.id[1] : ""), f.reference.node,
                              f.reference.direction};
    placed.response = place(set.responses, response);
    placed.input = place(set.inputs, input);
    (frf ? frfs : coherence ? coherences : deviations).push_back(placed);
  }
  if (frfs.empty()) {
    throw refuse(file.functions.empty() ? nullptr : &file.functions.front(),
                 "holds no frequency response function (dataset 58, function type 4, complex)",
                 "estimate them with `frf`, or give the recordings themselves");
  }
  const Uff58& first = *frfs.front().function;
  set.frequency_hz = frequencies_of(first);
  const auto frequency_unit = parse_unit(first.abscissa.unit);
  if (frequency_unit && frequency_unit->si == "rad/s") {
    set.frequency_hz /= 6.283185307179586;
  } else if (frequency_unit && frequency_unit->si == "Hz") {
    set.frequency_hz *= frequency_unit->factor;
  }
  const Eigen::Index lines = set.frequency_hz.size();
  if (!set.frequency_hz.allFinite() ||
      (lines > 1 &&
       (set.frequency_hz.tail(lines - 1) - set.frequency_hz.head(lines - 1)).minCoeff() <= 0)) {
    throw refuse(&first, "the frequencies do not rise", "export the FRFs again");
  }
  const auto columns = static_cast<Eigen::Index>(set.responses.size() * set.inputs.size());
  if (columns > static_cast<Eigen::Index>(4 * frfs.size())) {
    throw refuse(&first, "most of the FRFs between the points named are absent",
                 "give FRFs of all responses to all inputs");
  }
  const auto complex_nan = std::complex<double>(std::numeric_limits<double>::quiet_NaN(), 0);
  set.H = Eigen::MatrixXcd::Constant(lines, columns, complex_nan);
  std::vector<bool> have(static_cast<std::size_t>(columns), false);
  std::optional<FrfUnit> scale;
  std::vector<double> factors(static_cast<std::size_t>(columns), 1);
  const auto check_lines = [&](const Uff58& f) {
    const Eigen::VectorXd x = frequencies_of(f);
    if (x.size() != lines || !x.allFinite() ||
        (x - frequencies_of(first)).cwiseAbs().maxCoeff() >
            1e-6 * std::max(1e-300, frequencies_of(first).cwiseAbs().maxCoeff())) {
      throw refuse(
          &f, "has other frequencies than the first FRF (line " + std::to_string(first.line) + ")",
          "give functions over the same lines");
    }
  };
  for (const auto& placed : frfs) {
    const Uff58& f = *placed.function;
    check_lines(f);
    const FrfUnit own = scale_of(f);
    if (scale && scale->form != own.form) {
      throw refuse(
          &f, std::string("is of another form (receptance, mobility, accelerance) than the first"),
          "convert all FRFs to one form first");
    }
    if (!scale) scale = own;
    const Eigen::Index column = set.column(static_cast<Eigen::Index>(placed.response),
                                           static_cast<Eigen::Index>(placed.input));
    if (have[static_cast<std::size_t>(column)]) {
      throw refuse(&f,
                   "is a second FRF from \"" + set.inputs[placed.input].name + "\" to \"" +
                       set.responses[placed.response].name + "\"",
                   "keep one of the two");
    }
    have[static_cast<std::size_t>(column)] = true;
    factors[static_cast<std::size_t>(column)] = own.factor;
    for (Eigen::Index k = 0; k < lines; ++k) {
      set.H(k, column) = own.factor * std::complex<double>(f.real[k], f.imag[k]);
    }
  }
  for (std::size_t r = 0; r < set.responses.size(); ++r) {
    for (std::size_t i = 0; i < set.inputs.size(); ++i) {
      const auto column = set.column(static_cast<Eigen::Index>(r), static_cast<Eigen::Index>(i));
      if (!have[static_cast<std::size_t>(column)]) {
        throw refuse(
            &first,
            "no FRF from \"" + set.inputs[i].name + "\" to \"" + set.responses[r].name + "\"",
            "give FRFs of all responses to all inputs");
      }
    }
  }
  if (!set.H.allFinite()) {
    // A line of zero frequency is often not a number in mobility; elsewhere it is a fault.
    Eigen::Index keep = 0;
    if (set.frequency_hz[0] == 0 && lines > 1 && set.H.bottomRows(lines - 1).allFinite()) keep = 1;
    if (keep == 0) {
      throw refuse(&first, "an FRF holds values that are no numbers", "export the FRFs again");
    }
    set.H = Eigen::MatrixXcd(set.H.bottomRows(lines - 1));
    set.frequency_hz = Eigen::VectorXd(set.frequency_hz.tail(lines - 1));
    set.notes.push_back({"data_left_out", "the line at 0 Hz is no number and is left out", ""});
  }
  const auto fill = [&](const std::vector<Placed>& from, Eigen::MatrixXd& into, bool scaled,
                        const char* what) {
    if (from.empty()) return;
    if (from.size() != static_cast<std::size_t>(columns)) {
      set.notes.push_back({"incomplete", std::string(what) + " of some FRFs only: left out", ""});
      return;
    }
    into = Eigen::MatrixXd::Zero(set.H.rows(), columns);
    for (const auto& placed : from) {
      check_lines(*placed.function);
      const Eigen::Index column = set.column(static_cast<Eigen::Index>(placed.response),
                                             static_cast<Eigen::Index>(placed.input));
      into.col(column) = placed.function->real.tail(set.H.rows()) *
                         (scaled ? factors[static_cast<std::size_t>(column)] : 1.0);
    }
    if (!into.allFinite()) {
      set.notes.push_back({"not_a_number",
                           std::string(what) + " holds values that are no numbers: "
                                               "left out",
                           ""});
      into.resize(0, 0);
    }
  };
  fill(coherences, set.coherence, false, "coherence");
  fill(deviations, set.H_std, true, "standard deviation");
  set.form = scale->form;
  set.unit = scale->unit;
  if (set.unit.empty()) {
    set.notes.push_back({"no_unit", "the FRFs have no unit: the numbers are kept as they are", ""});
  }
  const auto remark = parse_uff58_remark(first.id[3]);
  set.averages = static_cast<int>(std::clamp(remark_number(remark, "averages", 0), 0.0, 1e9));
  set.sample_rate_hz = std::max(0.0, remark_number(remark, "rate", 0));
  set.exponential_decay_rate_1_s = std::max(0.0, remark_number(remark, "decay", 0));
  set.pre_trigger_s = std::max(0.0, remark_number(remark, "pre", 0));
  const auto more = parse_uff58_remark(first.id[4]);
  set.force_noise_span_s = std::max(0.0, remark_number(more, "span", 0));
  set.sample_rate_relative_std = std::max(0.0, remark_number(more, "rate_u", 0));
  for (const auto& text : file.remarks) set.notes.push_back({"uff_remark", text, ""});
  return set;
}

FrfSet read_uff_frfs(const std::filesystem::path& path) {
  const MappedFile file(path);
  return read_uff_frfs(file.bytes(), path);
}

}  // namespace rigfit::signal
