/// @file
/// Structs of `pdepth.h` read: sizes, poses, settings, questions.
#pragma once

#include <cstdint>
#include <optional>

#include "c_interface/handles.hpp"
#include "pd/compound/compound_depth.hpp"
#include "pd/depth/depth_answer.hpp"
#include "pd/shape/convex_shape.hpp"
#include "pd/solid/solid_depth.hpp"

namespace pd::c_interface {

/// No struct of any header comes near: a larger size is one that was never set.
inline constexpr std::uint32_t kMostSize = 4096;

[[noreturn]] void refuse_size(std::uint32_t size, std::size_t expected, const char* argument);
[[noreturn]] void refuse_newer_fields(const char* argument);

/// A struct of the caller, which may be one of a newer header where its new fields are 0.
template <class Struct>
const Struct& read_struct(const Struct* pointer, const char* argument) {
  const Struct& found = given(pointer, argument);
  if (found.size == sizeof(Struct)) return found;
  if (found.size < sizeof(Struct) || found.size > kMostSize) refuse_size(found.size, sizeof(Struct), argument);
  const auto* const bytes = reinterpret_cast<const unsigned char*>(pointer);
  for (std::size_t i = sizeof(Struct); i < found.size; ++i) {
    if (bytes[i] != 0) refuse_newer_fields(argument);
  }
  return found;
}

/// A struct for an answer, checked before the work is done.
template <class Struct>
Struct& answer_struct(Struct* pointer, const char* argument) {
  Struct& found = given(pointer, argument);
  if (found.size < sizeof(Struct) || found.size > kMostSize) refuse_size(found.size, sizeof(Struct), argument);
  return found;
}

/// Fields of a newer header, which this library does not know, become 0.
template <class Struct>
void clear_newer_fields(Struct& out) {
  auto* const bytes = reinterpret_cast<unsigned char*>(&out);
  for (std::size_t i = sizeof(Struct); i < out.size; ++i) bytes[i] = 0;
}

/// `answer`, which has the size of this header, into the caller's struct, whose size stays.
template <class Struct>
void write_answer(const Struct& answer, Struct& out) {
  const std::uint32_t size = out.size;
  out = answer;
  out.size = size;
  clear_newer_fields(out);
}

/// A number of the caller that has to be finite and not below 0.
void require_length(double value, const char* argument);
/// A field that a later header may give a meaning to, so that it has to be 0. @param owner  the struct that has it
void require_unused(std::int32_t reserved, const char* owner);

/// @param numbers  as many as the form has.
[[nodiscard]] Pose read_pose(std::int32_t form, const double* numbers, const char* argument);
[[nodiscard]] inline Pose read_pose(const pdepth_pose& pose, const char* argument) {
  require_unused(pose.reserved, argument);
  return read_pose(pose.form, pose.numbers, argument);
}
/// NULL is the identity.
[[nodiscard]] Pose read_pose(const pdepth_pose* pose, const char* argument);
[[nodiscard]] Vec3 read_vector(const double* numbers, const char* argument);

struct Settings {
  DepthSettings depth;
  UnionSettings of_unions;
  SolidSettings of_solids;
};

/// Room for settings that a call brings along, filled only then.
using SettingsRoom = std::optional<Settings>;

/// The settings by default where the pointer is NULL. @param room  holds the others.
[[nodiscard]] const Settings& read_settings(const pdepth_settings* settings, SettingsRoom& room);

/// Two bodies and how they are asked about. The shape of a posed body is nullptr for a compound or a solid.
struct Question {
  const pdepth_shape& a;
  const pdepth_shape& b;
  PosedShape posed_a;
  PosedShape posed_b;
  const Settings& settings;
  pdepth_pair* pair;

  [[nodiscard]] bool is_convex() const {
    return !kHasCompounds || (posed_a.shape != nullptr && posed_b.shape != nullptr);
  }
  /// Refuses compounds.
  void require_convex() const;
};

[[nodiscard]] Question read_question(const pdepth_question* question, SettingsRoom& room);

}  // namespace pd::c_interface
