// rigfit modal: poles, shapes and damping with error bars from FRFs, from recordings of hits, or
// from ambient motion.

#include "apps/cli/verbs/all.h"
#include "signal/ambient/ambient_modes.h"
#include "signal/modal/modal_identification.h"
#include "signal/readers/read_recording.h"
#include "signal/writers/writers.h"

namespace rigfit::apps {
namespace {

/// The options of `modal`, which begins with a hammer test where it is given recordings of hits.
struct ModalCommand {
  std::vector<std::string> files;
  ImpactCommand impact;
  int order = signal::LscfOptions().max_order;
  int averages = 0;  ///< behind the coherence of FRFs from a file; 0: as the file says
  std::string out, synthesis;
  bool all = false;                     ///< print uncertain modes as well
  bool ambient = false;                 ///< motion under unknown forces: no FRFs, no hits
  std::vector<std::string> references;  ///< stay in place in all set-ups of ambient motion

  [[nodiscard]] const describe::Band& band() const { return impact.hammer.impact.hits.band_hz; }
};

bool doubtful(const signal::IdentifiedMode& mode) { return mode.doubtful; }
bool doubtful(const signal::AmbientMode& one) { return one.mode.doubtful; }

/// The modes as a table: the sure ones, and how many others there are; `all`: those too.
template <class Mode>
void print_modes(VerbContext& context, std::vector<Mode> modes, bool all) {
  const auto others = std::erase_if(modes, [&](const Mode& one) { return !all && doubtful(one); });
  describe::print(context.out, describe::table_of(modes));
  if (others > 0) context.out << fmt::format("and {} uncertain: --all lists them\n", others);
}

// Modes from motion under unknown forces, one or several set-ups.

signal::AmbientResult analysed(const ModalCommand& command, VerbContext& context) {
  signal::AmbientOptions options{.channels = command.impact.hammer.responses,
                                 .references = command.references,
                                 .threads = context.threads};
  if (const auto& band = command.band()) std::tie(options.low_hz, options.high_hz) = *band;
  // The usual order of FRFs is not that of half spectra.
  if (command.order != ModalCommand().order) options.max_order = command.order;
  std::vector<signal::AmbientResult> setups;
  for (const auto& file : command.files) {
    // One recording is held at a time: a day of many channels fills the memory.
    setups.push_back(signal::ambient_modes(load_recording(file, context), options));
    if (command.files.size() == 1) continue;
    for (auto& note : setups.back().notes) note.where.insert(0, file + ": ");
  }
  return signal::merge_setups(setups, command.references);
}

Json ambient_result(const ModalCommand& command, VerbContext& context) {
  const signal::AmbientResult found = analysed(command, context);
  context.tell(found.notes);
  Json result = describe::json_of(found);
  result["input_points"] = Json::array();
  result["ambient"] = true;
  result["amplitudes"] = false;  // shapes have no scale
  print_modes(context, found.modes, command.all);
  if (!found.tones.empty()) describe::print(context.out, describe::table_of(found.tones));
  context.out << fmt::format("{:.4g} to {:.4g} Hz, {:.0f} s, correlations to {:.3g} s\n",
                             found.low_hz, found.high_hz, found.duration_s, found.lag_s);
  if (context.plots) context.plots->add(ambient_plots("ambient", found, Origin::measured));
  const auto modes = [&] { return signal::uff_text(found.sure_modes()); };  // no place for doubts
  write_result(command.out, modes, "modes (UFF 55)", "out", result, context);
  return result;
}

/// FRFs at hand, of one UFF file or of text tables; or those of hits, with the places struck.
ImpactRun frfs_of(ModalCommand& options, VerbContext& context) {
  if (!options.impact.hammer.force.empty()) {
    options.impact.files = options.files;
    return run_impact_test(context, options.impact);
  }
  if (!options.impact.hammer.responses.empty()) {
    throw UsageError("--response is for recordings: give --force or --ambient");
  }
  // FRFs of another analyser, whose error bars may have to come from the coherence.
  ImpactRun given;
  auto& frfs = given.test.frfs;
  if (context.at_hand && context.at_hand->frfs) {
    frfs = *context.at_hand->frfs;
  } else {
    for (const auto& file : options.files) context.input(file);
    frfs = signal::read_frfs({options.files.begin(), options.files.end()}, context.reading);
  }
  // The exponential window that another analyser used, as stated: its decay rate is in every pole.
  if (const double rate = options.impact.hammer.impact.exponential_decay_rate_1_s; rate > 0) {
    if (frfs.exponential_decay_rate_1_s > 0) {
      throw UsageError(fmt::format(
          "the file itself states an exponential window of {:g} 1/s: leave the option out",
          frfs.exponential_decay_rate_1_s));
    }
    frfs.exponential_decay_rate_1_s = rate;
  }
  signal::error_bars_from_coherence(frfs, options.averages, options.band());
  context.tell(frfs.notes);
  return given;
}

Json run(ModalCommand& options, VerbContext& context) {
  if (options.ambient) return ambient_result(options, context);
  const auto [places, test] = frfs_of(options, context);
  const signal::FrfSet& frfs = test.frfs;
  if (context.at_hand) context.at_hand->frfs = std::make_shared<signal::FrfSet>(frfs);
  Json result{{"modes", Json::array()}};
  if (!places.empty()) result["hits"] = hits_json(places, test);
  if (frfs.frequency_hz.size() == 0) return result;  // refused, and said why

  signal::ModalOptions modal;
  modal.lscf.max_order = options.order;
  std::vector<Finding> findings;
  const auto identified = ident::identify(frfs, options.band(), test.usable_hz, modal, findings);
  if (!identified) throw Refused(findings.front().message, findings.front().code);
  const signal::ModalResult& found = *identified;
  const signal::ModalModel& model = found.model;
  context.tell(findings);
  result.update(describe::json_of(found));
  print_modes(context, model.modes, options.all);
  context.out << fmt::format("{:.4g} to {:.4g} Hz, {} lines, model orders to {}", found.low_hz,
                             found.high_hz, found.lines_used, found.stabilisation.orders_solved);
  if (found.misfit_over_error_bars) {
    context.out << fmt::format("; misfit {:.2f} of the FRFs' error bars",
                               *found.misfit_over_error_bars);
  }
  context.out << '\n';
  if (context.plots) {
    context.plots->add(hammer_plots({.places = places, .test = test, .modal = &found}));
  }

  result["amplitudes"] = test.amplitudes;
  result["fit"] = {{"end", name_of(found.end)}, {"iterations", found.iterations}};

  const auto modes = [&] { return signal::uff_text(model); };
  write_result(options.out, modes, "modes (UFF 55)", "out", result, context);
  const auto again = [&] {
    return signal::uff_text(synthesised(found, frfs.frequency_hz, model.fitted_form));
  };
  write_result(options.synthesis, again, "FRFs rebuilt from the modes (UFF 58)", "synthesis",
               result, context);
  return result;
}

describe::Options options_of(ModalCommand& c) {
  describe::Options options{
      option("FILE", c.files,
             "FRFs: a UFF file, a .mat file, or text tables of frequency, real and imaginary part "
             "(or magnitude and phase); or, with --force, recordings of hits; or, with --ambient, "
             "recordings of motion under unknown forces, a set-up each")
          .once()
          .required(),
      option("--order", c.order, "Highest model order of the stabilisation diagram").within(2, 400),
      option("--out", c.out, "Modes as UFF 55").writes(),
      option(
          "--synthesis", c.synthesis,
          "FRFs rebuilt from the modes and what else was fitted, at the measured lines, as UFF 58")
          .writes()
          .excludes("--ambient"),
      option("--ambient", c.ambient,
             "Recordings of motion under wind, traffic or other unknown forces"),
      option("--reference", c.references,
             "Channels that stay in place in all set-ups [those that all files have]")
          .needs("--ambient"),
      option("--all", c.all, "List uncertain modes as well"),
      option("--averages", c.averages,
             "Averages behind the coherence of FRFs from a file [as the file says]")
          .within(1, 1000000)
          .excludes("--force")};
  for (auto& one : options_of(c.impact)) {
    if (one.name == "--exponential-window") {
      one.meaning =
          "Decay rate of a window on force and responses: used on hits, or stated of FRFs from a "
          "file that were measured with one; it is taken off the poles";
      one.unit = "1/s";
    } else if (one.name == "--band") {
      one.meaning = "Band to look for modes in (and for the force spectrum of hits)";
    } else if (one.name == "--force") {
      one.not_with.emplace_back("--ambient");
    } else if (one.name != "--response") {
      one.only_with.emplace_back("--force");
    }
    options.push_back(std::move(one));
  }
  return options;
}

}  // namespace

Verb modal_verb() {
  return verb_of<ModalCommand>(
      "modal", "Natural frequencies, damping and shapes with error bars from FRFs or hits",
      "Examples:\n"
      "  rigfit modal frf.uff --band 5 1400 --out modes.uff --json -\n"
      "  rigfit modal other.uff --exponential-window 1.5 --averages 5\n"
      "  rigfit modal point1.txt point2.txt point3.txt --averages 5\n"
      "  rigfit modal hits.csv --force hammer --exponential-window 1\n"
      "  rigfit modal setup1.csv setup2.csv --ambient --reference top --band 0.3 8\n"
      "Exit code 4: no mode stands out, or a window's damping dominates that of a mode (the\n"
      "frequency is given all the same).",
      run, true, true, []() -> Json {
        return {{"anyOf",
                 {describe::schema_of<signal::ModalResult>(),
                  describe::schema_of<signal::AmbientResult>()}}};
      });
}

}  // namespace rigfit::apps
