#include "pd/depth/depth_answer.hpp"

namespace pd {

std::string_view to_string(ContactClass contact) {
  switch (contact) {
    case ContactClass::separated:
      return "separated";
    case ContactClass::touching:
      return "touching";
    case ContactClass::overlapping:
      return "overlapping";
  }
  return "";
}

std::string_view to_string(Method method) {
  switch (method) {
    case Method::automatic:
      return "auto";
    case Method::expansion:
      return "expansion";
    case Method::overlay:
      return "overlay";
    case Method::decomposition:
      return "decomposition";
    case Method::shallow:
      return "shallow";
    case Method::grid:
      return "grid";
  }
  return "";
}

}  // namespace pd
