#include "signal/modal/modal_identification.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <utility>

#include "signal/estimation/groups.h"
#include "signal/modal/mode_shapes.h"
#include "signal/modal/pole_fit.h"
#include "signal/modal/pole_scan.h"
#include "signal/modal/pole_sweep.h"
#include "signal/modes/mac.h"
#include "signal/modes/modal_synthesis.h"
#include "signal/numerics/numbers.h"
#include "signal/poles/pole_clusters.h"

namespace rigfit::signal {
namespace {

using Complex = std::complex<double>;
using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Eigen::VectorXcd;
using Eigen::VectorXd;

constexpr double kAgree = 0.05;  // chance below which groups differ
constexpr double kNormal95 = 1.959964;

/// Poles of the stabilisation diagram that stay over its orders, and the diagram within the band.
VectorXcd diagram(const ModalData& data, const MatrixXcd& H, Index inputs,
                  const ModalOptions& options, LscfResult& shown) {
  const VectorXd rms = H.colwise().norm().transpose();
  const VectorXd weight = (rms.array() > 0).select(rms.array().inverse(), 0.0);
  shown = lscf(data.frequency_hz, H, inputs, {}, weight, options.lscf);
  std::vector<Complex> poles;
  for (const PoleCluster& cluster : cluster_poles(shown, data.spacing_hz)) {
    poles.push_back(cluster.pole_rad_s + data.window);
  }
  std::erase_if(shown.poles, [&](const StabilisationPole& pole) {
    return pole.frequency_hz < data.low_hz || pole.frequency_hz > data.high_hz;
  });
  return Eigen::Map<VectorXcd>(poles.data(), static_cast<Index>(poles.size()));
}

VectorXcd search(const ModalData& data, const VectorXcd& first, double max_damping) {
  VectorXcd poles = sweep_poles(data, first, max_damping);
  constexpr int kMostRounds = 5;
  for (int round = 0; round < kMostRounds; ++round) {
    const std::vector<Complex> more = scan_poles(data, residual_of(data, poles));
    if (more.empty()) break;
    VectorXcd all(poles.size() + static_cast<Index>(more.size()));
    all << poles, Eigen::Map<const VectorXcd>(more.data(), static_cast<Index>(more.size()));
    VectorXcd swept = sweep_poles(data, all, max_damping);
    const bool gained = swept.size() > poles.size();
    poles = std::move(swept);
    if (!gained) break;
  }
  return poles;
}

/// One part of a pole (its frequency or its decay) with its uncertainty.
struct PolePart {
  Estimate value;  ///< +-1.96 std hold 95 %
  double between = 0, chance = 1;
  Index farthest = 0;  ///< of the groups that see it
};

PolePart pole_part(double common, double variance, double degrees, const std::vector<double>& own,
                   const std::vector<double>& own_variance) {
  PolePart part;
  part.value = {common, std::sqrt(variance) * coverage_factor(0.95, degrees) / kNormal95};
  if (own.size() < 2) return part;
  const GroupMean mean = mean_over_groups(own, own_variance);
  // Scatter that chance may still give counts as noise that is larger than it looks.
  part.value.std *= std::sqrt(std::max(1.0, mean.cochran_Q / static_cast<double>(own.size() - 1)));
  part.chance = mean.chance;
  if (!(mean.chance < kAgree)) return part;
  part.between = std::sqrt(mean.between_variance);
  part.value = {mean.mean,
                std::sqrt(mean.variance) * coverage_factor(0.95, mean.degrees) / kNormal95};
  double most = -1;
  for (std::size_t g = 0; g < own.size(); ++g) {
    const double away = std::abs(own[g] - mean.mean);
    if (away > most) most = away, part.farthest = static_cast<Index>(g);
  }
  return part;
}

class Identification {
 public:
  Identification(const FrfSet& frfs, const ModalOptions& options)
      : frfs_(frfs), options_(options), inputs_(static_cast<Index>(frfs.inputs.size())) {}

