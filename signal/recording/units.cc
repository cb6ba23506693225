#include "signal/recording/units.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <pugixml.hpp>

namespace rigfit::signal {
namespace {

// Exponents of metre, kilogram, second, kelvin, volt, radian.
using Dimension = std::array<int, 6>;

/// Units by what they are made of, "|name=factor expression+offset"; '#' and a digit: by themselves
/// (the place in Dimension; 6: strain, 7: a pure number). Those behind a '~' may carry an SI
/// prefix.
constexpr std::string_view kUnits =
    "|~m=#0|kg=#1|~s=#2|K=#3|~V=#4|~rad=#5|~strain=#6|1=#7|g=9.80665 m/s2|~gram=0.001 "
    "kg|grams=gram|"
    "~N=kg m/s2|~Pa=N/m2|~bar=100000 Pa|~J=N m|~Nm=J|~Hz=s-1|~deg=0.017453292519943295 rad|"
    "degC=K+273.15|degF=0.5555555555555556 K+255.37222222222223|"
    "mg=0.00980665 m/s2|ug=9.80665e-06 m/s2|gs=g|Gs=g|gn=g|sec=s|dps=deg/s|nmm=0.001 J|ncm=0.01 J|"
    "eps=strain|ueps=ustrain|%=0.01 1|metre=m|meter=m|millimetre=mm|millimeter=mm|centimetre=cm|"
    "centimeter=cm|micron=um|micrometer=um|newton=N|kilonewton=kN|newtonmeter=Nm|volt=V|"
    "millivolt=mV|microvolt=uV|second=s|msec=ms|millis=ms|micros=us|millisecond=ms|usec=us|"
    "microsecond=us|min=60 s|minute=60 s|h=3600 s|hr=3600 s|hour=3600 s|day=86400 "
    "s|cpm=0.016666666666666666 Hz|hertz=Hz|pascal=Pa|"
    "kilopascal=kPa|megapascal=MPa|radian=rad|degree=deg|c=degC|celsius=degC|centigrade=degC|"
    "fahrenheit=degF|kelvin=K|kilogram=kg|joule=J|microstrain=ustrain|ue=ustrain|g's=g|g0=g|"
    "grav=g|gal=0.01 m/s2|mps=m/s|mps2=m/s2|ips=0.0254 m/s|in=0.0254 m|inch=0.0254 m|"
    "inches=0.0254 m|mil=2.54e-05 m|ft=0.3048 m|foot=0.3048 m|feet=0.3048 m|"
    "rev=6.283185307179586 rad|rpm=0.10471975511965977 rad/s|kgf=9.80665 N|kgforce=9.80665 N|"
    "kp=9.80665 N|lbfft=1.3558179483314 J|lbfin=0.1129848290276 J|gf=0.00980665 N|tf=9806.65 N|"
    "dyn=1e-05 N|lbf=4.4482216152605 N|lb=4.4482216152605 N|pound=4.4482216152605 N|"
    "poundforce=4.4482216152605 N|klbf=4448.2216152605 N|kip=4448.2216152605 N|"
    "lbm=0.45359237 kg|slug=14.593902937206 kg|psi=6894.757293168361 Pa|ksi=6894757.293168361 Pa|"
    "atm=101325 Pa|hpa=100 Pa|dan=10 N|";

struct Kind {
  Quantity quantity;
  const char* name;
  const char* si;
  Dimension dimension;
};
/// In the order of Quantity.
constexpr Kind kKinds[] = {
    {Quantity::unknown, "unknown", "", {}},
    {Quantity::time, "time", "s", {0, 0, 1}},
    {Quantity::force, "force", "N", {1, 1, -2}},
    {Quantity::acceleration, "acceleration", "m/s^2", {1, 0, -2}},
    {Quantity::velocity, "velocity", "m/s", {1, 0, -1}},
    {Quantity::displacement, "displacement", "m", {1}},
    {Quantity::angle, "angle", "rad", {0, 0, 0, 0, 0, 1}},
    {Quantity::angular_velocity, "angular_velocity", "rad/s", {0, 0, -1, 0, 0, 1}},
    {Quantity::angular_acceleration, "angular_acceleration", "rad/s^2", {0, 0, -2, 0, 0, 1}},
    {Quantity::torque, "torque", "N m", {2, 1, -2}},
    {Quantity::strain, "strain", "1", {}},
    {Quantity::pressure, "pressure", "Pa", {-1, 1, -2}},
    {Quantity::temperature, "temperature", "K", {0, 0, 0, 1}},
    {Quantity::voltage, "voltage", "V", {0, 0, 0, 0, 1}},
};

void replace_all(std::string& text, std::string_view from, std::string_view to) {
  for (std::size_t at = 0; (at = text.find(from, at)) != std::string::npos; at += to.size()) {
    text.replace(at, from.size(), to);
  }
}

std::string trimmed(std::string_view s) { return std::string(trim_blanks(s)); }

/// Plain ASCII: superscripts and powers as digits, micro as u, degree as deg, dots as '.', without
/// an outer pair of brackets.
std::string plain(std::string_view text) {
  std::string s = trimmed(to_utf8(text));
  using Spelling = std::pair<const char*, const char*>;
  // The first four: UTF-8 read as Latin-1 and written again. The last two: a superscript lost to a
  // wrong encoding; after a second in a quotient only the two is usual.
  for (const auto& [written, meant] : {Spelling{"\u00C2", ""}, {"\u00E2\u0081\u00BB", "-"},
                                       {"\u00CE\u00BC", "u"},  {"\u00CE\u00B5", "strain"},
                                       {"\u00B7", "."},        {"\u22C5", "."},
                                       {"\u2219", "."},        {"\u2022", "."},
                                       {"\u00D7", "."},        {"\u00B5", "u"},
                                       {"\u03BC", "u"},        {"\u03B5", "strain"},
                                       {"\u00B0", "deg"},      {"\u00BA", "deg"},
                                       {"\u2103", "degC"},     {"\u2109", "degF"},
                                       {"\u207B", "-"},        {"\u2212", "-"},
                                       {"\u2013", "-"},        {"\u00B9", "1"},
                                       {"\u00B2", "2"},        {"\u00B3", "3"},
                                       {"\u2044", "/"},        {"/s\uFFFD", "/s2"},
                                       {"/s?", "/s2"},         {"eg C", "egC"},
                                       {"eg F", "egF"}}) {
    replace_all(s, written, meant);
  }
  if (s.size() >= 2 &&
      ((s.front() == '[' && s.back() == ']') || (s.front() == '{' && s.back() == '}') ||
       (s.front() == '(' && s.find(')') == s.size() - 1))) {
    s = trimmed(std::string_view(s).substr(1, s.size() - 2));
  }
  for (const char* power : {"**", "^"}) replace_all(s, power, "");
  for (const char* power : {"-1", "-2"}) replace_all(s, "(" + std::string(power) + ")", power);
  // Metre per second squared, though "ms" alone is a millisecond. Exports drop the minus as well.
  return s == "ms-2" || s == "ms2" ? "m/s2" : s == "ms-1" ? "m/s" : s;
}

struct Product {
  double factor = 1;
  double offset = 0;
  Dimension dimension{};
  bool strain = false;
};

bool parse_product(std::string_view s, Product& product);

/// What kUnits says of a name, behind `mark`; false: it is not there.
bool find_unit(std::string_view name, std::string_view mark, bool ignore_case, Product& product) {
  static const std::string kLower = lower_case(kUnits);
  const std::string key = "|" + std::string(mark) + std::string(name) + "=";
  const std::size_t at = ignore_case ? kLower.find(lower_case(key)) : kUnits.find(key);
  if (at == std::string_view::npos) return false;
  auto meant = kUnits.substr(at + key.size());
  meant = meant.substr(0, meant.find('|'));
  product = {};
  if (meant[0] == '#') {
    const auto place = static_cast<std::size_t>(meant[1] - '0');
    if (place < product.dimension.size()) product.dimension[place] = 1;
    product.strain = place == product.dimension.size();
    return true;
  }
  double factor = 1, offset = 0;
  const auto number = [&](double& value) {
    const auto end = std::from_chars(meant.data(), meant.data() + meant.size(), value).ptr;
    meant.remove_prefix(static_cast<std::size_t>(end - meant.data()));
  };
  number(factor);
  const auto expression = meant.substr(0, meant.find('+'));
  meant.remove_prefix(std::min(expression.size() + 1, meant.size()));
  number(offset);
  if (!parse_product(trim_blanks(expression), product)) return false;
  product.factor *= factor;
  product.offset += offset;
  return true;
}

/// A unit as written, then ignoring case, with a prefix or without; then without a plural's s.
bool find_unit(std::string_view text, Product& product) {
  constexpr std::string_view kPrefixes = "numcdkMG";
  constexpr double kFactors[] = {1e-9, 1e-6, 1e-3, 1e-2, 1e-1, 1e3, 1e6, 1e9};
  if (text.empty() || text.find_first_of("|=~") != text.npos) return false;
  for (const bool ignore_case : {false, true}) {
    for (const char* mark : {"~", ""}) {
      if (find_unit(text, mark, ignore_case, product)) return true;
    }
    char letter = ignore_case && text[0] == 'K' ? 'k' : text[0];
    if (!find_unit(text.substr(1), "~", ignore_case, product)) continue;
    // All in capitals, "MM" and "MV" are milli, "MPA" and "MN" mega.
    const bool is_mega = product.dimension[1] == 1 && product.dimension[0] % 2 != 0;
    if (ignore_case && letter == 'M' && !is_mega) letter = 'm';
    const std::size_t place = kPrefixes.find(letter);
    if (place == kPrefixes.npos) continue;
    product.factor *= kFactors[place];
    return true;
  }
  const std::string word = lower_case(text);
  return word.size() > 2 && word.back() == 's' &&
         find_unit(std::string_view(word).substr(0, word.size() - 1), "", false, product);
}

/// One factor, "s", "s2" or "s-2", times `sign` in the exponent.
bool multiply(std::string_view term, int sign, Product& product) {
  int exponent = sign;
  Product unit;
  if (!find_unit(term, unit)) {
    if (term.size() < 2 || term.back() < '1' || term.back() > '4') return false;
    exponent *= term.back() - '0';
    term.remove_suffix(1);
    if (term.ends_with('-')) exponent = -exponent, term.remove_suffix(1);
    if (!find_unit(term, unit)) return false;
  }
  product.factor *= std::pow(unit.factor, exponent);
  product.offset = unit.offset;
  for (std::size_t k = 0; k < product.dimension.size(); ++k) {
    product.dimension[k] += exponent * unit.dimension[k];
  }
  product.strain |= unit.strain;
  return true;
}

/// Factors parted by '*', '.', ' ' or a '-' before a letter, behind a slash below it: "m/s.s" is
/// meant as "m/(s.s)"; brackets once.
bool parse_product(std::string_view s, Product& product) {
  const auto parts = [&](std::size_t at) {
    return std::string_view("/*. ()").find(s[at]) != std::string_view::npos ||
           (s[at] == '-' && at > 0 && at + 1 < s.size() && std::isalpha(s[at + 1]) != 0);
  };
  int sign = 1, outer_sign = 1, depth = 0, terms = 0;
  bool pending_slash = false;
  for (std::size_t at = 0, begin = 0; at <= s.size(); ++at) {
    if (at < s.size() && !parts(at)) continue;
    if (at > begin) {
      if (!multiply(s.substr(begin, at - begin), sign * outer_sign, product)) return false;
      ++terms;
      pending_slash = false;
    }
    begin = at + 1;
    const char c = at < s.size() ? s[at] : ' ';
    if (c == '(') {
      if (depth++ > 0) return false;
      outer_sign = sign, sign = 1, pending_slash = false;
    } else if (c == ')') {
      if (depth-- == 0) return false;
      sign = 1, outer_sign = 1;
    } else if (c != ' ' && terms == 0) {
      return false;
    } else if (c == '/') {
      if (pending_slash) return false;
      sign = -1, pending_slash = true;
    }
  }
  if (terms > 1) product.offset = 0;
  return terms > 0 && depth == 0 && !pending_slash;
}

std::string composed_symbol(const Dimension& dimension) {
  constexpr std::array<const char*, 6> base = {"m", "kg", "s", "K", "V", "rad"};
  std::string over, under;
  for (std::size_t k = 0; k < base.size(); ++k) {
    if (dimension[k] == 0) continue;
    std::string& side = dimension[k] > 0 ? over : under;
    if (!side.empty()) side += ' ';
    side += base[k];
    if (std::abs(dimension[k]) != 1) side += '^' + std::to_string(std::abs(dimension[k]));
  }
  if (under.empty()) return over.empty() ? "1" : over;
  const bool many = under.find(' ') != std::string::npos;
  return (over.empty() ? "1" : over) + '/' + (many ? '(' + under + ')' : under);
}

}  // namespace

const char* name_of(Quantity quantity) { return kKinds[static_cast<std::size_t>(quantity)].name; }

const char* si_of(Quantity quantity) { return kKinds[static_cast<std::size_t>(quantity)].si; }

std::optional<Unit> parse_unit(std::string_view text) {
  if (text.size() > 64) return std::nullopt;
  const std::string s = plain(text);
  if (s.empty() || s == "-" || lower_case(s) == "none") return std::nullopt;
  Product product;
  if (!parse_product(s, product)) return std::nullopt;
  Unit unit;
  unit.factor = product.factor;
  unit.offset = product.offset;
  for (const auto& kind : kKinds) {
    if (kind.quantity == Quantity::unknown || kind.dimension != product.dimension) continue;
    if (kind.quantity == Quantity::strain && !product.strain && s.find('/') == std::string::npos) {
      continue;  // per cent and pure numbers are not strain by themselves
    }
    unit.quantity = kind.quantity;
    unit.si = kind.si;
    return unit;
  }
  unit.si = composed_symbol(product.dimension);
  if (unit.si == "1/s") unit.si = "Hz";
  return unit;
}

std::optional<UnitQuotient> parse_quotient(const std::string& text, Quantity below) {
  for (std::size_t at = text.find('/'); at != std::string::npos; at = text.find('/', at + 1)) {
    const auto over = parse_unit(text.substr(0, at)), under = parse_unit(text.substr(at + 1));
    if (over && under && (below == Quantity::unknown || under->quantity == below)) {
      return UnitQuotient{text.substr(0, at), *over, *under};
    }
  }
  return std::nullopt;
}

TitledUnit split_title(std::string_view title) {
  const std::string s = trimmed(to_utf8(title));
  const std::size_t kind = s.empty() ? s.npos : std::string_view("])}").find(s.back());
  if (kind != s.npos) {
    const char open = "[({"[kind];
    // The bracket that belongs to the last one.
    std::size_t at = s.size() - 1;
    for (int depth = 1; at > 0 && depth > 0;) {
      --at;
      depth += s[at] == s.back() ? 1 : s[at] == open ? -1 : 0;
    }
    const std::string name = trimmed(std::string_view(s).substr(0, at));
    const std::string inside = trimmed(std::string_view(s).substr(at + 1, s.size() - at - 2));
    // "Excitation (Trigger)" is a name; a bracket is a unit when it is one or when square.
    const bool is_unit = parse_unit(inside) || open == '[' || lower_case(inside) == "counts";
    if (!name.empty() && is_unit) return {name, inside};
  }
  for (const std::string_view sign : {" / ", ", ", ": ", " in "}) {
    const std::size_t at = lower_case(s).rfind(sign);
    if (at == std::string::npos || at == 0) continue;
    const std::string unit = trimmed(std::string_view(s).substr(at + sign.size()));
    if (parse_unit(unit)) return {trimmed(std::string_view(s).substr(0, at)), unit};
  }
  // From the left, so that the unit is the longest: "Acc m/s^2" is no "Acc m" in s^2.
  for (std::size_t at = s.find_first_of("/_ ", 1); at != std::string::npos;
       at = s.find_first_of("/_ ", at + 1)) {
    const char sign = s[at];
    const std::string name = trimmed(std::string_view(s).substr(0, at));
    const std::string unit = trimmed(std::string_view(s).substr(at + 1));
    // "accel_m_s2", "gyro_rad_s": two parts as a quotient.
    const std::size_t before = sign == '_' ? name.rfind('_') : std::string::npos;
    if (before != std::string::npos && before > 0 && unit.starts_with('s')) {
      const std::string quotient = name.substr(before + 1) + '/' + unit;
      const auto parsed = parse_unit(quotient);
      if (parsed && parsed->quantity != Quantity::unknown) return {s, quotient};
    }
    if (!parse_unit(unit)) continue;
    // "C", "K", "h", "1" and the like at the end of a name are letters more often than units.
    if (is_listed("|C|K|h|J|c|k|H|j|n|M|S|G|in|v|", unit) ||
        std::isdigit(static_cast<unsigned char>(unit[0])) != 0) {
      continue;
    }
    if (sign == ' ' && unit.size() < 2 && !is_listed("|N|V|g|s|", unit)) continue;
    return {sign == '_' || lower_case(unit) == "strain" ? s : name, unit};
  }
  return {s, ""};
}

std::string to_utf8(std::string_view bytes) {
  std::string out(bytes);
  std::ranges::replace_if(
      out, [](unsigned char c) { return c < 0x20 || c == 0x7F; }, ' ');
  std::wstring wide = pugi::as_wide(out);
  // No surrogates, nor what is beyond Unicode.
  const bool valid =
      pugi::as_utf8(wide.c_str()) == out && std::ranges::none_of(wide, [](wchar_t c) {
        return (c >= 0xD800 && c < 0xE000) || c > 0x10FFFF;
      });
  if (valid) return out;
  wide.clear();
  for (const char c : out) {
    const auto code = static_cast<unsigned char>(c);
    wide += code < 0x80 || code >= 0xA0 ? code : 0xFFFD;
  }
  return pugi::as_utf8(wide.c_str());
}

std::string_view trim_blanks(std::string_view s) {
  s.remove_prefix(std::min(s.find_first_not_of(" \t\r"), s.size()));
  return s.substr(0, s.find_last_not_of(" \t\r") + 1);
}

bool is_listed(std::string_view list, const std::string& word) {
  return word.find('|') == std::string::npos &&
         list.find("|" + word + "|") != std::string_view::npos;
}

std::string lower_case(std::string_view s) {
  std::string out(s);
  std::ranges::transform(out, out.begin(),
                         [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return out;
}

}  // namespace rigfit::signal
