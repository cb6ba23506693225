// EI(T) of a cable from bending tests, with its uncertainty, for use in a model.
//
// Where the points favour one law (stiffness_law.h), EI(T) is that law. Where several laws compete,
// it is their mean by Akaike weight. Where no law can be ranked, or none passes through the points
// (chi-square of the best with a probability under 1 %), it is linear between the points; tests
// within 5 % of a tension are then averaged, and the points' uncertainty is scaled by
// sqrt(chi2 / degrees of freedom) of the best law where that exceeds one.
//
// The uncertainty is a sum of independent terms, each of which moves EI at all tensions together:
//   law            columns of the Cholesky factor of the covariance of its parameters
//   other laws     sqrt(weight) (EI of that law - EI of the curve)
//   interpolation  the standard uncertainty of each point times its share at the tension
//   tension        change of all points if EI holds at another tension within their tests
//
//   shared         uncertainty common to the tests (span, calibrations), relative to EI
// so that the covariance of EI between two tensions is the sum of products of their terms. Terms of
// a law are scaled so that 1.96 of them span its Student's 95 % band. The law is extrapolated down
// to half the lowest and up to twice the highest tested tension; interpolation keeps the nearest
// point's EI.
#pragma once

#include <span>

#include "ident/stiffness/stiffness_law.h"

namespace rigfit::ident {

enum class StiffnessSource { none, law, weighted_laws, interpolation };
/// "none", "law", "weighted laws", "interpolation".
[[nodiscard]] const char* name_of(StiffnessSource source);

struct StiffnessAtTension {
  double EI_Nm2 = 0;
  double std = 0;             ///< 95 % interval's half width / 1.96; NaN: not known
  double low = 0, high = 0;   ///< 95 %; NaN: not known
  double slope_m2 = 0;        ///< d EI / d tension
  bool extrapolated = false;  ///< outside the tested tensions
};

/// One independent source of uncertainty.
struct StiffnessTerm {
  std::string name;
  VectorXd change_Nm2;  ///< of EI at each tension by one standard uncertainty
};

class StiffnessCurve {
 public:
  StiffnessCurve() = default;
  /// Fits the laws (from two points on). Throws as fit_stiffness_laws.
  explicit StiffnessCurve(std::vector<StiffnessPoint> points,
                          const StiffnessLawOptions& options = {});

  [[nodiscard]] bool empty() const { return points_.empty(); }
  [[nodiscard]] StiffnessSource source() const { return source_; }
  /// Source of EI(T) and the reason for it, in words.
  [[nodiscard]] const std::string& sentence() const { return sentence_; }
  /// The points, by rising tension.
  [[nodiscard]] const std::vector<StiffnessPoint>& points() const { return points_; }
  [[nodiscard]] const StiffnessLaws& laws() const { return laws_; }
  [[nodiscard]] double lowest_tension_N() const { return points_.front().tension_N; }
  [[nodiscard]] double highest_tension_N() const { return points_.back().tension_N; }

  /// Throws std::invalid_argument for an empty curve or a tension that is negative or not finite.
  [[nodiscard]] StiffnessAtTension at(double tension_N) const;
  /// The terms above at these tensions; empty where no uncertainty is known.
  [[nodiscard]] std::vector<StiffnessTerm> uncertainty(std::span<const double> tensions_N) const;

  static constexpr auto fields() {
    using T = StiffnessCurve;
    return std::tuple{field("source", &T::source),
                      field("sentence", &T::sentence, "", "for a model", "")};
  }

 private:
  struct Knot {
    double tension_N = 0, EI_Nm2 = 0;
    double own_std = 0;     ///< not shared with other tests; NaN: not known
    double by_tension = 0;  ///< change of EI by the spread of tension within the tests
  };

  void choose();
  void make_knots(double scale);
  [[nodiscard]] double value(double tension_N) const;
  [[nodiscard]] double law_value(const FittedLaw& law, double tension_N) const;
  [[nodiscard]] double knot_share(std::size_t knot, double tension_N) const;
  [[nodiscard]] double clamped(double tension_N) const;

  std::vector<StiffnessPoint> points_;
  std::vector<Knot> knots_;
  StiffnessLaws laws_;
  std::vector<double> weights_;  ///< weights of the laws, in their order; sum 1
  double shared_relative_std_ = 0;
  StiffnessSource source_ = StiffnessSource::none;
  std::string sentence_;
};

}  // namespace rigfit::ident
