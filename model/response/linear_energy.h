// Where the energy of a small motion about the equilibrium is: the account's terms by member and
// kind to second order in the displacements u,
//   E_kind(rest + u) = E_kind(rest) + g_kind . u + u' K_kind u / 2,   kinetic u'' = v' M v / 2.
// The first-order terms of all kinds cancel in sum (equilibrium), the second-order ones add to the
// tangent stiffness: what the linear equations conserve is accounted for exactly. Axial holds the
// geometric stiffness N (1 - t t') / |e|.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "model/chain/assembly.h"

namespace rigfit::model {

class LinearEnergy {
 public:
  /// The chain must be settled; the assembly (of any motion) must outlive this object.
  LinearEnergy(const Assembly& assembly, const ChainState& rest);

  /// Adds the change by displacements `u` and the kinetic energy of velocities `v`, both in the
  /// assembly's unknowns, to an account with an entry for every member.
  void add(const Eigen::VectorXd& u, const Eigen::VectorXd& v, EnergyAccount& account) const;

 private:
  using Vector4 = Eigen::Vector4d;
  using Matrix4 = Eigen::Matrix4d;
  // One of two kinds of a joint's energy, in edge increment and twist of its segments (a: -1 none).
  struct Joint {
    int a = -1, b = -1;
    int rotation = -1;  // instead of a: the node's, about its basis
    std::size_t member = 0;
    bool torsion = false;
    Vector4 gradient_a, gradient_b;
    Matrix4 aa, ab, bb;
  };
  struct Axial {
    Eigen::Vector3d gradient;
    Eigen::Matrix3d hessian;
  };
  struct Spring {
    int node;
    Eigen::Vector3d gradient;
    Eigen::Matrix3d hessian;
  };
  void add_joint(Joint joint, const Eigen::Matrix3d& a, const Eigen::Matrix3d& b,
                 const JointSprings& springs, double length_a, double length_b);

  const Assembly& assembly_;
  std::vector<Axial> axial_;  // by segment
  std::vector<Joint> joints_;
  std::vector<Spring> springs_;
  struct Turn {
    int rotation;
    Eigen::Vector3d gradient;
    Eigen::Matrix3d hessian;
  };
  std::vector<Turn> turns_;
};

}  // namespace rigfit::model
