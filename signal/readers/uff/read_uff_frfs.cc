#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "signal/readers/files/frf_unit.h"
#include "signal/readers/files/mapped_file.h"
#include "signal/readers/uff/read_uff.h"
#include "signal/readers/uff/uff58.h"
#include "signal/readers/uff/uff58_remark.h"
#include "signal/recording/recording_error.h"
#include "signal/recording/units.h"

namespace rigfit::signal {
namespace {

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
  static constexpr const char* kAxes[] = {"", "X", "Y", "Z", "RX", "RY", "RZ"};
  std::string name = point.entity;
  if (point.node != 0 || name.empty()) {
    name += (name.empty() ? "" : " ") + std::to_string(point.node);
    if (point.direction != 0 && std::abs(point.direction) <= 6) {
      name += std::string(point.direction > 0 ? "+" : "-") + kAxes[std::abs(point.direction)];
    }
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
    set.notes.push_back({"line_left_out", "the line at 0 Hz is no number and is left out", ""});
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
  set.sample_rate_relative_std = std::max(0.0, remark_number(more, "rate_u", 0));
  for (const auto& text : file.remarks) set.notes.push_back({"uff_remark", text, ""});
  return set;
}

FrfSet read_uff_frfs(const std::filesystem::path& path) {
  const MappedFile file(path);
  return read_uff_frfs(file.bytes(), path);
}

}  // namespace rigfit::signal
