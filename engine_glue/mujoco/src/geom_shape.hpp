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

/// What a shape was made from: equal sources make equal shapes.
struct GeomSource {
  int type = -1;
  std::array<double, 3> size{};       ///< the numbers that the type reads, 0 else
  std::vector<std::int32_t> corners;  ///< of a mesh: vertices that collide, as indices into the mesh
  std::vector<float> vertices;        ///< of a mesh: their coordinates, three each

  friend bool operator==(const GeomSource&, const GeomSource&) = default;
};

struct GeomShape {
  GeomSource source;
  Expected<ConvexShape> body;
  double radius = 0;  ///< of the body, about the origin of its frame
};

/// Whether the model's geom is what the shape was made from. Time O(1), and O(n) in the vertices of a mesh's hull.
[[nodiscard]] bool made_from(const GeomShape& shape, const mjModel& model, int geom);

/// Shapes that are in use anywhere in the process, one for all geoms of the same source: clones of a model and threads
/// share them. Thread-safe.
[[nodiscard]] std::shared_ptr<const GeomShape> shared_shape(const mjModel& model, int geom);

/// A thread's own view: no lock on the way to a shape that is known. Holds the shapes of the last kModels models.
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

/// Where the kinematics have put a geom; refused where that is no pose.
[[nodiscard]] Expected<Pose> geom_pose(const mjData& data, int geom);

/// "geom 3 (\"gripper\", mesh)".
[[nodiscard]] std::string name_of(const mjModel& model, int geom);

}  // namespace pd::detail
