#include "pd/depth/warm_certificate.hpp"

#include "depth/expansion/cached_surface.hpp"

namespace pd {

WarmCertificate::WarmCertificate() noexcept = default;
WarmCertificate::~WarmCertificate() = default;
WarmCertificate::WarmCertificate(WarmCertificate&&) noexcept = default;
WarmCertificate& WarmCertificate::operator=(WarmCertificate&&) noexcept = default;

WarmCertificate::WarmCertificate(const WarmCertificate& other)
    : state_(other.state_ ? std::make_unique<detail::WarmState>(*other.state_) : nullptr) {}
WarmCertificate& WarmCertificate::operator=(const WarmCertificate& other) {
  if (state_ && other.state_) {
    *state_ = *other.state_;  // in the memory at hand
  } else if (this != &other) {
    *this = WarmCertificate(other);
  }
  return *this;
}

void WarmCertificate::clear() {
  if (state_) *state_ = detail::WarmState();
}

std::size_t WarmCertificate::memory_bytes() const {
  if (!state_) return sizeof(*this);
  const detail::WarmState& s = *state_;
  return sizeof(*this) + sizeof(s) + s.vertices.capacity() * sizeof(detail::VertexPair) +
         s.faces.capacity() * sizeof(detail::CachedFace);
}

detail::WarmState& WarmCertificate::state() {
  if (!state_) state_ = std::make_unique<detail::WarmState>();
  return *state_;
}

}  // namespace pd
