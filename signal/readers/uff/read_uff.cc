#include "signal/readers/uff/read_uff.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <map>
#include <numbers>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "signal/numerics/numbers.h"
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
using Functions = std::vector<const Uff58*>;

bool is_time_history(const Uff58& f) {
  return !f.complex &&
         (f.function_type == uff58_function::kTimeResponse ||
          (f.function_type == uff58_function::kGeneral && f.abscissa.data_type == kTimeAxis));
}

std::string point_text(const Uff58Point& point) {
  return std::to_string(point.node) + uff58_direction(point.direction);
}

std::string name_of_response(const Uff58& f) {
  if (!f.remark.empty() && !f.id[0].empty()) return f.id[0];
  for (const std::string& name : {f.response.entity, f.id[0], f.ordinate.label}) {
    if (!name.empty()) return name;
  }
  return f.response.node != 0 ? point_text(f.response) : "channel";
}

/// `exact`, which our own remark gives, where the printed number is it: 1e-5, since six digits of a
/// field are printed.
double exact_or(double printed, double exact, double tolerance = 1e-5) {
  return std::abs(exact - printed) <= tolerance * std::abs(printed) ? exact : printed;
}

/// One over the step, taken for a whole number of hertz where the printed digits allow it.
double rate_of(const Uff58& f) {
  if (!(f.abscissa_step > 0)) return 0;
  const double rate = 1 / f.abscissa_step;
  const double exact = f.noted("rate");
  const double tolerance = std::max(1e-5, 2 * f.abscissa_step_half_digit / f.abscissa_step);
  if (exact > 0 && std::abs(exact / rate - 1) < tolerance) return exact;
  const double whole = std::round(rate);
  return whole > 0 && std::abs(1 / whole - f.abscissa_step) <= f.abscissa_step_half_digit ? whole
                                                                                          : rate;
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
  take_samples(f.complex
                   ? Eigen::VectorXd((f.real.array().square() + f.imag.array().square()).sqrt())
                   : f.real,
               channel);
  return channel;
}

std::string kinds_in(const Uff58File& file) {
  std::set<std::string> kinds;
  for (const auto& f : file.functions) kinds.insert(uff58_function_name(f.function_type));
  return fmt::format("{}", fmt::join(kinds, ", "));
}

/// Functions as channels with names of their own and of one length.
void take_channels(const Uff58File& file, const Functions& functions, std::size_t file_size,
                   Recording& recording) {
  recording.format = functions.front()->binary ? "uff58-binary" : "uff58-ascii";
  std::map<std::string, int> times;
  Eigen::Index longest = 0;
  for (const auto* f : functions) {
    recording.channels.push_back(channel_of(*f, recording.notes));
    ++times[recording.channels.back().name];
    longest = std::max(longest, f->real.size());
  }
  if (static_cast<double>(longest) * static_cast<double>(functions.size()) >
      4.0 * static_cast<double>(file_size) + 4096) {
    throw RecordingError({recording.path.string(), 0, 0, "", ""},
                         fmt::format("its channels differ too much in length (the longest has {} "
                                     "samples) to be one recording",
                                     longest),
                         "split the file");
  }
  std::set<std::string> used;
  for (std::size_t k = 0; k < functions.size(); ++k) {
    Channel& channel = recording.channels[k];
    // Several channels of one name are told apart by their node and direction, where these differ.
    const Uff58Point& point = functions[k]->response;
    if (times[channel.name] > 1 && point.node != 0) channel.name += " " + point_text(point);
    channel.name = unused_name(channel.name, used);
    const Eigen::Index had = channel.samples.size();
    if (had == longest) continue;
    channel.samples.conservativeResize(longest);
    channel.samples.tail(longest - had).setConstant(kNaN);
    channel.missing_samples += longest - had;
    recording.notes.push_back(
        {"incomplete",
         fmt::format("has {} samples of {}; the rest counts as missing", had, longest),
         channel.name});
  }
  for (const auto& remark : file.remarks) recording.notes.push_back({"uff_remark", remark, ""});
  if (file.other_datasets.empty()) return;
  const std::set<int> others(file.other_datasets.begin(), file.other_datasets.end());
  recording.notes.push_back(
      {"left_out", fmt::format("datasets other than 58 are not read: {}", fmt::join(others, ", ")),
       ""});
}

