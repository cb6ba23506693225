// Modes that are hard to tell apart: planes that agree to 1e-5, rigs whose symmetry repeats
// frequencies, and a cable's modes followed through their crossings.
#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <complex>
#include <string>
#include <vector>

#include "ident/update/pairing/mode_assignment.h"
#include "model/linear/modal_analysis.h"
#include "tests/bench/hard_cases/bar_chain.h"
#include "tests/bench/hard_cases/hard_case.h"
#include "tests/reference/closed_forms.h"
#include "tests/scenes.h"

namespace rigfit::hard_cases {
namespace modes_area {
namespace {

using namespace model;

/// All displacements of all members, one under the other.
Eigen::VectorXd stacked(const NaturalMode& mode) {
  Eigen::Index size = 0;
  for (const auto& shape : mode.shape) size += shape.displacement.size();
  Eigen::VectorXd out(size);
  Eigen::Index at = 0;
  for (const auto& shape : mode.shape) {
    out.segment(at, shape.displacement.size()) = shape.displacement.reshaped();
    at += shape.displacement.size();
  }
  return out;
}

/// A limp cable at 300 N: its second modes in and out of plane are 1e-5 apart. The split against
/// bars along the catenary; in a plane of its own, turned in space, and among members that leave no
/// plane of symmetry at all.
Outcome planes_that_agree(bool) {
  Worst worst;
  const double mass = 0.16667, tension = 300;
  const ElasticCatenary truth{2.4, 0, mass * kStandardGravity, 221780};
  const BarFrequencies bars = bar_frequencies(truth, catenary_of_tension(truth, tension), mass, 2);
  const double split = bars.out_hz[1] / bars.in_hz[1] - 1;
  for (const int variant : {0, 1, 2}) {
    Scene scene = testing::paper_cable(tension, 0, 60);
    Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();
    if (variant == 1) {
      turn = Eigen::AngleAxisd(1, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix();
      for (auto& node : scene.nodes) node.position = turn * node.position;
      scene.gravity = turn * scene.gravity;
    }
    if (variant == 2) {  // a stiff strut beside it, out of every plane
      scene.nodes.push_back(testing::node("foot", {1, -1, 1}, Support::Kind::clamped));
      scene.nodes.push_back(testing::node("top", {1.3, -0.5, 1.2}));
      Member strut = testing::vertical_beam(1, 5000, 1, 4).members[0];
      strut.nodes = {"foot", "top"};
      scene.members.push_back(strut);
    }
    const ModalAnalysis found = analyse_modes(scene, {.count = 6});
    worst.require(found.complete && found.modes.size() == 6, "modes are missing");
    double in = 0, out = 0;
    int seen[2] = {0, 0};
    for (const NaturalMode& mode : found.modes) {
      worst.require(mode.plane == ModePlane::in || mode.plane == ModePlane::out,
                    "a plane is not recognised");
      const bool second = ++seen[mode.plane == ModePlane::out] == 2;
      if (second) (mode.plane == ModePlane::out ? out : in) = mode.extrapolated_hz;
      // Nothing of the other plane: to rounding, over the gap of 1e-5.
      const Eigen::Vector3d normal = turn.col(2);
      const Eigen::VectorXd across = mode.shape[0].displacement.transpose() * normal;
      const double share = across.squaredNorm() / mode.shape[0].displacement.squaredNorm();
      worst.add(mode.plane == ModePlane::out ? 1 - share : share, 1e-8);
    }
    // The extrapolated frequencies are good to a hundredth of what they correct, and so is the
    // split between them; the bars' own error adds.
    worst.add(std::abs(out / in - 1 - split), 0.01 * found.relative_error_estimate + bars.error);
    worst.require(split < 2e-5 && split > 0, "the planes do not agree to 1e-5");
  }
  return worst.outcome();
}

/// A mast between four guys, each like the next one a quarter turn on: turned by that, every mode
/// must lie in the space of those of its own frequency.
Outcome mast_with_four_guys(bool) {
  Scene scene = testing::vertical_beam(0.75, 2.1, 0.295, 12);
  scene.nodes[1].mass = 0.02;
  for (int k = 0; k < 4; ++k) {
    const double c[] = {1, 0, -1, 0}, s[] = {0, 1, 0, -1};
    const std::string end = fmt::format("anchor {}", k);
    scene.nodes.push_back(
        testing::node(end, {1.2 * c[k], 0.75, 1.2 * s[k]}, Support::Kind::pinned));
    Member guy = testing::paper_cable(100, 0.4948, 12).members[0];
    guy.name = fmt::format("guy {}", k);
    guy.nodes = {end, "tip"};
    scene.members.push_back(guy);
  }
  const ModalAnalysis found = analyse_modes(scene, {.count = 24, .error_estimate = false});
  Worst worst;
  worst.require(found.equilibrium.status == EquilibriumStatus::converged, found.equilibrium.reason);
  worst.require(found.complete && found.modes.size() == 24, "modes are missing");
  if (found.modes.size() != 24) return worst.outcome();
  // A quarter turn about y takes x to z and z to -x, guy k to guy k + 1.
  Eigen::Matrix3d quarter;
  quarter << 0, 0, -1, 0, 1, 0, 1, 0, 0;
  int pairs = 0;
  for (std::size_t i = 0; i < 24;) {
    std::size_t end = i + 1;
    while (end < 24 && found.modes[end].frequency_hz < (1 + 1e-6) * found.modes[i].frequency_hz) {
      ++end;
    }
    // The last group may go on beyond the modes asked for.
    if (end == 24) break;
    if (end - i == 2) ++pairs;
    // Equal to rounding: 1e-16 times EA / l over the lowest stiffness (1e4) times n^2.
    worst.add(found.modes[end - 1].frequency_hz / found.modes[i].frequency_hz - 1, 1e-9);
    Eigen::MatrixXd space(stacked(found.modes[i]).size(), Eigen::Index(end - i));
    for (std::size_t k = i; k < end; ++k) {
      space.col(Eigen::Index(k - i)) = stacked(found.modes[k]);
    }
    const Eigen::HouseholderQR<Eigen::MatrixXd> qr(space);
    for (std::size_t k = i; k < end; ++k) {
      NaturalMode turned = found.modes[k];
      turned.shape[0].displacement = quarter * found.modes[k].shape[0].displacement;
      for (std::size_t guy = 0; guy < 4; ++guy) {
        turned.shape[1 + (guy + 1) % 4].displacement =
            quarter * found.modes[k].shape[1 + guy].displacement;
      }
      const Eigen::VectorXd v = stacked(turned);
      // Rounding over the relative gap to the next frequency, 1e-6 at least.
      worst.add((v - space * qr.solve(v)).norm() / v.norm(), 1e-6);
    }
    i = end;
  }
  worst.require(pairs >= 6, fmt::format("only {} pairs", pairs));
  return worst.outcome();
}

/// 400 steps of tension past both crossovers of a sagging cable. Every mode is followed by its
/// shape alone; more than half of its MAC can go to one successor only.
struct Sweep {
  double least_mac = 1;
  bool one_to_one = true;
  bool parity_kept = true;
  double crossing[2] = {0, 0};  ///< N, of the first and second symmetric in-plane mode
};

Sweep sweep(double EI, double degrees) {
  Sweep out;
  constexpr int kSteps = 400, kFollowed = 12, kFound = 18;
  const double low = 24, high = 60;
  ModesOptions options{.count = kFound, .error_estimate = false};
  options.damped = false;
  std::vector<NaturalMode> last;
  std::vector<std::size_t> where(kFollowed);  // place of each followed mode in the list of a step
  std::vector<double> parity(kFollowed);
  double before[2] = {0, 0}, tension_before = 0;
  for (int step = 0; step <= kSteps; ++step) {
    const double tension = low + (high - low) * step / kSteps;
    Scene scene = testing::paper_cable(tension, EI, 40);
    const double angle = degrees * M_PI / 180;
    scene.nodes[1].position << 2.4 * std::cos(angle), 2.4 * std::sin(angle), 0;
    auto found = analyse_modes(scene, options);
    if (!found.complete || found.modes.size() != kFound) {
      out.one_to_one = false;
      return out;
    }
    const auto parity_of = [](const NaturalMode& mode) {
      // Parity of the transverse motion under left-right mirroring: +1 or -1.
      const auto& d = mode.shape[0].displacement;
      const Eigen::Index row = mode.plane == ModePlane::out ? 2 : 1;
      return d.row(row).dot(d.row(row).reverse()) / d.row(row).squaredNorm();
    };
    if (step == 0) {
      for (std::size_t k = 0; k < kFollowed; ++k) {
        where[k] = k;
        parity[k] = parity_of(found.modes[k]);
      }
    } else {
      std::vector<bool> taken(kFound, false);
      for (std::size_t k = 0; k < kFollowed; ++k) {
        const Eigen::VectorXcd old = stacked(last[where[k]]).cast<std::complex<double>>();
        double best = 0;
        std::size_t to = 0;
        for (std::size_t j = 0; j < kFound; ++j) {
          const double mac =
              ident::shape_correlation(old, stacked(found.modes[j]).cast<std::complex<double>>());
          if (mac > best) {
            best = mac;
            to = j;
          }
        }
        out.least_mac = std::min(out.least_mac, best);
        out.one_to_one = out.one_to_one && !taken[to];
        out.parity_kept = out.parity_kept && found.modes[to].plane == last[where[k]].plane &&
                          (degrees > 0 || std::abs(parity_of(found.modes[to]) - parity[k]) < 0.01);
        taken[to] = true;
        where[k] = to;
      }
    }
    // Where the k-th symmetric and antisymmetric in-plane modes change places.
    std::vector<double> symmetric, antisymmetric;
    for (const auto& mode : found.modes) {
      if (mode.plane != ModePlane::in) continue;
      (parity_of(mode) > 0 ? symmetric : antisymmetric).push_back(mode.frequency_hz);
    }
    for (std::size_t k = 0; k < 2 && degrees == 0; ++k) {
      const double difference = symmetric[k] - antisymmetric[k];
      if (step > 0 && before[k] > 0 && difference <= 0) {
        out.crossing[k] =
            tension - (tension - tension_before) * difference / (difference - before[k]);
      }
      before[k] = difference;
    }
    tension_before = tension;
    last = std::move(found.modes);
  }
  return out;
}

Outcome followed(double EI, double degrees) {
  const Sweep found = sweep(EI, degrees);
  Worst worst;
  worst.require(found.one_to_one, "a mode is lost");
  worst.require(found.parity_kept, "two modes are swapped");
  worst.add(1 - found.least_mac, 0.5);
  return worst.outcome("1 - MAC");
}

Outcome sweep_level(bool) { return followed(0.2549, 0); }
Outcome sweep_inclined(bool) { return followed(0.2549, 20); }

/// Irvine's theory for small (m g L / H)^2: what it leaves out is of that size, relative.
Outcome crossovers(bool) {
  const Sweep found = sweep(0, 0);
  Worst worst;
  for (const int k : {0, 1}) {
    const SaggingCable cable{2.4, 0.16667, 221780, found.crossing[k]};
    worst.require(found.crossing[k] > 0, "no crossing");
    if (!(found.crossing[k] > 0)) continue;
    const double expected = std::pow(2 * M_PI * (k + 1), 2);
    worst.add(std::abs(irvine_parameter(cable) / expected - 1),
              std::pow(0.16667 * kStandardGravity * 2.4 / found.crossing[k], 2));
  }
  return worst.outcome();
}

}  // namespace
}  // namespace modes_area

std::vector<HardCase> mode_cases() {
  using namespace modes_area;
  const std::string area = "modes";
  return {
      {area, "planes that agree to 1e-5, three attitudes", "split as of bars; planes pure",
       planes_that_agree},
      {area, "mast with four equal guys, 24 modes", "pairs; turned by 90 degrees the same space",
       mast_with_four_guys},
      {area, "24 to 60 N in 400 steps, 12 modes", "followed by MAC, none lost or swapped",
       sweep_level},
      {area, "the same, inclined by 20 degrees", "followed by MAC, none lost", sweep_inclined},
      {area, "its crossovers, EI = 0", "lambda^2 = 4 pi^2, 16 pi^2 to (m g L / H)^2", crossovers},
  };
}

}  // namespace rigfit::hard_cases
