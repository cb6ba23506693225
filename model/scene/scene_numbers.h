// The numbers of members and their dampers that have a key in a scene file: key, unit, bound and
// meaning, each once. The reader, the writer (read_scene.h) and the parameters
// (parameters.h) walk these tables.
#pragma once

#include <variant>

#include "document/toml_table.h"
#include "model/scene/scene.h"

namespace rigfit::model {

using document::Bound, document::nearest_word, document::TomlTable;

/// A key of `Owner`. A plain number that is not required keeps the value that a new `Owner` has
/// and is written where it differs.
template <class Owner>
struct SceneNumber {
  std::variant<double Owner::*, std::optional<double> Owner::*> value;
  const char* key;
  const char* unit;
  Bound bound;
  const char* words;  ///< for a person, such as "axial stiffness EA"
  bool required = false;

  [[nodiscard]] bool is_optional() const { return value.index() == 1; }
  /// The number itself; null: an optional one that is not given.
  [[nodiscard]] double* of(Owner& owner) const {
    if (value.index() == 0) return &(owner.*std::get<0>(value));
    auto& number = owner.*std::get<1>(value);
    return number ? &*number : nullptr;
  }
  void read(TomlTable& table, Owner& owner) const {
    if (value.index() == 1) {
      owner.*std::get<1>(value) = table.optional_number(key, bound, unit);
    } else if (double& number = owner.*std::get<0>(value); required) {
      number = table.number(key, bound, unit);
    } else {
      number = table.number_or(key, bound, unit, number);
    }
  }
};

inline constexpr SceneNumber<Member> kMemberNumbers[] = {
    {&Member::mass_per_length, "mass_per_length", "kg/m", Bound::positive, "mass per length", true},
    {&Member::EA, "EA", "N", Bound::positive, "axial stiffness EA", true},
    {&Member::GJ, "GJ", "N m2", Bound::not_negative, "torsional stiffness GJ"},
    {&Member::polar_inertia, "polar_inertia", "kg m", Bound::not_negative,
     "polar inertia per length"},
    {&Member::taper, "taper", "", Bound::positive, "taper"},
    {&Member::tension, "tension", "N", Bound::positive, "tension T"},
    {&Member::unstretched_length, "unstretched_length", "m", Bound::positive, "unstretched length"},
    {&Member::stretch, "stretch", "m", Bound::not_negative, "end displacement"},
    {&Member::thermal_expansion, "thermal_expansion", "1/K", Bound::not_negative,
     "thermal expansion"},
    {&Member::damping_ratio, "damping_ratio", "", Bound::not_negative, "damping ratio ζ"},
};

inline constexpr SceneNumber<JointDamping> kDampingNumbers[] = {
    {&JointDamping::axial, "axial", "N s", Bound::not_negative, "axial damper"},
    {&JointDamping::bending, "bending", "N m2 s", Bound::not_negative, "bending damper"},
    {&JointDamping::torsion, "torsion", "N m2 s", Bound::not_negative, "torsional damper"},
};

}  // namespace rigfit::model
