#include "pd/shape/compound.hpp"

#include <array>
#include <cmath>
#include <optional>
#include <string>

#include "numeric/double_double.hpp"
#include "numeric/dyadic.hpp"
#include "numeric/number_text.hpp"
#include "numeric/quotient.hpp"
#include "numeric/root_sum.hpp"

namespace pd {

namespace {

using detail::DoubleDouble;
using detail::Dyadic;

using Quaternion = std::array<double, 4>;

bool turns_nothing(const Pose& pose) {
  if (!pose.is_quaternion()) return pose.rotation() == Mat3::Identity();
  const Quaternion& q = pose.quaternion_wxyz();
  return q[1] == 0 && q[2] == 0 && q[3] == 0;
}

/// The nine numerators of R and their common denominator.
std::array<Dyadic, 9> exact_rotation(const Pose& pose, Dyadic& denominator) {
  std::array<Dyadic, 9> r;
  denominator = Dyadic(1.0);
  if (!pose.is_quaternion()) {
    for (int i = 0; i < 9; ++i) r[static_cast<std::size_t>(i)] = pose.rotation()(i / 3, i % 3);
    return r;
  }
  const Quaternion& q = pose.quaternion_wxyz();
  const Dyadic w(q[0]), x(q[1]), y(q[2]), z(q[3]), two(2.0);
  denominator = w * w + x * x + y * y + z * z;
  r = {w * w + x * x - y * y - z * z, two * (x * y - w * z),         two * (x * z + w * y),
       two * (x * y + w * z),         w * w - x * x + y * y - z * z, two * (y * z - w * x),
       two * (x * z - w * y),         two * (y * z + w * x),         w * w - x * x - y * y + z * z};
  return r;
}

/// R t_inner + t_outer.
Vec3 composed_translation(const Pose& outer, const Pose& inner) {
  Dyadic denominator;
  const std::array<Dyadic, 9> r = exact_rotation(outer, denominator);
  Vec3 t;
  for (int i = 0; i < 3; ++i) {
    Dyadic sum = Dyadic(outer.translation()[i]) * denominator;
    for (int j = 0; j < 3; ++j) {
      sum = sum + r[static_cast<std::size_t>(3 * i + j)] * Dyadic(inner.translation()[j]);
    }
    t[i] = detail::quotient(sum, denominator);
  }
  return t;
}

Mat3 composed_rotation(const Pose& outer, const Pose& inner) {
  Dyadic outer_denominator, inner_denominator;
  const std::array<Dyadic, 9> p = exact_rotation(outer, outer_denominator);
  const std::array<Dyadic, 9> q = exact_rotation(inner, inner_denominator);
  const Dyadic denominator = outer_denominator * inner_denominator;
  Mat3 product;
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) {
      const Dyadic sum = p[3 * i] * q[j] + p[3 * i + 1] * q[3 + j] + p[3 * i + 2] * q[6 + j];
      product(static_cast<int>(i), static_cast<int>(j)) = detail::quotient(sum, denominator);
    }
  }
  return product;
}

Pose with_translation(const Pose& rotation, const Vec3& translation) {
  if (!rotation.is_quaternion()) return Pose::from_trusted_matrix(rotation.rotation(), translation);
  return *Pose::from_quaternion(rotation.quaternion_wxyz(), translation);
}

/// The polytope moved by t, when every moved coordinate is a double.
std::optional<ConvexPolytope> moved_exactly(const ConvexPolytope& body, const Vec3& t) {
  std::vector<Vec3> points;
  points.reserve(static_cast<std::size_t>(body.num_vertices()));
  for (int v = 0; v < body.num_vertices(); ++v) {
    Vec3 x;
    for (int i = 0; i < 3; ++i) {
      const DoubleDouble sum = detail::two_sum(body.vertex(v)[i], t[i]);
      if (sum.lo != 0 || !(std::abs(sum.hi) <= kMaxCoordinate)) return std::nullopt;
      x[i] = sum.hi;
    }
    points.push_back(x);
  }
  auto moved = ConvexPolytope::from_points(points);
  if (!moved) return std::nullopt;
  return *std::move(moved);
}

}  // namespace

Expected<Pose> composed(const Pose& outer, const Pose& inner) {
  const Vec3 translation = composed_translation(outer, inner);
  if (!(translation.cwiseAbs().maxCoeff() <= kMaxCoordinate)) {
    return Error{ErrorCode::out_of_range,
                 "the translations of the poses add up to more than " + detail::number_text(kMaxCoordinate), "pose"};
  }
  if (turns_nothing(inner)) return with_translation(outer, translation);
  if (turns_nothing(outer)) return with_translation(inner, translation);
  return Pose::from_trusted_matrix(composed_rotation(outer, inner), translation);
}

Expected<Compound> Compound::from_parts(std::vector<Part> parts) {
  if (parts.empty()) {
    return Error{ErrorCode::too_few_points, "a compound needs a part at least", "parts"};
  }
  Compound result;
  for (Part& part : parts) {
    const ConvexPolytope* const polytope = part.shape.polytope();
    if (polytope && turns_nothing(part.pose)) {
      if (auto moved = moved_exactly(*polytope, part.pose.translation())) {
        part.shape = *ConvexShape(*std::move(moved)).with_margin(part.shape.margin());
        part.pose = Pose();
      }
    }
    result.parts_.push_back(std::move(part));
  }
  return result;
}

Expected<Compound> Compound::from_compounds(std::span<const Placed> bodies) {
  std::vector<Part> parts;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    for (const Part& part : bodies[i].body.parts()) {
      const Expected<Pose> pose = composed(bodies[i].pose, part.pose);
      if (!pose) {
        return Error{pose.error().code, pose.error().message, detail::indexed("parts", static_cast<int>(i)) + ".pose"};
      }
      parts.push_back({part.shape, *pose});
    }
  }
  return from_parts(std::move(parts));
}

Expected<Compound> Compound::with_margin(double margin) const {
  Compound result;
  for (const Part& part : parts_) {
    auto shape = part.shape.with_margin(margin);
    if (!shape) return shape.error();
    result.parts_.push_back({*std::move(shape), part.pose});
  }
  return result;
}

Expected<std::vector<PosedShape>> Compound::posed(const Pose& pose) const {
  std::vector<PosedShape> result;
  result.reserve(parts_.size());
  for (const Part& part : parts_) {
    const Expected<Pose> world = composed(pose, part.pose);
    if (!world) return world.error();
    result.push_back({&part.shape, *world});
  }
  return result;
}

}  // namespace pd
