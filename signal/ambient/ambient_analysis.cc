#include <Eigen/Cholesky>
#include <numeric>

#include "signal/ambient/ambient_steps.h"
#include "signal/estimation/groups.h"
#include "signal/numerics/factorisations.h"
#include "signal/recording/add_note.h"

namespace rigfit::signal {
namespace {

constexpr double kBandHalfBandwidths = 20;  // 15: f 10 % worse, half the work
constexpr double kNullHalfBandwidths = 4;  // nearer neighbours are suppressed; off: pairs are wrong
constexpr double kFilterLoad = 1e-3;       // share of the mean power: shapes are known to 3 %
constexpr double kDecayTimesOfGroup = 5;   // what groups share lowers stds by tau / 4 T_g = 5 %
constexpr double kFewestDecayTimes = 40;   // damping known to 16 % at best
constexpr double kLeastOwnShare = 0.5;     // share of a peak: else another mode's side

/// Sums of so many neighbouring values.
VectorXd joined_sums(const VectorXd& values, Index together) {
  VectorXd sums = VectorXd::Zero((values.size() + together - 1) / together);
  for (Index g = 0; g < values.size(); ++g) sums[g / together] += values[g];
  return sums;
}

/// Standard deviation by the delete-one jackknife, neighbours joined: `without` by group.
double jackknife_std(const VectorXd& without, Index together) {
  const auto G = static_cast<double>(without.size());
  const VectorXd d = joined_sums(without.array() - without.mean(), together);
  return std::sqrt((G - 1) * (G - 1) / (G * (G - static_cast<double>(together)))) * d.norm();
}

/// Its modes begin as the candidates.
class AmbientAnalysis : AmbientCandidates {
 public:
  AmbientAnalysis(const Recording& recording, const AmbientOptions& options,
                  const std::vector<Index>& channels, AmbientResult& result)
      : options_(options), signals_(recording, channels, result.low_hz), result_(result) {}

  void run(std::vector<Index> references);

 private:
  void keep(const std::vector<Index>& modes);
  void set_bands();
  MatrixXd filters();
  void fit_pass(int groups);
  VectorXcd shape_row(Index mode, const VectorXcd& at, bool last) const;
  void judge();
  [[nodiscard]] Index size() const { return poles.size(); }

