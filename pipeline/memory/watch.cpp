#include "pipeline/memory/watch.h"

namespace umtet {

Context polls_of(const Watch& watch) {
  return {.cancelled = [&watch] {
    watch(nullptr, 0);
    return false;
  }};
}

Context context_of(const Watch& watch) {
  Context context = polls_of(watch);
  context.progress = [&watch](const char* step, double fraction) { watch(step, fraction); };
  return context;
}

}  // namespace umtet
