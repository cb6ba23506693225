#include "apps/verbs/all.h"

namespace rigfit::apps {

void add_all_verbs(CLI::App& program, Verbs& verbs) {
  add_bending(program, verbs);
  add_frf(program, verbs);
}

}  // namespace rigfit::apps
