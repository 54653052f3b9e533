#include "pd/numeric/expected.hpp"

namespace pd {

std::string_view to_string(ErrorCode code) {
  switch (code) {
    case ErrorCode::bad_value:
      return "bad_value";
    case ErrorCode::non_finite:
      return "non_finite";
    case ErrorCode::out_of_range:
      return "out_of_range";
    case ErrorCode::too_few_points:
      return "too_few_points";
    case ErrorCode::not_full_dimensional:
      return "not_full_dimensional";
    case ErrorCode::not_convex:
      return "not_convex";
    case ErrorCode::bad_faces:
      return "bad_faces";
    case ErrorCode::not_closed:
      return "not_closed";
    case ErrorCode::not_a_rotation:
      return "not_a_rotation";
    case ErrorCode::zero_direction:
      return "zero_direction";
    case ErrorCode::unbounded:
      return "unbounded";
    case ErrorCode::unsupported:
      return "unsupported";
    case ErrorCode::limit_exceeded:
      return "limit_exceeded";
  }
  return "unknown";
}

RefusedValue::RefusedValue(const Error& refusal)
    : std::logic_error(std::string(to_string(refusal.code)) + (refusal.where.empty() ? "" : " at " + refusal.where) +
                       ": " + refusal.message),
      error_(refusal) {}

void RefusedValue::raise(const Error& refusal) { throw RefusedValue(refusal); }

}  // namespace pd
