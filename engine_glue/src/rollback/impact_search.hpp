/// @file
/// The first contact of a world's bodies between two states: swept boxes first, then pairs of convex pieces, then time
/// of impact.
#pragma once

#include <BulletCollision/CollisionShapes/btConcaveShape.h>
#include <BulletDynamics/Dynamics/btDiscreteDynamicsWorld.h>

#include <memory>
#include <optional>
#include <unordered_map>
#include <vector>

#include "pd/bullet/penetration_depth_solver.hpp"
#include "pd/contact/stays_apart.hpp"
#include "pd/depth/scratch.hpp"
#include "shapes/cached_shape.hpp"
#include "shapes/triangle_cache.hpp"
#include "shapes/triangles_in_box.hpp"

namespace pd::detail {

/// A convex piece of a body, or a concave child whose triangles are pieces.
struct Piece {
  btCollisionObject* body = nullptr;
  btTransform local = btTransform::getIdentity();  ///< in the body
  std::shared_ptr<CachedShape> cached;             ///< of a concave child: the triangle that was met
  const btConcaveShape* concave = nullptr;
  double radius = 0;  ///< of a convex piece, about its own origin

  [[nodiscard]] Pose present() const { return with_body_at(body->getWorldTransform()); }
  [[nodiscard]] Pose with_body_at(const btTransform& pose) const;
};

struct FoundImpact {
  Piece a;
  Piece b;
  double time = 0;
  double allowed_depth = 0;  ///< 0: a first contact
};

class ImpactSearch {
 public:
  ImpactSearch(btDiscreteDynamicsWorld& world, BulletPenetrationDepthSolver& solver) : world_(world), solver_(solver) {}

  /// Reads the world's bodies, and forgets their pieces: the host may have changed shapes since.
  void begin_frame();
  /// The present poses are where the motion begins. What is asked of them is kept until the next call: all trials of a
  /// part begin there.
  void mark_start();

  struct Settings {
    double gap = 0;         ///< at which bodies meet
    double in_contact = 0;  ///< pairs no farther apart than this are in contact already
    double searched = 0;    ///< pairs that move by no more than this are not searched
    double slop = 0;        ///< those may sink by this in a frame, about
  };
  /// The earliest first contact of the motion from the marked poses to the present ones, which takes `duration`.
  /// @return whether there is one.
  bool earliest(double duration, const Settings& settings, FoundImpact& found);

  /// The pair's answer at the present poses.
  [[nodiscard]] PenetrationDepth measure(const FoundImpact& impact) {
    return measure(impact, impact.a.body->getWorldTransform(), impact.b.body->getWorldTransform());
  }
  /// With its bodies elsewhere.
  [[nodiscard]] PenetrationDepth measure(const FoundImpact& impact, const btTransform& a, const btTransform& b);
  /// Returns where a body of the world would be at the end of a motion of length `time`, if forces change its velocity
  /// at a constant rate: Bullet moves it for all of a step by the velocity at the step's end. The motion that was
  /// searched last tells the rate. Bodies that bounce have that motion's velocity all the way.
  [[nodiscard]] btTransform pose_after(const btCollisionObject& object, double time) const;

 private:
  struct Body {
    btCollisionObject* object;
    int first_piece = 0;
    int num_pieces = 0;
    double radius = 0;  ///< of all pieces about the body's origin; infinite with a concave child
    btTransform start = btTransform::getIdentity();
    btVector3 linear = btVector3(0, 0, 0), angular = btVector3(0, 0, 0);  ///< velocities at `start`
    RigidMotion motion = {};
    double travel = 0;  ///< no point of it moves farther
    btVector3 lower = btVector3(0, 0, 0);
    btVector3 upper = btVector3(0, 0, 0);
  };