  ModalResult run() {
    ModalModel& model = result_.model;
    model.responses = frfs_.responses;
    model.inputs = frfs_.inputs;
    model.fitted_form = frfs_.form;
    model.exponential_decay_rate_1_s = frfs_.exponential_decay_rate_1_s;
    data_ = modal_data(frfs_, options_.low_hz, options_.high_hz, model.notes);
    if (frfs_.form == FrfForm::unknown) {
      model.notes.push_back({"form_unknown",
                             "the FRFs do not say whether they are receptances, mobilities or "
                             "accelerances: the units of shapes and residuals are not known",
                             ""});
    }
    count_lines();
    if (data_.Y.cols() == 0) {
      model.notes.push_back({"no_modes", "all FRFs are zero", ""});
    } else {
      const MatrixXcd H = averages_at(data_, frfs_);
      const VectorXcd first = diagram(data_, H, inputs_, options_, result_.stabilisation);
      const VectorXcd poles = search(data_, first, options_.lscf.max_damping_ratio);
      for (const auto& block : blocks_of(data_, poles)) describe_block(poles, block);
      if (model.modes.empty()) {
        model.notes.push_back(
            {"no_modes", "nothing in the band stands out of the noise as a resonance", ""});
      }
    }
    finish();
    return std::move(result_);
  }

 private:
  void count_lines() {
    for (Index k = 0; k < data_.frequency_hz.size(); ++k) {
      const double f = data_.frequency_hz[k];
      if (f < data_.low_hz || f > data_.high_hz) continue;
      if (result_.lines_used == 0) result_.low_hz = f;
      result_.high_hz = f;
      ++result_.lines_used;
    }
  }

  void describe_block(const VectorXcd& poles, const std::vector<Index>& block) {
    const PoleWindow window = window_of(data_, data_.Y, poles, block);
    VectorXcd start(static_cast<Index>(block.size()));
    for (Index r = 0; r < start.size(); ++r) start[r] = poles[block[static_cast<std::size_t>(r)]];
    const PoleFit fit = fit_common_poles(window, start);
    const double shared = shared_noise(data_, window, fit);
    const MatrixXcd covariance = shared * pole_covariance(data_, window, fit);
    const VectorXd F = gains(data_, window, fit) / shared;
    const auto m = static_cast<Index>(block.size());
    const auto begin = static_cast<Index>(covariances_.size());
    for (Index r = 0; r < m; ++r) {
      IdentifiedMode mode = describe(window, fit, covariance, shared, F, r);
      if (mode.frequency_hz.value < data_.low_hz || mode.frequency_hz.value > data_.high_hz)
        continue;
      result_.model.modes.push_back(std::move(mode));
      covariances_.push_back({covariance, r});
    }
    // Modes of one block share its covariance.
    for (auto i = static_cast<std::size_t>(begin); i < covariances_.size(); ++i) {
      covariances_[i].block = begin;
    }
  }

  IdentifiedMode describe(const PoleWindow& window, const PoleFit& fit, const MatrixXcd& covariance,
                          double shared, const VectorXd& F, Index r) {
    const GroupPoles own = poles_by_group(data_, window, fit, r);
    std::vector<double> decay, omega, variance;
    std::vector<Index> groups;
    for (Index g = 0; g < data_.groups(); ++g) {
      if (!own.near[static_cast<std::size_t>(g)]) continue;
      groups.push_back(g);
      decay.push_back(-own.pole[g].real());
      omega.push_back(own.pole[g].imag());
      variance.push_back(own.variance[g] * shared);
    }
    const Complex p = fit.poles[r];
    const double formal = 0.5 * covariance(r, r).real();
    const double degrees =
        2 * fit.freedom / data_.lines_a_value() * static_cast<double>(fit.weights.size()) - 2;
    const PolePart frequency = pole_part(p.imag(), formal, degrees, omega, variance);
    const PolePart damping = pole_part(-p.real(), formal, degrees, decay, variance);

    IdentifiedMode mode;
    mode.pole_rad_s = {-damping.value.value, frequency.value.value};
    const double x = mode.pole_rad_s.real(), y = mode.pole_rad_s.imag(),
                 w = std::abs(mode.pole_rad_s);
    mode.frequency_hz.value = w / kTwoPi;
    mode.damping_ratio.value = -x / w;
    mode.frequency_hz.std = std::hypot(x * damping.value.std, y * frequency.value.std) / w / kTwoPi;
    mode.damping_ratio.std =
        std::hypot(y * y * damping.value.std, x * y * frequency.value.std) / (w * w * w);
    const Complex raw = mode.pole_rad_s - data_.window;
    mode.damping_ratio_with_window = -raw.real() / std::abs(raw);
    mode.damping_dominated_by_window = data_.window > -0.5 * raw.real();
    mode.significance = std::sqrt(F[r]);
    const bool differ = frequency.between > 0 || damping.between > 0;
    if (!data_.hits) {
      mode.between_points_std_hz = frequency.between / kTwoPi;
      mode.between_points_std_damping = damping.between / w;
      if (data_.groups() > 1) fill_points(own, groups, mode);
    }
    if (differ) {
      const double half = -raw.real();
      const PolePart& most = frequency.between > damping.between ? frequency : damping;
      if (most.between / half > differ_.part) {
        differ_ = {
            most.between / half, mode.frequency_hz.value, most.between / kTwoPi,
            data_.member[static_cast<std::size_t>(groups[static_cast<std::size_t>(most.farthest)])],
            most.chance};
      }
    }
    fill_mode_shape(data_, frfs_, fit, covariance, r, differ && !data_.hits ? &own : nullptr, mode);
    double misfit = 0;
    for (const double one : own.misfit) misfit += one * one;
    mode.reconstruction_error = std::sqrt(misfit / static_cast<double>(own.misfit.size()));
    judge(own, fit, F, r, mode);
    return mode;
  }

