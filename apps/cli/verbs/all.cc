#include "apps/cli/verbs/all.h"

namespace rigfit::apps {

Verbs all_verbs() {
  Verbs verbs;
  for (const auto verb :
       {inspect_verb, resample_verb, bending_verb, axial_verb, decay_verb, frf_verb, modal_verb,
        modes_verb, respond_verb, update_verb, tension_verb, predict_verb, plan_verb,
        synthesize_verb, export_verb, bench_verb, new_verb, report_verb}) {
    verbs.push_back(verb());
  }
  return verbs;
}

}  // namespace rigfit::apps
