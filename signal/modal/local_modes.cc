#include "signal/modal/local_modes.h"

#include "signal/refinement/modal_basis.h"
#include "signal/refinement/modal_noise.h"

namespace rigfit::signal {
namespace {

/// Rms misfit over rms FRF that one pole must leave before a second within its resonance counts.
constexpr double kTwinMisfit = 0.1;
/// Share of the points that must show a mode.
constexpr double kShareOfPoints = 0.3;
/// A twentieth of a half bandwidth changes a peak by 5 % at its flanks.
constexpr double kScatterThatMatters = 0.05;

/// Mean over points of a part of their poles.
GroupMean mean_of(const std::vector<PointPole>& points, double (*part)(Complex)) {
  std::vector<double> values, variances;
  for (const PointPole& point : points) {
    values.push_back(part(point.pole));
    variances.push_back(std::pow(std::max(point.std, 1e-12 * std::abs(values.back())), 2));
  }
  return mean_over_groups(values, variances);
}

/// Whether poles of two points touch or, of a mode that is `drifting` and stands clear of its
/// surroundings at both, lie within 20 half-power bandwidths and a factor of 1.5.
bool may_be_one(const ModalBand& band, const PointPole& a, const PointPole& b, bool drifting) {
  if (!drifting) return apart(a.pole, b.pole, band.window) < 1;
  const double ha = band.window - a.pole.real(), hb = band.window - b.pole.real();
  return std::min(a.explained, b.explained) > 0.8 && std::max(ha, hb) < 2.5 * std::min(ha, hb) &&
         std::abs(a.pole.imag() - b.pole.imag()) < 20 * (ha + hb) &&
         std::max(a.pole.imag(), b.pole.imag()) < 1.5 * std::min(a.pole.imag(), b.pole.imag());
}

bool shows(const LocalMode& mode, Index point) {
  return std::ranges::find(mode.points, point, &PointPole::point) != mode.points.end();
}

/// How many points show both modes.
std::size_t in_common(const LocalMode& a, const LocalMode& b) {
  return static_cast<std::size_t>(
      std::ranges::count_if(b.points, [&](const PointPole& one) { return shows(a, one.point); }));
}

/// Whether enough of `count` points show a mode.
bool shown_by_enough(const LocalMode& mode, std::size_t count) {
  const double needed = std::max(2.0, std::ceil(kShareOfPoints * static_cast<double>(count)));
  return static_cast<double>(mode.points.size()) >= (count < 2 ? 1 : needed);
}

void average(LocalMode& mode) {
  mode.decay = mean_of(mode.points, [](Complex pole) { return -pole.real(); });
  mode.frequency = mean_of(mode.points, [](Complex pole) { return pole.imag(); });
}

}  // namespace

std::vector<MatrixXcd> frfs_of_points(const ModalBand& band) {
  std::vector<MatrixXcd> all;
  for (const auto& columns : columns_of_points(band)) {
    all.push_back(band.lines.H(Eigen::all, columns));
  }
  return all;
}

std::vector<LocalMode> check_groups(const ModalBand& band, const std::vector<MatrixXcd>& groups,
                                    const VectorXcd& poles, const ModalOptions& options,
                                    double twin_misfit) {
  std::vector<LocalMode> modes(static_cast<std::size_t>(poles.size()));
  for (std::size_t i = 0; i < groups.size(); ++i) {
    for (const PointPole& found :
         point_poles(band, groups[i], Index(i), poles, twin_misfit, options)) {
      Index nearest = 0;
      (poles.array() - found.pole).abs().minCoeff(&nearest);
      LocalMode& mode = modes[static_cast<std::size_t>(nearest)];
      if (apart(poles[nearest], found.pole, band.window) < 2 &&
          (mode.points.empty() || mode.points.back().point != found.point)) {
        mode.points.push_back(found);
      }
    }
  }
  for (LocalMode& mode : modes) {
    if (!mode.points.empty()) average(mode);
  }
  return modes;
}

void join_split_modes(const ModalBand& band, bool drifting, std::vector<LocalMode>& modes) {
  const auto linked = [&](const LocalMode& more, const LocalMode& fewer, bool drift) {
    bool any = false;
    for (const PointPole& a : fewer.points) {
      any |= std::ranges::any_of(more.points,
                                 [&](const PointPole& b) { return may_be_one(band, a, b, drift); });
    }
    return any && 4 * in_common(more, fewer) <= fewer.points.size();
  };
  // Those that touch first, all of them: what lies between two that drift belongs to one of them.
  for (int drift = 0; drift <= (drifting ? 1 : 0);) {
    LocalMode *more = nullptr, *fewer = nullptr;
    double least = std::numeric_limits<double>::infinity();
    for (LocalMode& a : modes) {
      for (LocalMode& b : modes) {
        if (a.points.size() < b.points.size() || (a.points.size() == b.points.size() && &a <= &b) ||
            !linked(a, b, drift > 0)) {
          continue;
        }
        const double distance = std::abs(a.frequency.mean - b.frequency.mean) /
                                (2 * band.window + a.decay.mean + b.decay.mean);
        if (distance < least) least = distance, more = &a, fewer = &b;
      }
    }
    if (more == nullptr) {
      ++drift;
      continue;
    }
    for (const PointPole& one : fewer->points) {
      if (!shows(*more, one.point)) more->points.push_back(one);
    }
    std::ranges::sort(more->points, {}, &PointPole::point);
    *fewer = {};
    average(*more);
  }
}

std::vector<LocalMode> find_local_modes(const ModalBand& band, const std::vector<Complex>& common,
                                        const ModalOptions& options) {
  const std::vector<MatrixXcd> points = frfs_of_points(band);
  const auto poles = Map<const VectorXcd>(common.data(), std::ssize(common));
  std::vector<LocalMode> modes = check_groups(band, points, poles, options, kTwinMisfit);
  join_split_modes(band, true, modes);
  std::erase_if(modes,
                [&](const LocalMode& mode) { return !shown_by_enough(mode, points.size()); });
  std::ranges::sort(modes, {}, [](const auto& one) { return one.frequency.mean; });
  return modes;
}

bool is_touched(const ModalBand& band, const VectorXcd& poles, Index r, double times) {
  for (Index q = 0; q < poles.size(); ++q) {
    const double halves = 2 * band.window - poles[r].real() - poles[q].real();
    if (q != r && std::abs(poles[r].imag() - poles[q].imag()) < times * halves) return true;
  }
  return false;
}

bool has_twins(const ModalBand& band, const VectorXcd& poles,
               const std::vector<LocalMode>& checked) {
  const Index inputs = band.lines.inputs, frfs = band.lines.H.cols();
  if (frfs < 2) return false;
  if (std::min(inputs, frfs / inputs) < 2) {
    for (Index r = 0; r < poles.size(); ++r) {
      if (is_touched(band, poles, r, 0.5)) return true;
    }
    return false;
  }
  const std::size_t count = columns_of_points(band).size();
  std::vector<LocalMode> few = checked;
  std::erase_if(few, [&](const LocalMode& mode) {
    return mode.points.empty() || shown_by_enough(mode, count);
  });
  std::ranges::sort(few, {}, [](const LocalMode& mode) { return mode.frequency.mean; });
  const auto pole = [](const LocalMode& mode) {
    return Complex(-mode.decay.mean, mode.frequency.mean);
  };
  LocalMode chain;
  for (std::size_t k = 0; k < few.size(); ++k) {
    const bool follows = k > 0 && apart(pole(few[k - 1]), pole(few[k]), band.window) < 2 &&
                         in_common(chain, few[k]) == 0;
    if (!follows) chain = {};
    chain.points.insert(chain.points.end(), few[k].points.begin(), few[k].points.end());
    if (follows && 2 * chain.points.size() >= count) return true;
  }
  return false;
}

bool global_fit_holds(const std::vector<LocalMode>& checked) {
  return std::ranges::none_of(checked, [](const LocalMode& mode) {
    const GroupMean &f = mode.frequency, &decay = mode.decay;
    // Over the half bandwidth: less does not move a fit of all FRFs together.
    return mode.points.size() > 1 && std::min(decay.chance, f.chance) < 1e-4 &&
           std::max(decay.between_std(), f.between_std()) > kScatterThatMatters * decay.mean;
  });
}

FoundModes as_found_modes(const ModalBand& band, const std::vector<LocalMode>& local,
                          bool exhausted) {
  FoundModes found;
  found.exhausted = exhausted;
  const auto count = static_cast<Index>(local.size());
  const MatrixXcd& H = band.lines.H;
  ModalRefineResult& fit = found.fit;
  fit.end = StepsEnd::converged;
  fit.poles.resize(count);
  for (Index r = 0; r < count; ++r) {
    const LocalMode& mode = local[static_cast<std::size_t>(r)];
    fit.poles[r] = {-mode.decay.mean, mode.frequency.mean};
  }
  const FrfNoise unknown = noise_unknown(H, band.lines.inputs, band.correlation_lines);
  fit.residues = refine_modes(band.lines, unknown, fit.poles, {.max_iterations = 0}).residues;
  if (fit.residues.size() == 0) fit.residues.setZero(count, H.cols());
  found.covariance.full_rank = true;
  found.covariance.poles = MatrixXd::Zero(2 * count, 2 * count);
  found.covariance.residue_std_re = fit.residues.cwiseAbs();
  found.covariance.significance.resize(count);
  const auto points = columns_of_points(band);
  for (Index r = 0; r < count; ++r) {
    const LocalMode& mode = local[static_cast<std::size_t>(r)];
    found.covariance.poles(2 * r, 2 * r) = std::pow(mode.decay.std_95(), 2);
    found.covariance.poles(2 * r + 1, 2 * r + 1) = std::pow(mode.frequency.std_95(), 2);
    found.covariance.significance[r] = 0;
    for (const PointPole& point : mode.points) {
      found.covariance.significance[r] += point.significance;
      const auto& columns = points[static_cast<std::size_t>(point.point)];
      for (std::size_t i = 0; i < columns.size(); ++i) {
        const auto at = static_cast<Index>(i);
        fit.residues(r, columns[i]) = point.residues[at];
        found.covariance.residue_std_re(r, columns[i]) = point.residue_std[at];
      }
    }
    found.presence.push_back(static_cast<double>(mode.points.size()) /
                             static_cast<double>(points.size()));
  }
  found.covariance.residue_std_im = found.covariance.residue_std_re;
  const MatrixXcd without = synthesise(band.lines.s, band.lines.power, fit.poles, fit.residues,
                                       VectorXcd::Zero(H.cols()), VectorXcd::Zero(H.cols()));
  FrfLines beside = band.lines;
  beside.H -= without;
  const ModalRefineResult rest = refine_modes(beside, unknown, VectorXcd(0));
  fit.lower = rest.lower;
  fit.upper = rest.upper;
  fit.background = rest.background;
  found.model = fitted_frfs(band.lines, fit);
  found.noise = noise_from_residuals(found.model, H - found.model, VectorXd::Zero(H.rows()),
                                     band.lines.inputs, band.correlation_lines, band.lead);
  return found;
}

}  // namespace rigfit::signal
