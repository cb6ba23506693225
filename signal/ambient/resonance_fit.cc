#include "signal/ambient/resonance_fit.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "signal/numerics/factorisations.h"
#include "signal/numerics/numbers.h"
#include "signal/spectra/fft.h"

namespace rigfit::signal {
namespace {

using Complex = std::complex<double>;
using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Eigen::VectorXcd;
using Eigen::VectorXd;

// s L: with 2 the lag window's side lobes make spectra negative; decay times in L go with it.
constexpr double kWindowDecay = 4;
constexpr int kWeightRounds = 4;

/// Auto-spectra of residues 1 and i, and their derivatives by the real and the imaginary part.
struct TwoSided {
  MatrixXd value, by_real, by_imaginary;  // lines x 2
};

TwoSided two_sided(const LagSpectrum& spectrum, Complex pole, Index from, Index count) {
  VectorXcd d, e;
  const VectorXcd b = spectrum.basis(pole, from, count, &d);
  const VectorXcd c = spectrum.basis(std::conj(pole), from, count, &e);
  TwoSided t{MatrixXd(count, 2), MatrixXd(count, 2), MatrixXd(count, 2)};
  t.value << 2 * (b + c).real().array() - 2, -2 * (b - c).imag();
  t.by_real << 2 * (d + e).real(), -2 * (d - e).imag();
  t.by_imaginary << -2 * (d - e).imag(), -2 * (d + e).real();
  return t;
}

VectorXd damped_solve(const MatrixXd& A, const VectorXd& right, double damping) {
  const VectorXd d = A.diagonal().cwiseMax(1e-200).cwiseSqrt().cwiseInverse();
  MatrixXd scaled = d.asDiagonal() * A * d.asDiagonal();
  scaled.diagonal().array() += damping + 1e-9;
  return d.asDiagonal() * scaled.llt().solve(d.asDiagonal() * right);
}

VectorXcd pairs_of(const VectorXd& step) {
  VectorXcd result(step.size() / 2);
  for (Index i = 0; i < result.size(); ++i) result[i] = {step[2 * i], step[2 * i + 1]};
  return result;
}

struct Evaluation {
  ResonanceFit fit;
  VectorXd gradient;
};

Evaluation evaluate(const LagSpectrum& spectrum, const std::vector<FilteredSpectrum>& signals,
                    const VectorXcd& poles) {
  const Index n = poles.size();
  Evaluation at;
  at.fit.poles = poles;
  at.fit.normal = MatrixXd::Zero(2 * n, 2 * n);
  at.gradient = VectorXd::Zero(2 * n);
  at.fit.own_share = VectorXd::Zero(n);
  for (Index q = 0; q < n; ++q) {
    const auto& signal = signals[static_cast<std::size_t>(q)];
    const auto used = static_cast<Index>(signal.modes.size());
    const VectorXd v = signal.S0.cwiseInverse();
    MatrixXd X(signal.count, 2 * used + 2);
    std::vector<TwoSided> parts;
    for (Index a = 0; a < used; ++a) {
      const Complex pole = poles[signal.modes[static_cast<std::size_t>(a)]];
      parts.push_back(two_sided(spectrum, pole, signal.from, signal.count));
      X.middleCols(2 * a, 2) = v.asDiagonal() * parts.back().value;
    }
    X.col(2 * used) = v;
    X.col(2 * used + 1) = v.cwiseProduct(VectorXd::LinSpaced(signal.count, -1, 1));
    const VectorXd scale = X.colwise().norm().cwiseMax(1e-200).cwiseInverse().transpose();
    const auto qr = thin_qr(X * scale.asDiagonal());
    const VectorXd z = v.cwiseProduct(signal.S);
    const VectorXd c =
        scale.asDiagonal() * qr.R.triangularView<Eigen::Upper>().solve(qr.Q.transpose() * z);
    const VectorXd explained = X * c, left = z - explained;
    MatrixXd J = MatrixXd::Zero(signal.count, 2 * n);
    for (Index a = 0; a < used; ++a) {
      const Index mode = signal.modes[static_cast<std::size_t>(a)];
      if (a >= used - signal.skirts) break;
      const auto& part = parts[static_cast<std::size_t>(a)];
      const Eigen::Vector2d residue = c.segment(2 * a, 2);
      J.col(2 * mode) = v.cwiseProduct(part.by_real * residue);
      J.col(2 * mode + 1) = v.cwiseProduct(part.by_imaginary * residue);
      if (mode != q) continue;
      Index peak = 0;
      (spectrum.omega.segment(signal.from, signal.count).array() - std::abs(poles[q]))
          .abs()
          .minCoeff(&peak);
      at.fit.own_share[q] = (part.value * residue)[peak] / std::max(signal.S[peak], 1e-30);
    }
    J -= qr.Q * (qr.Q.transpose() * J);
    at.fit.cost += left.squaredNorm();
    at.fit.normal += J.transpose() * J;
    at.gradient += J.transpose() * left;
    at.fit.to_gradient.push_back(J.transpose() * v.asDiagonal());
    at.fit.model.push_back(explained.cwiseProduct(signal.S0));
  }
  return at;
}

/// Levenberg and Marquardt's steps; no pole moves by more than half of its bandwidth at once.
Evaluation minimise(const LagSpectrum& spectrum, const std::vector<FilteredSpectrum>& signals,
                    const VectorXcd& start) {
  Evaluation best = evaluate(spectrum, signals, start);
  double damping = 1e-3;
  for (int k = 0; k < 30 && damping < 1e6; ++k) {
    VectorXcd step = pairs_of(damped_solve(best.fit.normal, best.gradient, damping));
    if (!step.allFinite()) break;
    const VectorXd half = best.fit.poles.real().cwiseAbs();
    for (Index i = 0; i < step.size(); ++i) {
      step[i] *= std::min(1.0, 0.5 * half[i] / std::max(std::abs(step[i]), 1e-30));
    }
    Evaluation next = evaluate(spectrum, signals, best.fit.poles + step);
    if (next.fit.cost <= best.fit.cost * (1 + 1e-12)) {
      best = std::move(next);
      damping = std::max(damping / 5, 1e-9);
      if ((step.cwiseAbs().array() / half.array()).maxCoeff() < 1e-5) break;
    } else {
      damping *= 8;
    }
  }
  return best;
}

}  // namespace

LagSpectrum::LagSpectrum(double rate_hz, Index lag_count, double low_hz, double high_hz)
    : dt(1 / rate_hz),
      decay(kWindowDecay * rate_hz / static_cast<double>(lag_count)),
      lags(lag_count),
      length(good_fft_length(2 * lag_count + 2)) {
  const double line_hz = rate_hz / static_cast<double>(length);
  first = std::max<Index>(1, static_cast<Index>(std::ceil(low_hz / line_hz)));
  const Index last = std::min(length / 2, static_cast<Index>(high_hz / line_hz));
  const auto count = std::max<Index>(last - first + 1, 0);
  omega = VectorXd::LinSpaced(count, static_cast<double>(first), static_cast<double>(last)) *
          (kTwoPi * line_hz);
}

MatrixXcd LagSpectrum::half(const Eigen::Ref<const MatrixXd>& R, Index from, Index count) const {
  const VectorXd window =
      (VectorXd::LinSpaced(lags + 1, 0, static_cast<double>(lags)) * (-decay * dt)).array().exp();
  MatrixXcd result(count, R.cols());
  RealFft fft(length);
  for (Index c = 0; c < R.cols(); ++c) {
    fft.time().setZero();
    fft.time().head(lags + 1) = R.col(c).cwiseProduct(window);
    fft.time()[0] *= 0.5;
    fft.forward();
    result.col(c) = fft.spectrum().segment(first + from, count);
  }
  return result;
}

VectorXcd LagSpectrum::basis(Complex pole, Index from, Index count, VectorXcd* slope) const {
  VectorXcd b(count);
  if (slope) slope->resize(count);
  const auto terms = static_cast<double>(lags + 1);
  for (Index l = 0; l < count; ++l) {
    const Complex rate = (pole - Complex(decay, omega[from + l])) * dt;
    const Complex x = std::exp(rate), xL = std::exp(rate * terms), under = 1.0 / (1.0 - x);
    b[l] = (1.0 - xL) * under;
    if (slope) (*slope)[l] = dt * under * (x * (1.0 - xL) * under - terms * xL);
  }
  return b;
}

VectorXcd ResonanceFit::change(const std::vector<VectorXd>& of_S) const {
  VectorXd gradient = VectorXd::Zero(normal.rows());
  for (std::size_t q = 0; q < of_S.size(); ++q) gradient += to_gradient[q] * of_S[q];
  return pairs_of(damped_solve(normal, gradient, 0));
}

ResonanceFit fit_resonances(const LagSpectrum& spectrum, std::vector<FilteredSpectrum>& signals,
                            VectorXcd poles) {
  ResonanceFit fit;
  for (int round = 0; round < kWeightRounds; ++round) {
    for (std::size_t q = 0; q < signals.size(); ++q) {
      FilteredSpectrum& signal = signals[q];
      const double low = spectrum.omega[signal.from],
                   high = spectrum.omega[signal.from + signal.count - 1];
      signal.modes.clear();
      for (Index i = 0; i < poles.size(); ++i) {
        const double beyond = 2 * (spectrum.decay - poles[i].real());
        if (signal.nulled[static_cast<std::size_t>(i)] || poles[i].imag() < low - beyond ||
            poles[i].imag() > high + beyond) {
          continue;
        }
        signal.modes.push_back(i);
      }
      // Fewer unknowns than lines: the nearest modes.
      const auto most = static_cast<std::size_t>((signal.count - 3) / 2);
      const Complex own = poles[static_cast<Index>(q)];
      std::stable_sort(signal.modes.begin(), signal.modes.end(), [&](Index a, Index b) {
        return std::abs(poles[a] - own) < std::abs(poles[b] - own);
      });
      if (signal.modes.size() > most) signal.modes.resize(most);
      std::sort(signal.modes.begin(), signal.modes.end());
      // What reaches in from the nearest modes outside: their poles are told elsewhere.
      signal.skirts = 0;
      for (const bool above : {false, true}) {
        Index nearest = -1;
        for (Index i = 0; i < poles.size(); ++i) {
          const double off = poles[i].imag() - (above ? high : low);
          const bool outside = above ? off > 0 : off < 0;
          if (!outside || signal.nulled[static_cast<std::size_t>(i)] ||
              std::count(signal.modes.begin(), signal.modes.end(), i) > 0) {
            continue;
          }
          if (nearest < 0 || above == (poles[i].imag() < poles[nearest].imag())) nearest = i;
        }
        if (nearest < 0 || signal.modes.size() >= most) continue;
        signal.modes.push_back(nearest), ++signal.skirts;
      }
    }
    fit = minimise(spectrum, signals, poles).fit;
    for (Index i = 0; i < poles.size(); ++i) {
      const double least = -1e-5 * std::abs(fit.poles[i]);
      poles[i] = {std::min(fit.poles[i].real(), least), fit.poles[i].imag()};
    }
    fit.poles = poles;
    for (std::size_t q = 0; q < signals.size(); ++q) {
      signals[q].S0 = fit.model[q].cwiseMax(1e-3 * fit.model[q].maxCoeff()).cwiseMax(1e-12);
    }
  }
  return fit;
}

}  // namespace rigfit::signal
