#include "signal/writers/write_uff.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <complex>
#include <cstdint>
#include <cstring>
#include <map>

#include "signal/readers/uff/uff58.h"
#include "signal/recording/units.h"

namespace rigfit::signal {
namespace {

constexpr const char* kMark = "    -1\n";

/// At most `width` bytes of plain ASCII, NONE for nothing: fixed columns know no other.
std::string fixed(std::string_view text, std::size_t width) {
  std::string out;
  for (std::size_t k = 0; k < text.size() && out.size() < width; ++k) {
    const auto c = static_cast<unsigned char>(text[k]);
    if (c < 0x80) {
      out += c < 0x20 ? ' ' : text[k];
    } else if ((c & 0xC0) == 0xC0) {
      out += '?';  // one for each character, none for its further bytes
    }
  }
  while (!out.empty() && out.front() == ' ') out.erase(0, 1);
  return out.empty() ? "NONE" : out;
}

/// An identification line: UTF-8 is kept, cut between characters, padded to 80 columns.
std::string id_line(std::string_view text) {
  std::string out;
  for (std::size_t k = 0; k < text.size();) {
    std::size_t next = k + 1;
    while (next < text.size() && (static_cast<unsigned char>(text[next]) & 0xC0) == 0x80) ++next;
    if (out.size() + next - k > 80) break;
    out += text.substr(k, next - k);
    k = next;
  }
  for (char& c : out) {
    if (static_cast<unsigned char>(c) < 0x20) c = ' ';
  }
  if (out.find_first_not_of(' ') == std::string::npos) out = "NONE";
  if (out.size() < 80) out.append(80 - out.size(), ' ');
  return out + '\n';
}

std::string axis_line(const Uff58Axis& axis) {
  return fmt::format("{:10d}{:5d}{:5d}{:5d} {:<20s} {:<20s}\n", axis.data_type, axis.exponents[0],
                     axis.exponents[1], axis.exponents[2], fixed(axis.label, 20),
                     fixed(axis.unit, 20));
}

/// 13 columns: six digits, or five behind a minus sign, where the seventh has no room.
std::string e13(double value) {
  std::string text = fmt::format("{:13.6e}", value);
  return text.size() > 13 ? fmt::format("{:13.5e}", value) : text;
}

void append_double(std::string& out, double value) {
  auto bits = std::bit_cast<std::uint64_t>(value);
  if constexpr (std::endian::native == std::endian::big) bits = __builtin_bswap64(bits);
  std::array<char, 8> bytes{};
  std::memcpy(bytes.data(), &bits, 8);
  out.append(bytes.data(), bytes.size());
}

void append_float(std::string& out, double value) {
  auto bits = std::bit_cast<std::uint32_t>(static_cast<float>(value));
  if constexpr (std::endian::native == std::endian::big) bits = __builtin_bswap32(bits);
  std::array<char, 4> bytes{};
  std::memcpy(bytes.data(), &bits, 4);
  out.append(bytes.data(), bytes.size());
}

/// Text behind `{:20.12e}`; what is no number as NaN.
void append_e20(std::string& out, double value) {
  if (std::isfinite(value)) {
    fmt::format_to(std::back_inserter(out), "{:20.12e}", value);
  } else {
    out += "                 NaN";
  }
}

void append_function(std::string& out, const Uff58& f, UffEncoding encoding) {
  const Eigen::Index n = f.real.size();
  const int values = (f.complex ? 2 : 1) + (f.even ? 0 : 1);
  const bool binary = encoding != UffEncoding::ascii;
  const bool single = encoding == UffEncoding::binary_single;
  const Eigen::Index bytes = single ? 4 : 8;
  out += kMark;
  if (binary) {
    // Byte order 1 (little endian), floating-point format 2 (IEEE 754), 11 lines of text.
    out += fmt::format("    58b{:6d}{:6d}{:12d}{:12d}{:6d}{:6d}{:12d}{:12d}\n", 1, 2, 11,
                       bytes * values * n, 0, 0, 0, 0);
  } else {
    out += fmt::format("    58{:74s}\n", "");
  }
  for (const auto& line : f.id) out += id_line(line);
  out +=
      fmt::format("{:5d}{:10d}{:5d}{:10d} {:<10s}{:10d}{:4d} {:<10s}{:10d}{:4d}\n", f.function_type,
                  0, 0, 0, fixed(f.response.entity, 10), f.response.node, f.response.direction,
                  fixed(f.reference.entity, 10), f.reference.node, f.reference.direction);
  out += fmt::format("{:10d}{:10d}{:10d}{}{}{}\n",
                     (f.complex ? 6 : 4) - (single ? (f.complex ? 1 : 2) : 0), n, f.even ? 1 : 0,
                     e13(f.even ? f.abscissa_start : 0), e13(f.even ? f.abscissa_step : 0), e13(0));
  for (const auto& axis : {f.abscissa, f.ordinate, f.denominator, f.z}) out += axis_line(axis);
  if (binary) {
    out.reserve(out.size() + static_cast<std::size_t>(bytes * values * n) + 8);
    const auto append = single ? append_float : append_double;
    for (Eigen::Index k = 0; k < n; ++k) {
      if (!f.even) append(out, f.x[k]);
      append(out, f.real[k]);
      if (f.complex) append(out, f.imag[k]);
    }
  } else {
    // 4E20.12; uneven: 2(E13.5,E20.12) or, complex, E13.5,2E20.12.
    const int per_line = f.even ? (f.complex ? 2 : 4) : (f.complex ? 1 : 2);
    for (Eigen::Index k = 0; k < n; ++k) {
      if (!f.even) out += fmt::format("{:13.5e}", f.x[k]);
      append_e20(out, f.real[k]);
      if (f.complex) append_e20(out, f.imag[k]);
      if ((k + 1) % per_line == 0 || k + 1 == n) out += '\n';
    }
  }
  out += kMark;
}

int direction_code(const std::array<double, 3>& direction) {
  int code = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    if (direction[k] == 0) continue;
    if (code != 0) return 0;  // oblique: has no code
    code = (direction[k] > 0 ? 1 : -1) * static_cast<int>(k + 1);
  }
  return code;
}

Uff58Axis time_axis_record() { return {17, {0, 0, 0}, "Time", "s"}; }
Uff58Axis frequency_axis_record() { return {18, {0, 0, 0}, "Frequency", "Hz"}; }

/// The numerator of the FRF's unit and its specific data type.
Uff58Axis ordinate_of(const FrfSet& frfs) {
  switch (frfs.form) {
    case FrfForm::receptance:
      return {8, {0, 0, 0}, "Receptance", "m"};
    case FrfForm::mobility:
      return {11, {0, 0, 0}, "Mobility", "m/s"};
    case FrfForm::accelerance:
      return {12, {0, 0, 0}, "Accelerance", "m/s^2"};
    case FrfForm::unknown:
      break;
  }
  return {0, {0, 0, 0}, "FRF", frfs.unit};
}

}  // namespace

