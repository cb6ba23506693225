#include "signal/modes/modal_result.h"

#include "signal/recording/add_note.h"
#include "signal/refinement/modal_basis.h"

namespace rigfit::signal {

FrfSet synthesised(const ModalModel& model, const Ref<const VectorXd>& frequency_hz, FrfForm form,
                   double decay_rate_1_s) {
  if (model.fitted_form == FrfForm::unknown && form != FrfForm::unknown) {
    throw std::invalid_argument("synthesised: the form of the fitted FRFs is not known");
  }
  const auto modes = static_cast<Index>(model.modes.size());
  const auto responses = static_cast<Index>(model.responses.size());
  const auto inputs = static_cast<Index>(model.inputs.size());
  FrfSet set;
  set.responses = model.responses;
  set.inputs = model.inputs;
  set.form = form;
  set.exponential_decay_rate_1_s = decay_rate_1_s;
  const auto usable = [&](double f) { return decay_rate_1_s != 0 || f != 0; };
  set.frequency_hz.resize(std::ranges::count_if(frequency_hz, usable));
  std::ranges::copy_if(frequency_hz, set.frequency_hz.begin(), usable);
  if (set.frequency_hz.size() < frequency_hz.size()) {
    add_note(set.notes, "data_left_out", "", "the line at 0 Hz is dropped: lower residual / s^2");
  }

  VectorXcd poles(modes);
  MatrixXcd residues(modes, responses * inputs);
  for (Index r = 0; r < modes; ++r) {
    const IdentifiedMode& mode = model.modes[static_cast<std::size_t>(r)];
    poles[r] = mode.pole_rad_s;
    residues.row(r) = (mode.participation * mode.shape.transpose()).reshaped().transpose();
  }
  const VectorXcd lower = model.lower_residual.transpose().reshaped(),
                  upper = model.upper_residual.transpose().reshaped();
  set.H = synthesise(laplace_lines(set.frequency_hz, decay_rate_1_s), power_of_s(form), poles,
                     residues, lower, upper);
  return set;
}

FrfSet synthesised(const ModalResult& fit, const Ref<const VectorXd>& frequency_hz, FrfForm form) {
  const double window = fit.model.exponential_decay_rate_1_s;
  FrfSet set = synthesised(fit.model, frequency_hz, form, window);
  if (fit.background.size() == 0) return set;
  const VectorXd& known = fit.background_hz;
  const int power = power_of_s(form) - power_of_s(fit.model.fitted_form);
  const VectorXcd s = laplace_lines(set.frequency_hz, window);
  for (Index k = 0; k < set.frequency_hz.size(); ++k) {
    const double f = set.frequency_hz[k];
    if (f < known[0] || f > known[known.size() - 1]) continue;
    const Index above =
        std::max<Index>(1, std::lower_bound(known.begin(), known.end(), f) - known.begin());
    const double part = (f - known[above - 1]) / (known[above] - known[above - 1]);
    set.H.row(k) += std::pow(s[k], power) *
                    ((1 - part) * fit.background.row(above - 1) + part * fit.background.row(above));
  }
  return set;
}

}  // namespace rigfit::signal
