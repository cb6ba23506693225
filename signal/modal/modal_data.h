// FRFs as the search for modes sees them: lines, columns, groups.
//
// A group is what was measured at once: a hit with all its responses, or a point struck (or a
// sensor's place) with its FRFs. Under an exponential window of rate sigma the lines hold H at s =
// sigma + i 2 pi f, so that poles come out without the window, and the noise of lines a distance d
// apart correlates by
//   rho(d) = exp(i 2 pi d t0 / T) / (1 + i pi d / (sigma T)),   T = 1 / line spacing,
// t0: from the block's beginning to the hit (transform of exp(-2 sigma t)). Then n lines tell as
// much as n / sum_d |rho(d)|^2 = n / (x coth x), x = sigma T, independent ones.
#pragma once

#include <Eigen/Core>
#include <complex>
#include <vector>

#include "signal/spectra/frf_set.h"

namespace rigfit::signal {

struct ModalData {
  Eigen::VectorXd frequency_hz;      ///< lines, rising
  Eigen::VectorXcd s;                ///< their s, rad/s
  Eigen::MatrixXcd Y;                ///< lines x columns; a group's columns lie side by side
  std::vector<Eigen::Index> begin;   ///< of each group's columns; one more at the end
  std::vector<Eigen::Index> frf;     ///< column of FrfSet::H that a column of Y belongs to
  std::vector<Eigen::Index> member;  ///< of each group: hit, input or response
  bool hits = false;                 ///< groups repeat one test; else they are points
  bool inputs_vary = false;          ///< points: struck places, else responses
  double low_hz = 0, high_hz = 0;    ///< band asked for; lines reach a quarter of it further
  double spacing_hz = 0;             ///< median step between lines
  double window = 0;                 ///< sigma, 1/s
  double correlation_lines = 0;      ///< sigma T
  double lead = 0;                   ///< t0 / T

  [[nodiscard]] Eigen::Index groups() const { return static_cast<Eigen::Index>(begin.size()) - 1; }
  [[nodiscard]] Eigen::Index columns_of(Eigen::Index group) const {
    return begin[static_cast<std::size_t>(group) + 1] - begin[static_cast<std::size_t>(group)];
  }
  [[nodiscard]] std::complex<double> line_correlation(Eigen::Index d) const;
  /// sum over d of |rho(d)|^2.
  [[nodiscard]] double lines_a_value() const;
};

/// Lines from `low_hz` (never 0 Hz) to `high_hz` (0: the last) and a quarter of that width further
/// on either side, with finite values; single hits where one point was struck and they are kept,
/// else points: the inputs, or the responses where these are more. FRFs that are zero throughout
/// and lines that are not finite are left out, which is noted. Throws std::invalid_argument for
/// sizes that do not fit, frequencies that do not rise, or fewer than 8 lines in the band.
[[nodiscard]] ModalData modal_data(const FrfSet& frfs, double low_hz, double high_hz,
                                   std::vector<Note>& notes);

/// FRFs of the set itself (averages of hits) at the lines of `data`: lines x FRFs.
[[nodiscard]] Eigen::MatrixXcd averages_at(const ModalData& data, const FrfSet& frfs);

}  // namespace rigfit::signal
