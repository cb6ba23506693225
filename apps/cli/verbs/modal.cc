// rigfit modal: poles, shapes and damping with error bars from FRFs, or from recordings of hits.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <memory>
#include <optional>
#include <utility>

#include "apps/cli/verbs/all.h"
#include "apps/cli/verbs/impact_command.h"
#include "apps/describe/digits.h"
#include "apps/results/modal_json.h"
#include "signal/modes/modal_synthesis.h"
#include "signal/readers/files/mapped_file.h"
#include "signal/readers/read_frfs.h"
#include "signal/readers/read_recording.h"
#include "signal/spectra/coherence_errors.h"
#include "signal/spectra/window.h"
#include "signal/writers/write_uff.h"

namespace rigfit::apps {
namespace {
using Eigen::Index;

/// FRFs to identify, and where they are from.
struct MeasuredFrfs {
  signal::FrfSet frfs;
  double usable_hz = 0;                  ///< 0: to the last line
  bool amplitudes = true;                ///< false: only frequencies and damping mean something
  std::shared_ptr<const ImpactRun> run;  ///< null: FRFs from a file
};

void refuse_options_of_hits(const ModalCommand& options) {
  std::string given;
  for (const auto& name : options.of_hits) given += (given.empty() ? "" : ", ") + name;
  if (given.empty()) return;
  throw UsageError(given +
                   ": for recordings of hits, which need --force C; FRFs from a file are averaged "
                   "already");
}

/// The exponential window that another analyser used, as stated: its decay rate is in every pole.
void take_off_window(const ModalCommand& options, signal::FrfSet& frfs) {
  double rate = options.impact.hammer.impact.exponential_decay_rate_1_s;
  if (options.impact.hammer.impact.exponential_end_level > 0) {
    const Index lines = frfs.frequency_hz.size();
    if (lines < 2) return;
    const double spacing =
        (frfs.frequency_hz[lines - 1] - frfs.frequency_hz[0]) / static_cast<double>(lines - 1);
    rate = signal::decay_rate_for(options.impact.hammer.impact.exponential_end_level, 1 / spacing);
  }
  if (!(rate > 0)) return;
  if (frfs.exponential_decay_rate_1_s > 0) {
    throw UsageError(fmt::format(
        "the file itself states an exponential window of {:g} 1/s: leave the option out",
        frfs.exponential_decay_rate_1_s));
  }
  frfs.exponential_decay_rate_1_s = rate;
}

Json number_json(double value) { return value; }
Json number_json(std::complex<double> value) { return complex_json(value); }

template <typename Matrix>
Json matrix_json(const Matrix& matrix) {
  Json rows = Json::array();
  for (Index i = 0; i < matrix.rows(); ++i) {
    Json row = Json::array();
    for (Index j = 0; j < matrix.cols(); ++j) row.push_back(number_json(matrix(i, j)));
    rows.push_back(std::move(row));
  }
  return rows;
}

Json points_json(const std::vector<signal::MeasuredPoint>& points) {
  Json list = Json::array();
  for (const auto& point : points) {
    list.push_back({{"name", point.name}, {"node", point.node}, {"direction", point.direction}});
  }
  return list;
}

Json stabilisation_json(const signal::LscfResult& diagram) {
  Json poles = Json::array();
  for (const auto& pole : diagram.poles) {
    poles.push_back({{"order", pole.order},
                     {"frequency_hz", pole.frequency_hz},
                     {"damping_ratio", pole.damping_ratio},
                     {"stable_frequency", pole.stable_frequency},
                     {"stable_damping", pole.stable_damping}});
  }
  return {{"highest_order", diagram.orders_solved}, {"poles", std::move(poles)}};
}

/// What the fit has besides modes and residuals, over the FRFs, rms over the lines of the fit;
/// null: nothing.
Json background_json(const signal::ModalResult& found, const signal::FrfSet& frfs) {
  if (found.background.size() == 0) return nullptr;
  double power = 0;
  for (Index k = 0; k < frfs.frequency_hz.size(); ++k) {
    const double f = frfs.frequency_hz[k];
    if (f < found.low_hz || f > found.high_hz || f == 0 || !frfs.H.row(k).allFinite()) continue;
    power += frfs.H.row(k).squaredNorm();
  }
  return {{"part_of_frfs", power > 0 ? found.background.norm() / std::sqrt(power) : 0.0}};
}

/// Sure modes, and how many others there are; `all`: those too.
void print(std::ostream& out, const signal::ModalResult& result, bool all) {
  std::size_t others = 0;
  out << fmt::format("{:>4} {:>12} {:>10} {:>11} {:>10} {:>6} {:>8}\n", "mode", "f, Hz", "+-",
                     "damping, %", "+-", "MPC", "misfit");
  for (std::size_t r = 0; r < result.model.modes.size(); ++r) {
    const auto& mode = result.model.modes[r];
    if (mode.doubtful && !all) {
      ++others;
      continue;
    }
    const std::string damping =
        mode.damping_dominated_by_window
            ? "refused"
            : value_digits(100 * mode.damping_ratio.value, 100 * mode.damping_ratio.std);
    const std::string std =
        mode.damping_dominated_by_window ? "" : std_digits(100 * mode.damping_ratio.std);
    out << fmt::format("{:>4} {:>12} {:>10} {:>11} {:>10} {:>6.3f} {:>7.2f}%  {}\n", r + 1,
                       value_digits(mode.frequency_hz.value, mode.frequency_hz.std),
                       std_digits(mode.frequency_hz.std), damping, std,
                       mode.modal_phase_collinearity, 100 * mode.reconstruction_error,
                       mode.doubtful ? "uncertain: " + mode.doubt : "");
  }
  if (others > 0) out << fmt::format("and {} uncertain: --all lists them\n", others);
  for (const auto& mode : result.model.modes) {
    if (mode.doubtful && !all) continue;
    if (mode.refinement == "global" || mode.points.size() < 2) continue;
    out << fmt::format(
        "{} Hz is the mean of {} points; scatter between them {} Hz{}\n",
        value_digits(mode.frequency_hz.value, mode.frequency_hz.std), mode.points.size(),
        std_digits(mode.between_points_std_hz),
        mode.has_trend ? fmt::format(", {:+.2g} Hz from point to point", mode.trend_hz.value) : "");
  }
  out << fmt::format("{:.4g} to {:.4g} Hz, {} lines, model orders to {}", result.low_hz,
                     result.high_hz, result.lines_used, result.stabilisation.orders_solved);
  if (result.misfit_over_error_bars) {
    out << fmt::format("; misfit {:.2f} of the FRFs' error bars", *result.misfit_over_error_bars);
  }
  out << '\n';
}

ident::IdentifiedModes identify(const MeasuredFrfs& measured, const ModalCommand& options) {
  signal::ModalOptions modal;
  std::optional<std::pair<double, double>> band;
  if (!options.impact.band.empty()) band = {options.impact.band[0], options.impact.band[1]};
  modal.lscf.max_order = options.order;
  modal.lscf.max_damping_ratio = options.max_damping;
  auto found = ident::identify(measured.frfs, band, measured.usable_hz, modal);
  if (!found.modal) throw Refused(found.findings.front().message, found.findings.front().code);
  return found;
}

/// FRFs of another analyser: takes off its window, and makes error bars from the coherence where
/// the file has none.
MeasuredFrfs completed(signal::FrfSet frfs, const ModalCommand& options, VerbContext& context) {
  MeasuredFrfs measured;
  measured.frfs = std::move(frfs);
  take_off_window(options, measured.frfs);
  std::optional<std::pair<double, double>> band;
  if (!options.impact.band.empty()) band = {options.impact.band[0], options.impact.band[1]};
  signal::error_bars_from_coherence(measured.frfs, options.averages, band);
  for (const signal::Note& note : measured.frfs.notes) {
    context.warn(note.code, note.message, note.where);
  }
  return measured;
}

/// FRFs at hand, of one UFF file or of text tables; or those of hits.
MeasuredFrfs frfs_of(ModalCommand& options, VerbContext& context) {
  if (!options.impact.hammer.force.empty()) {
    if (options.averages > 0) throw UsageError("--averages is for FRFs from a file");
    options.impact.files = options.files;
    const auto run = run_impact_test(context, options.impact);
    return {run->test.frfs, run->test.usable_hz, run->test.amplitudes, run};
  }
  refuse_options_of_hits(options);
  if (context.at_hand && context.at_hand->frfs) {
    return completed(*context.at_hand->frfs, options, context);
  }
  for (const auto& file : options.files) {
    context.input(file);
    if (options.files.size() == 1) break;
    const signal::MappedFile mapped(file);
    if (signal::format_of(mapped.bytes()) == signal::RecordingFormat::uff) {
      throw UsageError(
          "FRFs come from one UFF file, or from text tables; recordings of hits need --force C");
    }
  }
  return completed(signal::read_frfs({options.files.begin(), options.files.end()}, context.reading),
                   options, context);
}

Json run(ModalCommand options, VerbContext& context) {
  if (options.ambient) return ambient_result(options, context);
  const MeasuredFrfs measured = frfs_of(options, context);
  if (context.at_hand) context.at_hand->frfs = std::make_shared<signal::FrfSet>(measured.frfs);
  Json result{{"modes", Json::array()}};
  if (measured.run) {
    result["hits"] = hits_json(*measured.run);
    result["force_window"] = force_window_json(measured.run->test);
  }
  if (measured.frfs.frequency_hz.size() == 0) return result;  // refused, and said why

  const ident::IdentifiedModes identified = identify(measured, options);
  const signal::ModalResult& found = *identified.modal;
  const signal::ModalModel& model = found.model;
  context.tell(identified.findings);
  if (!identified.converged()) context.exit_code = ExitCode::not_converged;
  for (const auto& mode : model.modes) result["modes"].push_back(mode_json(mode));
  print(context.out, found, options.all);
  if (context.plots) {
    const auto& run = measured.run;
    draw_hammer_test(*context.plots, {run ? &run->places : nullptr, run ? &run->test : nullptr,
                                      measured.frfs, found.low_hz, found.high_hz, &found});
  }

  result["responses"] = points_json(model.responses);
  result["input_points"] = points_json(model.inputs);
  result["amplitudes"] = measured.amplitudes;
  result["frf_form"] = name_of(model.fitted_form);
  result["band_hz"] = {found.low_hz, found.high_hz};
  result["lines"] = found.lines_used;
  result["exponential_decay_rate_1_s"] = model.exponential_decay_rate_1_s;
  result["misfit_over_error_bars"] =
      found.misfit_over_error_bars ? Json(*found.misfit_over_error_bars) : Json(nullptr);
  result["fit"] = {{"end", name_of(found.end)}, {"iterations", found.iterations}};
  result["frf_error"] = matrix_json(model.frf_error);
  result["auto_mac"] = matrix_json(found.auto_mac);
  result["pole_covariance"] = matrix_json(model.pole_covariance);
  result["lower_residual"] = matrix_json(model.lower_residual);
  result["upper_residual"] = matrix_json(model.upper_residual);
  result["background"] = background_json(found, measured.frfs);
  result["stabilisation"] = stabilisation_json(found.stabilisation);

  if (!options.out.empty()) {
    context.write(options.out, signal::uff_text(model));
    result["out"] = options.out;
    context.out << "modes (UFF 55): " << options.out << '\n';
  }
  if (!options.synthesis.empty()) {
    const signal::FrfSet again = synthesised(found, measured.frfs.frequency_hz, model.fitted_form);
    context.write(options.synthesis, signal::uff_text(again, signal::UffEncoding::binary));
    result["synthesis"] = options.synthesis;
    context.out << "FRFs rebuilt from the modes (UFF 58): " << options.synthesis << '\n';
  }
  return result;
}

}  // namespace

describe::Options options_of(ModalCommand& c) {
  using describe::option;
  describe::Options options{
      option("FILE", c.files,
             "FRFs: a UFF file, a .mat file, or text tables of frequency, real and imaginary part "
             "(or magnitude and phase); or, with --force, recordings of hits; or, with --ambient, "
             "recordings of motion under unknown forces, a set-up each")
          .required(),
      option("--order", c.order, "Highest model order of the stabilisation diagram").within(2, 400),
      option("--max-damping", c.max_damping, "Largest damping ratio that is taken for a mode")
          .within(1e-6, 0.99),
      option("--out", c.out, "Modes as UFF 55").writes().type("F.uff"),
      option(
          "--synthesis", c.synthesis,
          "FRFs rebuilt from the modes and what else was fitted, at the measured lines, as UFF 58")
          .writes()
          .type("F.uff"),
      option("--ambient", c.ambient,
             "Recordings of motion under wind, traffic or other unknown forces"),
      option("--reference", c.references,
             "Channels that stay in place in all set-ups [those that all files have]")
          .type("C")
          .needs("--ambient"),
      option("--all", c.all, "List uncertain modes as well"),
      option("--averages", c.averages,
             "Averages behind the coherence of FRFs from a file [as the file says]")
          .within(1, 1000000)};
  for (auto& one : options_of(c.impact)) {
    if (one.name == "--exponential-window") {
      one.meaning =
          "Decay rate of a window on force and responses: used on hits, or stated of FRFs from a "
          "file that were measured with one; it is taken off the poles";
      one.unit = "1/s";
    } else if (one.name == "--band") {
      one.meaning = "Band to look for modes in (and for the force spectrum of hits)";
    } else if (one.name != "--force" && one.name != "--exponential-end-level") {
      one.told = &c.of_hits;
    }
    options.push_back(std::move(one));
  }
  return options;
}

Verb modal_verb() {
  Verb verb = verb_of<ModalCommand>(
      "modal", "Natural frequencies, damping and shapes with error bars from FRFs or hits",
      "Examples:\n"
      "  rigfit modal frf.uff --band 5 1400 --out modes.uff --json -\n"
      "  rigfit modal other.uff --exponential-window 1.5 --averages 5\n"
      "  rigfit modal point1.txt point2.txt point3.txt --averages 5\n"
      "  rigfit modal hits.csv --force hammer --exponential-window 1\n"
      "  rigfit modal setup1.csv setup2.csv --ambient --reference top --band 0.3 8\n"
      "Exit code 4: no mode stands out, or a window's damping dominates that of a mode (the\n"
      "frequency is given all the same).",
      [](const ModalCommand& c, VerbContext& context) { return run(c, context); });
  verb.draws = true;
  verb.reads = true;
  return verb;
}

}  // namespace rigfit::apps
