#include "c_interface/reading.hpp"

#include <array>
#include <cmath>

namespace pd::c_interface {

namespace {

void require_finite(const double* numbers, int count, const char* argument, const char* what) {
  for (int i = 0; i < count; ++i) {
    if (std::isfinite(numbers[i])) continue;
    refuse(PDEPTH_NON_FINITE, "must be finite", std::string(argument) + what + "[" + std::to_string(i) + "]");
  }
}

Pose translated(const Vec3& translation, const char* argument) {
  bool in_range = true;
  for (int i = 0; i < 3; ++i) in_range &= std::abs(translation[i]) <= kMaxCoordinate;  // false for NaN, too
  if (!in_range) {
    return value_of(Pose::from_matrix(Mat3::Identity(), translation), argument);  // which names the number
  }
  return Pose::from_trusted_matrix(Mat3::Identity(), translation);
}

double read_share(double delta) {
  if (!(delta >= 0 && delta <= 1))
    refuse(PDEPTH_BAD_VALUE, "must lie in (0, 1], or be 0 for the default", "settings.delta");
  return delta;
}

Method read_method(std::int32_t method) {
  if (method < PDEPTH_METHOD_AUTOMATIC || method > PDEPTH_METHOD_GRID) {
    refuse(PDEPTH_BAD_VALUE, "must be one of PDEPTH_METHOD_..., not " + std::to_string(method), "settings.method");
  }
  static_assert(static_cast<int>(Method::overlay) == PDEPTH_METHOD_OVERLAY);
  static_assert(static_cast<int>(Method::grid) == PDEPTH_METHOD_GRID);
  return static_cast<Method>(method);
}

Bracket read_bracket(std::int32_t bracket) {
  switch (bracket) {
    case PDEPTH_BRACKET_TIGHTEST:
      return Bracket::tightest;
    case PDEPTH_BRACKET_CERTIFIED:
      return Bracket::certified;
    case PDEPTH_BRACKET_CONTACT:
      return Bracket::contact;
    default:
      refuse(PDEPTH_BAD_VALUE, "must be one of PDEPTH_BRACKET_..., not " + std::to_string(bracket), "settings.bracket");
  }
}

}  // namespace

void refuse_size(std::uint32_t size, std::size_t expected, const char* argument) {
  refuse(PDEPTH_BAD_VALUE,
         "must be the sizeof its struct, " + std::to_string(expected) + ", not " + std::to_string(size),
         std::string(argument) + ".size");
}

void refuse_newer_fields(const char* argument) {
  refuse(PDEPTH_UNSUPPORTED, "has fields of a newer header that this library does not know", argument);
}

void require_length(double value, const char* argument) {
  if (!(value >= 0) || std::isinf(value)) refuse(PDEPTH_BAD_VALUE, "must be a finite length >= 0", argument);
}

void require_unused(std::int32_t reserved, const char* owner) {
  if (reserved == 0) return;
  refuse(PDEPTH_BAD_VALUE, "must be 0, not " + std::to_string(reserved), std::string(owner) + ".reserved");
}

Vec3 read_vector(const double* numbers, const char* argument) {
  const double* const three = &given(numbers, argument);
  require_finite(three, 3, argument, "");
  return {three[0], three[1], three[2]};
}

Pose read_pose(std::int32_t form, const double* n, const char* argument) {
  const Vec3 translation(n[0], n[1], n[2]);
  switch (form) {
    case PDEPTH_POSE_TRANSLATION:
      return translated(translation, argument);
    case PDEPTH_POSE_QUATERNION_WXYZ:
      return value_of(Pose::from_quaternion({n[3], n[4], n[5], n[6]}, translation), argument);
    case PDEPTH_POSE_QUATERNION_XYZW:
      return value_of(Pose::from_quaternion({n[6], n[3], n[4], n[5]}, translation), argument);
    case PDEPTH_POSE_MATRIX: {
      Mat3 rotation;
      for (int i = 0; i < 9; ++i) rotation(i / 3, i % 3) = n[3 + i];
      return value_of(Pose::from_matrix(rotation, translation), argument);
    }
    default:
      refuse(PDEPTH_BAD_VALUE, "must be one of PDEPTH_POSE_..., not " + std::to_string(form),
             std::string(argument) + ".form");
  }
}

Pose read_pose(const pdepth_pose* pose, const char* argument) {
  return pose == nullptr ? Pose() : read_pose(*pose, argument);
}

const Settings& read_settings(const pdepth_settings* settings, SettingsRoom& room) {
  static const Settings by_default;
  if (settings == nullptr) return by_default;
  const pdepth_settings& read = read_struct(settings, "settings");
  Settings& made = room.emplace();
  require_length(read.contact_tolerance, "settings.contact_tolerance");
  made.depth.method = read_method(read.method);
  made.depth.bracket = read_bracket(read.bracket);
  made.depth.delta = read_share(read.delta);
  made.depth.seed = read.seed;
  made.depth.contact_tolerance = read.contact_tolerance;
  if (read.use_beyond != 0) {
    if (!(read.beyond >= 0)) refuse(PDEPTH_BAD_VALUE, "must be a length >= 0", "settings.beyond");
    made.depth.beyond = read.beyond;
  }
  if (read.delta > 0) made.of_unions.delta = made.of_solids.delta = read.delta;
  if (read.max_points < 0) {
    refuse(PDEPTH_BAD_VALUE, "must be above 0, or be 0 for the default", "settings.max_points");
  }
  if (read.max_points > 0) made.of_solids.max_points = read.max_points;
  return made;
}

void Question::require_convex() const {
  if (is_convex()) return;
  refuse(PDEPTH_UNSUPPORTED, "this query takes convex shapes, no compounds and no solids",
         posed_a.shape == nullptr ? "question.a" : "question.b");
}

Question read_question(const pdepth_question* question, SettingsRoom& room) {
  const pdepth_question& read = read_struct(question, "question");
  require_unused(read.reserved, "question");
  const pdepth_shape& a = given(read.a, "question.a");
  const pdepth_shape& b = given(read.b, "question.b");
  return {a,
          b,
          {a.convex(), read_pose(read.pose_a, "question.pose_a")},
          {b.convex(), read_pose(read.pose_b, "question.pose_b")},
          read_settings(read.settings, room),
          read.pair};
}

}  // namespace pd::c_interface