std::string uff_text(const Recording& recording, UffEncoding encoding, const std::string& remark) {
  std::string out;
  const double rate = recording.sample_rate_hz;
  for (const auto& channel : recording.channels) {
    Uff58 f;
    f.function_type = uff58_function::kTimeResponse;
    f.even = recording.time_s.size() == 0 && rate > 0;
    f.id[0] = channel.name;
    f.id[1] = remark;
    f.id[3] =
        fmt::format("rigfit rate={} start={} channels={}{}", rate, recording.start_time_s,
                    recording.channels.size(),
                    channel.nominal_range > 0 ? fmt::format(" range={}", channel.nominal_range)
                                              : std::string());
    f.response.entity = channel.name;
    f.response.direction = direction_code(channel.direction);
    f.abscissa = time_axis_record();
    f.ordinate = {
        uff58_data_type(channel.quantity), {0, 0, 0}, name_of(channel.quantity), channel.unit};
    f.real = channel.samples;
    if (f.even) {
      f.abscissa_start = recording.start_time_s;
      f.abscissa_step = 1 / rate;
    } else if (recording.time_s.size() == channel.samples.size()) {
      f.x = recording.time_s;
    } else {
      // No rate is known: the samples are numbered, a step of zero would be none.
      f.x = Eigen::VectorXd::LinSpaced(f.real.size(), 0, static_cast<double>(f.real.size() - 1));
      f.abscissa = {0, {0, 0, 0}, "Sample", ""};
    }
    append_function(out, f, encoding);
  }
  return out;
}

