#include "signal/modal/local_modes.h"

#include "signal/estimation/pole_steps.h"
#include "signal/numerics/factorisations.h"
#include "signal/refinement/modal_noise.h"

namespace rigfit::signal {
namespace {

/// Half width of the window, half bandwidths of the mode, and at least so many lines.
constexpr double kBandwidths = 6, kLines = 8;

double half_bandwidth(const ModalBand& band, Complex pole) { return band.window - pole.real(); }

/// In half bandwidths; below half a line no data tell poles apart.
double gap(const ModalBand& band, Complex p, Complex q) {
  return apart(p, q, band.window, kTwoPi * band.spacing_hz);
}

/// Poles of one mode, or of few that overlap, on the lines s_k around them, with everything else as
/// a smooth background: column c of the FRFs is
///   H_c(s) = sum_r a_rc / (s - p_r) + sum_q a_qc / (s - p_q) + sum_{j=0..d} b_jc x^j,
/// p_r free, p_q of neighbours and fixed, x the frequency scaled to -1..1 in the window. The factor
/// s^n of mobility and accelerance, conjugate poles, modes further away and residual terms are
/// smooth there and part of the polynomial; a_rc is the receptance residue times p_r^n. The model
/// is analytic in the poles, so that complex least squares applies: amplitudes and background are
/// eliminated, poles move by steps (estimation/pole_steps.h) that never raise
///   sum_c w_c sum_k |H_c(s_k) - model|^2.
/// `usable` is false for too few lines, and for columns of the model that depend. Source: Ewins,
/// Modal Testing, 2nd ed., sec. 4.3 (single-mode methods, compensation for neighbouring modes).
struct LocalFit : PoleStage {
  VectorXcd s;
  MatrixXcd H;           ///< lines x columns
  MatrixXcd amplitudes;  ///< free poles x columns: a_rc
  MatrixXcd residual;    ///< lines x columns
  VectorXd misfit;       ///< columns: sum over lines of |residual|^2
  /// Free poles x columns: by how much `misfit` rises without that pole, the others kept.
  MatrixXd gain;
  /// sum_c w_c conj(a_rc) a_qc (D_r' D_q), D the derivatives of the free poles' columns outside the
  /// model's.
  MatrixXcd analytic_information;
  MatrixXcd outside;  ///< D: lines x free poles
  /// Covariance of the free poles for w_c = 1 / variance of a column's complex noise, white over
  /// lines.
  MatrixXcd covariance;
  /// The same from what the fit leaves at each line of all columns together (White, Econometrica 48
  /// (1980) 817): for noise that goes with |H| and is common to columns. Scatters when lines are
  /// few.
  MatrixXcd robust_covariance;
  Index freedom = 0;  ///< complex values a column less unknowns: lines - poles - d - 1
};

MatrixXcd columns_of(const VectorXcd& s, const VectorXcd& poles, const VectorXcd& fixed,
                     int order) {
  const Index lines = s.size(), free = poles.size(), all = free + fixed.size();
  MatrixXcd basis(lines, all + order + 1);
  for (Index r = 0; r < all; ++r) {
    basis.col(r) = (s.array() - (r < free ? poles[r] : fixed[r - free])).inverse();
  }
  const double low = s[0].imag(), high = s[lines - 1].imag();
  const VectorXd x = (2 * s.imag().array() - low - high) / (high - low);
  basis.col(all).setOnes();
  for (int j = 1; j <= order; ++j) {
    basis.col(all + j) = basis.col(all + j - 1).cwiseProduct(x.cast<Complex>());
  }
  return basis;
}

/// The fit at one set of free poles, without covariances.
LocalFit fit_at(const VectorXcd& s, const MatrixXcd& H, const VectorXd& weight,
                const VectorXcd& poles, const VectorXcd& fixed, int order) {
  LocalFit fit;
  fit.poles = poles;
  const Index free = poles.size();
  MatrixXcd basis = columns_of(s, poles, fixed, order);
  const VectorXd length = basis.colwise().norm().transpose();
  basis = basis * length.cwiseInverse().asDiagonal();
  const ThinQr<MatrixXcd> qr = thin_qr(basis);
  if (!(qr.R.diagonal().cwiseAbs().minCoeff() > 1e-10)) return fit;
  const MatrixXcd moments = qr.Q.adjoint() * H;
  const MatrixXcd all = qr.R.triangularView<Eigen::Upper>().solve(moments);
  fit.amplitudes = length.head(free).cwiseInverse().asDiagonal() * all.topRows(free);
  fit.residual = H - qr.Q * moments;
  fit.misfit = fit.residual.colwise().squaredNorm().transpose();
  fit.cost = fit.misfit.dot(weight);
  // |a|^2 over its unit variance: what a column of the model adds to the fit.
  const MatrixXcd inverse =
      qr.R.triangularView<Eigen::Upper>().solve(MatrixXcd::Identity(basis.cols(), basis.cols()));
  const VectorXd variance = inverse.topRows(free).rowwise().squaredNorm();
  fit.gain = variance.cwiseInverse().asDiagonal() * all.topRows(free).cwiseAbs2();
  MatrixXcd& D = fit.outside;
  D.resize(s.size(), free);
  for (Index r = 0; r < free; ++r) D.col(r) = (s.array() - poles[r]).square().inverse();
  D -= qr.Q * (qr.Q.adjoint() * D);
  const MatrixXcd conjugate = fit.amplitudes.conjugate();
  fit.analytic_information =
      (D.adjoint() * D).cwiseProduct(conjugate * weight.asDiagonal() * fit.amplitudes.transpose());
  fit.set_analytic(conjugate.cwiseProduct(D.adjoint() * fit.residual) * weight.cast<Complex>(),
                   fit.analytic_information);
  fit.usable = std::isfinite(fit.cost);
  return fit;
}

/// `weight`: w_c; `start`: free poles; `fixed`: neighbours; `order`: d; `step_in_std`: where the
/// steps of the poles end. Poles stay stable (Re p below Re s) and, in Im, within the window.
LocalFit fit_locally(const VectorXcd& s, const MatrixXcd& H, const VectorXd& weight,
                     const VectorXcd& start, const VectorXcd& fixed, int order,
                     double step_in_std) {
  const Index freedom = s.size() - start.size() - fixed.size() - order - 1;
  if (freedom < 2 || start.size() == 0) return {};
  const auto at = [&](const VectorXcd& poles) { return fit_at(s, H, weight, poles, fixed, order); };
  LocalFit fit = at(start);
  if (!fit.usable) return fit;
  PoleStepOptions steps;
  steps.max_iterations = 30;
  steps.step_in_std = step_in_std;
  steps.freedom = static_cast<double>(2 * freedom * H.cols());
  steps.rounding = 1e-28 * H.colwise().squaredNorm().dot(weight);
  steps.undamped = s[0].real();
  steps.low = s[0].imag(), steps.high = s[s.size() - 1].imag();
  take_pole_steps(steps, at, fit);
  fit.s = s, fit.H = H, fit.freedom = freedom;
  fit.covariance = hermitian_eigen(fit.analytic_information).pseudo_inverse();
  // Score of each line: sum_c w_c conj(a_rc D_kr) times what is left.
  const MatrixXcd score = fit.outside.conjugate().cwiseProduct(fit.residual * weight.asDiagonal() *
                                                               fit.amplitudes.adjoint());
  fit.robust_covariance = fit.covariance * (score.transpose() * score.conjugate()) *
                          fit.covariance *
                          (static_cast<double>(s.size()) / static_cast<double>(freedom));
  fit.usable = fit.covariance.allFinite();
  return fit;
}

/// Variance of a mean of lines that an exponential window correlates over that of independent ones.
double line_inflation(const ModalBand& band, Index lines) {
  const FrfNoise noise{{}, {}, {}, band.correlation_lines, band.lead};
  double sum = 1;
  for (Index d = 1; d <= std::min<Index>(8, lines / 5); ++d) {
    sum += 2 * line_correlation(noise, d).real();
  }
  return std::max(1.0, sum);
}

/// Fits of the candidates of one point.
struct PointFit {
  const ModalBand& band;
  const MatrixXcd& H;
  double twin_misfit, max_damping_ratio;
  double penalty = least_significance(H);

