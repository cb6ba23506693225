#include "signal/modal/mode_hits.h"

#include <gsl/gsl_cdf.h>

#include "signal/modal/local_modes.h"
#include "signal/recording/add_note.h"
#include "signal/refinement/modal_refine.h"

namespace rigfit::signal {
namespace {

constexpr double kMode = 0.05, kAll = 0.01;  // chances where hits agree
constexpr double kShareOfHits = 2.0 / 3;     // that must show a mode

/// Hits on one point.
struct HitsOnInput {
  std::vector<MatrixXcd> H;     ///< on the lines of the band
  std::vector<MatrixXd> moved;  ///< changes of (Re p, Im p) by each hit, by mode: 2 x modes
  VectorXd weight;              ///< in the average; sum 1

  /// Jackknife variance of an average over the hits.
  [[nodiscard]] double variance_of(const ArrayXd& by_hit) const {
    const ArrayXd weighted = by_hit * weight.array();
    const ArrayXd without = (weighted.sum() - weighted) / (1 - weight.array());
    return jackknife_variance({without.data(), static_cast<std::size_t>(without.size())});
  }
};

/// What the hits say of one mode.
struct ModeOfHits {
  double fits = 0, shown = 0;     ///< hits, and those that show it within its half bandwidth
  Eigen::Array2d variance{0, 0};  ///< the average's frequency has, its damping ratio
  double squares = 0;             ///< for Satterthwaite's degrees of freedom
  LocalMode own;                  ///< the hits' own poles and their mean