  /// Reads the pieces of all bodies, once a frame; bodies without any are left out.
  void collect();
  void add_pieces(btCollisionObject* object, const btCollisionShape* shape, const btTransform& local);
  /// No points of two bodies have moved farther against each other since `mark_start`. Rough, quicker than motions, and
  /// without pieces: how far a body reaches is taken from the broadphase.
  [[nodiscard]] double farthest_way() const;
  void sweep(Body& body, double duration);
  [[nodiscard]] bool may_meet(const Body& a, const Body& b) const;
  void search_bodies(const Body& a, const Body& b, const Settings& settings, FoundImpact& found);
  void search_convex(const Body& a, const Piece& pa, const Body& b, const Piece& pb, const Settings& settings,
                     FoundImpact& found);
  /// How deep a pair in contact, at present `depth` deep, may be at the end of the motion.
  double allowed_depth(const Piece& a, const Piece& b, double depth, const Settings& settings);
  void search_concave(const Body& a, const Piece& pa, const Body& b, const Piece& pb, const Settings& settings,
                      FoundImpact& found);
  [[nodiscard]] static SupportLevel level_of(const StillTriangle& triangle, const Vec3& towards);
  /// A triangle that a body may come to.
  struct Surface {
    TriangleCorners corners;  ///< in the concave piece's frame
    SupportLevel level;       ///< along its normal, towards the body
    StillTriangle world;
    double bound;                           ///< no larger than the signed distance where the motion begins
    double reach;                           ///< no smaller than the signed distance there
    std::shared_ptr<CachedShape> shape;     ///< null: not asked for yet; without a body: a corner is not finite
    std::optional<PenetrationDepth> start;  ///< the answer where the motion begins; empty: not asked for yet
  };
  /// A convex piece that moves against the triangles of a concave one.
  struct Approach {
    const Body& a;
    const Piece& convex;
    const Body& b;
    const Piece& concave;
    const MovingShape& moving;  ///< the convex piece
    DepthSettings depth;        ///< tells distances within which the triangles may be met
  };
  /// The triangles of a concave piece that a convex one may come to, the nearest first, and how far they are where the
  /// motion begins.
  struct Surroundings {
    btVector3 lower{0, 0, 0}, upper{0, 0, 0};  ///< the box that they were read from
    double beyond = 0;                         ///< up to which their distances are told
    std::vector<Surface> surface;
  };
  /// Returns those of a pair, and more: a shorter trial takes what a longer one read.
  std::vector<Surface>& surface_of(const Approach& pair, StaysApart& along);
  void read_surface(const Approach& pair, StaysApart& along, Surroundings& around);
  /// Returns what a triangle is converted to.
  [[nodiscard]] std::shared_ptr<CachedShape> shape_of(const TriangleCorners& triangle, double margin);
  /// Returns the signed distance of the convex piece and a triangle where the motion begins; HUGE_VAL if a corner is
  /// not finite. Asks the core once.
  double ask_start(const Approach& pair, Surface& triangle);
  /// True if the convex piece is in contact with a triangle where the motion begins.
  [[nodiscard]] bool is_in_contact(const Approach& pair, std::vector<Surface>& surface, double in_contact);
  /// Names a pair of pieces within the frame.
  [[nodiscard]] std::size_t place_of(const Piece& a, const Piece& b) const;
  /// The box of a convex piece's motion in the frame of a concave one.
  void swept_box(const Body& a, const Piece& pa, const Body& b, const Piece& pb, btVector3& lower,
                 btVector3& upper) const;

  btDiscreteDynamicsWorld& world_;
  BulletPenetrationDepthSolver& solver_;
  double duration_ = 0;
  DepthSettings quick_{.bracket = Bracket::contact};
  bool collected_ = false;
  std::vector<Piece> pieces_;
  std::vector<Body> bodies_;
  std::vector<int> order_;
  std::unordered_map<std::size_t, Surroundings> surroundings_;  ///< of pairs with a concave piece, by `place_of`
  std::unordered_map<std::size_t, PenetrationDepth> starts_;    ///< of convex pairs where the motion begins
  TriangleCache triangles_;
  std::vector<std::size_t> unproved_;  ///< triangles of a surface that the body may meet
  /// How deep pairs were when they were first found in contact in this frame; by `place_of`.
  std::unordered_map<std::size_t, double> first_depths_;
  Scratch scratch_;
};

}  // namespace pd::detail