bool same_times(const Uff58& a, const Uff58& b) {
  if (&a == &b) return true;  // also where times are missing, which equal nothing
  if (a.even != b.even) return false;
  if (a.even) return a.abscissa_start == b.abscissa_start && a.abscissa_step == b.abscissa_step;
  return a.x.size() == b.x.size() && (a.x.array() == b.x.array()).all();
}

/// All channels share their times: the largest group of the same form. The others are noted.
Functions of_one_form(const Functions& all, std::vector<Note>& notes) {
  constexpr std::size_t kMostForms = 64;  // more forms than that: the largest among the first
  std::size_t best = 0;
  std::ptrdiff_t most = 0;
  const auto like = [&](std::size_t k) {
    return [first = all[k]](const Uff58* f) { return same_times(*first, *f); };
  };
  for (std::size_t k = 0; k < std::min(all.size(), kMostForms); ++k) {
    if (k > 0 && same_times(*all[k], *all[k - 1])) continue;
    const auto count = std::count_if(all.begin(), all.end(), like(k));
    if (count > most) best = k, most = count;
  }
  Functions taken;
  std::string left;
  for (const auto* f : all) {
    if (same_times(*all[best], *f)) {
      taken.push_back(f);
    } else if (left.size() < 200) {
      left += fmt::format("{}\"{}\" (line {})", left.empty() ? "" : ", ", name_of_response(*f),
                          f->line);
    }
  }
  if (!left.empty()) {
    notes.push_back({"left_out", "other start, rate or times than the rest: left out", left});
  }
  return taken;
}

void take_abscissa(const Uff58& first, Recording& recording) {
  const auto unit = parse_unit(first.abscissa.unit);
  const bool known = unit && unit->quantity == Quantity::time;
  const double to_seconds = known ? unit->factor : 1;
  if (!first.abscissa.unit.empty() && !known) {
    recording.notes.push_back(
        {"time_unit",
         "the abscissa's unit \"" + first.abscissa.unit + "\" is no unit of time: taken as seconds",
         ""});
  }
  if (first.even) {
    recording.sample_rate_hz = rate_of(first) / to_seconds;
    recording.start_time_s =
        exact_or(first.abscissa_start, first.noted("start", first.abscissa_start)) * to_seconds;
    return;
  }
  const Eigen::VectorXd time = first.x * to_seconds;
  TimeAxisOptions options;
  // Single-precision times carry seven digits of the latest one.
  const double latest = time.cwiseAbs().maxCoeff();
  options.printed_resolution_s =
      std::isfinite(latest) ? latest * (first.binary && !first.single_precision ? 1e-15 : 1e-5) : 0;
  const TimeAxis axis = time_axis(time, options);
  if (axis.missing > 0) {
    throw RecordingError({recording.path.string(), first.line, 0, "", ""}, "some times are missing",
                         "export the recording again");
  }
  take_times(axis, {time, options.printed_resolution_s, "", "", first.abscissa.label, 0},
             recording);
  recording.sample_rate_hz = first.noted("rate", recording.sample_rate_hz);
}

FrfUnit scale_of(const Uff58& f) {
  FrfUnit scale;
  const auto numerator = parse_unit(f.ordinate.unit);
  const auto denominator = parse_unit(f.denominator.unit);
  // "(m/s^2)/N" fits the label of 20 characters; brackets around the whole do not matter.
  if (const auto whole = parse_frf_unit(f.ordinate.unit)) {
    scale = *whole;
  } else if (numerator) {
    scale.factor = numerator->factor / (denominator ? denominator->factor : 1);
    scale.form = frf_form_of(numerator->quantity);
    scale.unit = denominator                     ? "(" + numerator->si + ")/" + denominator->si
                 : f.denominator.data_type == 13 ? "(" + numerator->si + ")/N"
                                                 : numerator->si;
  }
  if (scale.form == FrfForm::unknown) {
    scale.form = frf_form_of(uff58_quantity(f.ordinate.data_type));
  }
  return scale;
}

