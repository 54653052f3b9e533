/// @file
/// MuJoCo's geoms as convex bodies, each converted once for every model and geom, and compared in every call: a host
/// may change sizes in a model, or free it and load another one at the same address.
#pragma once

#include <mujoco/mujoco.h>

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <unordered_map>
#include <vector>

#include "pd/shape/convex_shape.hpp"

namespace pd::detail {

/// The numbers of a geom from which its shape is made. Equal sources make equal shapes.
struct GeomSource {
  int type = -1;
  std::array<double, 3> size{};       ///< the numbers that the type reads, 0 else
  std::vector<std::int32_t> corners;  ///< vertices of a mesh that collide, as indices into the mesh
  std::vector<float> vertices;        ///< their coordinates, three each
};

struct GeomShape {
  GeomSource source;
  Expected<ConvexShape> body;
  double radius = 0;  ///< of the body, about the origin of its frame
};

/// True if the shape was made from the geom as it is now. Time O(1), and O(n) in the vertices of a mesh's hull.
[[nodiscard]] bool made_from(const GeomShape& shape, const mjModel& model, int geom);

/// The shape of a convex geom. All geoms of the same source share one shape, also those of clones of a model and of
/// other threads, as long as any of them uses it. Thread-safe.
[[nodiscard]] std::shared_ptr<const GeomShape> shared_shape(const mjModel& model, int geom);

/// A thread's own view, which finds a known shape without a lock. It holds the shapes of the last kModels models.
class GeomShapes {
 public:
  /// The shape of a convex geom, or a named refusal in it. Valid until this geom, or another model, is asked for.
  const GeomShape& find(const mjModel& model, int geom, std::int64_t& conversions);

 private:
  static constexpr std::size_t kModels = 16;
  struct Model {
    const mjModel* model = nullptr;
    std::vector<std::shared_ptr<const GeomShape>> geoms;
  };
  std::vector<std::shared_ptr<const GeomShape>>& geoms_of(const mjModel& model);

  std::vector<Model> models_;  ///< the one asked last stands first
};

/// The pose that the kinematics have given to a geom; an error if it is NaN, infinite or no rotation.
[[nodiscard]] Expected<Pose> geom_pose(const mjData& data, int geom);

/// The number, name and type of a geom, for messages: geom 3 ("gripper", mesh).
[[nodiscard]] std::string name_of(const mjModel& model, int geom);

}  // namespace pd::detail
