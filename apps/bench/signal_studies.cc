#include "apps/bench/signal_studies.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <random>

#include "apps/bench/ten_modes.h"
#include "signal/decay/decay.h"
#include "signal/envelope/log_decrement.h"
#include "signal/modal/modal_identification.h"
#include "signal/poles/lscf.h"
#include "signal/sinusoids/damped_sinusoids.h"
#include "signal/spectra/frf.h"

namespace rigfit::apps {
namespace {

using Complex = std::complex<double>;
using Eigen::Index;

}  // namespace

BenchStudy decay_study(std::uint64_t seed, const BenchBudget& budget) {
  constexpr double kHz = 50, kZeta = 0.017, kRate = 500;
  const double sigma = std::sqrt(0.5e-4);  // 40 dB below the first cycle
  const int seeds = budget.quick ? 6 : 40;
  BenchStudy study;
  study.task = "decay";
  study.scene = "free decay, 50 Hz, 500 samples/s, 40 dB";
  study.error_of = fmt::format("the damping ratio, rms over {} records", seeds);
  study.reference = "the truth the records are made of";
  study.default_does =
      "the default is not told where the decay begins, how many modes there are and where, and "
      "gives "
      "intervals that hold";
  const double w = 2 * std::numbers::pi * kHz / kRate;
  const Complex pole(-kZeta * w, w * std::sqrt(1 - kZeta * kZeta));
  for (const double duration : {0.25, 0.5, 1.0, 2.0}) {
    const auto samples = static_cast<Index>(std::lround(duration * kRate));
    std::vector<Eigen::VectorXd> records;
    double bound = 0;
    for (int k = 0; k < seeds; ++k) {
      std::mt19937_64 random(seed + static_cast<std::uint64_t>(k));
      std::normal_distribution<double> normal;
      std::uniform_real_distribution<double> angle(0, 2 * std::numbers::pi);
      const Complex amplitude = std::polar(1.0, angle(random));
      Eigen::VectorXd y(samples);
      for (Index j = 0; j < samples; ++j) {
        y[j] = (amplitude * std::exp(pole * static_cast<double>(j))).real();
      }
      // Cramer-Rao bound: the covariance of the linearised fit at the truth.
      signal::DampedSinusoidsOptions at_truth;
      at_truth.max_iterations = 0;
      const auto truth = signal::fit_damped_sinusoids(y, std::span(&pole, 1), at_truth);
      const double s = pole.real(), v = pole.imag(), r = std::abs(pole);
      const Eigen::Vector2d slope(-v * v / (r * r * r), s * v / (r * r * r));
      bound += sigma * sigma * slope.dot(truth.unit_covariance.block<2, 2>(2, 2) * slope) / seeds;
      for (double& value : y) value += sigma * normal(random);
      records.push_back(std::move(y));
    }
    const auto add = [&](const char* method, bool is_default, auto&& ratio_of) {
      BenchRow row;
      row.method = fmt::format("{}, {:g} s of record", method, duration);
      row.is_default = is_default;
      row.bound = std::sqrt(bound) / kZeta;
      double sum = 0;
      for (const auto& y : records) {
        const double ratio = ratio_of(y);
        const double error = std::isfinite(ratio) ? ratio / kZeta - 1 : 1;
        sum += error * error;
      }
      row.relative_error = std::min(1.0, std::sqrt(sum / seeds));
      std::size_t next = 0;
      row.wall_s = median_time(budget, [&] { (void)ratio_of(records[next++ % records.size()]); });
      study.rows.push_back(std::move(row));
    };
    add("modes found and fitted", duration == 1, [&](const Eigen::VectorXd& y) {
      const auto found = signal::estimate_decay(y, kRate);
      return found.modes.empty() ? NAN : found.modes[0].damping_ratio.value;
    });
    add("one damped sinusoid, start known", false, [&](const Eigen::VectorXd& y) {
      const Complex start(-0.7 * kZeta * w, 1.002 * w);
      const auto fit = signal::fit_damped_sinusoids(y, std::span(&start, 1));
      return -fit.poles[0].real() / std::abs(fit.poles[0]);
    });
    add("logarithmic decrement", false, [&](const Eigen::VectorXd& y) {
      signal::LogDecrementOptions options;
      options.noise_std = sigma;
      return signal::log_decrement(y, kRate, kHz, options).damping_ratio.value;
    });
  }
  mark_front(study);
  return study;
}

BenchStudy frf_study(std::uint64_t seed, const BenchBudget& budget) {
  constexpr double kRate = 4096;
  const Index block = budget.quick ? 8192 : 16384, responses = 10;
  const int hits = budget.quick ? 5 : 20;
  BenchStudy study;
  study.task = "frf";
  study.scene =
      fmt::format("hits on ten modes, {} responses, blocks of {}, 0.5 % noise", responses, block);
  study.error_of = "all functions to 1300 Hz, rms";
  study.reference = "the sampled structure's exact functions";
  study.default_does =
      "the default changes nothing in the records: a window is asked for, as its decay rate must "
      "be "
      "taken out of every damping again";
  const SampledStructure structure(TenModes(responses), kRate);
  std::vector<Eigen::MatrixXd> records;
  for (int k = 0; k < hits; ++k) {
    records.push_back(structure.hit(block, 40 + 7 * k, 3 + k % 3, 80 + 5 * k, 0.005,
                                    seed + static_cast<std::uint64_t>(k)));
  }
  std::vector<signal::FrfBlock> blocks;
  for (const auto& record : records) {
    signal::FrfBlock one;
    const auto view = [&](Index c) {
      return std::span<const double>(record.col(c).data(), static_cast<std::size_t>(block));
    };
    one.force = view(0);
    for (Index c = 1; c <= responses; ++c) one.responses.push_back(view(c));
    blocks.push_back(std::move(one));
  }
  const auto add = [&](signal::FrfEstimator estimator, int averages, double window) {
    signal::FrfOptions options;
    options.estimator = estimator;
    options.sample_rate_hz = kRate;
    options.block_samples = block;
    options.exponential_decay_rate_1_s = window;
    const std::span<const signal::FrfBlock> some(blocks.data(), static_cast<std::size_t>(averages));
    const auto estimate = signal::average_frfs(some, options);
    const Index lines = (estimate.frequency_hz.array() < 1300).count();
    const Eigen::MatrixXcd exact = structure.frfs(estimate.frequency_hz.head(lines), window);
    BenchRow row;
    row.method = fmt::format("{}{}, hits", name_of(estimator),
                             window > 0 ? fmt::format(", window {:g} 1/s", window) : "");
    row.order = averages;
    row.is_default = estimator == signal::FrfEstimator::h1 && averages == 5 && window == 0;
    row.relative_error = (estimate.H.topRows(lines) - exact).norm() / exact.norm();
    row.wall_s = median_time(budget, [&] { (void)signal::average_frfs(some, options); });
    study.rows.push_back(std::move(row));
  };
  for (const int averages : {1, 2, 5, 10, 20}) {
    if (averages > hits) continue;
    for (const double window : {0.0, 2.0}) add(signal::FrfEstimator::h1, averages, window);
  }
  add(signal::FrfEstimator::h2, 5, 0);
  add(signal::FrfEstimator::hv, 5, 0);
  mark_front(study);
  return study;
}

BenchStudy poles_study(std::uint64_t seed, const BenchBudget& budget) {
  BenchStudy study;
  study.task = "poles";
  study.scene =
      fmt::format("ten modes, 20 functions, {} lines, 0.1 % noise", budget.quick ? 1400 : 5600);
  study.error_of = "the ten natural frequencies, largest; 1: not all found";
  study.reference = "the poles the functions are made of";
  study.default_does =
      "the default also decides which poles are modes, fits residues and weights, and gives each "
      "mode "
      "its uncertainty; bare orders leave that to the reader";
  const TenModes truth(20);
  const auto worst = [&](const std::vector<double>& found) {
    double error = 0;
    for (const double f : truth.frequency_hz) {
      double nearest = 1;
      for (const double hz : found) nearest = std::min(nearest, std::abs(hz / f - 1));
      error = std::max(error, nearest);
    }
    return error > 2e-3 ? 1.0 : error;  // 6 Hz at 315 Hz is 2 %: beyond a tenth of that, missed
  };
  const Index lines = budget.quick ? 1400 : 5600;
  const auto set =
      truth.frfs(Eigen::VectorXd::LinSpaced(lines, 1400.0 / double(lines), 1400), 1e-3, seed);
  const auto add = [&](const char* method, int order, bool is_default,
                       const std::function<std::vector<double>()>& work) {
    BenchRow row;
    row.method = method;
    row.order = order;
    row.is_default = is_default;
    row.relative_error = worst(work());
    if (row.relative_error == 1) row.note = "not all ten found";
    row.wall_s = median_time(budget, [&] { (void)work(); });
    study.rows.push_back(std::move(row));
  };
  for (const int order : {12, 20, 30, 60, 90}) {
    add("poles of one order", order, false, [&] {
      signal::LscfOptions options;
      options.max_order = order;
      std::vector<double> top;
      for (const auto& pole : signal::lscf(set.frequency_hz, set.H, 1, {}, {}, options).poles) {
        if (pole.order == order) top.push_back(pole.frequency_hz);
      }
      return top;
    });
  }
  const int standard = signal::LscfOptions{}.max_order;
  for (const int order : {20, 30, standard, 90}) {
    if (budget.quick && order != standard) continue;
    add("modes found and refined, orders to", order, order == standard, [&] {
      signal::ModalOptions options;
      options.lscf.max_order = order;
      std::vector<double> found;
      for (const auto& mode : signal::identify_modes(set, options).model.modes) {
        found.push_back(mode.frequency_hz.value);
      }
      return found;
    });
  }
  mark_front(study);
  return study;
}

}  // namespace rigfit::apps
