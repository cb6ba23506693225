#include "signal/modal/modal_identification.h"

#include "signal/modal/band_background.h"
#include "signal/modal/local_modes.h"
#include "signal/modal/mode_hits.h"
#include "signal/numerics/factorisations.h"
#include "signal/recording/add_note.h"
#include "signal/refinement/modal_basis.h"

namespace rigfit::signal {
namespace {

/// Modes of a band, and how they came about.
struct Search {
  FoundModes found;
  bool local = false;             ///< modes of local fits; else maximum likelihood of all FRFs
  std::vector<LocalMode> points;  ///< each mode as the points show it
};

/// Candidates for local fits: columns of the diagrams of the band and of parts of it, and what a
/// global search found, each once.
std::vector<Complex> local_candidates(const ModalBand& band,
                                      const std::vector<PoleCluster>& clusters,
                                      const FoundModes& found, const FrfNoise& noise,
                                      const ModalOptions& options) {
  std::vector<Complex> candidates;
  const auto add = [&](Complex pole) {
    const bool known = std::ranges::any_of(
        candidates, [&](Complex other) { return apart(other, pole, band.window) < 0.5; });
    if (!known && pole.real() < band.window) candidates.push_back(pole);
  };
  for (const PoleCluster& cluster : clusters) add(cluster.pole_rad_s + band.window);
  for (Index parts = 4, pass = 0; pass < options.searches; parts *= 4, ++pass) {
    for (const PoleCluster& cluster : search_parts(band, band.lines.H, noise, options, parts)) {
      add(cluster.pole_rad_s + band.window);
    }
  }
  if (!found.exhausted && found.covariance.full_rank) {
    for (const Complex pole : found.fit.poles) add(pole);
  }
  return candidates;
}

/// All FRFs together where the points then agree on the poles, else point by point. Where poles of
/// all FRFs lie close together, they stand if single points show as many; else they are what one
/// mode that varies between points makes of a common fit.
Search search_of(const ModalBand& band, const std::vector<PoleCluster>& clusters,
                 const FrfNoise& noise, const ModalOptions& options) {
  Search search;
  search.found = search_modes(band, clusters, noise, options);
  FoundModes& found = search.found;
  const bool solved = !found.exhausted && found.fit.residues.cols() > 0;
  bool holds = false;
  if (solved && found.covariance.full_rank) {
    search.points = check_groups(band, frfs_of_points(band), found.fit.poles, options);
    holds = global_fit_holds(search.points);
  }
  const auto keep = [&] {
    found.covariance = modal_covariance(band.lines, found.noise, found.fit);
    return search;
  };
  if (holds && !has_twins(band, found.fit.poles, search.points)) return keep();
  if (!found.exhausted && !solved) return search;
  std::vector<LocalMode> local =
      find_local_modes(band, local_candidates(band, clusters, found, noise, options), options);
  if (holds && std::ssize(local) >= found.fit.poles.size()) return keep();
  search.local = true;
  found = as_found_modes(band, local, found.exhausted);
  search.points = std::move(local);
  return search;
}

/// Raises variances by what correlates in the misfit: their formula is that of noise.
void allow_for_misfit(const MatrixXcd& H, FoundModes& found) {
  if (found.model.size() == 0 || !found.covariance.full_rank) return;
  const double inflation = misfit_inflation(found.noise, H - found.model);
  found.covariance.poles *= inflation;
  found.covariance.residue_std_re *= std::sqrt(inflation);
  found.covariance.residue_std_im *= std::sqrt(inflation);
}

void fill_shape(const ModalRefineResult& fit, const ModalCovariance& covariance, Index r,
                Index inputs, IdentifiedMode& mode) {
  const Index responses = fit.residues.cols() / inputs;
  const MatrixXcd residue = fit.residues.row(r).reshaped(inputs, responses).transpose();
  Index strongest = 0;
  if (inputs == 1) {
    mode.shape = residue.col(0);
    mode.participation = VectorXcd::Ones(1);
  } else {
    // The nearest matrix of rank one, with the strongest input's participation made 1.
    const HermitianEigen squares = hermitian_eigen(residue.adjoint() * residue);
    const VectorXcd v = squares.vectors.col(inputs - 1);
    v.cwiseAbs().maxCoeff(&strongest);
    mode.participation = (v / v[strongest]).conjugate();
    mode.shape = residue * v * std::conj(v[strongest]);
  }
  mode.shape_std.resize(responses, 2);
  const auto own = Eigen::seqN(strongest, responses, inputs);
  mode.shape_std.col(0) = covariance.residue_std_re.row(r).transpose()(own);
  mode.shape_std.col(1) = covariance.residue_std_im.row(r).transpose()(own);
  mode.modal_phase_collinearity = modal_phase_collinearity(mode.shape);
}

/// A mode as the points show it, and how it varies between them.
void fill_points(const FrfSet& frfs, const ModalBand& band, const LocalMode& local,
                 IdentifiedMode& mode) {
  mode.between_points_std_hz = local.frequency.between_std() / kTwoPi;
  if (columns_of_points(band).size() < 2) return;
  const bool by_input = points_are_inputs(band);
  for (const PointPole& found : local.points) {
    const auto at = static_cast<std::size_t>(found.point);
    const double magnitude = std::abs(found.pole);
    mode.points.push_back({by_input ? frfs.inputs[at] : frfs.responses[at],
                           found.point,
                           {magnitude / kTwoPi, found.std / kTwoPi},
                           {-found.pole.real() / magnitude, found.std / magnitude},
                           found.misfit});
  }
}

void export_modes(const FrfSet& frfs, const ModalBand& band, const Search& search,
                  ModalResult& result) {
  const FoundModes& found = search.found;
  const ModalRefineResult& fit = found.fit;
  const ModalCovariance& covariance = found.covariance;
  const Index inputs = band.lines.inputs;
  const auto responses = static_cast<Index>(frfs.responses.size());
  ModalModel& model = result.model;
  model.lower_residual = fit.lower.reshaped(inputs, responses).transpose();
  model.upper_residual = fit.upper.reshaped(inputs, responses).transpose();
  std::vector<Index> order(found.presence.size());
  for (std::size_t r = 0; r < order.size(); ++r) order[r] = static_cast<Index>(r);
  std::ranges::sort(order, {}, [&](Index r) { return std::abs(fit.poles[r]); });
  const auto size = static_cast<Index>(2 * order.size());
  MatrixXd jacobian = MatrixXd::Zero(size, size);
  for (std::size_t i = 0; i < order.size(); ++i) {
    const Index r = order[i], row = static_cast<Index>(2 * i);
    IdentifiedMode mode;
    set_pole(mode, fit.poles[r], band.window);
    jacobian.block<2, 2>(row, 2 * r) = pole_jacobian(fit.poles[r]);
    fill_shape(fit, covariance, r, inputs, mode);
    // A record that ends before the mode has decayed scales its residue by 1 - exp(raw * length),
    // whose phase goes with that of the hit; as likely one way as another. So does noise of a
    // force.
    const double factor = std::hypot(
        frfs.force_noise_std, left_at_the_end(band, fit.poles[r] - band.window) / std::sqrt(2.0));
    mode.shape_std = (mode.shape_std.array().square() +
                      (factor * mode.shape.array().abs()).square().replicate(1, 2))
                         .sqrt();
    mode.presence = found.presence[static_cast<std::size_t>(r)];
    mode.significance = std::sqrt(covariance.significance[r] / least_significance(band.lines.H));
    mode.refinement = search.local ? "local" : "global";
    fill_points(frfs, band, search.points[static_cast<std::size_t>(r)], mode);
    model.modes.push_back(std::move(mode));
  }
  model.pole_covariance = jacobian * covariance.poles * jacobian.transpose();
  MatrixXcd shapes(responses, static_cast<Index>(order.size()));
  for (std::size_t i = 0; i < order.size(); ++i) {
    const auto row = static_cast<Index>(2 * i);
    model.modes[i].frequency_hz.std = std::sqrt(model.pole_covariance(row, row));
    model.modes[i].damping_ratio.std = std::sqrt(model.pole_covariance(row + 1, row + 1));
    shapes.col(static_cast<Index>(i)) = model.modes[i].shape;
  }
  result.auto_mac = auto_mac(shapes);
}

/// Rms misfit over rms FRF: of each FRF, and within half a bandwidth of each mode (three lines at
/// least); where points have their own poles, that of their fits.
void measure_errors(const ModalBand& band, const MatrixXcd& fitted, ModalModel& model) {
  const MatrixXcd misfit = band.lines.H - fitted;
  const Index inputs = band.lines.inputs;
  const auto over = [](const auto& left, const auto& H) {
    const double size = H.norm();
    return size > 0 ? left.norm() / size : 0;
  };
  model.frf_error.resize(misfit.cols() / inputs, inputs);
  for (Index c = 0; c < misfit.cols(); ++c) {
    model.frf_error(c / inputs, c % inputs) = over(misfit.col(c), band.lines.H.col(c));
  }
  for (IdentifiedMode& mode : model.modes) {
    const auto [first, count] = lines_around(band, mode.pole_rad_s, 1.5);
    mode.reconstruction_error =
        over(misfit.middleRows(first, count), band.lines.H.middleRows(first, count));
    if (mode.refinement == "global" || mode.points.empty()) continue;
    double sum = 0;
    for (const ModeAtPoint& point : mode.points) sum += point.misfit * point.misfit;
    mode.reconstruction_error = std::sqrt(sum / static_cast<double>(mode.points.size()));
  }
}

/// Modes left out whose resonance reaches into the band.
void tell_modes_at_ends(const ModalBand& band, ModalResult& result) {
  for (const Complex pole : band.beside) {
    const double at = pole.imag() / kTwoPi, half = (band.window - pole.real()) / kTwoPi;
    if (at - half > result.high_hz || at + half < result.low_hz) continue;
    add_note(result.model.notes, "modes_beside", "",
             "a mode at {:.4g} Hz, just outside of the band, reaches into it and is left out: a "
             "wider band holds it",
             at);
  }
}

}  // namespace

ModalResult identify_modes(const FrfSet& frfs, const ModalOptions& options) {
  ModalResult result;
  ModalModel& model = result.model;
  model.responses = frfs.responses;
  model.inputs = frfs.inputs;
  model.fitted_form = frfs.form;
  model.exponential_decay_rate_1_s = frfs.exponential_decay_rate_1_s;
  ModalBand band = select_band(frfs, options.low_hz, options.high_hz, model.notes);
  const MatrixXcd& H = band.lines.H;
  const Index inputs = band.lines.inputs;
  result.lines_used = band.frequency_hz.size();
  result.low_hz = band.frequency_hz[0];
  result.high_hz = band.frequency_hz[result.lines_used - 1];
  if (frfs.form == FrfForm::unknown) {
    add_note(model.notes, "frf_form", "",
             "the FRFs do not say whether they are receptances, mobilities or accelerances: the "
             "units of shapes and residuals are not known");
  }
  for (Index c = 0; c < H.cols(); ++c) {
    if (H.col(c).isZero(0)) {
      add_note(model.notes, "dead_frf", frfs.responses[static_cast<std::size_t>(c / inputs)].name,
               "this FRF is zero throughout and was left out");
    }
  }
  const bool has_error_bars = band.H_std.size() > 0;
  const FrfNoise first = first_noise(band);
  if (!first.column.cwiseInverse().any()) {
    model.notes.push_back({"no_modes", "all FRFs are zero", "", true});
    result.noise = first;
    model.pole_covariance.resize(0, 0);
    return result;
  }

  const MatrixXcd background =
      smooth_background(band.lines.s, band.lines.power, frfs.force_noise_span_s);
  band.beside = poles_beside(frfs, band, options);
  set_background(background, band);
  result.stabilisation = stabilise(band, H, first, options.lscf, 0, result.lines_used);
  const std::vector<PoleCluster> clusters = cluster_poles(result.stabilisation, band.spacing_hz);
  const auto search_all = [&] {
    Search found = search_of(band, clusters, first, options);
    const FoundModes& modes = found.found;
    const MatrixXcd misfit = modes.model.size() > 0 ? MatrixXcd(H - modes.model) : MatrixXcd();
    if (!modes.exhausted &&
        allow_for_cut_off(frfs, modes.fit.poles, misfit, modes.noise, options.max_work, band)) {
      found = search_of(band, clusters, first, options);
    }
    return found;
  };
  Search search = search_all();
  if (band.beside.size() > 0 && search.found.fit.end != StepsEnd::converged) {
    // The fit without them is the one to trust then, as before they were looked for.
    band.beside.resize(0);
    set_background(background, band);
    search = search_all();
    add_note(
        model.notes, "modes_beside", "",
        "modes just outside of the band are left out, since the fit does not converge with them: "
        "the damping ratio of a mode near an end of the band may be off; a wider band holds them");
  }
  if (!search.local) allow_for_misfit(H, search.found);
  const FoundModes& found = search.found;
  result.end = found.fit.end;
  result.iterations = found.iterations;
  result.noise = found.noise;
  if (found.fit.residues.cols() == 0 || !found.covariance.full_rank) {
    result.end = StepsEnd::rank_deficient;
    model.lower_residual.setZero(static_cast<Index>(frfs.responses.size()), inputs);
    model.upper_residual = model.lower_residual;
    model.notes.push_back(
        {"rank_deficient", "the lines of the band do not determine any mode", "", true});
    return result;
  }
  export_modes(frfs, band, search, result);
  if (found.fit.background.size() > 0) {
    result.background = band.lines.background * found.fit.background;
    result.background_hz = band.frequency_hz;
  }
  tell_modes_at_ends(band, result);
  if (model.modes.empty()) {
    model.notes.push_back(
        {"no_modes", "nothing in the band stands out of the noise as a resonance", "", true});
  }
  // Where two modes share a frequency, residues of several inputs are of no single shape.
  const MatrixXcd fitted = inputs == 1 || search.local
                               ? found.model
                               : synthesised(result, band.frequency_hz, frfs.form).H;
  measure_errors(band, fitted, model);
  if (has_error_bars) {
    const MatrixXcd& m = found.model;
    double sum = 0;
    Index count = 0;
    for (Index c = 0; c < H.cols(); ++c) {
      if (!std::isfinite(first.column[c])) continue;
      sum += ((H.col(c) - m.col(c)).array().abs2() /
              (2 * first.line.array() *
               (first.column[c] + first.common[c % inputs] * m.col(c).array().abs2())))
                 .sum();
      count += H.rows();
    }
    result.misfit_over_error_bars = std::sqrt(sum / static_cast<double>(count));
  }
  allow_for_hits(frfs, band, found, search.local, options, model);
  judge_modes(result, band, H - found.model, H - fitted);
  return result;
}

}  // namespace rigfit::signal
