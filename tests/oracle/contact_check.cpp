#include "oracle/contact_check.hpp"

#include <algorithm>
#include <cmath>

#include "oracle/answer_check.hpp"
#include "oracle/judging.hpp"
#include "pd/shape/convex_polytope.hpp"

namespace pd::oracle {

SignedInterval signed_distance(const PenetrationDepth& answer) {
  switch (answer.contact) {
    case ContactClass::separated:
      return {answer.distance_lower, answer.distance_upper};
    case ContactClass::overlapping:
      return {-answer.upper, -answer.lower};
    case ContactClass::touching:
      return {-answer.upper, answer.distance_upper};
  }
  return {0, 0};
}

double size_of_numbers(const PosedShape& a, const PosedShape& b) {
  return size_of_numbers(*a.shape->polytope(), a.pose, *b.shape->polytope(), b.pose) + a.shape->margin() +
         b.shape->margin();
}

std::string check_contact(const PosedShape& a, const PosedShape& b, const PenetrationDepth& answer,
                          const PenetrationDepth& exact, double allowed_width, Scratch& scratch) {
  if (answer.statistics.exact_signs != 0) return text("%g exact signs, %g", double(answer.statistics.exact_signs), 0);
  const SignedInterval own = signed_distance(answer), truth = signed_distance(exact);
  if (!std::isfinite(own.lower) || !std::isfinite(own.upper)) return "interval not finite";
  if (!(own.lower <= truth.upper && own.upper >= truth.lower)) {
    return text("interval [%.17g, %.17g] does not hold %.17g", own.lower, own.upper, truth.lower);
  }
  const double width = own.upper - own.lower;
  if (answer.bracket_reached && !(width <= allowed_width)) return text("width %g of %g", width, allowed_width);
  const bool sign = answer.contact == ContactClass::separated     ? own.lower >= 0
                    : answer.contact == ContactClass::overlapping ? own.upper <= 0
                                                                  : own.lower <= 0 && own.upper >= 0;
  if (!sign || (answer.contact == ContactClass::touching && (answer.depth != 0 || answer.distance != 0))) {
    return text("class does not fit [%g, %g]", own.lower, own.upper);
  }
  if (std::abs(answer.normal.norm() - 1) > 1e-15) return "normal";
  const double world = std::max(answer.witness_a.norm(), answer.witness_b.norm());
  const Vec3 gap =
      answer.contact == ContactClass::overlapping ? answer.translation : Vec3(-answer.distance * answer.normal);
  const double error = (answer.witness_b - answer.witness_a - gap).cwiseAbs().maxCoeff();
  if (error > 2 * std::max(width, allowed_width) + 8 * 0x1p-52 * world) {
    return text("witnesses differ by %g, width %g", error, width);
  }
  if (answer.contact == ContactClass::separated) return {};
  const Vec3 out = a.pose.translation() + answer.upper * answer.normal;
  const PosedShape moved{a.shape, a.pose.is_quaternion() ? *Pose::from_quaternion(a.pose.quaternion_wxyz(), out)
                                                         : Pose::from_trusted_matrix(a.pose.rotation(), out)};
  const double left = signed_distance(penetration_depth(moved, b, scratch)).lower;
  if (-left > allowed_width + 4 * 0x1p-52 * out.norm()) return text("leaves %g of %g", -left, answer.upper);
  return {};
}

}  // namespace pd::oracle
