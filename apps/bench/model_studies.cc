#include "apps/bench/model_studies.h"

#include <fmt/format.h>

#include <cmath>
#include <complex>
#include <numeric>

#include "apps/bench/calculix_rows.h"
#include "model/algebra/eigenpairs.h"
#include "model/chain/assembly.h"
#include "model/frfs/frf_synthesis.h"
#include "model/linear/modal_analysis.h"
#include "model/linear/modes.h"
#include "model/statics/equilibrium.h"

namespace rigfit::apps {
namespace {

constexpr int kModes = 6;

/// How the unknowns of a rig at rest are set up.
enum class Unknowns { apart, space, torsion };

std::vector<int> all(const model::Scene& scene, int segments) {
  return std::vector<int>(scene.members.size(), segments);
}

model::ChainModes planes_apart(const model::Scene& scene, int segments,
                               model::RotaryInertia inertia, bool torsion, int count) {
  model::ModesOptions options;
  options.count = count;
  options.rotary_inertia = inertia;
  if (torsion) options.torsion = true;
  return model::find_modes(scene, options, all(scene, segments));
}

/// All displacements in one problem, as if the scene had no plane of symmetry.
struct WholeSpace {
  model::Chain chain;
  model::ChainEquilibrium rest;

  WholeSpace(const model::Scene& scene, int segments, model::RotaryInertia inertia)
      : chain(chain_of(scene, segments, inertia)), rest(model::find_equilibrium(chain, scene)) {}

  [[nodiscard]] Eigen::VectorXd lowest(int count) const {
    if (rest.status != model::EquilibriumStatus::converged) return {};
    const model::Assembly assembly(chain, model::Motion::space);
    model::EnvelopeMatrix stiffness = assembly.matrix(), mass = assembly.matrix();
    Eigen::VectorXd force(assembly.size());
    assembly.force_and_tangent(rest.state, force, stiffness);
    assembly.mass(mass);
    return model::lowest_eigenpairs(stiffness, mass, count).values;
  }

