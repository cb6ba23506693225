#include "model/linear/modes.h"

#include "model/scene/sensor_quantity.h"

namespace rigfit::model {
namespace {

double squared_omega(double frequency_hz) {
  const double omega = 2 * M_PI * frequency_hz;
  return omega * omega;
}

void solve(MotionModes& motion, int count) {
  motion.take(lowest_eigenpairs(motion.stiffness, motion.mass, count));
}

ChainOptions chain_options_of(const ModesOptions& options, const std::vector<int>& segments) {
  ChainOptions out;
  out.segments = segments;
  out.rotary_inertia = options.rotary_inertia;
  out.torsion = options.torsion;
  return out;
}

ChainModes prepare(const Scene& scene, const ChainOptions& chain_options) {
  ChainModes out;
  out.chain = std::make_unique<Chain>(Chain::from_scene(scene, chain_options));
  out.equilibrium = find_equilibrium(*out.chain, scene);
  for (RestMotion& at_rest : out.equilibrium.motions) {
    MotionModes& motion = out.motions.emplace_back();
    static_cast<RestMotion&>(motion) = std::move(at_rest);
    motion.mass = motion.assembly->matrix();
    motion.assembly->mass(motion.mass);
  }
  out.equilibrium.motions.clear();
  return out;
}

}  // namespace

double ChainModes::frequency_hz(std::size_t i) const {
  const Which& which = order[i];
  return std::sqrt(motions[std::size_t(which.motion)].omega2[which.mode]) / (2 * M_PI);
}

bool ChainModes::complete() const {
  return !motions.empty() && std::all_of(motions.begin(), motions.end(),
                                         [](const MotionModes& m) { return m.complete; });
}

ChainModes prepare_motions(const Scene& scene, const ModesOptions& options,
                           const std::vector<int>& segments) {
  return prepare(scene, chain_options_of(options, segments));
}

ChainModes find_modes(const Scene& scene, const ModesOptions& options,
                      const std::vector<int>& segments) {
  return find_chain_modes(scene, options, chain_options_of(options, segments));
}

ChainModes find_chain_modes(const Scene& scene, const ModesOptions& options,
                            const ChainOptions& chain) {
  ChainModes out = prepare(scene, chain);
  if (out.equilibrium.status != EquilibriumStatus::converged) return out;
  if (options.band_hz) {
    for (MotionModes& motion : out.motions) {
      motion.take(eigenpairs_between(motion.stiffness, motion.mass,
                                     squared_omega(options.band_hz->first),
                                     squared_omega(options.band_hz->second)));
    }
  } else if (out.motions.size() == 1) {
    solve(out.motions[0], options.count);
  } else if (options.by_plane) {
    for (MotionModes& motion : out.motions) {
      const int count = (*options.by_plane)[motion.motion == Motion::in_plane ? 0 : 1];
      if (count > 0) {
        solve(motion, count);
      } else {
        motion.shapes.resize(motion.assembly->size(), 0);
        motion.complete = true;
      }
    }
  } else {
    // Half of them in each motion, one more, then what is lacking where the highest lies too low.
    std::vector<int> asked(out.motions.size(), std::min(options.count, options.count / 2 + 1));
    for (std::size_t k = 0; k < out.motions.size(); ++k) solve(out.motions[k], asked[k]);
    for (;;) {
      std::vector<double> all;
      for (const auto& motion : out.motions) {
        all.insert(all.end(), motion.omega2.data(), motion.omega2.data() + motion.omega2.size());
      }
      std::sort(all.begin(), all.end());
      const auto wanted = static_cast<std::size_t>(options.count);
      const double top =
          all.size() >= wanted ? all[wanted - 1] : std::numeric_limits<double>::infinity();
      bool again = false;
      for (std::size_t k = 0; k < out.motions.size(); ++k) {
        MotionModes& motion = out.motions[k];
        if (motion.omega2.size() < asked[k]) continue;  // it has no more
        if (asked[k] >= options.count || motion.omega2[asked[k] - 1] >= top) continue;
        asked[k] = std::min(options.count, 2 * asked[k]);
        solve(motion, asked[k]);
        again = true;
      }
      if (!again) break;
    }
  }
  for (std::size_t k = 0; k < out.motions.size(); ++k) {
    for (Index i = 0; i < out.motions[k].omega2.size(); ++i) {
      out.order.push_back({static_cast<int>(k), static_cast<int>(i)});
    }
  }
  std::stable_sort(out.order.begin(), out.order.end(),
                   [&](const ChainModes::Which& a, const ChainModes::Which& b) {
                     return out.motions[std::size_t(a.motion)].omega2[a.mode] <
                            out.motions[std::size_t(b.motion)].omega2[b.mode];
                   });
  const bool by_plane = options.by_plane && out.motions.size() > 1;
  if (!options.band_hz && !by_plane) {
    out.order.resize(std::min(out.order.size(), static_cast<std::size_t>(options.count)));
  }
  return out;
}

MatrixXd sensor_rows(const Assembly& assembly, const ChainState& state, const Scene& scene) {
  const Chain& chain = assembly.chain();
  const auto count = static_cast<Index>(chain.sensors.size());
  MatrixXd rows = MatrixXd::Zero(assembly.size(), count);
  const auto elongations = assembly.elongations(state);
  for (Index i = 0; i < count; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const ChainPoint& point = chain.sensors[k];
    if (described(scene.sensors[k].quantity).reading == SensorReading::displacement) {
      rows.col(i) = assembly.row_of(point, chain.sensor_direction[k]);
      continue;
    }
    if (point.segment < 0) continue;
    const Segment& s = chain.segments[static_cast<std::size_t>(point.segment)];
    rows.col(i) = s.EA / s.length * elongations.row(point.segment).transpose();
  }
  return rows;
}

MatrixXd load_rows(const Assembly& assembly) {
  const Chain& chain = assembly.chain();
  MatrixXd rows(assembly.size(), static_cast<Index>(chain.loads.size()));
  for (std::size_t k = 0; k < chain.loads.size(); ++k) {
    rows.col(static_cast<Index>(k)) = assembly.row_of(chain.loads[k], chain.load_direction[k]);
  }
  return rows;
}

}  // namespace rigfit::model