  void fill_points(const GroupPoles& own, const std::vector<Index>& groups, IdentifiedMode& mode) {
    for (const Index g : groups) {
      const auto i = static_cast<std::size_t>(g);
      const auto member = static_cast<std::size_t>(data_.member[i]);
      ModeAtPoint point;
      point.point = data_.inputs_vary ? frfs_.inputs[member] : frfs_.responses[member];
      point.order = data_.member[i];
      const double w = std::abs(own.pole[g]), std = std::sqrt(own.variance[g]);
      point.frequency_hz = {w / kTwoPi, std / kTwoPi};
      point.damping_ratio = {-own.pole[g].real() / w, std / w};
      point.misfit = own.misfit[i];
      mode.points.push_back(point);
    }
  }

  void judge(const GroupPoles& own, const PoleFit& fit, const VectorXd& F, Index r,
             IdentifiedMode& mode) const {
    std::vector<std::string> doubts;
    const auto groups = static_cast<double>(data_.groups());
    const auto near = static_cast<double>(std::count(own.near.begin(), own.near.end(), true));
    if (data_.groups() > 2 && near < groups * (data_.hits ? kShare : 1.0 / 3)) {
      doubts.push_back(
          fmt::format("seen by {:.0f} of {:.0f} {}", near, groups, data_.hits ? "hits" : "points"));
    }
    for (Index q = 0; q < fit.poles.size(); ++q) {
      const double together = 2 * data_.window - fit.poles[q].real() - fit.poles[r].real();
      if (q == r || F[q] < F[r] || data_.Y.cols() / (data_.hits ? data_.groups() : 1) > 2 ||
          std::abs(fit.poles[q] - fit.poles[r]) > together) {
        continue;
      }
      doubts.push_back(fmt::format("one FRF cannot tell it from a change of the mode at {:.4g} Hz",
                                   fit.poles[q].imag() / kTwoPi));
    }
    const double part = mode.damping_ratio.std / mode.damping_ratio.value;
    if (!(part > 0 && part < 0.25)) {
      doubts.push_back(part > 0 && part < 10
                           ? fmt::format("damping known to {:.0f} % only", 100 * part)
                           : std::string("damping not determined"));
    }
    if (own.left > own.size) doubts.emplace_back("its fit leaves more than its own peak");
    mode.sure_but_for_window = mode.damping_dominated_by_window && doubts.empty();
    if (mode.damping_dominated_by_window) {
      const double decay = -mode.pole_rad_s.real();
      doubts.push_back(fmt::format(
          "the window gives {:.0f} % of the measured decay rate: damping refused, frequency kept",
          100 * data_.window / (decay + data_.window)));
    }
    mode.doubtful = !doubts.empty();
    for (const std::string& one : doubts) mode.doubt += (mode.doubt.empty() ? "" : "; ") + one;
  }

