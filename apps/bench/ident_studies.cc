#include "apps/bench/ident_studies.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "apps/bench/cable_update.h"
#include "apps/bench/exact_bending_ratio.h"
#include "ident/bending/bending_equation.h"
#include "ident/update/model_update.h"

namespace rigfit::apps {
namespace {

/// F(lambda) as the paper prints it: 1 + 2 (1 - cosh) / (lambda sinh).
double printed_ratio(double lambda) {
  return 1 + 2 * (1 - std::cosh(lambda)) / (lambda * std::sinh(lambda));
}

/// Halving between 1e-3 and 300 until the bracket is `tolerance` of its middle.
double bisected(double ratio, double tolerance) {
  double low = 1e-3, high = 300;
  while (high - low > tolerance * 0.5 * (low + high)) {
    const double middle = 0.5 * (low + high);
    (printed_ratio(middle) < ratio ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

}  // namespace

BenchStudy bending_study(const BenchBudget& budget) {
  BenchStudy study;
  study.task = "bending";
  study.scene = "bending equation, lambda from 0.3 to 25";
  study.error_of = "EI, largest of 101 tests";
  study.reference = "EI that the ratio was computed from, in extended precision";
  study.default_does =
      "the default also gives EI its interval, from 4096 draws of what was measured";
  constexpr int kTests = 101;
  std::vector<double> lambda(kTests), ratio(kTests);
  for (int i = 0; i < kTests; ++i) {
    lambda[std::size_t(i)] = 0.3 * std::pow(25 / 0.3, double(i) / (kTests - 1));
    ratio[std::size_t(i)] =
        static_cast<double>(exact_bending_ratio(static_cast<long double>(lambda[std::size_t(i)])));
    // The ratio as a double is off by half a unit: d ln EI = -2 d ln lambda.
    const double slope = ident::bending_ratio_log_derivative(lambda[std::size_t(i)]);
    study.reference_error =
        std::max(study.reference_error,
                 2 * 0.5 * std::numeric_limits<double>::epsilon() * ratio[std::size_t(i)] / slope);
  }
  const auto add = [&](const char* method, std::optional<double> tolerance, bool is_default,
                       const std::function<double(double)>& EI_over_truth) {
    BenchRow row;
    row.method = method;
    row.tolerance = tolerance;
    row.is_default = is_default;
    row.relative_error = 0;
    for (int i = 0; i < kTests; ++i) {
      const double error = std::abs(EI_over_truth(ratio[std::size_t(i)]) *
                                        (lambda[std::size_t(i)] * lambda[std::size_t(i)]) -
                                    1);
      row.relative_error = std::max(row.relative_error, std::isfinite(error) ? error : 1.0);
    }
    int next = 0;
    double sum = 0;
    row.wall_s =
        median_time(budget, [&] { sum += EI_over_truth(ratio[std::size_t(next++ % kTests)]); });
    if (!std::isfinite(sum)) row.note = "fails for some";
    study.rows.push_back(std::move(row));
  };
  // EI = P l^2 / (4 lambda^2): 1 / lambda^2 for P l^2 = 4.
  add("bracketed Newton", {}, false, [](double r) {
    const double found = ident::lambda_from_bending_ratio(r).lambda;
    return 1 / (found * found);
  });
  for (const double tolerance : {1e-3, 1e-6, 1e-9, 1e-12}) {
    add("bisection of the printed form", tolerance, false, [tolerance](double r) {
      const double found = bisected(r, tolerance);
      return 1 / (found * found);
    });
  }
  add("EI with its interval", {}, true, [](double r) {
    // P = 4 N, l = 1 m, d / Q = r l / (4 P), each known to 0.1 %.
    const double slope = r / 16;
    const auto found =
        ident::stiffness_from_compliance({{slope, 1e-3 * slope}, {4, 4e-3}, {1, 1e-3}, 20});
    return found.EI_Nm2.value;
  });
  mark_front(study);
  return study;
}

namespace {

/// Derivatives by differences of a relative 1e-6, as a program without its own would take them.
model::ModeSensitivities by_differences(const model::Scene& scene,
                                        const std::vector<std::string>& names,
                                        const model::ModesOptions& options) {
  model::ModeSensitivities out;
  out.analysis = model::analyse_modes(scene, options);
  const auto modes = static_cast<Eigen::Index>(out.analysis.modes.size());
  const auto count = static_cast<Eigen::Index>(names.size());
  out.frequency.setZero(modes, count);
  out.damping_ratio.setZero(modes, count);
  for (Eigen::Index p = 0; p < count; ++p) {
    const std::string& name = names[static_cast<std::size_t>(p)];
    const double value = model::parameter(scene, name);
    const double step = 1e-6 * std::abs(value);
    model::Scene moved = scene;
    model::set_parameter(moved, name, value + step);
    const auto there = model::analyse_modes(moved, options);
    Eigen::MatrixXd shape =
        Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(scene.sensors.size()), modes);
    for (Eigen::Index i = 0; i < modes && i < Eigen::Index(there.modes.size()); ++i) {
      const auto &a = out.analysis.modes[std::size_t(i)], &b = there.modes[std::size_t(i)];
      out.frequency(i, p) = (b.frequency_hz - a.frequency_hz) / step;
      out.damping_ratio(i, p) = (b.damping_ratio - a.damping_ratio) / step;
      shape.col(i) = (b.sensor_shape - a.sensor_shape) / step;
    }
    out.sensor_shape.push_back(std::move(shape));
  }
  return out;
}

}  // namespace

BenchStudy update_study(const BenchBudget& budget) {
  BenchStudy study;
  study.task = "update";
  study.scene = "cable at 100 and 200 N, six frequencies each; free: EI, both tensions";
  study.error_of = "the parameters, largest";
  study.default_does =
      "the default starts from four places, so that a start off by three still ends in the best "
      "fit, and takes off what the segments do";
  const int fine = budget.quick ? 120 : 240;
  const CableUpdate problem(fine);
  const auto add = [&](const char* method, int segments, const ident::UpdateOptions& options,
                       bool is_default = false) {
    BenchRow row;
    row.method = method;
    row.segments = segments;
    row.order = options.starts;
    row.is_default = is_default;
    const ident::UpdateResult result = problem.fit(segments, options);
    row.relative_error = problem.error_of(result);
    if (row.relative_error == 1) row.note = result.message;
    row.wall_s = median_time(budget, [&] { (void)problem.fit(segments, options); });
    study.rows.push_back(std::move(row));
  };
  ident::UpdateOptions options;
  options.starts = 1;
  study.reference = fmt::format("the values the frequencies were computed with, {} segments", fine);
  study.reference_error = problem.reference_error();
  for (const int n : {10, 20, 30, 60, 90}) {
    if (budget.quick && n != 30) continue;
    add("own sensitivities, starts", n, options);
  }
  add("own sensitivities, \"auto\", starts", 0, options);
  options.solver = by_differences;
  add("finite differences, starts", 30, options);
  options.solver = nullptr;
  options.starts = ident::UpdateOptions{}.starts;
  add("own sensitivities, starts", 30, options);
  add("own sensitivities, \"auto\", starts", 0, options, true);
  mark_front(study);
  return study;
}

}  // namespace rigfit::apps
