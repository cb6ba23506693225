// The verbs there are. Each `add_*` registers one: its options, its help with an example, its run.
#pragma once

#include "apps/cli/verb.h"

namespace rigfit::apps {

void add_axial(CLI::App& program, Verbs& verbs);
void add_bench(CLI::App& program, Verbs& verbs);
void add_bending(CLI::App& program, Verbs& verbs);
void add_decay(CLI::App& program, Verbs& verbs);
void add_export(CLI::App& program, Verbs& verbs);
void add_frf(CLI::App& program, Verbs& verbs);
void add_inspect(CLI::App& program, Verbs& verbs);
void add_modal(CLI::App& program, Verbs& verbs);
void add_modes(CLI::App& program, Verbs& verbs);
void add_new(CLI::App& program, Verbs& verbs);
void add_report(CLI::App& program, Verbs& verbs);
void add_resample(CLI::App& program, Verbs& verbs);
void add_respond(CLI::App& program, Verbs& verbs);
void add_synthesize(CLI::App& program, Verbs& verbs);
void add_tension(CLI::App& program, Verbs& verbs);
void add_predict(CLI::App& program, Verbs& verbs);
void add_update(CLI::App& program, Verbs& verbs);

}  // namespace rigfit::apps
