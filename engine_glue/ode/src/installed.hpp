/// @file
/// The function in ODE's table: one for pdepth's answers and for recorders, which stands there while either wants it.
#pragma once

#include <ode/ode.h>

#include <array>
#include <atomic>
#include <mutex>

#include "own_colliders.hpp"
#include "pd/ode/install.hpp"

namespace pd::detail {

class OdeRecord;

/// The only state of the process.
class InstalledOde {
 public:
  static InstalledOde& instance() {
    static InstalledOde installed;
    return installed;
  }

  /// Sets the options and answers from now on. @return the number of pairs of classes
  int begin_answers(const OdeOptions& options);
  void end_answers();
  /// @return false if another record is being written
  bool begin_record(OdeRecord* record);
  void end_record(const OdeRecord* record);

  [[nodiscard]] bool answers() const { return answers_; }
  [[nodiscard]] const OdeOptions& options() const { return options_; }
  [[nodiscard]] OdeRecord* record() const { return record_.load(std::memory_order_acquire); }

 private:
  void put_or_put_back();

  std::mutex mutex_;  ///< of those that begin and end
  bool put_ = false;
  bool answers_ = false;
  OdeOptions options_;
  std::atomic<OdeRecord*> record_{nullptr};
  std::array<bool, kOwnColliders> ours_{};  ///< entries that hold pdepth's function
};

}  // namespace pd::detail