Eigen::VectorXd frequencies_of(const Uff58& f) {
  if (!f.even) return f.x;
  double start = f.abscissa_start, step = f.abscissa_step;
  const double exact_start = f.noted("x0", start), exact_step = f.noted("dx", step);
  if (exact_or(step, exact_step) == exact_step && exact_or(start, exact_start) == exact_start) {
    start = exact_start, step = exact_step;
  }
  const Eigen::Index n = f.real.size();
  return start + step * Eigen::ArrayXd::LinSpaced(n, 0, static_cast<double>(n - 1));
}

/// FRFs of a universal file, and the functions beside them.
class FrfCollector {
 public:
  FrfCollector(const Uff58File& file, std::string name) : file_(file), name_(std::move(name)) {}

  FrfSet collect() {
    for (const auto& f : file_.functions) sort_in(f);
    if (frfs_.empty()) {
      throw refusal(file_.functions.empty() ? nullptr : &file_.functions.front(),
                    "holds no frequency response function (dataset 58, function type 4, complex)",
                    "estimate them with `frf`, or give the recordings themselves");
    }
    first_ = frfs_.front().function;
    take_frequencies();
    take_frfs();
    drop_zero_line();
    fill(coherences_, set_.coherence, false, "coherence");
    fill(deviations_, set_.H_std, true, "standard deviation");
    if (set_.unit.empty()) {
      note("no_unit", "the FRFs have no unit: the numbers are kept as they are");
    }
    const auto positive = [&](const char* key) { return std::max(0.0, first_->noted(key)); };
    set_.averages = static_cast<int>(std::min(positive("averages"), 1e9));
    set_.sample_rate_hz = positive("rate");
    set_.exponential_decay_rate_1_s = positive("decay");
    set_.pre_trigger_s = positive("pre");
    set_.force_noise_span_s = positive("span");
    set_.sample_rate_relative_std = positive("rate_u");
    for (const auto& text : file_.remarks) note("uff_remark", text);
    return std::move(set_);
  }

 private:
  struct Placed {
    const Uff58* function = nullptr;
    std::size_t response = 0, input = 0;
  };

  RecordingError refusal(const Uff58* f, std::string problem, std::string remedy) const {
    return {{name_, f == nullptr ? 1 : f->line, 0, "", ""}, std::move(problem), std::move(remedy)};
  }
  void note(const char* code, const std::string& message) {
    set_.notes.push_back({code, message, ""});
  }
  [[nodiscard]] Eigen::Index column_of(const Placed& placed) const {
    return set_.column(static_cast<Eigen::Index>(placed.response),
                       static_cast<Eigen::Index>(placed.input));
  }

  /// Place of the point in the list, added when it is new. `full_name`: of our own files.
  static std::size_t place(std::vector<MeasuredPoint>& points, const Uff58Point& point,
                           const std::string& full_name) {
    std::string name = full_name.empty() ? point.entity : full_name;
    if (full_name.empty() && (point.node != 0 || name.empty())) {
      name += (name.empty() ? "" : " ") + point_text(point);
    }
    const auto same = std::find_if(points.begin(), points.end(), [&](const MeasuredPoint& p) {
      return p.name == name && p.node == point.node && p.direction == point.direction;
    });
    const auto at = static_cast<std::size_t>(same - points.begin());
    if (same == points.end()) points.push_back({name, point.node, point.direction});
    return at;
  }