  void finish() {
    ModalModel& model = result_.model;
    std::vector<std::size_t> order(model.modes.size());
    for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
    std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
      return model.modes[a].frequency_hz.value < model.modes[b].frequency_hz.value;
    });
    std::vector<IdentifiedMode> modes;
    for (const std::size_t i : order) modes.push_back(model.modes[i]);
    model.modes = std::move(modes);
    fill_covariance(order);
    const auto responses = static_cast<Index>(frfs_.responses.size());
    MatrixXcd shapes(responses, static_cast<Index>(order.size()));
    for (std::size_t i = 0; i < order.size(); ++i) {
      shapes.col(static_cast<Index>(i)) = model.modes[i].shape;
    }
    result_.auto_mac = auto_mac(shapes);
    fit_residuals(frfs_, result_.low_hz, result_.high_hz, model);
    if (!(differ_.part > 0)) return;
    const std::string who =
        data_.hits ? fmt::format("hit {}", differ_.group + 1)
                   : (data_.inputs_vary ? frfs_.inputs
                                        : frfs_.responses)[static_cast<std::size_t>(differ_.group)]
                         .name;
    model.notes.push_back(
        {"groups_differ",
         fmt::format(
             "{} differ by more than noise, most at {:.4g} Hz: by {:.2g} Hz, {:.0f} % of the "
             "half bandwidth; {} is farthest from the mean. Intervals allow for it",
             data_.hits ? "hits" : "points", differ_.frequency_hz, differ_.size_hz,
             100 * differ_.part, who),
         ""});
  }

  /// Covariance of frequencies and damping ratios: that of a block's common fit, scaled to the
  /// standard deviations given.
  void fill_covariance(const std::vector<std::size_t>& order) {
    ModalModel& model = result_.model;
    const auto size = static_cast<Index>(2 * order.size());
    model.pole_covariance = MatrixXd::Zero(size, size);
    const auto jacobian = [&](Complex pole) {
      const double x = pole.real(), y = pole.imag(), w = std::abs(pole);
      Eigen::Matrix2d J;
      J << x / (w * kTwoPi), y / (w * kTwoPi), -y * y / (w * w * w), x * y / (w * w * w);
      return J;
    };
    for (std::size_t i = 0; i < order.size(); ++i) {
      for (std::size_t j = 0; j < order.size(); ++j) {
        const Shared& a = covariances_[order[i]];
        const Shared& b = covariances_[order[j]];
        if (a.block != b.block) continue;
        const Complex V = a.covariance(a.row, b.row) / 2.0;
        Eigen::Matrix2d C;
        C << V.real(), -V.imag(), V.imag(), V.real();
        model.pole_covariance.block<2, 2>(static_cast<Index>(2 * i), static_cast<Index>(2 * j)) =
            jacobian(model.modes[i].pole_rad_s) * C *
            jacobian(model.modes[j].pole_rad_s).transpose();
      }
    }
    VectorXd scale(size);
    for (std::size_t i = 0; i < order.size(); ++i) {
      const auto row = static_cast<Index>(2 * i);
      const auto& mode = model.modes[i];
      scale[row] = mode.frequency_hz.std / std::sqrt(model.pole_covariance(row, row));
      scale[row + 1] = mode.damping_ratio.std / std::sqrt(model.pole_covariance(row + 1, row + 1));
    }
    model.pole_covariance = scale.asDiagonal() * model.pole_covariance * scale.asDiagonal();
  }

  struct Shared {
    MatrixXcd covariance;
    Index row = 0, block = 0;
  };
  struct Differ {
    double part = 0, frequency_hz = 0, size_hz = 0;
    Index group = 0;
    double chance = 1;
  };

  const FrfSet& frfs_;
  const ModalOptions& options_;
  Index inputs_;
  ModalData data_;
  ModalResult result_;
  std::vector<Shared> covariances_;
  Differ differ_;
};

}  // namespace

ModalResult identify_modes(const FrfSet& frfs, const ModalOptions& options) {
  return Identification(frfs, options).run();
}

}  // namespace rigfit::signal