  LocalFit fit(const std::vector<Complex>& group, const std::vector<Complex>& others,
               double bandwidths, int order) const {
    Index first = band.frequency_hz.size(), end = 0;
    for (const Complex p : group) {
      const auto [from, count] = lines_around(band, p, kLines, bandwidths);
      first = std::min(first, from), end = std::max(end, from + count);
    }
    const Index stride = std::max<Index>(1, (end - first) / 1000);
    const Index count = std::max<Index>(0, end - first) / stride;
    const auto rows = Eigen::seqN(first, count, stride);
    const VectorXcd start = Map<const VectorXcd>(group.data(), std::ssize(group));
    std::vector<Complex> near;
    if (count < 2) return {};
    const VectorXcd s = band.lines.s(rows);
    const MatrixXcd part = H(rows, Eigen::all);
    for (const Complex p : others) {
      const double beyond = 3 * half_bandwidth(band, p);
      if (p.imag() > s[0].imag() - beyond && p.imag() < s[count - 1].imag() + beyond) {
        near.push_back(p);
      }
    }
    const VectorXcd fixed = Map<const VectorXcd>(near.data(), Index(near.size()));
    // Several columns weigh by what a first fit leaves of them, whose steps may end early: 0.3 of a
    // standard uncertainty adds 0.09 of a degree of freedom to the misfit. A tenth of the mean
    // keeps a column that is fitted by chance from deciding alone.
    VectorXd weight = VectorXd::Ones(H.cols());
    const bool several = H.cols() > 1;
    LocalFit fit = fit_locally(s, part, weight, start, fixed, order, several ? 0.3 : 3e-3);
    const double mean = fit.usable && several ? fit.misfit.mean() : 0;
    if (!(mean > 0)) return fit;
    weight = mean / (fit.misfit.array() + 0.1 * mean);
    return fit_locally(s, part, weight, fit.poles, fixed, order, 3e-3);
  }

