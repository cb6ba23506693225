// Natural modes of a chain about its equilibrium, each motion on its own: (K - omega^2 M) phi = 0,
// phi' M phi = 1. The layer below `analyse_modes`, for those who need the matrices too (response,
// sensitivities, FRFs).
#pragma once

#include "model/algebra/eigenpairs.h"
#include "model/algebra/numbers.h"
#include "model/chain/assembly.h"
#include "model/linear/natural_mode.h"
#include "model/scene/scene.h"
#include "model/statics/equilibrium.h"

namespace rigfit::model {

struct MotionModes : RestMotion {
  EnvelopeMatrix mass;
  VectorXd omega2;        ///< (rad/s)^2, rising
  MatrixXd shapes;        ///< unknowns x modes, mass-normalised
  bool complete = false;  ///< Sturm count agrees

  void take(Eigenpairs pairs) {
    omega2 = std::move(pairs.values);
    shapes = std::move(pairs.vectors);
    complete = pairs.complete;
  }
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

/// Modes, and the error that the number of segments leaves in them.
struct ResolvedModes {
  ChainModes modes;                  ///< the finest chain has
  std::vector<double> frequency_hz;  ///< by ChainModes::order
  std::vector<double> limit_hz;      ///< NaturalMode::extrapolated_hz, likewise
  double relative_error = 0;         ///< estimated, of `frequency_hz`, largest of all
  bool known = false;  ///< whether that is known: finer chains found the equilibrium and all modes
  bool extrapolated = false;  ///< `frequency_hz` is that of vanishing segments
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

/// By sensor (columns) its quantity in a motion's unknowns: displacement along its direction, or
/// for a force sensor the change of axial force, N per m.
[[nodiscard]] MatrixXd sensor_rows(const Assembly& assembly, const ChainState& state,
                                   const Scene& scene);
/// By load (columns) the displacement along its direction.
[[nodiscard]] MatrixXd load_rows(const Assembly& assembly);

}  // namespace rigfit::model