  static model::Chain chain_of(const model::Scene& scene, int segments,
                               model::RotaryInertia inertia) {
    model::ChainOptions options;
    options.segments = all(scene, segments);
    options.rotary_inertia = inertia;
    model::Chain chain = model::Chain::from_scene(scene, options);
    chain.planar = false;
    return chain;
  }
};

Eigen::VectorXd frequencies(const model::Scene& scene, int segments, model::RotaryInertia inertia,
                            Unknowns unknowns) {
  if (unknowns == Unknowns::space) {
    const Eigen::VectorXd omega2 = WholeSpace(scene, segments, inertia).lowest(kModes);
    return omega2.array().sqrt() / (2 * M_PI);
  }
  const model::ChainModes modes =
      planes_apart(scene, segments, inertia, unknowns == Unknowns::torsion, kModes);
  Eigen::VectorXd hz(static_cast<Eigen::Index>(modes.order.size()));
  for (Eigen::Index i = 0; i < hz.size(); ++i) {
    hz[i] = modes.frequency_hz(static_cast<std::size_t>(i));
  }
  return hz;
}

/// Middles of all members at rest, scene axes, one after the other; empty without equilibrium.
Eigen::VectorXd middles(const model::Chain& chain, const model::ChainEquilibrium& rest) {
  if (rest.status != model::EquilibriumStatus::converged) return {};
  Eigen::VectorXd out(3 * static_cast<Eigen::Index>(chain.members.size()));
  for (std::size_t m = 0; m < chain.members.size(); ++m) {
    const auto& member = chain.members[m];
    const auto middle = static_cast<std::size_t>(member.segments / 2);
    Eigen::Vector3d at = rest.state.position.col(member.nodes[middle]);
    if (member.segments % 2 != 0) {
      at = 0.5 * (at + rest.state.position.col(member.nodes[middle + 1]));
    }
    out.segment<3>(3 * static_cast<Eigen::Index>(m)) = chain.axes.transpose() * at;
  }
  return out;
}

struct RestOptions {
  int segments = 30;
  model::RotaryInertia inertia = model::RotaryInertia::accurate;
  bool space = false;
  double tolerance = model::EquilibriumOptions{}.residual;
};

Eigen::VectorXd middles_at_rest(const model::Scene& scene, const RestOptions& options) {
  model::ChainOptions chain_options;
  chain_options.segments = all(scene, options.segments);
  chain_options.rotary_inertia = options.inertia;
  model::Chain chain = model::Chain::from_scene(scene, chain_options);
  if (options.space) chain.planar = false;
  model::EquilibriumOptions equilibrium;
  equilibrium.residual = equilibrium.step = options.tolerance;
  const model::ChainEquilibrium rest = model::find_equilibrium(chain, scene, equilibrium);
  return middles(chain, rest);
}

/// The limit of what `values` gives for vanishing segments, and how far it can be trusted.
struct Limit {
  Eigen::VectorXd value;  ///< empty: a chain has no answer
  Eigen::VectorXd error;
};

template <class Values>
Limit limit_of(Values values, const BenchBudget& budget) {
  const int n0 = budget.quick ? 40 : 80;  // 1, 1.5, 2 and 3 times as many: all even
  const int counts[] = {n0, 3 * n0 / 2, 2 * n0, 3 * n0};
  std::vector<Eigen::VectorXd> found;
  for (const int n : counts) {
    found.push_back(values(n));
    if (found.back().size() == 0 || found.back().size() != found.front().size()) return {};
  }
  Limit limit;
  limit.value.resize(found[0].size());
  limit.error.resize(found[0].size());
  for (Eigen::Index i = 0; i < limit.value.size(); ++i) {
    const auto from = [&](std::size_t first) {
      return extrapolated(
          {double(counts[first]), double(counts[first + 1]), double(counts[first + 2])},
          {found[first][i], found[first + 1][i], found[first + 2][i]});
    };
    limit.value[i] = from(1);
    limit.error[i] = std::abs(limit.value[i] - from(0));
  }
  return limit;
}

std::string limit_words(const BenchBudget& budget) {
  const int n0 = budget.quick ? 40 : 80;
  return fmt::format("limit of {}, {} and {} segments a member", 3 * n0 / 2, 2 * n0, 3 * n0);
}

bool planar(const model::Scene& scene) {
  return model::Chain::from_scene(with_segments(scene, 4)).planar;
}

const char* name_of(model::RotaryInertia inertia) {
  return inertia == model::RotaryInertia::accurate ? "accurate inertia" : "rigid rods (paper)";
}

constexpr const char* kAutoDoes =
    "the default is not told the number of segments: it goes on with longer chains until their "
    "differences show the scene's accuracy";

}  // namespace

int mean_segments(const std::vector<int>& by_member) {
  if (by_member.empty()) return 0;
  const double sum = std::accumulate(by_member.begin(), by_member.end(), 0.0);
  return static_cast<int>(std::lround(sum / static_cast<double>(by_member.size())));
}

model::Scene with_segments(model::Scene scene, int segments) {
  for (auto& member : scene.members) member.segments = segments;
  return scene;
}

BenchStudy statics_study(const model::Scene& scene, const BenchBudget& budget) {
  BenchStudy study;
  study.task = "statics";
  study.scene = scene.title;
  study.error_of = "positions of the members' middles at rest, over the largest sag";
  study.reference = limit_words(budget);
  study.default_does =
      "the default tolerance leaves what follows (modes, motion) nothing to correct";
  const Limit limit =
      limit_of([&](int n) { return middles_at_rest(scene, {.segments = n}); }, budget);
  if (limit.value.size() == 0) {
    study.skipped = "the scene has no equilibrium";
    return study;
  }
  double sag = 0;
  {
    const auto chain = model::prepare_motions(scene, {}, all(scene, 30));
    for (const auto& member : model::describe(*chain.chain, chain.equilibrium, scene).members) {
      sag = std::max(sag, member.sag_m);
    }
  }
  if (!(sag > 0)) {
    study.skipped = "nothing sags";
    return study;
  }
  study.reference_error = limit.error.cwiseAbs().maxCoeff() / sag;
  const auto add = [&](const char* method, const RestOptions& options, bool is_default = false) {
    BenchRow row;
    row.method = method;
    row.segments = options.segments;
    row.tolerance = options.tolerance;
    row.is_default = is_default;
    const Eigen::VectorXd found = middles_at_rest(scene, options);
    if (found.size() != limit.value.size()) {
      row.note = "no equilibrium found";
    } else {
      row.relative_error = std::min(1.0, (found - limit.value).cwiseAbs().maxCoeff() / sag);
    }
    row.wall_s = median_time(budget, [&] { (void)middles_at_rest(scene, options); });
    study.rows.push_back(std::move(row));
  };
  const bool flat = planar(scene);
  const char* const own = flat ? "accurate joints, in the plane" : "accurate joints, in space";
  for (const int n : {4, 8, 16, 30, 60, 120}) add(own, {.segments = n}, n == 30);
  for (const double tolerance : {1e-2, 1e-4, 1e-6, 1e-12}) {
    add(own, {.segments = 30, .tolerance = tolerance});
  }
  for (const int n : {8, 30, 120}) {
    add("rigid rods' joints (paper)", {.segments = n, .inertia = model::RotaryInertia::rigid_rod});
  }
  if (flat) {
    for (const int n : {8, 30, 120}) {
      add("accurate joints, in space", {.segments = n, .space = true});
    }
  }
  mark_front(study);
  return study;
}

BenchStudy modes_study(const model::Scene& scene, const BenchBudget& budget) {
  using model::RotaryInertia;
  BenchStudy study;
  study.task = "modes";
  study.scene = scene.title;
  study.error_of = fmt::format("the first {} natural frequencies, largest", kModes);
  study.reference = limit_words(budget);
  study.default_does = kAutoDoes;
  const Limit limit = limit_of(
      [&](int n) { return frequencies(scene, n, RotaryInertia::accurate, Unknowns::apart); },
      budget);
  if (limit.value.size() == 0) {
    study.skipped = "the scene has no equilibrium, or no modes";
    return study;
  }
  study.reference_error = (limit.error.array() / limit.value.array()).abs().maxCoeff();
  study.reference_values.assign(limit.value.begin(), limit.value.end());
  const auto error_of = [&](const Eigen::VectorXd& hz) {
    if (hz.size() != limit.value.size()) return 1.0;
    return std::min(1.0, (hz.array() / limit.value.array() - 1).abs().maxCoeff());
  };
  const auto add = [&](const std::string& method, int n, RotaryInertia inertia, Unknowns unknowns) {
    BenchRow row;
    row.method = method;
    row.segments = n;
    row.relative_error = error_of(frequencies(scene, n, inertia, unknowns));
    row.wall_s = median_time(budget, [&] { (void)frequencies(scene, n, inertia, unknowns); });
    study.rows.push_back(std::move(row));
  };
  const bool flat = planar(scene);
  const std::string own = flat ? ", planes apart" : ", in space";
  for (const RotaryInertia inertia : {RotaryInertia::accurate, RotaryInertia::rigid_rod}) {
    for (const int n : {6, 8, 10, 15, 20, 30, 45, 60, 120}) {
      if (inertia == RotaryInertia::rigid_rod && n < 10) continue;
      add(name_of(inertia) + own, n, inertia, Unknowns::apart);
    }
  }
  if (flat) {
    for (const int n : {10, 30, 60}) {
      add("accurate inertia, in space", n, RotaryInertia::accurate, Unknowns::space);
    }
  }
  bool twists = false;
  for (const auto& member : scene.members) twists = twists || member.GJ > 0;
  if (twists) {
    for (const int n : {10, 30, 60}) {
      add("accurate inertia, torsion kept", n, RotaryInertia::accurate, Unknowns::torsion);
    }
  }
  // The default: nothing is told but the accuracy.
  model::Scene free = with_segments(scene, 0);
  for (const double accuracy : {1e-3, 1e-4, 1e-5, 1e-6}) {
    free.accuracy = accuracy;
    model::ModesOptions options;
    options.count = kModes;
    BenchRow row;
    row.method = "segments = \"auto\"";
    row.tolerance = accuracy;
    row.is_default = accuracy == model::Scene{}.accuracy;
    options.damped = options.shapes = false;
    const model::ModalAnalysis analysis = model::analyse_modes(free, options);
    std::vector<int> segments;
    for (const auto& member : analysis.equilibrium.members) segments.push_back(member.segments);
    row.segments = mean_segments(segments);
    Eigen::VectorXd hz(static_cast<Eigen::Index>(analysis.modes.size()));
    for (Eigen::Index i = 0; i < hz.size(); ++i) {
      hz[i] = analysis.modes[static_cast<std::size_t>(i)].frequency_hz;
    }
    row.relative_error = error_of(hz);
    row.wall_s = median_time(budget, [&] { (void)model::analyse_modes(free, options); });
    study.rows.push_back(std::move(row));
  }
  CalculixRows other = calculix_rows(scene, limit.value, budget);
  for (BenchRow& row : other.rows) study.rows.push_back(std::move(row));
  study.beside = std::move(other.note);
  mark_front(study);
  return study;
}

namespace {

using ComplexMatrix = Eigen::MatrixXcd;

/// Lines one after the other, sensors x loads each.
Eigen::VectorXcd flattened(const std::vector<ComplexMatrix>& H) {
  if (H.empty()) return {};
  Eigen::VectorXcd out(static_cast<Eigen::Index>(H.size()) * H[0].size());
  Eigen::Index at = 0;
  for (const ComplexMatrix& line : H) {
    out.segment(at, line.size()) = line.reshaped();
    at += line.size();
  }
  return out;
}

/// The same from the scene's first modes alone.
Eigen::VectorXcd modal_sum(const model::Scene& scene, const Eigen::VectorXd& lines, int segments,
                           int count) {
  model::ModesOptions options;
  options.count = count;
  options.segments = segments;
  options.shapes = options.error_estimate = false;
  const model::ModalAnalysis analysis = model::analyse_modes(scene, options);
  std::vector<ComplexMatrix> H(static_cast<std::size_t>(lines.size()),
                               ComplexMatrix::Zero(static_cast<Eigen::Index>(scene.sensors.size()),
                                                   static_cast<Eigen::Index>(scene.loads.size())));
  for (const auto& mode : analysis.modes) {
    const double wr = 2 * M_PI * mode.frequency_hz;
    for (Eigen::Index k = 0; k < lines.size(); ++k) {
      const double w = 2 * M_PI * lines[k];
      const std::complex<double> gain =
          1.0 / std::complex<double>(wr * wr - w * w, 2 * mode.damping_ratio * wr * w);
      ComplexMatrix& line = H[static_cast<std::size_t>(k)];
      for (Eigen::Index s = 0; s < line.rows(); ++s) {
        for (Eigen::Index l = 0; l < line.cols(); ++l) {
          line(s, l) += gain * mode.sensor_shape[s] * mode.load_shape[l];
        }
      }
    }
  }
  return flattened(H);
}

}  // namespace

BenchStudy frf_synthesis_study(const model::Scene& given, const BenchBudget& budget) {
  BenchStudy study;
  study.task = "frf-synthesis";
  study.scene = given.title;
  const int lines = budget.quick ? 60 : 200;
  study.error_of = fmt::format("receptances at {} lines, root mean square", lines);
  study.default_does = std::string(kAutoDoes) + ", and leaves no mode out, whatever the lines";
  if (given.loads.empty() || given.sensors.empty()) {
    study.skipped = "the scene has no load or no sensor";
    return study;
  }
  model::Scene scene = given;
  for (auto& sensor : scene.sensors) {
    if (sensor.quantity != model::Sensor::Quantity::force) {
      sensor.quantity = model::Sensor::Quantity::displacement;
    }
  }
  for (auto& member : scene.members) {
    const auto& own = member.damping;
    if (!member.damping_ratio && own.axial + own.bending + own.torsion == 0) {
      member.damping_ratio = 0.005;  // without damping there is no function at a resonance
      study.error_of += "; 0.5 % damping where the scene has none";
    }
  }
  const Eigen::VectorXd hz =
      frequencies(scene, 30, model::RotaryInertia::accurate, Unknowns::apart);
  if (hz.size() == 0) {
    study.skipped = "the scene has no equilibrium, or no modes";
    return study;
  }
  const double top = 1.25 * hz[hz.size() - 1];
  const Eigen::VectorXd line_hz = Eigen::VectorXd::LinSpaced(lines, top / lines, top);
  const auto direct = [&](int n, model::RotaryInertia inertia) {
    model::ModesOptions options;
    options.segments = n;
    options.rotary_inertia = inertia;
    return flattened(model::synthesize_frfs(scene, line_hz, options).H);
  };
  const int fine = budget.quick ? 120 : 240;
  const Eigen::VectorXcd truth = direct(fine, model::RotaryInertia::accurate);
  const double norm = truth.norm();
  if (!(norm > 0)) {
    study.skipped = "no load moves a sensor";
    return study;
  }
  study.reference = fmt::format("every line solved at {} segments a member", fine);
  study.reference_error =
      (direct(2 * fine / 3, model::RotaryInertia::accurate) - truth).norm() / norm;
  const auto add = [&](const std::string& method, int n, std::optional<int> order,
                       const std::function<Eigen::VectorXcd()>& work) {
    BenchRow row;
    row.method = method;
    row.segments = n;
    row.order = order;
    const Eigen::VectorXcd found = work();
    if (found.size() == truth.size() && found.allFinite()) {
      row.relative_error = std::min(1.0, (found - truth).norm() / norm);
    }
    row.wall_s = median_time(budget, [&] { (void)work(); });
    study.rows.push_back(std::move(row));
  };
  using model::RotaryInertia;
  for (const RotaryInertia inertia : {RotaryInertia::accurate, RotaryInertia::rigid_rod}) {
    for (const int n : {10, 20, 30, 60, 120}) {
      if (n >= fine) continue;
      add(std::string("every line solved, ") + name_of(inertia), n, {},
          [&] { return direct(n, inertia); });
    }
  }
  for (const int n : {30, 60}) {
    for (const int modes : {6, 12, 24, 48}) {
      add("sum of the lowest modes", n, modes, [&] { return modal_sum(scene, line_hz, n, modes); });
    }
  }
  const model::Scene free = with_segments(scene, 0);
  BenchRow row;
  row.method = "segments = \"auto\", every line solved";
  row.tolerance = free.accuracy;
  row.is_default = true;
  const auto automatic = [&] { return model::synthesize_frfs(free, line_hz); };
  const model::SynthesizedFrfs found = automatic();
  std::vector<int> segments;
  for (const auto& member : found.equilibrium.members) segments.push_back(member.segments);
  row.segments = mean_segments(segments);
  const Eigen::VectorXcd flat = flattened(found.H);
  if (flat.size() == truth.size()) {
    row.relative_error = std::min(1.0, (flat - truth).norm() / norm);
  }
  row.wall_s = median_time(budget, [&] { (void)automatic(); });
  study.rows.push_back(std::move(row));
  mark_front(study);
  return study;
}

}  // namespace rigfit::apps