std::string uff_text(const FrfSet& frfs, UffEncoding encoding) {
  std::string out;
  const Eigen::Index lines = frfs.frequency_hz.size();
  // Evenly spaced where start + k step gives the frequencies back but for rounding.
  double start = 0, step = 0;
  bool even = lines > 0;
  if (lines > 0) {
    start = frfs.frequency_hz[0];
    step = lines > 1 ? (frfs.frequency_hz[lines - 1] - start) / static_cast<double>(lines - 1) : 1;
    for (Eigen::Index k = 0; k < lines && even; ++k) {
      even = step > 0 && std::abs(start + static_cast<double>(k) * step - frfs.frequency_hz[k]) <=
                             1e-12 * frfs.frequency_hz[lines - 1];
    }
  }
  for (std::size_t r = 0; r < frfs.responses.size(); ++r) {
    for (std::size_t i = 0; i < frfs.inputs.size(); ++i) {
      const Eigen::Index column =
          frfs.column(static_cast<Eigen::Index>(r), static_cast<Eigen::Index>(i));
      Uff58 f;
      f.even = even;
      f.abscissa_start = start;
      f.abscissa_step = step;
      if (!even) f.x = frfs.frequency_hz;
      f.response = {frfs.responses[r].name, frfs.responses[r].node, frfs.responses[r].direction};
      f.reference = {frfs.inputs[i].name, frfs.inputs[i].node, frfs.inputs[i].direction};
      f.id[0] = frfs.responses[r].name;
      f.id[1] = frfs.inputs[i].name;
      const std::string about =
          fmt::format("averages={} rate={} decay={} pre={:.6g}", frfs.averages, frfs.sample_rate_hz,
                      frfs.exponential_decay_rate_1_s, frfs.pre_trigger_s);
      // A line holds 80 characters.
      f.id[4] = fmt::format("rigfit x0={} dx={} span={:.4g}", start, step, frfs.force_noise_span_s);
      if (frfs.sample_rate_relative_std > 0) {
        f.id[4] += fmt::format(" rate_u={:.2g}", frfs.sample_rate_relative_std);
      }
      f.abscissa = frequency_axis_record();

      f.function_type = uff58_function::kFrf;
      f.complex = true;
      f.id[3] = "rigfit what=frf " + about;
      f.ordinate = ordinate_of(frfs);
      f.denominator =
          frfs.form == FrfForm::unknown ? Uff58Axis{} : Uff58Axis{13, {0, 0, 0}, "Force", "N"};
      f.real = frfs.H.col(column).real();
      f.imag = frfs.H.col(column).imag();
      append_function(out, f, encoding);

      f.complex = false;
      f.imag.resize(0);
      if (frfs.coherence.size() > 0) {
        f.function_type = uff58_function::kCoherence;
        f.id[3] = "rigfit what=coherence " + about;
        f.real = frfs.coherence.col(column);
        Uff58 c = f;
        c.ordinate = {0, {0, 0, 0}, "Coherence", ""};
        c.denominator = {};
        append_function(out, c, encoding);
      }
      if (frfs.H_std.size() > 0) {
        f.function_type = uff58_function::kGeneral;
        f.id[3] = "rigfit what=std " + about;
        f.ordinate.label = "Std of re and of im";
        f.real = frfs.H_std.col(column);
        append_function(out, f, encoding);
      }
    }
  }
  return out;
}