  void sort_in(const Uff58& f) {
    const auto what = f.remark.find("what");
    std::vector<Placed>* list = nullptr;
    if (f.function_type == uff58_function::kFrf && f.complex) list = &frfs_;
    if (f.function_type == uff58_function::kCoherence && !f.complex) list = &coherences_;
    if (f.function_type == uff58_function::kGeneral && what != f.remark.end() &&
        what->second == "std") {
      list = &deviations_;
    }
    if (list == nullptr) return;
    const bool ours = !f.remark.empty();
    list->push_back({&f, place(set_.responses, f.response, ours ? f.id[0] : ""),
                     place(set_.inputs, f.reference, ours ? f.id[1] : "")});
  }

  void take_frequencies() {
    set_.frequency_hz = frequencies_of(*first_);
    const auto unit = parse_unit(first_->abscissa.unit);
    if (unit && unit->si == "rad/s") set_.frequency_hz /= 2 * std::numbers::pi;
    if (unit && unit->si == "Hz") set_.frequency_hz *= unit->factor;
    const Eigen::Index n = set_.frequency_hz.size();
    if (!set_.frequency_hz.allFinite() ||
        !(set_.frequency_hz.tail(n - 1).array() > set_.frequency_hz.head(n - 1).array()).all()) {
      throw refusal(first_, "the frequencies do not rise", "export the FRFs again");
    }
  }

  void check_lines(const Uff58& f) const {
    const Eigen::VectorXd x = frequencies_of(f), of_first = frequencies_of(*first_);
    if (x.size() == of_first.size() && x.allFinite() &&
        (x - of_first).cwiseAbs().maxCoeff() <=
            1e-6 * std::max(1e-300, of_first.cwiseAbs().maxCoeff())) {
      return;
    }
    throw refusal(&f,
                  fmt::format("has other frequencies than the first FRF (line {})", first_->line),
                  "give functions over the same lines");
  }

  void take_frfs() {
    const auto columns = static_cast<Eigen::Index>(set_.responses.size() * set_.inputs.size());
    if (columns > static_cast<Eigen::Index>(4 * frfs_.size())) {
      throw refusal(first_, "most of the FRFs between the points named are absent",
                    "give FRFs of all responses to all inputs");
    }
    const FrfUnit unit = scale_of(*first_);
    set_.form = unit.form;
    set_.unit = unit.unit;
    set_.H.resize(set_.frequency_hz.size(), columns);
    factors_.assign(static_cast<std::size_t>(columns), kNaN);
    for (const auto& placed : frfs_) {
      const Uff58& f = *placed.function;
      check_lines(f);
      const FrfUnit own = scale_of(f);
      if (unit.form != own.form) {
        throw refusal(&f, "is of another form (receptance, mobility, accelerance) than the first",
                      "convert all FRFs to one form first");
      }
      const Eigen::Index column = column_of(placed);
      double& factor = factors_[static_cast<std::size_t>(column)];
      if (!std::isnan(factor)) {
        throw refusal(
            &f,
            fmt::format("is a second FRF from \"{}\" to \"{}\"", set_.inputs[placed.input].name,
                        set_.responses[placed.response].name),
            "keep one of the two");
      }
      factor = own.factor;
      set_.H.col(column).real() = factor * f.real;
      set_.H.col(column).imag() = factor * f.imag;
    }
    for (std::size_t r = 0; r < set_.responses.size(); ++r) {
      for (std::size_t i = 0; i < set_.inputs.size(); ++i) {
        if (!std::isnan(factors_[static_cast<std::size_t>(column_of({nullptr, r, i}))])) continue;
        throw refusal(first_,
                      fmt::format("no FRF from \"{}\" to \"{}\"", set_.inputs[i].name,
                                  set_.responses[r].name),
                      "give FRFs of all responses to all inputs");
      }
    }
  }

