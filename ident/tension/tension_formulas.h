// Tension of a cable from one natural frequency by closed formulas of the literature, for
// comparison with the model's answer.
//
// With f_n the frequency of order n, L the span, m the mass per length, C = sqrt(EI / (m L^4)) in
// 1/s:
//
//   string        T = 4 m (f_n L / n)^2
//   pinned beam   T = 4 m (f_n L / n)^2 - n^2 pi^2 EI / L^2
//   clamped beam  the characteristic equation of a tensioned beam with clamped ends, solved for T:
//                 2 a b (1 - cosh a cos b) + (a^2 - b^2) sinh a sin b = 0,
//                 a^2, b^2 = +-x^2/2 + sqrt(x^4/4 + w^2), x^2 = T L^2 / EI, w = 2 pi f_n / C
//   Zui           polynomials in C / f_1 or C / f_2, fitted to clamped cables by Zui, Shinke and
//                 Namita: of the first mode if the sag is small, else of the second, of a higher
//                 one if both are missing
//
// Sources: T. M. Irvine, Cable Structures, 1981; H. Zui, T. Shinke and Y. Namita, J. Struct. Eng.
// 122 (1996) 651-656; A. Bokaian, J. Sound Vib. 126 (1988) 49.
#pragma once

namespace rigfit::ident {

struct CableFormulaInput {
  int order = 1;               ///< mode number of the frequency, from 1
  double frequency_hz = 0;     ///< > 0
  double span_m = 0;           ///< > 0
  double mass_per_length = 0;  ///< kg/m, > 0
  double EI_Nm2 = 0;           ///< 0: a string
};

[[nodiscard]] double string_tension(const CableFormulaInput& input);
/// NaN where the frequency is lower than that of the beam without tension.
[[nodiscard]] double pinned_beam_tension(const CableFormulaInput& input);
/// NaN like pinned_beam_tension.
[[nodiscard]] double clamped_beam_tension(const CableFormulaInput& input);
/// NaN where C / f is outside the range of the formula's fit.
[[nodiscard]] double zui_tension(const CableFormulaInput& input);

}  // namespace rigfit::ident
