#include "apps/verbs/all.h"

namespace rigfit::apps {

void add_all_verbs(CLI::App& program, Verbs& verbs) {
  (void)program;
  (void)verbs;
}

}  // namespace rigfit::apps
