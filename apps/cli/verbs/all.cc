#include "apps/cli/verbs/all.h"

namespace rigfit::apps {

void add_all_verbs(CLI::App& program, Verbs& verbs) {
  // In the order in which a person goes from recordings to a report.
  add_inspect(program, verbs);
  add_resample(program, verbs);
  add_bending(program, verbs);
  add_axial(program, verbs);
  add_decay(program, verbs);
  add_frf(program, verbs);
  add_modal(program, verbs);
  add_modes(program, verbs);
  add_respond(program, verbs);
  add_update(program, verbs);
  add_tension(program, verbs);
  add_predict(program, verbs);
  add_synthesize(program, verbs);
  add_export(program, verbs);
  add_bench(program, verbs);
  add_new(program, verbs);
  add_report(program, verbs);
}

}  // namespace rigfit::apps
