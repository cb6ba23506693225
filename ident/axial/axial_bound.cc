#include "ident/axial/axial_bound.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "ident/axial/rod_stiffness.h"

namespace rigfit::ident {

signal::Estimate assembly_stiffness(const AxialLengthData& length, const AxialSetup& setup) {
  const double W = std::exp(length.log_omega_squared);
  const double k =
      rod_stiffness({W, setup.mass_kg.value, setup.mass_per_length_kg_m.value, length.length_m,
                     setup.adapter_stiffness_N_m.value, setup.frame_stiffness_N_m.value})
          .series_N_m;
  // k = W (M + moving part of the cable's mass): a third under a rigid frame, all of it under a
  // soft one, none above a soft adapter.
  const double third = length.length_m / 3;
  const bool told = setup.frame_stated || setup.series_compliance_std_m_N.has_value();
  const double place = told ? 0 : third * setup.mass_per_length_kg_m.value / std::sqrt(3.0);
  return {k, std::hypot(std::hypot(k * length.log_omega_squared_std, W * place),
                        W * setup.mass_kg.std, W * third * setup.mass_per_length_kg_m.std)};
}

void bound_axial(double low_N, const AxialSetup& setup, const AxialOptions& options,
                 AxialTestResult& result) {
  result.EA_if_rigid_N = result.EA_N;
  result.EA_if_rigid_low_N = result.EA_low_N, result.EA_if_rigid_high_N = result.EA_high_N;
  const double solid =
      setup.mass_per_length_kg_m.value / options.steel_density_kg_m3 * options.solid_modulus_Pa;
  const double most = std::max(solid, setup.catalogue_EA_N);
  result.EA_low_N = low_N;
  result.EA_high_N =
      most > 0 ? std::max(most, result.EA_high_N) : std::numeric_limits<double>::infinity();
  result.EA_N.std = (result.EA_high_N - result.EA_low_N) / std::sqrt(12.0);
  result.coverage_factor = std::sqrt(3.0);  // half the width over the std
  result.degrees_of_freedom = 0;
  if (!std::isfinite(result.EA_N.std)) return;
  const double own = result.EA_if_rigid_N.std, all = result.EA_N.std;
  const double share = std::max(0.0, 1 - own * own / (all * all));
  for (auto& row : result.budget) row.share *= 1 - share;
  BudgetRow row;
  row.source = "what else gives way, not told", row.unit = "N";
  row.value = std::numeric_limits<double>::quiet_NaN();
  row.std = row.contribution_N = all * std::sqrt(share);
  row.sensitivity = 1, row.share = share;
  result.budget.insert(result.budget.begin(), row);
}

}  // namespace rigfit::ident
