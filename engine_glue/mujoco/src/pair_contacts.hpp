/// @file
/// Two geoms of a MuJoCo model, asked of the core: from poses and shapes to points in the frame of the world.
#pragma once

#include <mujoco/mujoco.h>

#include <cstdint>
#include <optional>
#include <unordered_map>

#include "geom_shape.hpp"
#include "pair_points.hpp"
#include "pd/mujoco/install.hpp"

namespace pd::detail {

/// Two geoms of a model, and the margin within which their contacts are wanted.
struct GeomPair {
  const mjModel* model;
  const mjData* data;
  int geom1;
  int geom2;
  double margin;
};

/// The reason why MuJoCo has to answer a pair, and a text that names the geom.
struct NamedRefusal {
  MujocoRefusal kind;
  std::string text;
};

/// Contacts of pairs, with the shapes and buffers of one thread.
class PairContacts {
 public:
  /// Fills `points` with the contacts, whose normal points from the second geom to the first.
  /// @return why MuJoCo's own function has to answer, or nothing.
  std::optional<NamedRefusal> ask(const GeomPair& pair, const MujocoOptions& options);

  [[nodiscard]] const ContactManifold& points() const { return points_; }
  [[nodiscard]] std::int64_t conversions() const { return conversions_; }

 private:
  WarmCertificate* memory_of(const GeomPair& pair);

  GeomShapes shapes_;
  PairPoints pairs_;
  ContactManifold points_;
  std::int64_t conversions_ = 0;
  std::unordered_map<const mjModel*, std::unordered_map<std::uint64_t, WarmCertificate>> memories_;
};

}  // namespace pd::detail
