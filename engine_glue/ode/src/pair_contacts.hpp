/// @file
/// Two geoms of ODE, asked of the core: from poses and shapes to points in the frame of the world.
#pragma once

#include <ode/ode.h>

#include <cstdint>
#include <optional>
#include <string>
#include <unordered_map>

#include "geom_body.hpp"
#include "pair_points.hpp"
#include "pd/ode/install.hpp"

namespace pd::detail {

/// The reason why ODE has to answer a pair, and a text that names the geom.
struct NamedOdeRefusal {
  OdeRefusal kind;
  std::string text;
};

/// Contacts of pairs, with the shapes and buffers of one thread.
class OdePairContacts {
 public:
  /// Fills `points` with the contacts, whose normal points from the second geom to the first. Only the second may be a
  /// plane.
  /// @return why ODE's own function has to answer, or nothing.
  std::optional<NamedOdeRefusal> ask(dGeomID first, dGeomID second, const OdeOptions& options);

  [[nodiscard]] const ContactManifold& points() const { return points_; }
  [[nodiscard]] std::int64_t conversions() const { return bodies_.conversions(); }

 private:
  /// A body at its pose, or a refusal.
  struct Asked {
    const KeptBodies::Body* body = nullptr;
    Pose pose = Pose();
    std::optional<NamedOdeRefusal> refusal;

    [[nodiscard]] PosedShape posed() const { return {&*body->shape, pose}; }
  };
  Asked ask_geom(dGeomID geom);
  std::optional<NamedOdeRefusal> ask_on_plane(dGeomID body, dGeomID plane);
  WarmCertificate* memory_of(dGeomID first, dGeomID second);

  KeptBodies bodies_;
  PairPoints pairs_;
  ContactManifold points_;
  std::unordered_map<dGeomID, std::unordered_map<dGeomID, WarmCertificate>> memories_;
};

}  // namespace pd::detail
