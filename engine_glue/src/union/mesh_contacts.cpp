#include "union/mesh_contacts.hpp"

#include <BulletCollision/BroadphaseCollision/btBroadphaseProxy.h>
#include <BulletCollision/CollisionDispatch/btCollisionObjectWrapper.h>
#include <BulletCollision/CollisionShapes/btConcaveShape.h>
#include <BulletCollision/CollisionShapes/btSdfCollisionShape.h>
#include <BulletCollision/CollisionShapes/btTriangleShape.h>

#include <algorithm>
#include <array>
#include <span>
#include <vector>

#include "pair/solver_core.hpp"
#include "pd/bullet/scalar.hpp"
#include "pd/union_contact/gentle_ground.hpp"
#include "pd/union_contact/one_sided.hpp"
#include "pd/union_contact/piece_memories.hpp"
#include "pd/union_contact/straddled.hpp"
#include "pieces/compound_facts.hpp"
#include "shapes/compound_children.hpp"
#include "shapes/met_triangle.hpp"
#include "shapes/moving_body.hpp"
#include "shapes/triangles_around.hpp"
#include "union/child_on_ground.hpp"
#include "union/pieces_in_result.hpp"
#include "union/sheet_sides.hpp"
#include "union/step_leap.hpp"

namespace pd::detail {

namespace {

/// Of a way out of a triangle: so much farther, a body that follows it is off the triangle beyond rounding.
constexpr double kClear = 1 + 0x1p-6;

/// Triangles of one step that a body or child remembers, some 2 KB each; those met after them begin anew each step.
constexpr std::size_t kMostRemembered = 256;

/// Children whose boxes have less than this share of the surface of the box around all of them read the mesh one by
/// one: between them lie triangles that none of them meets.
constexpr btScalar kCloseTogether = btScalar(.5);

/// Half the surface of a box.
btScalar surface(const btVector3& lower, const btVector3& upper) {
  const btVector3 extent = upper - lower;
  return extent.x() * extent.y() + extent.y() * extent.z() + extent.z() * extent.x();
}

/// A number of both, in place of the triangle's part: Bullet's number of that for a body that is no compound.
int part_of(const Child& child, const MetTriangle& triangle) { return triangle.part ^ ((child.index + 1) << 16); }

/// Corners of a plane may be off it by this share of their coordinates, because the author of the mesh rounded them to
/// Bullet's scalar.
constexpr double kFlat = sizeof(btScalar) == sizeof(float) ? 0x1p-22 : 0x1p-50;

/// A child that is asked about, and where.
struct ChildAsked {
  const btCollisionObjectWrapper& wrapper;
  const btTransform& pose;
};

class MeshContacts final : public UnionContacts {
 public:
  bool find(const UnionQuestion& question, Patches& patches) override;
  [[nodiscard]] PointPieces pieces_of(int triangle) const override {
    const MetTriangle& met = triangles_[static_cast<std::size_t>(triangle)];
    return {children_[static_cast<std::size_t>(met.child)], nullptr, &met};
  }
  void remember_chosen(const Patches& patches, PairMemory& memory) override;

