// Modes from local fits, point by point: what is left standing where a common-pole model of all
// FRFs fits no better than its misfit lets it.
//
// The points of a roving test are measured one after the other: what is warm, loaded or touched
// differently has other frequencies at each. Points are the struck ones (inputs) or those with a
// sensor (responses), whichever are more. Candidates come from stabilisation diagrams of the whole
// band and of overlapping parts of it. Each is fitted on the lines around it (LocalFit in
// point_poles.cc), neighbours that overlap jointly, the others held, and given up when it does not
// stand out of the misfit around it, or when its pole moves by more than half its half bandwidth
// with another window and background: such a pole describes the background. The misfit counts as
// noise, correlated between lines as a window makes it.
//
// Each point's own poles go to the nearest candidate within twice the half
// bandwidths of both; candidates that hardly a point shows together are one mode where poles of
// their points touch (|p - q| below the sum of the half bandwidths) or drift (join_split_modes()).
// A mode is what enough points show. Its pole is the random-effects mean over points
// (estimation/groups.h).
#pragma once

#include "signal/estimation/groups.h"
#include "signal/modes/mode_search.h"

namespace rigfit::signal {

/// A mode as one point shows it.
struct PointPole {
  Index point = 0;
  Complex pole;          ///< rad/s, window removed
  double std = 0;        ///< std of the decay rate and of the damped frequency, each, rad/s
  VectorXcd residues;    ///< receptance, one a column of the point
  VectorXd residue_std;  ///< std of the real and the imaginary part, each
  /// Twice the fall of the misfit with this pole over the misfit's variance, correlated lines
  /// counted once: chi-square of 2 columns for a pole that is not there.
  double significance = 0;
  double explained = 0;  ///< share of what the background leaves that this pole explains
  double misfit = 0;     ///< rms misfit over rms FRF within the half bandwidth
};

/// Whether struck points vary (they are more than one and no fewer than the responses).
[[nodiscard]] bool points_are_inputs(const ModalBand& band);

/// Columns of `H` of every point, in the order in which the file lists the points.
[[nodiscard]] std::vector<std::vector<Index>> columns_of_points(const ModalBand& band);

/// `H`: FRFs of the point (or of a hit) on the lines of the band; `common`: starting poles, window
/// removed; `twin_misfit`: rms misfit over rms FRF that one pole must leave before a second within
/// its resonance counts. By rising frequency.
[[nodiscard]] std::vector<PointPole> point_poles(const ModalBand& band, const MatrixXcd& H,
                                                 Index point, const VectorXcd& common,
                                                 double twin_misfit, const ModalOptions& options);

struct LocalMode {
  std::vector<PointPole> points;  ///< one a point that shows it
  GroupMean decay;                ///< of -Re p, rad/s
  GroupMean frequency;            ///< of Im p, rad/s
};

/// Modes by rising frequency. `common`: candidates of all FRFs together, window removed.
[[nodiscard]] std::vector<LocalMode> find_local_modes(const ModalBand& band,
                                                      const std::vector<Complex>& common,
                                                      const ModalOptions& options);

/// Each pole of a global fit as every group (point, hit) shows it, the other poles held beside it;
/// a group that does not show it is left out. No points where none does. `groups`: FRFs on the
/// lines of the band; `twin_misfit`: see point_poles().
[[nodiscard]] std::vector<LocalMode> check_groups(const ModalBand& band,
                                                  const std::vector<MatrixXcd>& groups,
                                                  const VectorXcd& poles,
                                                  const ModalOptions& options,
                                                  double twin_misfit = 0);

/// Makes one mode of two where poles of their groups touch and at most a quarter of the groups of
/// one show both: poles that differ between groups look like two in a fit of all. The one that more
/// groups show takes all, the other is left empty. `drifting`: then also modes that stand clear of
/// their surroundings within 20 half-power bandwidths, with like damping. `modes`: of
/// check_groups().
void join_split_modes(const ModalBand& band, bool drifting, std::vector<LocalMode>& modes);

/// FRFs of every point.
[[nodiscard]] std::vector<MatrixXcd> frfs_of_points(const ModalBand& band);

/// Whether the frequency of another pole lies within so many times the sum of both half bandwidths.
[[nodiscard]] bool is_touched(const ModalBand& band, const VectorXcd& poles, Index r, double times);

/// Poles of a global fit that may be one mode that varies between points. FRFs of one reference may
/// not tell it from two whose frequencies lie within half their bandwidths. Several references do;
/// there it shows as poles whose resonances overlap, each at points of its own and too few of them
/// for a mode. At half of all points together they are of the whole structure, at fewer of members.
[[nodiscard]] bool has_twins(const ModalBand& band, const VectorXcd& poles,
                             const std::vector<LocalMode>& checked);

/// Whether the modes of a global fit are to be kept: of every mode the points agree on the pole
/// (chance above 1e-4) or scatter about it by less than 5 % of its half bandwidth.
[[nodiscard]] bool global_fit_holds(const std::vector<LocalMode>& checked);

/// The same form as a global search gives, for export. `exhausted`: as that search was.
[[nodiscard]] FoundModes as_found_modes(const ModalBand& band, const std::vector<LocalMode>& local,
                                        bool exhausted);

}  // namespace rigfit::signal
