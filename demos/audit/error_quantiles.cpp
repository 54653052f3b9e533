#include "audit/error_quantiles.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

namespace pd::audit {

namespace {

constexpr int kDroppedBits = 46;  // of the 52 of a significand

std::int64_t bin_of(double value) {
  return static_cast<std::int64_t>(std::bit_cast<std::uint64_t>(value) >> kDroppedBits);
}

}  // namespace

double ErrorQuantiles::middle_of(std::int64_t bin) {
  const std::uint64_t low = static_cast<std::uint64_t>(bin) << kDroppedBits;
  return std::bit_cast<double>(low + (std::uint64_t{1} << (kDroppedBits - 1)));
}

void ErrorQuantiles::add(double value) {
  ++count_;
  max_ = std::max(max_, value);
  if (value == 0) {
    ++zeros_;
    return;
  }
  const std::int64_t bin = bin_of(value);
  if (bins_.empty()) first_bin_ = bin;
  if (bin < first_bin_) {
    bins_.insert(bins_.begin(), static_cast<std::size_t>(first_bin_ - bin), 0);
    first_bin_ = bin;
  }
  const auto index = static_cast<std::size_t>(bin - first_bin_);
  if (index >= bins_.size()) bins_.resize(index + 1, 0);
  ++bins_[index];
}

double ErrorQuantiles::quantile(double share) const {
  const auto rank =
      std::max<std::int64_t>(1, static_cast<std::int64_t>(std::ceil(share * static_cast<double>(count_))));
  std::int64_t below = zeros_;
  if (below >= rank) return 0;
  for (std::size_t i = 0; i < bins_.size(); ++i) {
    below += bins_[i];
    if (below >= rank) return std::min(middle_of(first_bin_ + static_cast<std::int64_t>(i)), max_);
  }
  return max_;
}

}  // namespace pd::audit