 private:
  /// Compares where the children are with where all triangles were asked about them.
  /// @return whether only those that made points are to be asked again
  bool stand_still(const UnionQuestion& question);
  /// False: in the next step the body will not be where it is.
  static bool may_come_to_rest(const UnionQuestion& question);
  /// The triangles that one of the children is asked about.
  void choose_triangles(int place, const TrianglesAround& around, StandingStill& standing);
  /// Sets how far the children reach.
  void reach_out(const UnionQuestion& question);
  /// Widens the reach of children that leap over themselves in a step, and so may be through a sheet as a whole, by as
  /// far as they come.
  void reach_back(const UnionQuestion& question);
  /// Reads the mesh around one of them, or all.
  void read_mesh(const UnionQuestion& question, const btVector3& lower, const btVector3& upper);
  /// The contacts of one of them. @return false where a piece has no exact form
  bool find_of(const UnionQuestion& question, int place, Patches& patches);
  /// Finds the contacts with the triangles from number `first` on, if these are flat. @return false if each triangle
  /// has to be asked
  bool find_on_flat(ChildOnGround& standing, const btCollisionObjectWrapper& a, const UnionQuestion& question,
                    std::size_t first, Patches& patches);
  /// Whether the body can be asked along the normals of gentle triangles. @param a  the wrapper of the child
  bool begin_gentle(const btCollisionObjectWrapper& a, const UnionQuestion& question, int place);
  /// The contacts with one of the triangles that were chosen, if it is gentle. @return false: it is not
  bool find_on_gentle(const btCollisionObjectWrapper& a, const UnionQuestion& question, std::size_t triangle,
                      Patches& patches);
  /// True if a child's origin is on the side of a triangle that the child came from.
  [[nodiscard]] bool is_on_its_side(const UnionQuestion& question, std::size_t triangle) const;
  /// Asks a triangle by itself.
  SolverCore::Outcome ask(const ChildAsked& child, const UnionQuestion& question, const TriangleInResult& triangle,
                          PieceMemory* memory, PairAnswer& answer) const;
  void add_fronts(const btCollisionObjectWrapper& a, const UnionQuestion& question, Patches& patches);
  /// Adds the way out of the whole body if no contact of a child is left that overlaps.
  void leave_straddled(const UnionQuestion& question, Patches& patches);