  const AmbientOptions& options_;
  AmbientSignals signals_;
  AmbientResult& result_;
  MatrixXd gap_;  ///< distance of the modes in half bandwidths at the pass's beginning
  std::vector<FilteredSpectrum> bands_;
  ResonanceFit fit_;
  // The last pass has by group: poles (modes x groups), shapes (channels x groups, by mode),
  // energy (groups x modes).
  MatrixXcd poles_without_;
  std::vector<MatrixXcd> shapes_without_;
  MatrixXd energy_;
};

void AmbientAnalysis::keep(const std::vector<Index>& modes) {
  poles = poles(modes).eval();
  presence = presence(modes).eval();
  shapes = shapes(Eigen::all, modes).eval();
}

void AmbientAnalysis::set_bands() {
  const VectorXd& w = spectrum->omega;
  const double spacing = w[1] - w[0];
  std::vector<Index> wide_enough;
  bands_.clear();
  for (Index i = 0; i < size(); ++i) {
    const double reach = kBandHalfBandwidths * -poles[i].real() + 3 * spectrum->decay;
    const auto line = [&](double omega) {
      return std::clamp<Index>(static_cast<Index>(std::ceil((omega - w[0]) / spacing)), 0,
                               w.size());
    };
    FilteredSpectrum band;
    band.from = line(poles[i].imag() - reach);
    band.count = line(poles[i].imag() + reach) - band.from;
    if (band.count < kFewestLines) continue;
    wide_enough.push_back(i);
    bands_.push_back(std::move(band));
  }
  keep(wide_enough);
  gap_.resize(size(), size());
  for (Index i = 0; i < size(); ++i) {
    for (Index j = 0; j < size(); ++j) gap_(i, j) = apart(poles[i], poles[j]);
    bands_[static_cast<std::size_t>(i)].nulled.assign(static_cast<std::size_t>(size()), false);
  }
}

/// t_r = argmin t^T B_r t with t^T phi_r = 1 and t^T phi_s = 0 for neighbours.
MatrixXd AmbientAnalysis::filters() {
  const Index No = signals_.channels();
  MatrixXd F(No, size());
  for (Index i = 0; i < size(); ++i) {
    auto& band = bands_[static_cast<std::size_t>(i)];
    const VectorXcd b = spectrum->basis(poles[i], band.from, band.count);
    const VectorXcd c = spectrum->basis(std::conj(poles[i]), band.from, band.count);
    const VectorXd own = (2 * (b + c).real().array() - 2).abs().max(1e-12);
    const MatrixXd spectra = pairs.middleRows(band.from, band.count).real();
    const VectorXd power = spectra.transpose() * own.cwiseInverse();
    MatrixXd B = power.reshaped(No, No);
    B += B.transpose().eval();
    B.diagonal().array() += kFilterLoad * B.trace() / static_cast<double>(No);
    std::vector<Index> near;
    for (Index j = 0; j < size(); ++j) {
      if (j != i && gap_(i, j) < kNullHalfBandwidths && mac(shapes.col(i), shapes.col(j)) < 0.95) {
        near.push_back(j);
      }
    }
    // Nearest first, and one freedom left to suppress the rest.
    std::ranges::sort(near, {}, [&](Index j) { return gap_(i, j); });
    near.resize(std::min(near.size(), static_cast<std::size_t>(std::max<Index>(No - 2, No > 1))));
    for (const Index j : near) band.nulled[static_cast<std::size_t>(j)] = true;
    near.insert(near.begin(), i);
    const MatrixXd phi = shapes(Eigen::all, near).real();
    const MatrixXd weighted = B.ldlt().solve(phi);
    const MatrixXd inner = phi.transpose() * weighted;
    F.col(i) = weighted * inner.ldlt().solve(VectorXd::Unit(inner.rows(), 0));
  }
  return F;
}

/// The row that takes a mode's residue from half spectra on the lines of its band.
VectorXcd AmbientAnalysis::shape_row(Index mode, const VectorXcd& at, bool last) const {
  const auto& band = bands_[static_cast<std::size_t>(mode)];
  std::vector<Index> used{mode};
  const auto use = [&](Index other) {
    if (other != mode && std::ssize(used) + 3 < band.count) used.push_back(other);
  };
  // Modes that the filter suppresses reach the spectra by forces that correlate; within the
  // bandwidth nothing tells them apart.
  for (Index j = 0; j < size(); ++j) {
    if (band.nulled[static_cast<std::size_t>(j)] && gap_(mode, j) >= 1) use(j);
  }
  // Those of the fit in its band and, in the last pass, the nearest on either side, whose tails
  // bend more than a straight line does. (Noise beside a mode would spoil its filter.)
  for (Index a = 0; a < (last ? std::ssize(band.modes) : band.moving); ++a) {
    use(band.modes[static_cast<std::size_t>(a)]);
  }
  const auto n = static_cast<Index>(used.size());
  const VectorXd weight = band.S0.cwiseSqrt().cwiseInverse();
  MatrixXcd X(band.count, n + 2);
  for (Index a = 0; a < n; ++a) {
    X.col(a) = spectrum->basis(at[used[static_cast<std::size_t>(a)]], band.from, band.count);
  }
  X.col(n).setOnes();
  X.col(n + 1) = VectorXd::LinSpaced(band.count, -1, 1).cast<Complex>();
  X = weight.asDiagonal() * X;
  const VectorXd scale = X.colwise().norm().cwiseInverse().transpose();
  const auto qr = thin_qr(X * scale.asDiagonal());
  const VectorXcd first =
      qr.R.adjoint().triangularView<Eigen::Lower>().solve(VectorXcd::Unit(n + 2, 0));
  return (weight.asDiagonal() * (qr.Q * first)).conjugate() * scale[0];
}

/// Filters, correlations by group, fit, shapes; of several groups the jackknife as well.
void AmbientAnalysis::fit_pass(int groups) {
  set_bands();
  const Index n = size(), No = signals_.channels(), L = spectrum->lags, G = groups;
  if (n == 0) return;
  // By mode: half spectra of all channels and the two-sided one of the filtered signal.
  struct Spectra {
    MatrixXcd half;
    VectorXd S;
  };
  const MatrixXd F = filters();
  std::vector<Spectra> whole(static_cast<std::size_t>(n));
  std::vector<std::vector<Spectra>> of_group(static_cast<std::size_t>(G), whole);
  energy_.resize(G, n);
  group_correlations(signals_, F, L, groups, std::max(options_.threads, 1),
                     [&](int g, const MatrixXd& R) {
                       for (Index i = 0; i < n; ++i) {
                         const auto mode = static_cast<std::size_t>(i);
                         const auto& band = bands_[mode];
                         const auto of_mode = R.middleCols(i * No, No);
                         const VectorXd own = of_mode * F.col(i);
                         const VectorXd both = own.tail(L + 1) + own.head(L + 1).reverse();
                         auto& [half, S] = of_group[static_cast<std::size_t>(g)][mode];
                         half = spectrum->half(of_mode.bottomRows(L + 1), band.from, band.count);
                         S = spectrum->half(both, band.from, band.count).real();
                         energy_(g, i) = own[L];
                         auto& sum = whole[mode];
                         sum = g == 0 ? Spectra{half, S} : Spectra{sum.half + half, sum.S + S};
                       }
                     });
  for (std::size_t i = 0; i < bands_.size(); ++i) bands_[i].S = whole[i].S;
  fit_ = fit_resonances(*spectrum, bands_, poles);
  poles = fit_.poles;
  for (Index i = 0; i < n; ++i) {
    shapes.col(i) = phase_real(whole[static_cast<std::size_t>(i)].half.transpose() *
                               shape_row(i, poles, G > 1));
  }
  if (G == 1) return;
  // A group's part of the whole is left out; scales are eliminated in the fit and of no shape.
  const double others = static_cast<double>(G) / static_cast<double>(G - 1);
  poles_without_.resize(n, G);
  shapes_without_.assign(static_cast<std::size_t>(n), MatrixXcd(No, G));
  for (Index g = 0; g < G; ++g) {
    const auto& group = of_group[static_cast<std::size_t>(g)];
    std::vector<VectorXd> change;
    for (const Spectra& one : group) change.push_back(-others * one.S);
    VectorXcd moved = poles + fit_.change(change);
    moved.real() = moved.real().cwiseMin(0.05 * poles.real()).eval();
    for (Index i = 0; i < n; ++i) {
      const auto mode = static_cast<std::size_t>(i);
      shapes_without_[mode].col(g) =
          (whole[mode].half - group[mode].half).transpose() * shape_row(i, moved, true);
    }
    poles_without_.col(g) = moved;
  }
}

void AmbientAnalysis::judge() {
  const VectorXd& unit = signals_.scale();
  const Index G = poles_without_.cols();
  const double length = result_.duration_s * signals_.present();
  for (Index i = 0; i < size(); ++i) {
    AmbientMode found;
    IdentifiedMode& mode = found.mode;
    const Complex pole = poles[i];
    const double half = -pole.real(), f = std::abs(pole) / kTwoPi, zeta = half / std::abs(pole);
    const double group_s = length / static_cast<double>(G);
    found.joined = static_cast<int>(std::clamp<Index>(
        static_cast<Index>(std::ceil(kDecayTimesOfGroup / half / group_s)), 1, G / 2));
    const VectorXd moduli = poles_without_.row(i).cwiseAbs();
    const VectorXd log_zeta =
        (-poles_without_.row(i).real().transpose().array() / moduli.array()).log();
    const VectorXd e = joined_sums(energy_.col(i), found.joined).cwiseMax(0);
    const double squares = e.squaredNorm();
    found.degrees = std::max(squares * squares / std::max(e.array().pow(4).sum(), 1e-300) - 1, 1.0);
    const double t = coverage_factor(0.95, found.degrees);
    const double f_std = jackknife_std(moduli, found.joined) / kTwoPi;
    found.log_damping_std = jackknife_std(log_zeta, found.joined);
    set_pole(mode, pole, 0);
    mode.frequency_hz.std = f_std;
    mode.damping_ratio.std = zeta * found.log_damping_std;
    mode.presence = presence[i];
    mode.refinement = "ambient";
    found.frequency_95 = {f - t * f_std, f + t * f_std};
    found.damping_95 = {zeta * std::exp(-t * found.log_damping_std),
                        zeta * std::exp(t * found.log_damping_std)};
    found.decay_times = length * half;
    const auto& band = bands_[static_cast<std::size_t>(i)];
    mode.reconstruction_error =
        (band.S - fit_.model[static_cast<std::size_t>(i)]).norm() / band.S.norm();

    VectorXcd shape = shapes.col(i).cwiseProduct(unit);
    Index top = 0;
    shape.cwiseAbs().maxCoeff(&top);
    shape /= shape[top];
    found.without_group = unit.asDiagonal() * shapes_without_[static_cast<std::size_t>(i)];
    for (auto one : found.without_group.colwise()) one /= Complex(one[top]);
    mode.shape = shape;
    mode.shape_std.resize(shape.size(), 2);
    for (Index o = 0; o < shape.size(); ++o) {
      mode.shape_std(o, 0) = jackknife_std(found.without_group.row(o).real(), found.joined);
      mode.shape_std(o, 1) = jackknife_std(found.without_group.row(o).imag(), found.joined);
    }
    mode.modal_phase_collinearity = modal_phase_collinearity(shape);

    const auto doubt = [&](const char* code, std::string why) {
      if (mode.doubtful) return;
      mode.doubtful = true, mode.doubt = std::move(why), found.code = code;
    };
    const std::string where = fmt::format("{:.4g} Hz", f);
    if (found.decay_times < kFewestDecayTimes) {
      const double needed = kFewestDecayTimes / half;
      doubt("too_short",
            fmt::format("needs {:.0f} s of recording ({:.0f} decay times), has {:.0f} s", needed,
                        kFewestDecayTimes, length));
      add_note(result_.notes, "too_short", where,
               "record {:.0f} min: {:.0f} min hold {:.0f} decay times, and intervals need {:.0f}",
               std::ceil(needed / 60), length / 60, found.decay_times, kFewestDecayTimes);
    }
    // Written so that what is not a number is doubtful.
    if (!(fit_.own_share[i] >= kLeastOwnShare)) {
      doubt("peak_not_its_own", fmt::format("holds {:.0f} % of the spectrum at its frequency",
                                            100 * std::max(0.0, fit_.own_share[i])));
    }
    if (!(found.log_damping_std <= 0.5) || zeta > options_.max_damping_ratio) {
      doubt("damping_uncertain",
            fmt::format("damping is known to {:.0f} %", 100 * found.log_damping_std));
    }
    for (Index j = 0; j < size(); ++j) {
      const double distance = apart(pole, poles[j]);
      if (j == i || distance > 1) continue;
      const bool alike = mac(shapes.col(i), shapes.col(j)) > 0.9;
      if (distance < 0.5 && alike &&
          (presence[j] > presence[i] || (presence[j] == presence[i] && j < i))) {
        doubt("close_modes",
              fmt::format("cannot be told from the mode at {:.4g} Hz, which has its shape",
                          std::abs(poles[j]) / kTwoPi));
      }
      if (j > i) {
        add_note(result_.notes, "close_modes", where,
                 "check the shapes of the modes at {:.5g} and {:.5g} Hz, {:.2f} bandwidths apart: "
                 "within their bandwidths shapes mix",
                 f, std::abs(poles[j]) / kTwoPi, distance);
      }
    }
    result_.modes.push_back(std::move(found));
  }
  std::ranges::sort(result_.modes, {},
                    [](const AmbientMode& one) { return one.mode.frequency_hz.value; });
}

void AmbientAnalysis::run(std::vector<Index> references) {
  const double rate = signals_.rate_hz();
  result_.high_hz = options_.high_hz > 0 ? std::min(options_.high_hz, rate / 2) : 0.4 * rate;
  result_.tones = signals_.take_out_tones(result_.low_hz, result_.high_hz);
  static_cast<AmbientCandidates&>(*this) =
      find_candidates(signals_, options_, result_, std::move(references));
  if (pairs.rows() > 0) {
    const Index No = signals_.channels(), lines = spectrum->omega.size();
    result_.spectra.push_back({spectrum->omega / kTwoPi, MatrixXd(lines, No)});
    auto& shown = result_.spectra.back();
    for (Index l = 0; l < lines; ++l) {
      const VectorXcd row = pairs.row(l);
      const MatrixXcd S = row.reshaped(No, No);
      shown.singular_values.row(l) = hermitian_eigen(S + S.adjoint()).values.reverse().transpose();
    }
  }
  if (size() > 0) {
    // Candidates that do not hold their own peak leave, those that the fewest orders have first:
    // they disturb the others.
    for (bool more = true; more;) {
      fit_pass(1);
      double least = 2;
      for (Index i = 0; i < size(); ++i) {
        if (fit_.own_share[i] < kLeastOwnShare) least = std::min(least, presence[i]);
      }
      std::vector<Index> holding;
      for (Index i = 0; i < size(); ++i) {
        if (fit_.own_share[i] > kLeastOwnShare || presence[i] > least) holding.push_back(i);
      }
      more = !holding.empty() && std::ssize(holding) < size();
      if (more) keep(holding);
    }
    fit_pass(options_.groups);
    if (size() > 0) judge();
  }
  if (result_.modes.empty()) {
    result_.notes.push_back({"no_modes", "no mode stands out of the noise in the band", "", true});
  }
}

}  // namespace

AmbientResult ambient_modes(const Recording& recording, const AmbientOptions& options) {
  AmbientResult result;
  result.duration_s = static_cast<double>(recording.samples()) / recording.sample_rate_hz;
  result.low_hz = options.low_hz > 0 ? options.low_hz : 100 / result.duration_s;
  std::vector<Index> channels, references;
  for (const auto& name : options.channels) channels.push_back(recording.channel_index(name));
  if (channels.empty()) {
    channels.resize(recording.channels.size());
    std::iota(channels.begin(), channels.end(), Index{0});
  }
  for (const Index c : channels) {
    result.channels.push_back(recording.channels[static_cast<std::size_t>(c)].name);
  }
  for (const auto& name : options.references) {
    const auto at = std::ranges::find(channels, recording.channel_index(name));
    if (at == channels.end()) {
      throw RecordingError({recording.path.string(), 0, 0, name},
                           "the reference is not among the channels analysed",
                           "choose from " + listed(result.channels));
    }
    references.push_back(at - channels.begin());
  }
  AmbientAnalysis(recording, options, channels, result).run(std::move(references));
  return result;
}

}  // namespace rigfit::signal
