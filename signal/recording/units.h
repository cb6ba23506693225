// Parses units as people and loggers write them: factor and offset to SI, SI symbol, quantity.
//
// Accepted: products and quotients of (prefixed) symbols with exponents in any usual spelling
// ("m/s2", "m/s^2", "m/s**2", "ms-2", "m.s^-2", "N*m", "(kN)", "[mm]"), names ("Newtons", "volt"),
// superscripts and the micro and degree signs in UTF-8, in Latin-1 and in the usual mangled forms.
// "g", "gn", "mg" are standard gravity (9.80665 m/s^2, ISO 80000-3), never gram; "lb" and "lbs" are
// pounds-force, as load cells mean it; "kg" is mass, "kgf" and "kp" are forces.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace rigfit::signal {

/// The physical quantity that a channel, a unit or a sensor stands for.
enum class Quantity {
  unknown,
  time,
  force,
  acceleration,
  velocity,
  displacement,
  angle,
  angular_velocity,
  angular_acceleration,
  torque,
  strain,
  pressure,
  temperature,
  voltage,
};

/// The word used in JSON and messages, such as "acceleration".
[[nodiscard]] const char* name_of(Quantity quantity);
/// Its SI symbol, such as "m/s^2"; empty for `unknown`.
[[nodiscard]] const char* si_of(Quantity quantity);

/// value in SI = factor * number + offset.
struct Unit {
  std::string si;  ///< "m/s^2", "N", "V", "rad/s" ...; "1" for a pure number such as strain
  double factor = 1;
  double offset = 0;  ///< temperatures only (degC, degF)
  Quantity quantity = Quantity::unknown;
};

/// Empty when the text is no unit we know (also for "", "-", "NONE", "EU").
[[nodiscard]] std::optional<Unit> parse_unit(std::string_view text);

/// "mV/N" as mV and N.
struct UnitQuotient {
  std::string over_text;
  Unit over, under;
};
/// At the first slash that parts two units, of which the second is of this quantity (`unknown`: of
/// any). Empty: none does.
[[nodiscard]] std::optional<UnitQuotient> parse_quotient(const std::string& text,
                                                         Quantity below = Quantity::unknown);

/// A column title split into the name and the unit written with it.
struct TitledUnit {
  std::string name;
  std::string unit;  ///< as written, without brackets; empty: none
};

/// "Force [N]", "Force (N)", "Force / N", "Force, N" -> {"Force", "N"}; "rate_gyro_V" ->
/// {"rate_gyro_V", "V"} (a suffix stays part of the name). Brackets are taken as a unit even when
/// it is unknown ("Load (counts)"); the other forms only when it is known.
[[nodiscard]] TitledUnit split_title(std::string_view title);

/// Valid UTF-8 of text in UTF-8 or, where it is not that, in Latin-1. Control characters become
/// blanks.
[[nodiscard]] std::string to_utf8(std::string_view bytes);
[[nodiscard]] std::string_view trim_blanks(std::string_view s);
[[nodiscard]] std::string lower_case(std::string_view s);
/// Whether "|a|b|" lists the word.
[[nodiscard]] bool is_listed(std::string_view list, const std::string& word);

}  // namespace rigfit::signal
