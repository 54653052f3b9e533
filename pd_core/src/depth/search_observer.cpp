#include "pd/depth/search_observer.hpp"

#include "depth/pair/scratch_buffers.hpp"
#include "pd/depth/scratch.hpp"

namespace pd {

void observe_searches(Scratch& scratch, SearchObserver* observer) {
  scratch.buffers().surface.watch.observer = observer;
}

}  // namespace pd
