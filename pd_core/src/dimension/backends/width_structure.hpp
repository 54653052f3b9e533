/// @file
/// The structure behind a `DirectionalWidth` has a dimension that is known at run time.
#pragma once

#include <memory>

#include "dimension/any_dimension.hpp"
#include "pd/dimension/directional_width.hpp"

namespace pd::dimension::detail {

/// A backend of directional width queries.
class WidthStructure {
 public:
  WidthStructure() = default;
  WidthStructure(const WidthStructure&) = delete;
  WidthStructure& operator=(const WidthStructure&) = delete;
  virtual ~WidthStructure() = default;
  [[nodiscard]] virtual AnySupport support(const AnyVector& direction, QueryCounters& counters) const = 0;
  [[nodiscard]] virtual StructureSize size() const = 0;
};

/// A preprocessed body.
struct PreparedBody {
  std::shared_ptr<const WidthStructure> structure;
  AnySandwich sandwich;
  double epsilon = 0;
  Backend backend = Backend::kernel;

  /// `DirectionalWidth<D>::build`. The exact structure of halfspaces keeps `body`.
  static Expected<PreparedBody> build(const AnyBody& body, double epsilon, Backend backend);
};

}  // namespace pd::dimension::detail
