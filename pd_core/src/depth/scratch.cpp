#include "pd/depth/scratch.hpp"

#include "depth/pair/scratch_buffers.hpp"

namespace pd {

Scratch::Scratch() : buffers_(std::make_unique<detail::ScratchBuffers>()) {}
Scratch::~Scratch() = default;
Scratch::Scratch(Scratch&&) noexcept = default;
Scratch& Scratch::operator=(Scratch&&) noexcept = default;

}  // namespace pd