  /// A line of zero frequency is often not a number in mobility; elsewhere it is a fault.
  void drop_zero_line() {
    if (set_.H.allFinite()) return;
    const Eigen::Index lines = set_.H.rows();
    if (set_.frequency_hz[0] != 0 || lines < 2 || !set_.H.bottomRows(lines - 1).allFinite()) {
      throw refusal(first_, "an FRF holds values that are no numbers", "export the FRFs again");
    }
    set_.H = Eigen::MatrixXcd(set_.H.bottomRows(lines - 1));
    set_.frequency_hz = Eigen::VectorXd(set_.frequency_hz.tail(lines - 1));
    note("data_left_out", "the line at 0 Hz is no number and is left out");
  }

  void fill(const std::vector<Placed>& from, Eigen::MatrixXd& into, bool scaled,
            const std::string& what) {
    if (from.empty()) return;
    if (static_cast<Eigen::Index>(from.size()) != set_.H.cols()) {
      note("incomplete", what + " of some FRFs only: left out");
      return;
    }
    into = Eigen::MatrixXd::Zero(set_.H.rows(), set_.H.cols());
    for (const auto& placed : from) {
      check_lines(*placed.function);
      const Eigen::Index column = column_of(placed);
      into.col(column) = placed.function->real.tail(set_.H.rows()) *
                         (scaled ? factors_[static_cast<std::size_t>(column)] : 1.0);
    }
    if (into.allFinite()) return;
    note("not_a_number", what + " holds values that are no numbers: left out");
    into.resize(0, 0);
  }

  const Uff58File& file_;
  const std::string name_;
  const Uff58* first_ = nullptr;
  std::vector<Placed> frfs_, coherences_, deviations_;
  std::vector<double> factors_;  ///< to SI, by column; NaN: no FRF
  FrfSet set_;
};

}  // namespace

Recording read_uff(std::string_view bytes, const std::filesystem::path& path,
                   const ReadOptions& options, const std::function<void(std::size_t)>& done_with) {
  const std::string name = path.string();
  const Uff58File file = read_uff58(bytes, name, done_with);
  Recording recording;
  recording.path = path;
  Functions histories;
  for (const auto& f : file.functions) {
    if (is_time_history(f)) histories.push_back(&f);
  }
  if (histories.empty()) {
    const bool any = !file.functions.empty();
    throw RecordingError(
        {name, any ? file.functions.front().line : 1, 0, "", ""},
        any ? "holds no time history, but: " + kinds_in(file) : "holds no dataset 58",
        "give a recording over time (FRFs are taken by `modal`)");
  }
  const double written = histories.front()->noted("channels");
  if (written > static_cast<double>(histories.size())) {
    throw RecordingError({name, histories.back()->line, 0, "", ""},
                         fmt::format("breaks off: it was written with {} channels and holds {}",
                                     written, histories.size()),
                         "copy the file again");
  }
  if (const std::size_t others = file.functions.size() - histories.size(); others > 0) {
    recording.notes.push_back(
        {"left_out",
         fmt::format("{} functions that are no time histories are left out (the file holds: {})",
                     others, kinds_in(file)),
         ""});
  }
  const Functions taken = of_one_form(histories, recording.notes);
  take_channels(file, taken, bytes.size(), recording);
  take_abscissa(*taken.front(), recording);
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
  Functions all;
  bool is_complex = false;
  for (const auto& f : file.functions) {
    if (is_time_history(f)) return read_uff(bytes, path);
    all.push_back(&f);
    is_complex |= f.complex;
  }
  Recording recording;
  recording.path = path;
  take_channels(file, all, bytes.size(), recording);
  recording.notes.push_back({"not_a_time_history", "holds: " + kinds_in(file), ""});
  if (is_complex) {
    recording.notes.push_back({"magnitudes", "complex functions are given by magnitude", ""});
  }
  note_unitless(recording);
  return recording;
}

FrfSet read_uff_frfs(std::string_view bytes, const std::filesystem::path& path) {
  const Uff58File file = read_uff58(bytes, path.string());
  return FrfCollector(file, path.string()).collect();
}

FrfSet read_uff_frfs(const std::filesystem::path& path) {
  const MappedFile file(path);
  return read_uff_frfs(file.bytes(), path);
}

}  // namespace rigfit::signal