std::string uff_text(const ModalModel& modes, const std::vector<NodePosition>& positions) {
  std::string out;
  if (!positions.empty()) {
    out += kMark;
    out += fmt::format("    15{:74s}\n", "");
    for (const auto& p : positions) {
      out += fmt::format("{:10d}{:10d}{:10d}{:10d}{:13.5e}{:13.5e}{:13.5e}\n", p.node, 0, 0, 0,
                         p.position_m[0], p.position_m[1], p.position_m[2]);
    }
    out += kMark;
  }
  // Responses by node; a point without a node gets its place in the list.
  std::vector<int> node(modes.responses.size());
  for (std::size_t r = 0; r < node.size(); ++r) {
    node[r] = modes.responses[r].node != 0 ? modes.responses[r].node : static_cast<int>(r) + 1;
  }
  for (std::size_t m = 0; m < modes.modes.size(); ++m) {
    const IdentifiedMode& mode = modes.modes[m];
    std::complex<double> modal_a = 0;
    for (std::size_t r = 0; r < modes.responses.size() && modal_a == 0.0; ++r) {
      for (std::size_t i = 0; i < modes.inputs.size(); ++i) {
        const auto& response = modes.responses[r];
        const auto& input = modes.inputs[i];
        const bool driving = response.node != 0 && response.node == input.node &&
                             std::abs(response.direction) == std::abs(input.direction);
        const auto row = static_cast<Eigen::Index>(r), col = static_cast<Eigen::Index>(i);
        if (!driving || row >= mode.shape.size() || col >= mode.participation.size()) continue;
        if (mode.participation[col] == 0.0) continue;
        const double sign = response.direction == input.direction ? 1 : -1;
        modal_a = sign * mode.shape[row] / mode.participation[col];
        break;
      }
    }
    out += kMark;
    out += fmt::format("    55{:74s}\n", "");
    out += id_line(fmt::format("mode {}", m + 1));
    out += id_line(fmt::format("frequency {:.6g} Hz, damping ratio {:.4g}", mode.frequency_hz.value,
                               mode.damping_ratio.value));
    out += id_line("NONE") + id_line("NONE") + id_line("NONE");
    // Structural model, complex eigenvalue of first order, three translations, displacement,
    // complex values, three a node.
    out += fmt::format("{:10d}{:10d}{:10d}{:10d}{:10d}{:10d}\n", 1, 3, 2, 8, 5, 3);
    out += fmt::format("{:10d}{:10d}{:10d}{:10d}\n", 2, 6, 1, m + 1);
    out += fmt::format("{:13.5e}{:13.5e}{:13.5e}{:13.5e}{:13.5e}{:13.5e}\n", mode.pole_rad_s.real(),
                       mode.pole_rad_s.imag(), modal_a.real(), modal_a.imag(), 0.0, 0.0);
    std::map<int, std::array<std::complex<double>, 3>> at_node;
    for (std::size_t r = 0; r < node.size(); ++r) {
      const auto row = static_cast<Eigen::Index>(r);
      if (row >= mode.shape.size()) continue;
      const int direction = modes.responses[r].direction;
      const int axis = std::abs(direction);
      const std::size_t place = axis >= 1 && axis <= 3 ? static_cast<std::size_t>(axis - 1) : 2;
      at_node[node[r]][place] = (direction < 0 ? -1.0 : 1.0) * mode.shape[row];
    }
    for (const auto& [number, values] : at_node) {
      out += fmt::format("{:10d}\n", number);
      for (const auto& v : values) out += fmt::format("{:13.5e}{:13.5e}", v.real(), v.imag());
      out += '\n';
    }
    out += kMark;
  }
  return out;
}

}  // namespace rigfit::signal
