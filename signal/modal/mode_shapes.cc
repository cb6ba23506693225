#include "signal/modal/mode_shapes.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "signal/estimation/groups.h"
#include "signal/modes/mac.h"
#include "signal/modes/modal_synthesis.h"
#include "signal/numerics/factorisations.h"
#include "signal/numerics/numbers.h"

namespace rigfit::signal {

using Complex = std::complex<double>;
using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Eigen::VectorXcd;
using Eigen::VectorXd;

namespace {

/// Variance of each part of a column's coefficient: its own noise and the poles' uncertainty.
double coefficient_variance(const PoleFit& fit, const MatrixXcd& covariance, Index r, Index c) {
  const VectorXcd by_pole = fit.turn.row(r).transpose().cwiseProduct(fit.residues.col(c));
  const double of_poles = by_pole.dot((covariance.conjugate() * by_pole).eval()).real();
  return 0.5 * (fit.gram_inverse(r, r).real() / fit.weights[c] + of_poles);
}

/// u and v of the nearest u v^T, |v| = 1, by powers of residue' residue: where the second singular
/// value is so near the first that they converge slowly, any mixture is as near.
std::pair<VectorXcd, VectorXcd> nearest_rank_one(const MatrixXcd& residue) {
  Index strongest = 0;
  residue.colwise().squaredNorm().maxCoeff(&strongest);
  VectorXcd v = residue.adjoint() * residue.col(strongest);
  if (!(v.norm() > 0)) v = VectorXcd::Unit(residue.cols(), strongest);
  v.normalize();
  for (int power = 0; power < 1000; ++power) {
    VectorXcd next = residue.adjoint() * (residue * v);
    const double length = next.norm();
    if (!(length > 0)) break;
    next /= length;
    const double change = (next - v).norm();
    v = next;
    if (change < 1e-15) break;
  }
  return {residue * v, v.conjugate()};
}

}  // namespace

void fill_mode_shape(const ModalData& data, const FrfSet& frfs, const PoleFit& fit,
                     const MatrixXcd& covariance, Index r, const GroupPoles* own,
                     IdentifiedMode& mode) {
  const auto inputs = static_cast<Index>(frfs.inputs.size());
  const auto responses = static_cast<Index>(frfs.responses.size());
  const Complex scale = std::pow(mode.pole_rad_s, -power_of_s(frfs.form));
  MatrixXcd residue = MatrixXcd::Zero(responses, inputs);
  MatrixXd variance_re = MatrixXd::Zero(responses, inputs), variance_im = variance_re;
  VectorXcd a = fit.residues.row(r).transpose();
  if (own != nullptr) {
    for (Index g = 0; g < data.groups(); ++g) {
      if (!own->near[static_cast<std::size_t>(g)]) continue;
      const Index first = data.begin[static_cast<std::size_t>(g)], columns = data.columns_of(g);
      a.segment(first, columns) = own->residues.segment(first, columns);
    }
  }
  const Index hits = data.hits ? data.groups() : 1;
  const Index columns = a.size() / hits;  // hits have the same ones
  for (Index c = 0; c < columns; ++c) {
    const Index frf = data.frf[static_cast<std::size_t>(c)];
    double weights = 0, formal = 0;
    Complex sum = 0;
    for (Index h = 0; h < hits; ++h) {
      const Index i = h * columns + c;
      weights += fit.weights[i];
      sum += fit.weights[i] * a[i];
      formal += std::pow(fit.weights[i], 2) * coefficient_variance(fit, covariance, r, i);
    }
    const Complex mean = sum / weights;
    double re = formal / (weights * weights), im = re;
    if (hits > 2) {
      re = im = 0;
      for (Index h = 0; h < hits; ++h) {
        const Complex away = (a[h * columns + c] - mean) * scale;
        re += fit.weights[h * columns + c] * away.real() * away.real();
        im += fit.weights[h * columns + c] * away.imag() * away.imag();
      }
      const auto degrees = static_cast<double>(hits - 1);
      const double wider = std::pow(coverage_factor(0.95, degrees) / coverage_factor(0.95, 0), 2);
      re *= wider / (degrees * weights), im *= wider / (degrees * weights);
    } else {
      re *= std::norm(scale), im *= std::norm(scale);
    }
    residue(frf / inputs, frf % inputs) = mean * scale;
    variance_re(frf / inputs, frf % inputs) = re;
    variance_im(frf / inputs, frf % inputs) = im;
  }
  Index strongest = 0;
  if (inputs == 1) {
    mode.shape = residue.col(0);
    mode.participation = VectorXcd::Ones(1);
  } else {
    // The strongest input's participation is made 1.
    const auto [u, v] = nearest_rank_one(residue);
    v.cwiseAbs().maxCoeff(&strongest);
    mode.participation = v / v[strongest];
    mode.shape = u * v[strongest];
  }
  // A record that ends before the mode has decayed scales its residue by 1 - exp(raw * length),
  // whose phase goes with that of the hit; as likely one way as another.
  const double raw = mode.pole_rad_s.real() - data.window;
  const double cut_off = std::exp(raw / data.spacing_hz) / std::sqrt(2.0);
  mode.shape_std.resize(responses, 2);
  for (Index o = 0; o < responses; ++o) {
    const double end = std::norm(cut_off * mode.shape[o]);
    mode.shape_std(o, 0) = std::sqrt(variance_re(o, strongest) + end);
    mode.shape_std(o, 1) = std::sqrt(variance_im(o, strongest) + end);
  }
  mode.modal_phase_collinearity = modal_phase_collinearity(mode.shape);
}

void fit_residuals(const FrfSet& frfs, double low_hz, double high_hz, ModalModel& model) {
  const auto responses = static_cast<Index>(model.responses.size());
  const auto inputs = static_cast<Index>(model.inputs.size());
  model.lower_residual.setZero(responses, inputs);
  model.upper_residual.setZero(responses, inputs);
  model.frf_error.setZero(responses, inputs);
  std::vector<Index> rows;
  for (Index k = 0; k < frfs.frequency_hz.size(); ++k) {
    const double f = frfs.frequency_hz[k];
    if (f > 0 && f >= low_hz && f <= high_hz && frfs.H.row(k).allFinite()) rows.push_back(k);
  }
  const auto lines = static_cast<Index>(rows.size());
  if (lines < 3) return;
  VectorXd f(lines);
  for (Index i = 0; i < lines; ++i) f[i] = frfs.frequency_hz[rows[static_cast<std::size_t>(i)]];
  MatrixXcd left = synthesised(model, f, frfs.form, frfs.exponential_decay_rate_1_s).H;
  MatrixXcd basis(lines, 2);
  const VectorXcd s = laplace_lines(f, frfs.exponential_decay_rate_1_s);
  const int power = power_of_s(frfs.form);
  VectorXd whole = VectorXd::Zero(left.cols());
  for (Index i = 0; i < lines; ++i) {
    const auto measured = frfs.H.row(rows[static_cast<std::size_t>(i)]);
    left.row(i) = measured - left.row(i);
    whole += measured.cwiseAbs2().transpose();
    basis(i, 0) = std::pow(s[i], power - 2);
    basis(i, 1) = std::pow(s[i], power);
  }
  const ThinQr<MatrixXcd> qr = thin_qr(basis);
  const MatrixXcd along = qr.Q.adjoint() * left;
  left -= qr.Q * along;
  for (Index c = 0; c < left.cols(); ++c) {
    const Index o = c / inputs, i = c % inputs;
    const Complex upper = along(1, c) / qr.R(1, 1);
    model.upper_residual(o, i) = upper;
    model.lower_residual(o, i) = (along(0, c) - qr.R(0, 1) * upper) / qr.R(0, 0);
    model.frf_error(o, i) = whole[c] > 0 ? std::sqrt(left.col(c).squaredNorm() / whole[c]) : 0;
  }
}

}  // namespace rigfit::signal
