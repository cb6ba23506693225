#include "signal/ambient/ambient_steps.h"

#include "signal/numerics/factorisations.h"
#include "signal/spectra/fft.h"

namespace rigfit::signal {
namespace {

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

ResonanceFit fit_at(const LagSpectrum& spectrum, const std::vector<FilteredSpectrum>& signals,
                    const VectorXcd& poles) {
  const Index n = poles.size();
  ResonanceFit at;
  at.poles = poles;
  at.information = MatrixXd::Zero(2 * n, 2 * n);
  at.gradient = VectorXd::Zero(2 * n);
  at.own_share = VectorXd::Zero(n);
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
    for (Index a = 0; a < signal.moving; ++a) {
      const Index mode = signal.modes[static_cast<std::size_t>(a)];
      const auto& part = parts[static_cast<std::size_t>(a)];
      const Eigen::Vector2d residue = c.segment(2 * a, 2);
      J.col(2 * mode) = v.cwiseProduct(part.by_real * residue);
      J.col(2 * mode + 1) = v.cwiseProduct(part.by_imaginary * residue);
      if (mode != q) continue;
      Index peak = 0;
      (spectrum.omega.segment(signal.from, signal.count).array() - std::abs(poles[q]))
          .abs()
          .minCoeff(&peak);
      at.own_share[q] = (part.value * residue)[peak] / std::max(signal.S[peak], 1e-30);
    }
    J -= qr.Q * (qr.Q.transpose() * J);
    at.cost += left.squaredNorm();
    at.information += J.transpose() * J;
    at.gradient += J.transpose() * left;
    at.to_gradient.push_back(J.transpose() * v.asDiagonal());
    at.model.push_back(explained.cwiseProduct(signal.S0));
  }
  at.usable = std::isfinite(at.cost);
  return at;
}

/// The modes that the model of a signal has: those in its band, and the nearest on either side of
/// it, which reach in and whose poles are told elsewhere; fewer unknowns than lines.
void choose_modes(const LagSpectrum& spectrum, const VectorXcd& poles, Index own,
                  FilteredSpectrum& signal) {
  const double low = spectrum.omega[signal.from],
               high = spectrum.omega[signal.from + signal.count - 1];
  const auto apart = [&](Index i) { return std::abs(poles[i] - poles[own]); };
  const auto most = static_cast<std::size_t>((signal.count - 3) / 2);
  Index beside[2] = {-1, -1};
  signal.modes.clear();
  for (Index i = 0; i < poles.size(); ++i) {
    if (signal.nulled[static_cast<std::size_t>(i)]) continue;
    const double beyond = 2 * (spectrum.decay - poles[i].real()), w = poles[i].imag();
    Index& nearest = beside[w > high];
    if (w > low - beyond && w < high + beyond) {
      signal.modes.push_back(i);
    } else if (nearest < 0 || apart(i) < apart(nearest)) {
      nearest = i;
    }
  }
  std::ranges::stable_sort(signal.modes, {}, apart);
  signal.modes.resize(std::min(most, signal.modes.size()));
  signal.moving = std::ssize(signal.modes);
  for (const Index i : beside) {
    if (i >= 0 && signal.modes.size() < most) signal.modes.push_back(i);
  }
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

MatrixXcd LagSpectrum::half(const Ref<const MatrixXd>& R, Index from, Index count) const {
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
  VectorXd moved = VectorXd::Zero(information.rows());
  for (std::size_t q = 0; q < of_S.size(); ++q) moved += to_gradient[q] * of_S[q];
  MatrixXd solvable = information;  // whatever cannot be told apart
  solvable.diagonal() = (solvable.diagonal() * (1 + 1e-9)).cwiseMax(1e-200);
  moved = ScaledGram(solvable).solve_vector(moved);
  return moved(Eigen::seq(0, Eigen::last, 2)) +
         Complex(0, 1) * moved(Eigen::seq(1, Eigen::last, 2));
}

ResonanceFit fit_resonances(const LagSpectrum& spectrum, std::vector<FilteredSpectrum>& signals,
                            VectorXcd poles) {
  ResonanceFit fit;
  const auto weigh = [](FilteredSpectrum& signal, const VectorXd& S) {
    signal.S0 = S.cwiseMax(1e-3 * S.maxCoeff()).cwiseMax(1e-12);
  };
  for (FilteredSpectrum& signal : signals) weigh(signal, signal.S.cwiseAbs());
  for (int round = 0; round < kWeightRounds; ++round) {
    for (Index q = 0; q < poles.size(); ++q) {
      choose_modes(spectrum, poles, q, signals[static_cast<std::size_t>(q)]);
    }
    PoleStepOptions steps;
    steps.freedom = 0;
    for (const auto& signal : signals) {
      steps.freedom +=
          static_cast<double>(signal.count) - static_cast<double>(2 * (signal.modes.size() + 2));
    }
    steps.freedom = std::max(steps.freedom, 1.0);
    const auto at = [&](const VectorXcd& there) { return fit_at(spectrum, signals, there); };
    fit = at(poles);
    take_pole_steps(steps, at, fit);
    poles.imag() = fit.poles.imag();
    poles.real() = fit.poles.real().cwiseMin(-1e-5 * fit.poles.cwiseAbs());
    fit.poles = poles;
    for (std::size_t q = 0; q < signals.size(); ++q) weigh(signals[q], fit.model[q]);
  }
  return fit;
}

}  // namespace rigfit::signal
