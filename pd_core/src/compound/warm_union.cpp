#include "pd/compound/warm_union.hpp"

#include "compound/union_memory.hpp"

namespace pd {

WarmUnion::WarmUnion() noexcept = default;
WarmUnion::~WarmUnion() = default;
WarmUnion::WarmUnion(WarmUnion&&) noexcept = default;
WarmUnion& WarmUnion::operator=(WarmUnion&&) noexcept = default;

WarmUnion::WarmUnion(const WarmUnion& other)
    : state_(other.state_ ? std::make_unique<detail::WarmUnionState>(*other.state_) : nullptr) {}
WarmUnion& WarmUnion::operator=(const WarmUnion& other) {
  if (this != &other) *this = WarmUnion(other);
  return *this;
}

void WarmUnion::clear() {
  if (state_) *state_ = detail::WarmUnionState();
}

std::size_t WarmUnion::memory_bytes() const {
  if (!state_) return sizeof(*this);
  return sizeof(*this) + sizeof(*state_) +
         (state_->tree.nodes.capacity() + state_->next.nodes.capacity()) * sizeof(detail::CoverNode);
}

detail::WarmUnionState& WarmUnion::state() {
  if (!state_) state_ = std::make_unique<detail::WarmUnionState>();
  return *state_;
}

}  // namespace pd
