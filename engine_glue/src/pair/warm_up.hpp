/// @file
/// Buffers made before the first step of a world instead of in it.
#pragma once

#include "pair/thread_buffers.hpp"

namespace pd::detail {

/// Asks one query of each kind that has buffers of its own, of bodies as no world has them: what the first step would
/// have to allocate, most of what the step costs in a small world.
void warm_up(ThreadBuffers& buffers);

}  // namespace pd::detail
