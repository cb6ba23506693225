#include "signal/ambient/ambient_steps.h"

#include <Eigen/QR>

#include "signal/numerics/factorisations.h"

namespace rigfit::signal {
namespace {

// The window then widens a mode by a third; with 4, of pairs 0.5 % apart 5 % more are lost.
constexpr double kDecayTimesOfLags = 12;
constexpr double kMostValues = 1 << 23;  // 128 MiB of spectra

/// The six channels that tell most: pivots of the QR of the spectral matrices over their traces.
std::vector<Index> telling_channels(const MatrixXcd& half, Index n) {
  MatrixXcd stacked(half.rows() * n, n);
  for (Index l = 0; l < half.rows(); ++l) {
    const VectorXcd row = half.row(l);
    const MatrixXcd S = row.reshaped(n, n);
    stacked.middleRows(l * n, n) = (S + S.adjoint()) / S.trace().real();
  }
  const Eigen::ColPivHouseholderQR<MatrixXcd> qr(stacked);
  const auto order = qr.colsPermutation().indices().head(std::min<Index>(n, 6));
  std::vector<Index> channels(order.begin(), order.end());
  std::ranges::sort(channels);
  return channels;
}

}  // namespace

VectorXcd phase_real(VectorXcd v) {
  v.normalize();
  return v * std::polar(1.0, -0.5 * std::arg(v.cwiseProduct(v).sum()));
}

AmbientCandidates find_candidates(const AmbientSignals& signals, const AmbientOptions& options,
                                  AmbientResult& result, std::vector<Index> references) {
  AmbientCandidates found;
  auto& [spectrum, pairs, poles, presence, shapes] = found;
  const double duration = static_cast<double>(signals.samples()) / signals.rate_hz();
  const double rate = signals.rate_hz(), low = result.low_hz, high = result.high_hz;
  const Index No = signals.channels();
  const double pairs_of_lines = 2 * high * static_cast<double>(No * No);  // of a second of lags
  const double longest = std::min(duration / 8, std::max(20 / high, kMostValues / pairs_of_lines));
  double lag = std::min({duration / 16, 60 / low, longest});
  std::vector<PoleCluster> clusters;
  for (int round = 0; round < 3; ++round) {
    const auto lags = static_cast<Index>(lag * rate);
    spectrum.emplace(rate, lags, low, high);
    if (spectrum->omega.size() < 2 * kFewestLines) return found;
    pairs.setZero(spectrum->omega.size(), No * No);
    group_correlations(signals, MatrixXd::Identity(No, No), lags, 1, std::max(options.threads, 1),
                       [&](int, const MatrixXd& R) {
                         const Index lines = found.pairs.rows();
                         found.pairs = found.spectrum->half(R.bottomRows(lags + 1), 0, lines);
                       });
    if (references.empty()) references = telling_channels(pairs, No);
    const auto Ni = static_cast<Index>(references.size());
    const auto every_second = Eigen::seq(0, Eigen::last, 2);  // 1 / L apart
    const VectorXd hz = spectrum->omega(every_second) / kTwoPi;
    VectorXd weight(No * Ni);
    MatrixXcd H(hz.size(), No * Ni);
    for (Index o = 0; o < No; ++o) {
      for (Index i = 0; i < Ni; ++i) {
        H.col(o * Ni + i) = pairs(every_second, references[static_cast<std::size_t>(i)] * No + o);
      }
      weight.segment(o * Ni, Ni).setConstant(1 / H.middleCols(o * Ni, Ni).norm());
    }
    LscfOptions lscf_options;
    lscf_options.participation = true;
    // Noise takes its share of the poles: one to 15 lines. In a narrow band 120 lose modes of close
    // pairs.
    const Index poles_asked = std::clamp<Index>(hz.size() / 15, 60, 120);
    lscf_options.max_order = options.max_order > 0
                                 ? options.max_order
                                 : static_cast<int>(std::clamp<Index>(poles_asked / Ni, 8, 40));
    result.stabilisation = lscf(hz, H, Ni, {}, weight, lscf_options);
    clusters = cluster_poles(result.stabilisation, hz[1] - hz[0]);
    for (auto& cluster : clusters) {
      Complex& pole = cluster.pole_rad_s;
      pole += spectrum->decay;
      pole.real(std::min(pole.real(), -1e-4 * std::abs(pole)));
    }
    std::erase_if(clusters, [&](const PoleCluster& c) {
      return -c.pole_rad_s.real() > options.max_damping_ratio * std::abs(c.pole_rad_s);
    });
    if (clusters.empty()) return found;
    double slowest = -clusters.front().pole_rad_s.real();
    for (const auto& c : clusters) slowest = std::min(slowest, -c.pole_rad_s.real());
    const double wanted = std::min(std::max(kDecayTimesOfLags / slowest, 20 / high), longest);
    if (wanted > 0.6 * lag && wanted < 1.6 * lag) break;
    if (round < 2) lag = wanted;
  }
  result.lag_s = static_cast<double>(spectrum->lags) / rate;
  const auto n = static_cast<Index>(clusters.size());
  poles.resize(n), presence.resize(n);
  for (Index i = 0; i < n; ++i) {
    poles[i] = clusters[static_cast<std::size_t>(i)].pole_rad_s;
    presence[i] = clusters[static_cast<std::size_t>(i)].presence;
  }
  // Residues of all pairs with the references; the first left singular vector is the shape.
  const Index lines = spectrum->omega.size();
  MatrixXcd X(lines, n + 2), P(lines, No * static_cast<Index>(references.size()));
  for (Index i = 0; i < n; ++i) X.col(i) = spectrum->basis(poles[i], 0, lines);
  X.col(n).setOnes();
  X.col(n + 1) = VectorXd::LinSpaced(lines, -1, 1).cast<Complex>();
  for (std::size_t i = 0; i < references.size(); ++i) {
    P.middleCols(static_cast<Index>(i) * No, No) = pairs.middleCols(references[i] * No, No);
  }
  const auto qr = thin_qr(X);
  const MatrixXcd A = qr.R.triangularView<Eigen::Upper>().solve(qr.Q.adjoint() * P);
  shapes.resize(No, n);
  for (Index i = 0; i < n; ++i) {
    const VectorXcd row = A.row(i);
    const MatrixXcd residues = row.reshaped(No, P.cols() / No);
    shapes.col(i) = phase_real(hermitian_eigen(residues * residues.adjoint()).vectors.col(No - 1));
  }
  return found;
}

}  // namespace rigfit::signal