  std::vector<Child> children_;               ///< of question.a, or itself
  std::vector<BodyReach> reaches_;            ///< of the children
  btVector3 lower_, upper_;                   ///< of the box around all of them
  double way_ = 0;                            ///< of the body in a step
  bool together_ = true;                      ///< so close that the mesh is read once for all
  bool still_ = false;                        ///< since all triangles were asked
  std::vector<StandingChild> stand_;          ///< as the children are now
  std::vector<double> radii_;                 ///< of the children, about the origins of their frames
  std::vector<int> known_;                    ///< places of the triangles around among those that were asked
  std::vector<MetTriangle> triangles_;        ///< of all children, one child's after the other's
  std::vector<std::size_t> places_;           ///< theirs among the triangles around
  std::vector<std::array<Vec3, 3>> corners_;  ///< of the child's triangles
  FlatGround flat_;
  GentleGround gentle_;
  PosedShape body_{};  ///< the child at hand
  PieceMemories<PieceMemory> memories_;
  OneSided one_sided_;
  StraddledTriangles straddled_;
  SheetSides sides_;
};

void MeshContacts::reach_out(const UnionQuestion& question) {
  const btTransform into_mesh = question.b.getWorldTransform().inverse();
  const btScalar reach = question.b.getCollisionShape()->getMargin() + question.threshold;
  reaches_.clear();
  lower_.setValue(BT_LARGE_FLOAT, BT_LARGE_FLOAT, BT_LARGE_FLOAT);
  upper_ = -lower_;
  btScalar of_children = 0;
  for (const Child& child : children_) {
    reaches_.emplace_back(static_cast<const btConvexShape&>(*child.shape), into_mesh * child.pose, reach);
    lower_.setMin(reaches_.back().lower());
    upper_.setMax(reaches_.back().upper());
    of_children += surface(reaches_.back().lower(), reaches_.back().upper());
  }
  together_ = children_.size() == 1 || of_children >= kCloseTogether * surface(lower_, upper_);
}

void MeshContacts::reach_back(const UnionQuestion& question) {
  const StepLeap step(question, (upper_ - lower_).length());
  way_ = step.way();
  const auto behind = static_cast<btScalar>(question.memory.sheet.behind);
  const btTransform& pose = question.b.getWorldTransform();
  const btScalar reach = question.b.getCollisionShape()->getMargin() + question.threshold;
  for (std::size_t i = 0; i < children_.size(); ++i) {
    const btVector3 box = reaches_[i].upper() - reaches_[i].lower() - btScalar(2) * btVector3(reach, reach, reach);
    const btVector3 middle = pose * (btScalar(0.5) * (reaches_[i].lower() + reaches_[i].upper()));
    const btScalar back = step.over_itself(middle, box, pose.getBasis(), children_.size() == 1) + behind;
    if (back <= 0) continue;
    const Child& child = children_[i];
    reaches_[i] =
        BodyReach(static_cast<const btConvexShape&>(*child.shape), pose.inverseTimes(child.pose), reach + back);
    lower_.setMin(reaches_[i].lower());
    upper_.setMax(reaches_[i].upper());
  }
}

void MeshContacts::read_mesh(const UnionQuestion& question, const btVector3& lower, const btVector3& upper) {
  ThreadBuffers& buffers = question.buffers;
  const auto& mesh = static_cast<const btConcaveShape&>(*question.b.getCollisionShape());
  const int skipped = buffers.around.read(mesh, lower, upper);
  if (skipped > 0) buffers.counters.skipped_triangles.add(skipped);
  buffers.near.know(buffers.around, question.b);
  gentle_.know(buffers.around.corners());
}

SolverCore::Outcome MeshContacts::ask(const ChildAsked& child, const UnionQuestion& question,
                                      const TriangleInResult& triangle, PieceMemory* memory, PairAnswer& answer) const {
  const bool met = (memory != nullptr && memory->met) || sides_.fast();
  const PairQuestion asked{.a = static_cast<const btConvexShape&>(*child.wrapper.getCollisionShape()),
                           .pose_a = child.pose,
                           .b = triangle.shape(),
                           .pose_b = question.b.getWorldTransform(),
                           .shapes = memory != nullptr ? memory->shapes : question.buffers.recent,
                           .warm = memory != nullptr ? &memory->warm : nullptr,
                           .stamp = question.stamp,
                           .corners = {true, is_part(child.wrapper), false},
                           .beyond = met ? kAnyDistance : static_cast<double>(question.threshold)};
  return question.core.answer(asked, question.buffers, answer);
}

/// The contacts along the fronts of triangles that the body stands through, where none of the others leads off them.
void MeshContacts::add_fronts(const btCollisionObjectWrapper& a, const UnionQuestion& question, Patches& patches) {
  const btTransform& pose = a.getWorldTransform();
  for (const OneSided::Behind& behind : one_sided_.behind()) {
    const MetTriangle& met = triangles_[static_cast<std::size_t>(behind.triangle)];
    const TriangleInResult triangle(question.result, question.b, met);
    PairAnswer answer;
    const std::vector<Vec3>& ways = one_sided_.ways_out();
    const bool left = std::any_of(ways.begin(), ways.end(), [&](const Vec3& way) {
      // A little farther than touching, which rounding would decide.
      const btTransform moved(pose.getBasis(), pose.getOrigin() + to_bullet(Vec3(kClear * way)));
      return ask({a, moved}, question, triangle, nullptr, answer) == SolverCore::Outcome::answered &&
             answer.depth.contact != ContactClass::overlapping;
    });
    if (left || ask({a, pose}, question, triangle, nullptr, answer) != SolverCore::Outcome::answered) {
      continue;
    }
    const ContactManifold points =
        along_front(question.of_pieces(a, triangle.wrapper()).as(answer.a, answer.b, behind.front));
    for (int k = 0; k < points.count; ++k) sides_.lead(points.points[static_cast<std::size_t>(k)].depth);
    patches.add(points, behind.triangle, part_of(children_[static_cast<std::size_t>(met.child)], met), met.index);
  }
}

void MeshContacts::leave_straddled(const UnionQuestion& question, Patches& patches) {
  const btTransform& pose = question.b.getWorldTransform();
  const Vec3 middle = to_pd(pose.invXform(whole_of(question.a).getWorldTransform().getOrigin()));
  for (const auto& [place, triangle] : straddled_.need_way_out(patches)) {
    const MetTriangle& met = triangles_[static_cast<std::size_t>(triangle)];
    const Child& child = children_[static_cast<std::size_t>(place)];
    const Vec3 corner = to_pd(met.corners[0]);
    const Vec3 normal = (to_pd(met.corners[1]) - corner).cross(to_pd(met.corners[2]) - corner).normalized();
    const bool one_sided = question.core.settings.one_sided_meshes;
    const Vec3 front = one_sided ? normal : side_towards(middle, normal, corner);
    if (!one_sided) sides_.keep(number_of_pieces(child.index, met), front, corner);
    const ChildInResult piece(question.result, question.a, child);
    one_sided_.clear();
    one_sided_.add_behind(triangle, to_pd(pose).rotation() * front);
    add_fronts(piece.wrapper(), question, patches);
  }
}

bool MeshContacts::find(const UnionQuestion& question, Patches& patches) {
  SolverCore& core = question.core;
  ThreadBuffers& buffers = question.buffers;
  PairMemory& memory = question.memory;
  triangles_.clear();
  places_.clear();
  straddled_.clear();
  memories_.begin();
  if (!is_finite(question.a.getWorldTransform()) || !is_finite(question.b.getWorldTransform())) return true;
  if (!all_children(question.a, *question.b.getCollisionShape(), children_)) return false;
  buffers.near.begin_pair(question.stamp);
  look_at(question.a, children_, buffers.near.facts(), core.cache);
  if (children_.empty()) return true;
  reach_out(question);
  if (!core.settings.one_sided_meshes) reach_back(question);
  sides_.begin(memory.sheet);
  still_ = stand_still(question);
  if (together_) read_mesh(question, lower_, upper_);
  if (still_) {
    memory.standing.find(buffers.around.triangles(), known_);
  } else if (!stand_.empty() && may_come_to_rest(question)) {
    memory.standing.begin(stand_, question.threshold, question.b.getCollisionShape()->getMargin(),
                          buffers.around.triangles());
  } else {
    memory.standing.forget();
  }
  for (std::size_t i = 0; i < children_.size(); ++i) {
    if (find_of(question, static_cast<int>(i), patches)) continue;
    memory.standing.forget();
    return false;
  }
  leave_straddled(question, patches);
  if (!still_) {
    memories_.end(memory.pieces);
    sides_.end(memory.sheet);
  }
  return true;
}

bool MeshContacts::stand_still(const UnionQuestion& question) {
  SolverCore& core = question.core;
  PairMemory& memory = question.memory;
  stand_.clear();
  radii_.clear();
  // Children far apart read the mesh one by one; what stands behind a one-sided triangle is asked with all others.
  if (!together_ || core.settings.one_sided_meshes) return false;
  const btTransform into_mesh = question.b.getWorldTransform().inverse();
  for (std::size_t i = 0; i < children_.size(); ++i) {
    const Child& child = children_[i];
    std::shared_ptr<CachedShape>& shape = memory.shape_of_child(0, child.index);
    core.find(static_cast<const btConvexShape&>(*child.shape), question.stamp, shape, question.buffers);
    stand_.push_back({child.index, into_mesh * child.pose, shape});
    const Vec3 origin = to_pd(stand_.back().pose.getOrigin());
    radii_.push_back((to_pd(reaches_[i].upper()) - origin).cwiseMax(origin - to_pd(reaches_[i].lower())).norm());
  }
  return memory.standing.still(stand_, radii_, question.threshold, question.b.getCollisionShape()->getMargin());
}

bool MeshContacts::may_come_to_rest(const UnionQuestion& question) {
  const Vec3 way = static_cast<double>(question.time.seconds) * (linear_velocity(*question.a.getCollisionObject()) -
                                                                 linear_velocity(*question.b.getCollisionObject()));
  return way.squaredNorm() <= static_cast<double>(question.threshold) * static_cast<double>(question.threshold);
}

void MeshContacts::choose_triangles(int place, const TrianglesAround& around, StandingStill& standing) {
  using Met = StandingStill::Met;
  const auto child = static_cast<std::size_t>(place);
  const BodyReach& reach = reaches_[child];
  const std::span<const MeshTriangle> all = around.triangles();
  const Met least = still_ && !standing.flat(child) ? Met::with_points : Met::within_reach;
  for (std::size_t i = 0; i < all.size(); ++i) {
    const MeshTriangle& near = all[i];
    const bool known = still_ && known_[i] >= 0;
    if (known ? standing.met(child, static_cast<std::size_t>(known_[i])) < least : !reach.meets(near)) continue;
    if (!still_ && !standing.empty()) standing.set(child, i, Met::within_reach);
    triangles_.push_back({{near.corners[0], near.corners[1], near.corners[2]}, near.part, near.index, place});
    places_.push_back(i);
  }
}

void MeshContacts::remember_chosen(const Patches& patches, PairMemory& memory) {
  StandingStill& standing = memory.standing;
  if (still_ || standing.empty()) return;
  for (int i = 0; i < patches.size(); ++i) {
    for (int k = 0; k < patches[i].count; ++k) {
      const auto piece = static_cast<std::size_t>(patches[i].points[static_cast<std::size_t>(k)].piece);
      standing.set(static_cast<std::size_t>(triangles_[piece].child), places_[piece], StandingStill::Met::with_points);
    }
  }
}

bool MeshContacts::begin_gentle(const btCollisionObjectWrapper& a, const UnionQuestion& question, int place) {
  const btTransform& pose = a.getWorldTransform();
  if (!in_range(pose) || !in_range(question.b.getWorldTransform())) return false;
  const int child = children_[static_cast<std::size_t>(place)].index;
  std::shared_ptr<CachedShape>& shape = question.memory.shape_of_child(0, child);
  StepShapes{question.core.cache, question.stamp}.refresh(static_cast<const btConvexShape&>(*a.getCollisionShape()),
                                                          shape);
  if (!shape->body) return false;
  body_ = {(is_part(a) && shape->sharp ? shape->sharp : shape->body).get(), to_pd(pose)};
  const BodyReach& reach = reaches_[static_cast<std::size_t>(place)];
  return gentle_.begin(body_,
                       {.mesh = to_pd(question.b.getWorldTransform()),
                        .margin = static_cast<double>(question.b.getCollisionShape()->getMargin()),
                        .lower = to_pd(reach.lower()),
                        .upper = to_pd(reach.upper()),
                        .one_sided = question.core.settings.one_sided_meshes},
                       static_cast<double>(question.threshold));
}

bool MeshContacts::is_on_its_side(const UnionQuestion& question, std::size_t triangle) const {
  const MetTriangle& met = triangles_[triangle];
  const Child& child = children_[static_cast<std::size_t>(met.child)];
  const Vec3 normal = question.buffers.around.triangles()[places_[triangle]].across.normalized();
  const Vec3 corner = to_pd(met.corners[0]);
  const Vec3 origin = to_pd(question.b.getWorldTransform().invXform(child.pose.getOrigin()));
  const Vec3 front = sides_.front_of(number_of_pieces(child.index, met), normal);
  const double height = normal.dot(origin - corner);
  return height * (front.isZero() ? normal.dot(sides_.middle_before() - corner) : front.dot(normal)) >= 0;
}

bool MeshContacts::find_on_gentle(const btCollisionObjectWrapper& a, const UnionQuestion& question,
                                  std::size_t triangle, Patches& patches) {
  ThreadBuffers& buffers = question.buffers;
  const bool one_sided = question.core.settings.one_sided_meshes;
  const std::size_t place = places_[triangle];
  if (!one_sided && !is_on_its_side(question, triangle)) return false;
  if (!gentle_.ask(place)) return false;
  buffers.counters.calls.add();
  buffers.counters.support_calls.add();
  const MetTriangle& met = triangles_[triangle];
  const Child& child = children_[static_cast<std::size_t>(met.child)];
  if (!one_sided && !gentle_.manifolds().empty()) {
    const Vec3 normal = buffers.around.triangles()[place].across.normalized();
    const bool ahead =
        (to_pd(question.b.getWorldTransform()).rotation() * normal).dot(gentle_.manifolds()[0].normal) > 0;
    sides_.keep(number_of_pieces(child.index, met), ahead ? normal : Vec3(-normal), to_pd(met.corners[0]));
  }
  for (const ContactManifold& found : gentle_.manifolds()) {
    ContactManifold points = found;
    double deepest = -1;
    for (int k = 0; k < points.count; ++k) {
      const double depth = points.points[static_cast<std::size_t>(k)].depth;
      if (depth > 0) one_sided_.add_way(depth * points.normal);
      deepest = std::max(deepest, depth);
    }
    if (is_piece(a)) {
      count_covered(drop_covered(question.of_pieces(a, question.b).as(body_, body_), points), buffers);
      straddled_.note({met.child, static_cast<int>(triangle)}, deepest, points);
    }
    patches.add(points, static_cast<int>(triangle), part_of(child, met), met.index);
  }
  return true;
}

bool MeshContacts::find_on_flat(ChildOnGround& standing, const btCollisionObjectWrapper& a,
                                const UnionQuestion& question, std::size_t first, Patches& patches) {
  corners_.clear();
  for (std::size_t i = first; i < triangles_.size(); ++i) {
    const MetTriangle& met = triangles_[i];
    corners_.push_back({to_pd(met.corners[0]), to_pd(met.corners[1]), to_pd(met.corners[2])});
  }
  const Pose mesh = to_pd(question.b.getWorldTransform());
  const GroundTriangles ground{.corners = corners_,
                               .mesh = mesh,
                               .margin = static_cast<double>(question.b.getCollisionShape()->getMargin()),
                               .corner_rounding = kFlat,
                               .pose_rounding = kPoseRounding,
                               .one_sided = !standing.remembers_sides()};
  const GroundPlace place{to_pd(a.getWorldTransform().getOrigin()), to_pd(whole_of(a).getWorldTransform().getOrigin()),
                          is_part(a)};
  if (!flat_.find(standing, place, ground)) return false;
  flat_.for_each_point([&](const ContactManifold& point, std::size_t triangle) {
    // Features are the body's alone, and go on from triangle to triangle.
    patches.add(point, static_cast<int>(first + triangle), is_part(a) ? a.m_index : -1, -1);
  });
  return true;
}

bool MeshContacts::find_of(const UnionQuestion& question, int place, Patches& patches) {
  ThreadBuffers& buffers = question.buffers;
  PairMemory& memory = question.memory;
  const Child& child = children_[static_cast<std::size_t>(place)];
  const BodyReach& reach = reaches_[static_cast<std::size_t>(place)];
  const btTransform& pose = question.b.getWorldTransform();
  if (!together_) read_mesh(question, reach.lower(), reach.upper());
  const std::size_t first = triangles_.size();
  choose_triangles(place, buffers.around, memory.standing);
  const bool one_sided = question.core.settings.one_sided_meshes;
  if (triangles_.size() == first) {
    if (!one_sided) sides_.pass(child.index, pose.inverseTimes(child.pose));
    return true;
  }
  const ChildInResult piece(question.result, question.a, child);
  const btCollisionObjectWrapper& a = piece.wrapper();
  const auto threshold = static_cast<double>(question.threshold);
  if (!one_sided) {
    const Vec3 middle = to_pd(pose * (btScalar(0.5) * (reach.lower() + reach.upper())));
    sides_.enter(child.index, pose.inverseTimes(child.pose), to_pd(pose), middle, way_, threshold);
  }
  const auto met_of_child = std::span<const MetTriangle>(triangles_).subspan(first);
  const SheetSides::Around around{met_of_child, std::span(places_).subspan(first), buffers.around};
  ChildOnGround standing({question, a, is_part(a) ? a.m_index : -1, met_of_child, one_sided ? nullptr : &sides_},
                         memory.shape_of_child(0, child.index));
  const bool asked_one_by_one = still_ && !memory.standing.flat(static_cast<std::size_t>(place));
  if (!asked_one_by_one && find_on_flat(standing, a, question, first, patches)) {
    if (!memory.standing.empty()) memory.standing.set_flat(static_cast<std::size_t>(place));
    return true;
  }
  if (still_ && !asked_one_by_one) memory.standing.forget();  // it stands over an edge of flat ground now
  one_sided_.clear();
  const bool gentle = begin_gentle(a, question, place);
  for (std::size_t i = first; i < triangles_.size(); ++i) {
    const MetTriangle& met = triangles_[i];
    if (gentle && find_on_gentle(a, question, i, patches)) continue;
    const TriangleInResult triangle(question.result, question.b, met);
    PairAnswer answer;
    PieceMemory* remembered = nullptr;
    if (still_) {
      remembered = PieceMemories<PieceMemory>::find(memory.pieces, number_of_pieces(child.index, met));
    } else if (i - first < kMostRemembered) {
      remembered = &memories_.take(memory.pieces, number_of_pieces(child.index, met));
    }
    const auto outcome = ask({a, child.pose}, question, triangle, remembered, answer);
    if (outcome == SolverCore::Outcome::unsupported) return false;
    if (outcome != SolverCore::Outcome::answered) continue;
    if (remembered != nullptr) remembered->met = answer.depth.signed_distance() <= threshold;
    const MeshTriangle& near = buffers.around.triangles()[places_[i]];
    // The side from which the corners run counter-clockwise.
    const Vec3 front = one_sided ? Vec3((to_pd(pose).rotation() * near.across).normalized()) : Vec3(Vec3::Zero());
    if (one_sided && !one_sided_.admit(answer.depth, front, static_cast<int>(i))) continue;
    if (!one_sided) {
      const Vec3 back = sides_.judge(met, near.across.normalized(), around, answer);
      if (!back.isZero()) {
        one_sided_.add_behind(static_cast<int>(i), back);
        continue;
      }
    }
    ContactManifold points;
    AskedPieces pieces = question.of_pieces(a, triangle.wrapper());
    const PiecePair pair = pieces.as(answer.a, answer.b, front);
    count_covered(keep_uncovered(pair, answer.depth, AnswerPoints::to_be_made, points), buffers);
    // Siblings may turn a part's contact to the side where the whole is.
    if (!one_sided && !is_part(a) && points.count > 0 && sides_.leads_back(points.normal)) {
      one_sided_.add_behind(static_cast<int>(i), sides_.front());
      continue;
    }
    one_sided_.add_way_of(answer.depth);
    if (points.count == 0 && is_piece(a)) {
      straddled_.note({place, static_cast<int>(i)}, -answer.depth.signed_distance(), points);
    }
    patches.add(points, static_cast<int>(i), part_of(child, met), met.index);
  }
  add_fronts(a, question, patches);
  return true;
}

}  // namespace

std::unique_ptr<UnionContacts> mesh_contacts() { return std::make_unique<MeshContacts>(); }

bool takes_mesh(int proxy_type) {
  return proxy_type == TRIANGLE_MESH_SHAPE_PROXYTYPE || proxy_type == SCALED_TRIANGLE_MESH_SHAPE_PROXYTYPE ||
         proxy_type == MULTIMATERIAL_TRIANGLE_MESH_PROXYTYPE || proxy_type == FAST_CONCAVE_MESH_PROXYTYPE ||
         proxy_type == TERRAIN_SHAPE_PROXYTYPE || proxy_type == CUSTOM_CONCAVE_SHAPE_TYPE;
}

bool is_distance_field(const btCollisionShape& shape) {
  return shape.getShapeType() == SDF_SHAPE_PROXYTYPE && dynamic_cast<const btSdfCollisionShape*>(&shape) != nullptr;
}

}  // namespace pd::detail