  /// The weakest pole of a group that does not stand out; -1: all do.
  Index weakest(const LocalFit& fit) const {
    const double inflation = line_inflation(band, fit.residual.rows());
    Index worst = -1;
    double least = penalty;
    for (Index r = 0; r < fit.poles.size(); ++r) {
      const double value = significance(fit, r, inflation);
      if (value < least || !plausible(fit.poles[r])) {
        least = plausible(fit.poles[r]) ? value : -1;
        worst = r;
      }
    }
    return worst;
  }

  /// A pole of a group that another one beside it makes needless, and the fit `without` it; -1:
  /// none. Where resonances overlap, one pole must leave more than `twin_misfit` of the FRFs before
  /// a second is believed, or several times what two of like damping at a distance leave: a
  /// resonance that is not quite linear is fitted better by two poles than by one.
  Index needless_twin(const std::vector<Complex>& group, const std::vector<Complex>& others,
                      const LocalFit& both, std::optional<LocalFit>& without) const {
    for (Index r = 0; r < both.poles.size(); ++r) {
      for (Index q = 0; q < both.poles.size(); ++q) {
        if (q == r || gap(band, both.poles[r], both.poles[q]) > 1.5) continue;
        if (both.gain.row(r).sum() > both.gain.row(q).sum()) continue;
        const double hr = half_bandwidth(band, both.poles[r]);
        const double hq = half_bandwidth(band, both.poles[q]);
        const double distance = std::abs(both.poles[r].imag() - both.poles[q].imag()) / (hr + hq);
        const bool alike = std::max(hr, hq) < 2 * std::min(hr, hq);
        const double asked = !alike || distance < 0.5 ? std::numeric_limits<double>::infinity()
                             : distance < 0.8         ? 10
                                                      : 4;
        std::vector<Complex> fewer = group;
        fewer.erase(fewer.begin() + r);
        const LocalFit fit = this->fit(fewer, others, kBandwidths, 2);
        if (!fit.usable) continue;
        double worst = 0;
        const double left =
            std::max(misfit_around(both, both.poles[r]), misfit_around(both, both.poles[q]));
        for (const Complex pole : fit.poles) {
          if (gap(band, pole, both.poles[r]) > 1.5 && gap(band, pole, both.poles[q]) > 1.5) {
            continue;
          }
          worst = std::max(worst, misfit_around(fit, pole));
        }
        if (worst < twin_misfit && worst < asked * left) {
          without = fit;
          return r;
        }
      }
    }
    return -1;
  }

