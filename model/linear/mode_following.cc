#include "model/linear/mode_following.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace rigfit::model {

Eigen::MatrixXd sampled_shapes(const ChainModes& modes, const MotionModes& motion,
                               const std::vector<int>& samples) {
  const Chain& chain = *modes.chain;
  const auto& numbering = motion.assembly->numbering();
  Eigen::MatrixXd out = Eigen::MatrixXd::Zero(
      3 * std::accumulate(samples.begin(), samples.end(), Eigen::Index{0}), motion.omega2.size());
  Eigen::Index row = 0;
  for (std::size_t m = 0; m < chain.members.size(); ++m) {
    const ChainMember& member = chain.members[m];
    std::size_t i = 0;
    for (int k = 0; k < samples[m]; ++k) {
      const double place = (k + 0.5) / samples[m];
      while (member.places[i + 1] < place) ++i;
      const double f = (place - member.places[i]) / (member.places[i + 1] - member.places[i]);
      for (int axis = 0; axis < 3; ++axis, ++row) {
        const int a = numbering.displacement(axis, member.nodes[i]);
        const int b = numbering.displacement(axis, member.nodes[i + 1]);
        if (a >= 0) out.row(row) += (1 - f) * motion.shapes.row(a);
        if (b >= 0) out.row(row) += f * motion.shapes.row(b);
      }
    }
  }
  for (Eigen::Index k = 0; k < out.cols(); ++k) {
    const double size = out.col(k).norm();
    if (size > 0) out.col(k) /= size;
  }
  return out;
}

std::vector<int> following_modes(const Eigen::MatrixXd& before, const Eigen::MatrixXd& after,
                                 const Eigen::VectorXd& omega2_before,
                                 const Eigen::VectorXd& omega2_after) {
  Eigen::MatrixXd overlap = (before.transpose() * after).cwiseAbs2();
  std::vector<int> next(static_cast<std::size_t>(overlap.rows()), -1);
  std::vector<bool> taken(static_cast<std::size_t>(overlap.cols()), false);
  for (Eigen::Index round = 0; round < std::min(overlap.rows(), overlap.cols()); ++round) {
    Eigen::Index i = 0, j = 0;
    if (overlap.maxCoeff(&i, &j) < 0.5) break;
    next[static_cast<std::size_t>(i)] = static_cast<int>(j);
    taken[static_cast<std::size_t>(j)] = true;
    overlap.row(i).setZero();
    overlap.col(j).setZero();
  }
  // Equal frequencies share their shapes in any mixture; twist alone has none here.
  std::size_t j = 0;
  for (std::size_t i = 0; i < next.size(); ++i) {
    if (next[i] >= 0) continue;
    while (j < taken.size() && taken[j]) ++j;
    if (j == taken.size()) break;
    const double ratio =
        omega2_after[static_cast<Eigen::Index>(j)] / omega2_before[static_cast<Eigen::Index>(i)];
    if (std::abs(ratio - 1) > 0.2) continue;
    next[i] = static_cast<int>(j);
    taken[j] = true;
  }
  return next;
}

}  // namespace rigfit::model
