#include "signal/refinement/modal_basis.h"

#include "signal/refinement/modal_refine.h"
#include "tests/reference/ten_mode_truth.h"
#include "tests/test.h"

namespace rigfit::signal::modal_basis_test {

TEST(ModalBasis, RecoversResiduesAndResidualsOfEveryForm) {
  const auto truth = testing::ten_mode_truth(4);
  const Eigen::VectorXd f = Eigen::VectorXd::LinSpaced(1400, 1, 1400);
  for (const FrfForm form : {FrfForm::receptance, FrfForm::mobility, FrfForm::accelerance}) {
    for (const double window : {0.0, 3.0}) {
      const Eigen::VectorXcd s = laplace_lines(f, window);
      const Eigen::MatrixXcd residues = truth.residues().transpose();
      const double size = residues.cwiseAbs().maxCoeff();
      Eigen::VectorXcd lower(4), upper(4);
      lower << -0.1, 0.2, Complex(-0.3, 0.01), 0;
      upper << 1e-8, Complex(2e-8, -1e-9), 0, -1e-8;
      const Eigen::MatrixXcd H =
          synthesise(s, power_of_s(form), truth.poles(), residues, lower, upper);
      const ModalRefineResult found =
          refine_modes({s, power_of_s(form), H, 1, {}}, noise_unknown(H, 1, 0), truth.poles(),
                       {.max_iterations = 0});
      // Rounding of H, some 1e-16 of its largest value, over condition numbers below 1e4, squared
      // in a Gram matrix.
      EXPECT_TRUE(MatricesNear(found.residues, residues, 1e-8 * size)) << name_of(form);
      EXPECT_TRUE(MatricesNear(found.lower, lower, 1e-5));
      EXPECT_TRUE(MatricesNear(found.upper, upper, 1e-13));
    }
  }
}

TEST(ModalBasis, SynthesisIsTheTruthsAccelerance) {
  const auto truth = testing::ten_mode_truth(5);
  const Eigen::VectorXd f = Eigen::VectorXd::LinSpaced(500, 3, 1400);
  const Eigen::MatrixXcd H =
      synthesise(laplace_lines(f, 2), 2, truth.poles(), truth.residues().transpose(),
                 Eigen::VectorXcd::Zero(5), Eigen::VectorXcd::Zero(5));
  const Eigen::MatrixXcd exact = truth.accelerance(f, 2);
  EXPECT_TRUE(MatricesNear(H, exact, 1e-12 * exact.cwiseAbs().maxCoeff()));
}

}  // namespace rigfit::signal::modal_basis_test