  /// Rms misfit over rms FRF within the half bandwidth of a pole.
  double misfit_around(const LocalFit& fit, Complex pole) const {
    const double half = std::max(half_bandwidth(band, pole), kTwoPi * band.spacing_hz);
    double above = 0, below = 0;
    for (Index k = 0; k < fit.residual.rows(); ++k) {
      if (std::abs(fit.s[k].imag() - pole.imag()) > half) continue;
      above += fit.residual.row(k).squaredNorm();
      below += fit.H.row(k).squaredNorm();
    }
    return below > 0 ? std::sqrt(above / below) : 0;
  }

  double significance(const LocalFit& fit, Index r, double inflation) const {
    const double floor = 1e-12 * H.squaredNorm() / static_cast<double>(H.size());
    double sum = 0;
    for (Index c = 0; c < H.cols(); ++c) {
      const double variance = fit.misfit[c] / static_cast<double>(fit.freedom) + floor;
      sum += 2 * fit.gain(r, c) / variance;
    }
    return sum / inflation;
  }

  bool plausible(Complex pole) const {
    const Complex raw = pole - band.window;
    return raw.real() < 0 && -raw.real() < max_damping_ratio * std::abs(raw);
  }
};

/// Candidates in groups whose resonances overlap.
std::vector<std::vector<Complex>> groups_of(const ModalBand& band, std::vector<Complex> poles) {
  std::ranges::sort(poles, {}, [](Complex pole) { return pole.imag(); });
  std::vector<std::vector<Complex>> groups;
  for (const Complex p : poles) {
    const bool joins =
        !groups.empty() && groups.back().size() < 6 &&
        std::ranges::any_of(groups.back(), [&](Complex q) { return gap(band, p, q) < 2; });
    if (joins) {
      groups.back().push_back(p);
    } else {
      groups.push_back({p});
    }
  }
  return groups;
}

std::vector<Complex> other_poles(const std::vector<std::vector<Complex>>& groups, std::size_t own) {
  std::vector<Complex> others;
  for (std::size_t g = 0; g < groups.size(); ++g) {
    if (g != own) others.insert(others.end(), groups[g].begin(), groups[g].end());
  }
  return others;
}

/// What the final fit of a group says about its pole r; `moved`: how far the pole goes with another
/// window and background.
PointPole described(const PointFit& point, const LocalFit& fit, Index r, double moved) {
  PointPole pole;
  pole.pole = fit.poles[r];
  const double inflation = line_inflation(point.band, fit.residual.rows());
  pole.significance = point.significance(fit, r, inflation);
  const auto freedom = static_cast<double>(fit.freedom);
  // The fit's weights are relative: mean misfit over (misfit + a tenth of it).
  const double mean = fit.misfit.mean();
  const double variance = inflation * 1.1 * mean / freedom;
  const double own = 0.5 * std::max({0.0, variance * fit.covariance(r, r).real(),
                                     inflation * fit.robust_covariance(r, r).real()});
  pole.std = std::sqrt(own + 0.5 * moved * moved);
  const Complex power = std::pow(pole.pole, point.band.lines.power);
  pole.residues = (fit.amplitudes.row(r) / power).transpose();
  pole.residue_std.resize(pole.residues.size());
  for (Index c = 0; c < pole.residues.size(); ++c) {
    const double norm = fit.gain(r, c) > 0 ? std::norm(fit.amplitudes(r, c)) / fit.gain(r, c) : 0;
    pole.residue_std[c] =
        std::sqrt(0.5 * inflation * norm * fit.misfit[c] / freedom / std::norm(power)) +
        std::sqrt(own) / half_bandwidth(point.band, pole.pole) * std::abs(pole.residues[c]);
  }
  const double gain = fit.gain.row(r).sum(), left = fit.misfit.sum();
  pole.explained = gain > 0 ? gain / (gain + left) : 0;
  pole.misfit = point.misfit_around(fit, pole.pole);
  return pole;
}

}  // namespace

bool points_are_inputs(const ModalBand& band) {
  const Index inputs = band.lines.inputs;
  return inputs > 1 && inputs * inputs >= band.lines.H.cols();
}

std::vector<std::vector<Index>> columns_of_points(const ModalBand& band) {
  const Index inputs = band.lines.inputs, responses = band.lines.H.cols() / inputs;
  const bool by_input = points_are_inputs(band);
  std::vector<std::vector<Index>> points(static_cast<std::size_t>(by_input ? inputs : responses));
  for (Index c = 0; c < band.lines.H.cols(); ++c) {
    if (band.lines.H.col(c).isZero(0)) continue;
    points[static_cast<std::size_t>(by_input ? c % inputs : c / inputs)].push_back(c);
  }
  return points;
}

std::vector<PointPole> point_poles(const ModalBand& band, const MatrixXcd& H, Index index,
                                   const VectorXcd& common, double twin_misfit,
                                   const ModalOptions& options) {
  std::vector<PointPole> result;
  if (H.cols() == 0) return result;
  const PointFit point{band, H, twin_misfit, options.lscf.max_damping_ratio};
  std::vector<std::vector<Complex>> groups = groups_of(band, {common.begin(), common.end()});
  // Rounds: each group against what the others were in the round before; what does not stand out
  // goes, the weakest first.
  for (int round = 0; round < 2; ++round) {
    for (std::size_t g = 0; g < groups.size(); ++g) {
      const std::vector<Complex> others = other_poles(groups, g);
      for (std::optional<LocalFit> fit, without; !groups[g].empty(); fit.swap(without)) {
        if (!fit) fit = point.fit(groups[g], others, kBandwidths, 2);
        Index worst = fit->usable ? point.weakest(*fit) : Index(groups[g].size()) - 1;
        if (worst < 0) worst = point.needless_twin(groups[g], others, *fit, without);
        if (worst < 0) {
          groups[g].assign(fit->poles.begin(), fit->poles.end());
          break;
        }
        groups[g].erase(groups[g].begin() + worst);
        fit.reset();
      }
    }
    std::vector<Complex> kept = other_poles(groups, groups.size());
    groups = groups_of(band, std::move(kept));
  }
  for (std::size_t g = 0; g < groups.size(); ++g) {
    const std::vector<Complex> others = other_poles(groups, g);
    const LocalFit fit = point.fit(groups[g], others, kBandwidths, 2);
    if (!fit.usable) continue;
    const std::vector<Complex> start(fit.poles.begin(), fit.poles.end());
    const LocalFit again = point.fit(start, others, 0.5 * kBandwidths, 1);
    for (Index r = 0; r < fit.poles.size(); ++r) {
      if (!point.plausible(fit.poles[r])) continue;
      const double half =
          std::max(half_bandwidth(band, fit.poles[r]), 0.5 * kTwoPi * band.spacing_hz);
      double moved = again.usable ? std::abs(again.poles[r] - fit.poles[r]) : half;
      if (moved > 0.5 * half) continue;
      PointPole pole = described(point, fit, r, moved);
      pole.point = index;
      if (pole.significance > point.penalty) result.push_back(std::move(pole));
    }
  }
  std::ranges::sort(result, {}, [](const auto& one) { return one.pole.imag(); });
  return result;
}

}  // namespace rigfit::signal
