// Natural modes of a chain about its equilibrium, each motion on its own: (K - omega^2 M) phi = 0,
// phi' M phi = 1. The layer below `analyse_modes`, for those who need the matrices too (response,
// sensitivities, FRFs).
#pragma once

#include <memory>
#include <vector>

#include "model/chain/assembly.h"
#include "model/linear/natural_mode.h"
#include "model/scene/scene.h"
#include "model/statics/equilibrium.h"

namespace rigfit::model {

struct MotionModes {
  Motion motion = Motion::space;
  std::unique_ptr<Assembly> assembly;
  EnvelopeMatrix stiffness, mass;
  Eigen::VectorXd omega2;  ///< (rad/s)^2, rising
  Eigen::MatrixXd shapes;  ///< unknowns x modes, mass-normalised
  bool complete = false;   ///< Sturm count agrees
};

struct ChainModes {
  std::unique_ptr<Chain> chain;  ///< settled
  ChainEquilibrium equilibrium;
  std::vector<MotionModes> motions;  ///< empty unless the equilibrium converged
  struct Which {
    int motion = 0, mode = 0;
  };
  std::vector<Which> order;  ///< all modes asked for, by rising frequency
  [[nodiscard]] double frequency_hz(std::size_t i) const;
  [[nodiscard]] bool complete() const;
};

/// The equilibrium and each motion's matrices, without modes. `segments` as below.
[[nodiscard]] ChainModes prepare_motions(const Scene& scene, const ModesOptions& options,
                                         const std::vector<int>& segments = {});
/// `segments` by member; empty: the scene's own, 30 where it says "auto". Uses of `options`:
/// count, band, rotary inertia, torsion.
[[nodiscard]] ChainModes find_modes(const Scene& scene, const ModesOptions& options,
                                    const std::vector<int>& segments = {});

/// The same of a chain cut and lumped as `chain` says.
[[nodiscard]] ChainModes find_chain_modes(const Scene& scene, const ModesOptions& options,
                                          const ChainOptions& chain);

/// Row of a sensor's quantity in a motion's unknowns: displacement along its direction, or for a
/// force sensor the change of axial force, N per m.
[[nodiscard]] Eigen::VectorXd sensor_row(const Assembly& assembly, const ChainState& state,
                                         const Scene& scene, int sensor);
[[nodiscard]] Eigen::VectorXd load_row(const Assembly& assembly, int load);

}  // namespace rigfit::model
