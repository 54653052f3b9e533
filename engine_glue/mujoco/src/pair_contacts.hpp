/// @file
/// Two geoms of a MuJoCo model, asked of the core: from poses and shapes to points in the frame of the world.
#pragma once

#include <mujoco/mujoco.h>

#include <cstdint>
#include <optional>
#include <unordered_map>

#include "geom_shape.hpp"
#include "pd/contact/manifold.hpp"
#include "pd/depth/scratch.hpp"
#include "pd/depth/warm_certificate.hpp"
#include "pd/mujoco/install.hpp"

namespace pd::detail {

/// Two geoms of a model, and the margin within which their contacts are wanted.
struct GeomPair {
  const mjModel* model;
  const mjData* data;
  int geom1;
  int geom2;
  double margin;
  double size = 0;  ///< radius of the smaller body, once its shape is known
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
  std::optional<NamedRefusal> ask(GeomPair pair, const MujocoOptions& options);

  [[nodiscard]] const ContactManifold& points() const { return points_; }
  [[nodiscard]] std::int64_t conversions() const { return conversions_; }

 private:
  /// The largest gap of a contact, which is never negative.
  static double within_margin(const GeomPair& pair);
  /// The points within the margin, chosen so that small changes of depth do not change the choice.
  /// @param points_within  the contact points up to a threshold.
  template <class Points>
  ContactManifold steady_four(const GeomPair& pair, Points&& points_within);
  void two_boxes(const GeomPair& pair, const MujocoOptions& options, const PosedShape& a, const PosedShape& b);
  void two_bodies(const GeomPair& pair, const MujocoOptions& options, const PosedShape& a, const PosedShape& b);
  void body_on_plane(const GeomPair& pair, const PosedShape& body, const Pose& plane);
  /// Gives the deepest point the exact distance of the bodies.
  void correct_deepest(double signed_distance);
  WarmCertificate* memory_of(const GeomPair& pair);

  GeomShapes shapes_;
  Scratch scratch_;
  ManifoldScratch manifold_;
  ContactManifold points_;
  std::int64_t conversions_ = 0;
  std::unordered_map<const mjModel*, std::unordered_map<std::uint64_t, WarmCertificate>> memories_;
};

}  // namespace pd::detail