  /// Cochran's Q of the hits' own poles and its degrees of freedom.
  [[nodiscard]] std::pair<double, double> own_scatter() const {
    const double others = std::max(0.0, static_cast<double>(own.points.size()) - 1);
    return {own.decay.cochran_Q + own.frequency.cochran_Q, 2 * others};
  }
  [[nodiscard]] double degrees() const {
    return squares > 0 ? variance[0] * variance[0] / squares : 0;
  }
};

std::vector<HitsOnInput> hits_of(const FrfSet& frfs, const ModalBand& band, const FoundModes& found,
                                 const std::vector<Index>& order, bool local) {
  const Index inputs = band.lines.inputs;
  std::vector<HitsOnInput> all(frfs.inputs.size());
  std::vector<std::vector<double>> weights(all.size());
  for (std::size_t h = 0; h < frfs.by_hit.size(); ++h) {
    const MatrixXcd H = frfs.by_hit[h](band.rows, Eigen::all);
    MatrixXd moved;
    if (!local) {
      MatrixXcd error = H - band.lines.H;
      for (Index c = 0; c < H.cols(); ++c) {
        if (!error.col(c).allFinite()) error.col(c).setZero();
      }
      moved = pole_errors(band.lines, found.noise, found.fit, error);
    }
    for (Index i = 0; i < inputs; ++i) {
      const auto at = static_cast<std::size_t>(i);
      const MatrixXcd own = H(Eigen::all, Eigen::seq(i, Eigen::last, inputs));
      if (!own.allFinite()) continue;
      all[at].H.push_back(own);
      const bool known = at < frfs.hit_impulse.size() && h < frfs.hit_impulse[at].size();
      weights[at].push_back(known ? std::pow(frfs.hit_impulse[at][h], 2) : kNaN);
      if (moved.size() == 0) continue;
      const MatrixXd parts = moved(Eigen::all, Eigen::seq(i, Eigen::last, inputs));
      const VectorXd sum = parts.rowwise().sum();
      const MatrixXd by_mode = sum.reshaped(2, sum.size() / 2);
      all[at].moved.emplace_back(by_mode(Eigen::all, order));
    }
  }
  for (std::size_t i = 0; i < all.size(); ++i) {
    all[i].weight = Map<const VectorXd>(weights[i].data(), std::ssize(weights[i]));
    if (!all[i].weight.allFinite() || !(all[i].weight.array() > 0).all()) all[i].weight.setOnes();
    all[i].weight /= std::max(all[i].weight.sum(), 1e-300);
  }
  return all;
}

/// Adds the variance of mode `r` of the average by leaving out one hit at a time.
void add_jackknife(const HitsOnInput& hits, Index r, Complex pole, ModeOfHits& mode) {
  if (hits.moved.empty()) return;
  const auto count = std::ssize(hits.moved);
  MatrixXd change(2, count);
  for (Index h = 0; h < count; ++h) {
    change.col(h) = pole_jacobian(pole) * hits.moved[static_cast<std::size_t>(h)].col(r);
  }
  for (Index part = 0; part < 2; ++part) {
    const double variance = hits.variance_of(change.row(part).transpose());
    mode.variance[part] += variance;
    if (part == 0) mode.squares += variance * variance / static_cast<double>(count - 1);
  }
}

std::vector<ModeOfHits> modes_of_hits(const ModalBand& band, const std::vector<HitsOnInput>& all,
                                      const VectorXcd& poles, bool local,
                                      const ModalOptions& options) {
  std::vector<ModeOfHits> modes(static_cast<std::size_t>(poles.size()));
  std::vector<MatrixXcd> every;
  for (const HitsOnInput& hits : all) {
    if (hits.H.size() < 2) continue;
    every.insert(every.end(), hits.H.begin(), hits.H.end());
    for (std::size_t r = 0; r < modes.size(); ++r) {
      add_jackknife(hits, static_cast<Index>(r), poles[static_cast<Index>(r)], modes[r]);
    }
  }
  std::vector<LocalMode> own = check_groups(band, every, poles, options);
  if (local || all.size() == 1) join_split_modes(band, false, own);
  for (std::size_t r = 0; r < modes.size(); ++r) {
    ModeOfHits& mode = modes[r];
    const Complex pole = poles[static_cast<Index>(r)];
    // A single hit, which is of one reference, may show two modes that touch as one.
    if (!local && all.size() > 1 && is_touched(band, poles, static_cast<Index>(r), 1)) continue;
    mode.fits = static_cast<double>(every.size());
    mode.shown =
        static_cast<double>(std::ranges::count_if(own[r].points, [&](const PointPole& hit) {
          return std::abs(hit.pole - pole) < band.window - pole.real();
        }));
    mode.own = std::move(own[r]);
  }
  return modes;
}

/// Raises the standard deviations of a mode.
void widen(double f_std, double z_std, std::size_t r, ModalModel& model) {
  IdentifiedMode& mode = model.modes[r];
  const double factor[2] = {std::max(1.0, f_std / mode.frequency_hz.std),
                            std::max(1.0, z_std / mode.damping_ratio.std)};
  for (Index part = 0; part < 2; ++part) {
    if (!std::isfinite(factor[part])) continue;
    const auto row = static_cast<Index>(2 * r) + part;
    model.pole_covariance.row(row) *= factor[part];
    model.pole_covariance.col(row) *= factor[part];
    (part == 0 ? mode.frequency_hz : mode.damping_ratio).std *= factor[part];
  }
  // Errors of residues go with those of the poles.
  const double most = std::max(factor[0], factor[1]);
  if (std::isfinite(most)) mode.shape_std *= most;
}

/// Raises the standard deviations of the shapes where the hits' FRFs around a mode scatter in size
/// and phase by more than noise, all lines together (a gain, a place that is not met): jackknife of
/// their parts of the average's fit.
void widen_shapes(const ModalBand& band, const std::vector<HitsOnInput>& all,
                  const FoundModes& found, ModalModel& model) {
  if (band.H_std.size() == 0 || found.model.size() == 0) return;
  for (IdentifiedMode& mode : model.modes) {
    Index input = 0;
    mode.participation.cwiseAbs().maxCoeff(&input);
    const HitsOnInput& hits = all[static_cast<std::size_t>(input)];
    const auto count = std::ssize(hits.H);
    const auto [first, lines] = lines_around(band, mode.pole_rad_s, 1);
    if (count < 2 || lines < 1) continue;
    double squares = 0;
    const Index responses = mode.shape.size();
    MatrixXd variance(responses, 2);
    for (Index o = 0; o < responses; ++o) {
      const Index c = o * band.lines.inputs + input;
      const VectorXcd fit = found.model.col(c).segment(first, lines);
      const double size = std::max(fit.squaredNorm(), 1e-300);
      ArrayXcd part(count);
      for (Index h = 0; h < count; ++h) {
        const auto at = static_cast<std::size_t>(h);
        part[h] = fit.dot(hits.H[at].col(o).segment(first, lines)) / size;
      }
      variance(o, 0) = hits.variance_of(part.real());
      variance(o, 1) = hits.variance_of(part.imag());
      const double noise =
          fit.cwiseAbs().cwiseProduct(band.H_std.col(c).segment(first, lines)).squaredNorm();
      squares += variance.row(o).sum() * size * size / std::max(noise, 1e-300);
    }
    const auto degrees = static_cast<double>(count - 1);
    if (!(gsl_cdf_chisq_Q(degrees * squares, degrees * 2 * static_cast<double>(responses)) <
          kAll)) {
      continue;
    }
    variance *= std::pow(widening_95(degrees), 2);
    for (Index o = 0; o < responses; ++o) {
      const double re = std::norm(mode.shape[o].real()), im = std::norm(mode.shape[o].imag());
      auto std = mode.shape_std.row(o);
      std[0] = std::sqrt(std[0] * std[0] + re * variance(o, 0) + im * variance(o, 1));
      std[1] = std::sqrt(std[1] * std[1] + im * variance(o, 0) + re * variance(o, 1));
    }
  }
}

}  // namespace

void allow_for_hits(const FrfSet& frfs, const ModalBand& band, const FoundModes& found, bool local,
                    const ModalOptions& options, ModalModel& model) {
  if (frfs.by_hit.size() < 2 || frfs.by_hit.front().rows() <= band.rows.back()) return;
  VectorXcd poles(std::ssize(model.modes));
  std::vector<Index> order(model.modes.size());  // places of the modes' poles in the fit
  for (std::size_t r = 0; r < order.size(); ++r) {
    const Complex pole = poles[static_cast<Index>(r)] = model.modes[r].pole_rad_s;
    (found.fit.poles.array() - pole).abs().minCoeff(&order[r]);
  }
  const std::vector<HitsOnInput> all = hits_of(frfs, band, found, order, local);
  widen_shapes(band, all, found, model);
  const std::vector<ModeOfHits> hits = modes_of_hits(band, all, poles, local, options);

  // Chi-square of the scatter between hits over what noise gives, and its degrees of freedom.
  std::vector<std::pair<double, double>> scatter;
  double squares = 0, degrees = 0;
  for (std::size_t r = 0; r < hits.size(); ++r) {
    const ModeOfHits& one = hits[r];
    const IdentifiedMode& mode = model.modes[r];
    scatter.push_back(one.own_scatter());
    if (one.degrees() > 0 && mode.frequency_hz.std > 0 && mode.damping_ratio.std > 0) {
      scatter.back() = {one.degrees() * (one.variance[0] / std::pow(mode.frequency_hz.std, 2) +
                                         one.variance[1] / std::pow(mode.damping_ratio.std, 2)),
                        2 * one.degrees()};
    }
    squares += scatter.back().first, degrees += scatter.back().second;
  }
  if (!(degrees > 0)) return;
  const bool all_differ = gsl_cdf_chisq_Q(squares, degrees) < kAll;
  double largest = 0;
  bool means = false;
  for (std::size_t r = 0; r < hits.size(); ++r) {
    const ModeOfHits& one = hits[r];
    IdentifiedMode& mode = model.modes[r];
    if (!(scatter[r].second > 0)) continue;
    const double omega = std::abs(mode.pole_rad_s);
    const auto [own_Q, own_degrees] = one.own_scatter();
    const bool own_differ = own_degrees > 0 && gsl_cdf_chisq_Q(own_Q, own_degrees) < kMode;
    const bool differs =
        all_differ || own_differ || gsl_cdf_chisq_Q(scatter[r].first, scatter[r].second) < kMode;
    mode.between_hits = {static_cast<int>(one.shown), one.own.frequency.between_std() / kTwoPi,
                         one.own.decay.between_std() / omega, differs};
    if (!differs) continue;
    largest = std::max(largest, mode.between_hits.frequency_std_hz / mode.frequency_hz.value);
    const bool few = one.shown < kShareOfHits * one.fits;
    if (few) {
      mode.doubt = fmt::format("only {:.0f} of {:.0f} single hits show it", one.shown, one.fits);
    }
    double f_std = 0, z_std = 0;
    if (one.degrees() > 0) {
      const double wider = widening_95(one.degrees());
      f_std = wider * std::sqrt(one.variance[0]), z_std = wider * std::sqrt(one.variance[1]);
    }
    if (own_differ && !few) {
      means = true;
      set_pole(mode, {-one.own.decay.mean, one.own.frequency.mean}, band.window);
      f_std = one.own.frequency.std_95() / kTwoPi, z_std = one.own.decay.std_95() / omega;
    }
    widen(f_std, z_std, r, model);
  }
  if (!all_differ || !(largest > 0)) return;
  add_note(model.notes, "hits_disagree", "",
           "frequencies differ from hit to hit by up to {:.2g} % (one standard deviation), modes "
           "{:.1f} times as much as noise gives: the structure (as under several tensions, each a "
           "state), the hammer or the place struck changes, or noise on the force is large, as "
           "without a force window; {}error bars are those of the scatter between hits",
           100 * largest, std::sqrt(squares / degrees),
           means ? "values are means over the hits where their own poles differ, " : "");
}

}  // namespace rigfit::signal
