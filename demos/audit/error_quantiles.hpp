/// @file
/// Quantiles of many numbers in bounded memory: counts in bins that are fixed, so that they are the same whatever the
/// order, and the exact maximum.
#pragma once

#include <cstdint>
#include <vector>

namespace pd::audit {

/// Numbers >= 0 counted in bins of 1/64 of a power of two, which are at most 1.6 % wide: a bin's middle is within
/// 0.8 % of what it holds. Zeros are counted apart. At most 1 MB.
class ErrorQuantiles {
 public:
  /// Requires a finite value >= 0.
  void add(double value);

  [[nodiscard]] std::int64_t count() const { return count_; }
  [[nodiscard]] std::int64_t zeros() const { return zeros_; }
  /// Calls `visit(middle, count)` for every bin that holds something, the least first; zeros are in none.
  template <class Visit>
  void each_bin(Visit&& visit) const {
    for (std::size_t i = 0; i < bins_.size(); ++i) {
      if (bins_[i] > 0) visit(middle_of(first_bin_ + static_cast<std::int64_t>(i)), bins_[i]);
    }
  }
  /// Exact; 0 of nothing.
  [[nodiscard]] double max() const { return max_; }
  /// The value of rank ceil(share * count), to 1 %. @param share  in (0, 1]. Requires count() > 0.
  [[nodiscard]] double quantile(double share) const;

 private:
  static double middle_of(std::int64_t bin);

  std::vector<std::int64_t> bins_;  ///< of the bit patterns from first_bin_ on, cut to exponent and six bits
  std::int64_t first_bin_ = 0;
  std::int64_t zeros_ = 0;
  std::int64_t count_ = 0;
  double max_ = 0;
};

}  // namespace pd::audit
