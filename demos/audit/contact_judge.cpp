#include "audit/contact_judge.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "audit/body_extent.hpp"
#include "audit/exact_depth.hpp"
#include "audit/surface_distance.hpp"
#include "pd/depth/difference_queries.hpp"

namespace pd::audit {

namespace {

/// How far x lies beyond the interval; 0 within.
double beyond(double x, const SignedDepth& interval) {
  if (x > interval.upper) return x - interval.upper;
  return x < interval.lower ? x - interval.lower : 0;
}

/// h_P(n) over the parts, the poses moved together so that B stands at the origin: nothing cancels far from it.
double difference_support(const RecordedContact& contact, const Vec3& n) {
  if (!contact.a->is_union && !contact.b->is_union && contact.a->convex().polytope() != nullptr &&
      contact.b->convex().polytope() != nullptr) {
    return support_of_difference({&contact.a->convex(), contact.pose_a}, {&contact.b->convex(), contact.pose_b}, n)
        ->value;
  }
  const Vec3 apart = contact.pose_b.translation() - contact.pose_a.translation();
  return turned_support(*contact.b->body, contact.pose_b, n) + apart.dot(n) +
         turned_support(*contact.a->body, contact.pose_a, -n);
}

double normal_excess(const RecordedContact& contact, const Vec3& n, const SignedDepth& x, double scale) {
  if (!contact.a->halfspace && !contact.b->halfspace) return beyond(difference_support(contact, n), x) / scale;
  // A leaves a half-space B along its normal, and is left by a half-space A against it.
  const Vec3 out = plane_contact(contact).normal.normalized();
  const double along = contact.b->halfspace ? n.dot(out) : -n.dot(out);
  if (!(along > 0)) return kNoWayOut;
  const SignedDepth way{x.lower / along, x.upper / along};
  const double excess = std::max(0.0, way.lower - x.upper);  // the least that both intervals allow
  return std::min(excess / scale, kNoWayOut);
}

double point_error(const RecordedContact& contact, double tolerance, double scale, Scratch& scratch) {
  const double delta = std::min(tolerance / 10, 1.0);
  double most = 0;
  for (const Report::Point& point : contact.report->points) {
    if (point.position_a) {
      most = std::max(most, surface_distance(*contact.a, contact.pose_a, *point.position_a, delta, scratch));
    }
    if (point.position_b) {
      most = std::max(most, surface_distance(*contact.b, contact.pose_b, *point.position_b, delta, scratch));
    }
  }
  return most / scale;
}

bool has_positions(const Report& report) {
  return std::any_of(report.points.begin(), report.points.end(),
                     [](const Report::Point& point) { return point.position_a || point.position_b; });
}

}  // namespace

double contact_scale(const RecordedContact& contact) {
  if (contact.a->halfspace || contact.b->halfspace) {
    const bool a_is_plane = contact.a->halfspace.has_value();
    const RecordedShape& solid = a_is_plane ? *contact.b : *contact.a;
    const Pose& pose = a_is_plane ? contact.pose_b : contact.pose_a;
    const PlaneContact plane = plane_contact(contact);
    const Box box = bounding_box(*solid.body, pose);
    // From the body's centre to the plane, along the normal: its reach below the centre, and the gap that is left.
    const Vec3 out = plane.normal.normalized();
    const Vec3 centre = (box.low + box.high) / 2;
    const double reach = turned_support(*solid.body, pose, -out) + centre.dot(out);
    const Vec3 foot = centre + (plane.depth.upper - reach) * out;
    return std::max((box.low - foot).cwiseAbs().maxCoeff(), (box.high - foot).cwiseAbs().maxCoeff());
  }
  const Box a = bounding_box(*contact.a->body, contact.pose_a);
  const Box b = bounding_box(*contact.b->body, contact.pose_b);
  const Vec3 apart = contact.pose_b.translation() - contact.pose_a.translation();
  const Vec3 high = apart + b.high - a.low;
  const Vec3 low = apart + b.low - a.high;
  return std::max(high.cwiseAbs().maxCoeff(), low.cwiseAbs().maxCoeff());
}

Judgement judge(const RecordedContact& contact, double tolerance, Scratch& scratch) {
  Judgement result;
  // Two points that coincide are no length apart: any unit does.
  const double scale = contact_scale(contact);
  result.scale = scale > 0 ? scale : 1;
  const auto x = signed_depth(contact, tolerance, result.scale, scratch);
  if (!x) return result;
  result.lower = x->lower;
  result.upper = x->upper;
  const double slack = tolerance * result.scale;
  result.answered = x->upper - x->lower <= slack;
  if (!result.answered) return result;

  const bool says_contact = contact.report && contact.report->depth > 0;
  result.missed = x->lower > slack && !says_contact;
  result.phantom = x->upper < -slack && says_contact;
  if (!contact.report) return result;
  const double error = beyond(contact.report->depth, *x);
  result.depth_error = error / result.scale;
  result.depth_error_absolute = error;
  const double smaller = std::min(contact.a->extent, contact.b->extent);
  if (smaller > 0) result.depth_error_of_smaller = error / smaller;
  const auto fits_turned = [](double as_it_stands, double turned) {
    return std::abs(as_it_stands) > kFarOff && std::abs(turned) < 0.25 * std::abs(as_it_stands);
  };
  result.depth_turned = fits_turned(*result.depth_error, beyond(-contact.report->depth, *x) / result.scale);
  if (contact.report->normal && x->lower > 0) {
    const Vec3 n = contact.report->normal->stableNormalized();
    result.normal_excess = normal_excess(contact, n, *x, result.scale);
    result.normal_turned = *result.normal_excess > kFarOff &&
                           fits_turned(*result.normal_excess, normal_excess(contact, -n, *x, result.scale));
  }
  if (has_positions(*contact.report)) result.point_error = point_error(contact, tolerance, result.scale, scratch);
  return result;
}

}  // namespace pd::audit
