#include <fmt/format.h>
#include <fmt/ranges.h>

#include <bit>
#include <cctype>
#include <initializer_list>
#include <iterator>

#include "signal/readers/uff58.h"
#include "signal/writers/writers.h"

namespace rigfit::signal {
namespace {

/// Quoted when it would break the table.
std::string cell(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (char c : text) {
    if (c == '"') quoted += '"';
    quoted += c == '\n' || c == '\r' ? ' ' : c;
  }
  return quoted + "\"";
}

constexpr const char* kMark = "    -1\n";

/// How a dataset of text begins.
std::string head(int number) { return fmt::format("{}{:6d}{:74s}\n", kMark, number, ""); }

/// Numbers of a record, I10 and 1PE13.5.
std::string whole(std::initializer_list<int> values) {
  return fmt::format("{:10d}", fmt::join(values, ""));
}
std::string numbers(std::initializer_list<double> values) {
  return fmt::format("{:13.5e}", fmt::join(values, ""));
}

/// Text of exactly `width` bytes, NONE for nothing: UTF-8 cut between characters or, in fixed
/// columns, which other programs count by characters, a '?' for each that is not ASCII.
std::string padded(std::string_view text, std::size_t width, bool ascii = true) {
  std::string out;
  for (std::size_t k = 0, next = 0; k < text.size(); k = next) {
    while (++next < text.size() && (static_cast<unsigned char>(text[next]) & 0xC0) == 0x80) {
    }
    const bool plain = next == k + 1 && static_cast<unsigned char>(text[k]) < 0x80;
    std::string_view one = text.substr(k, next - k);
    if (ascii && !plain) one = "?";
    if (plain && one[0] < ' ') one = " ";
    if (out.size() + one.size() > width) break;
    if (one != " " || !out.empty()) out += one;
  }
  if (out.empty()) out = "NONE";
  out.resize(width, ' ');
  return out;
}

std::string id_line(std::string_view text) { return padded(text, 80, false) + '\n'; }

std::string axis_line(const Uff58Axis& axis) {
  return fmt::format("{:10d}    0    0    0 {} {}\n", axis.data_type, padded(axis.label, 20),
                     padded(axis.unit, 20));
}

/// 13 columns: six digits, or five behind a minus sign, where the seventh has no room.
std::string e13(double value) {
  return fmt::format("{:13.{}e}", value, std::signbit(value) ? 5 : 6);
}

template <typename Number>
void append_binary(std::string& out, double value) {
  const auto bytes = std::bit_cast<std::array<char, sizeof(Number)>>(static_cast<Number>(value));
  out.append(bytes.data(), bytes.size());
}

void append_function(std::string& out, const Uff58& f) {
  const Index n = f.real.size();
  const int values = (f.complex ? 2 : 1) + (f.even ? 0 : 1);
  const bool single = f.function_type == uff58_function::time_response && f.even;
  const Index bytes = n * values * (single ? 4 : 8);
  // Byte order (1: little, 2: big endian), floating-point format 2 (IEEE 754), 11 lines of text.
  out += fmt::format("{}    58b{:6d}{:6d}{:12d}{:12d}{:6d}{:6d}{:12d}{:12d}\n", kMark,
                     std::endian::native == std::endian::little ? 1 : 2, 2, 11, bytes, 0, 0, 0, 0);
  for (const auto& line : f.id) out += id_line(line);
  out += fmt::format("{:5d}{:10d}{:5d}{:10d}", f.function_type, 0, 0, 0);
  for (const auto& at : {f.response, f.reference}) {
    out += fmt::format(" {}{:10d}{:4d}", padded(at.name, 10), at.node, at.direction);
  }
  out += '\n';
  out += fmt::format("{:10d}{:10d}{:10d}{}{}{}\n",
                     (f.complex ? 6 : 4) - (single ? (f.complex ? 1 : 2) : 0), n, f.even ? 1 : 0,
                     e13(f.even ? f.abscissa_start : 0), e13(f.even ? f.abscissa_step : 0), e13(0));
  for (const auto& axis : {f.abscissa, f.ordinate, f.denominator, Uff58Axis{}})
    out += axis_line(axis);
  out.reserve(out.size() + static_cast<std::size_t>(bytes) + 8);
  const auto append = single ? append_binary<float> : append_binary<double>;
  for (Index k = 0; k < n; ++k) {
    if (!f.even) append(out, f.x[k]);
    append(out, f.real[k]);
    if (f.complex) append(out, f.imag[k]);
  }
  out += kMark;
}

/// The numerator of the FRF's unit and its specific data type.
Uff58Axis ordinate_of(const FrfSet& frfs) {
  if (frfs.form == FrfForm::unknown) return {0, "FRF", frfs.unit};
  std::string label = name_of(frfs.form);
  label.front() = static_cast<char>(std::toupper(label.front()));
  const Quantity response = response_of(frfs.form);
  return {uff58_data_type(response), label, si_of(response)};
}

}  // namespace

std::string uff_text(const Recording& recording, const std::string& remark) {
  std::string out;
  const double rate = recording.sample_rate_hz;
  for (const auto& channel : recording.channels) {
    Uff58 f;
    f.function_type = uff58_function::time_response;
    f.even = recording.time_s.size() == 0;
    f.id[0] = channel.name;
    f.id[1] = remark;
    f.id[3] =
        fmt::format("rigfit rate={} start={} channels={}{}", rate, recording.start_time_s,
                    recording.channels.size(),
                    channel.nominal_range > 0 ? fmt::format(" range={}", channel.nominal_range)
                                              : std::string());
    f.response.name = channel.name;
    f.response.direction = uff58_direction(channel.direction);
    f.abscissa = {17, "Time", "s"};
    f.ordinate = {uff58_data_type(channel.quantity), name_of(channel.quantity), channel.unit};
    f.real = channel.samples;
    f.x = recording.time_s;
    f.abscissa_start = recording.start_time_s;
    f.abscissa_step = rate > 0 ? 1 / rate : 0;
    append_function(out, f);
  }
  return out;
}

std::string uff_text(const FrfSet& frfs) {
  std::string out;
  const Index lines = frfs.frequency_hz.size();
  // Evenly spaced where start + k step gives the frequencies back but for rounding.
  if (lines == 0) return out;
  const auto last = static_cast<double>(lines - 1);
  const double start = frfs.frequency_hz[0], end = frfs.frequency_hz[lines - 1];
  const double step = lines > 1 ? (end - start) / last : 1;
  const ArrayXd departure =
      start + step * ArrayXd::LinSpaced(lines, 0, last) - frfs.frequency_hz.array();
  const bool even = step > 0 && departure.abs().maxCoeff() <= 1e-12 * end;
  for (std::size_t r = 0; r < frfs.responses.size(); ++r) {
    for (std::size_t i = 0; i < frfs.inputs.size(); ++i) {
      const MeasuredPoint &response = frfs.responses[r], &input = frfs.inputs[i];
      const Index column = frfs.column(static_cast<Index>(r), static_cast<Index>(i));
      Uff58 common;
      common.even = even;
      common.abscissa_start = start;
      common.abscissa_step = step;
      if (!even) common.x = frfs.frequency_hz;
      common.response = response;
      common.reference = input;
      common.id[0] = response.name;
      common.id[1] = input.name;
      // A line holds 80 characters.
      common.id[4] =
          fmt::format("rigfit x0={} dx={} span={:.4g}", start, step, frfs.force_noise_span_s);
      if (frfs.sample_rate_relative_std > 0) {
        common.id[4] += fmt::format(" rate_u={:.2g}", frfs.sample_rate_relative_std);
      }
      common.abscissa = {18, "Frequency", "Hz"};
      const auto append = [&](int type, const char* what, const Uff58Axis& ordinate, bool per_force,
                              const Ref<const VectorXd>& real, const VectorXd& imag = {}) {
        Uff58 f = common;
        f.function_type = type;
        f.complex = imag.size() > 0;
        f.id[3] = fmt::format("rigfit what={} averages={} rate={} decay={} pre={:.6g}", what,
                              frfs.averages, frfs.sample_rate_hz, frfs.exponential_decay_rate_1_s,
                              frfs.pre_trigger_s);
        f.ordinate = ordinate;
        if (per_force) f.denominator = {13, "Force", "N"};
        f.real = real;
        f.imag = imag;
        append_function(out, f);
      };
      const bool has_form = frfs.form != FrfForm::unknown;
      Uff58Axis ordinate = ordinate_of(frfs);
      append(uff58_function::frf, "frf", ordinate, has_form, frfs.H.col(column).real(),
             frfs.H.col(column).imag());
      if (frfs.coherence.size() > 0) {
        append(uff58_function::coherence, "coherence", {0, "Coherence", ""}, false,
               frfs.coherence.col(column));
      }
      if (frfs.H_std.size() > 0) {
        ordinate.label = "Std of re and of im";
        append(uff58_function::general, "std", ordinate, has_form, frfs.H_std.col(column));
      }
    }
  }
  return out;
}

std::string uff_text(const ModalModel& modes, const std::vector<NodePosition>& positions) {
  std::string out;
  if (!positions.empty()) {
    out += head(15);
    for (const auto& p : positions) {
      const auto& [x, y, z] = p.position_m;
      out += whole({p.node, 0, 0, 0}) + numbers({x, y, z}) + '\n';
    }
    out += kMark;
  }
  for (std::size_t m = 0; m < modes.modes.size(); ++m) {
    const IdentifiedMode& mode = modes.modes[m];
    out += head(55);
    out += id_line(fmt::format("mode {}", m + 1));
    out += id_line(fmt::format("frequency {:.6g} Hz, damping ratio {:.4g}", mode.frequency_hz.value,
                               mode.damping_ratio.value));
    for (int k = 0; k < 3; ++k) out += id_line("");
    // Structural model, complex eigenvalue of first order, three translations, displacement,
    // complex values, three a node.
    out += whole({1, 3, 2, 8, 5, 3}) + '\n';
    out += whole({2, 6, 1, static_cast<int>(m) + 1}) + '\n';
    out += numbers({mode.pole_rad_s.real(), mode.pole_rad_s.imag(), 0, 0, 0, 0}) + '\n';
    std::map<int, std::array<Complex, 3>> at_node;
    for (Index r = 0; r < mode.shape.size(); ++r) {
      // A point without a node gets its place in the list, one without a direction is z.
      const MeasuredPoint& point = modes.responses[static_cast<std::size_t>(r)];
      const int node = point.node != 0 ? point.node : static_cast<int>(r) + 1;
      const int axis = std::abs(point.direction);
      at_node[node][axis >= 1 && axis <= 3 ? static_cast<std::size_t>(axis - 1) : 2] =
          (point.direction < 0 ? -1.0 : 1.0) * mode.shape[r];
    }
    for (const auto& [node, values] : at_node) {
      out += whole({node}) + '\n';
      for (const auto& v : values) out += numbers({v.real(), v.imag()});
      out += '\n';
    }
    out += kMark;
  }
  return out;
}

std::string csv_text(const Recording& recording,
                     const std::vector<std::pair<std::string, std::string>>& header, int digits,
                     const std::string& axis) {
  std::string text;
  for (const auto& [key, value] : header) text += cell(key) + "," + cell(value) + "\n";
  text += axis;
  for (const auto& channel : recording.channels) {
    text += ",";
    text += cell(channel.source_unit.empty()
                     ? channel.name
                     : fmt::format("{} ({})", channel.name, channel.source_unit));
  }
  text += "\n";
  const auto out = std::back_inserter(text);
  for (Index i = 0; i < recording.samples(); ++i) {
    // The rate can be read back from times that count from 1970 as well.
    fmt::format_to(out, "{:.15g}", recording.time_at(i));
    for (const auto& channel : recording.channels) {
      text += ',';
      const double value = (channel.samples[i] - channel.si_offset) / channel.si_per_source;
      if (std::isfinite(value)) fmt::format_to(out, "{:.{}g}", value, digits);
    }
    text += '\n';
  }
  return text;
}

}  // namespace rigfit::signal
