#include "ident/predict/damage_estimate.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace rigfit::ident {
namespace {

Eigen::Index index_of(const FittedParameters& fitted, const std::string& name) {
  for (std::size_t i = 0; i < fitted.parameters.size(); ++i) {
    if (fitted.parameters[i].name == name) return static_cast<Eigen::Index>(i);
  }
  std::string known;
  for (const auto& parameter : fitted.parameters) known += " \"" + parameter.name + "\"";
  throw std::invalid_argument("the fit identifies no parameter \"" + name + "\"; it has" + known);
}

}  // namespace

DamageEstimate damage_estimate(const FittedParameters& fitted, const DamageQuestion& question) {
  const Eigen::Index zone = index_of(fitted, question.zone);
  const auto n = static_cast<Eigen::Index>(fitted.parameters.size());
  // Gradient of ln(EI_zone / EI_sound) by the fit's parameters.
  Eigen::VectorXd gradient = Eigen::VectorXd::Zero(n);
  const double EI = fitted.parameters[static_cast<std::size_t>(zone)].value;
  gradient[zone] = 1 / EI;
  double sound = question.sound_EI.value, extra = 0;
  Eigen::Index reference = -1;
  if (!question.sound.empty()) {
    reference = index_of(fitted, question.sound);
    sound = fitted.parameters[static_cast<std::size_t>(reference)].value;
    gradient[reference] -= 1 / sound;
  } else if (question.sound_EI.std > 0) {
    extra = std::pow(question.sound_EI.std / sound, 2);
  }
  if (!(EI > 0) || !(sound > 0))
    throw std::invalid_argument("EI of zone and sound part must be positive");
  const double ratio = EI / (question.sound_ratio * sound);
  const double variance = gradient.dot(fitted.covariance * gradient) + extra;
  const double s = std::sqrt(std::max(0.0, variance));
  DamageEstimate estimate;
  estimate.damage = {1 - ratio, ratio * s};
  const double two_sided = coverage_factor(0.95, 0), one_sided = coverage_factor(0.9, 0);
  estimate.low = 1 - ratio * std::exp(two_sided * s);
  estimate.high = 1 - ratio * std::exp(-two_sided * s);
  estimate.smallest_found = 2 * one_sided * estimate.damage.std;
  estimate.called = estimate.damage.value > one_sided * estimate.damage.std;
  for (Eigen::Index i = 0; i < n; ++i) {
    if (i == zone || i == reference) continue;
    const double other = fitted.covariance(i, i);
    if (!(other > 0) || !(variance > 0)) continue;
    const double correlation = gradient.dot(fitted.covariance.col(i)) / std::sqrt(variance * other);
    if (std::abs(correlation) > kNotToldApart)
      estimate.like.push_back(fitted.parameters[static_cast<std::size_t>(i)].name);
  }
  estimate.statement = fmt::format(
      "{} of the zone's EI is lost: {:.3g} +- {:.2g}; the smallest loss that these measurements "
      "show with 95 % probability is {:.2g}",
      estimate.called ? "part" : "nothing significant", estimate.damage.value, estimate.damage.std,
      estimate.smallest_found);
  for (const auto& name : estimate.like) {
    estimate.statement += "; the measurements do not tell it apart from " + name;
  }
  if (estimate.smallest_found >= 1) {
    estimate.statement += "; no loss at all could be shown by them";
  }
  return estimate;
}

}  // namespace rigfit::ident
