#include <ode/collision.h>
#include <ode/odeinit.h>
#include <ode/version.h>

#include <array>

#include "bench/peers/solver.hpp"
#ifdef PD_BENCH_WITH_ODE_DOOR
#include "pd/ode/install.hpp"
#endif

namespace pd::bench {

namespace {

static_assert(sizeof(dReal) == sizeof(double), "this peer is meant for ODE in double precision");

/// A hull for ODE, which refers to these arrays. ODE wants the origin inside: the caller sees to it.
struct OdeHull {
  std::vector<dReal> planes;
  std::vector<dReal> points;
  std::vector<unsigned int> polygons;
  dGeomID geom = nullptr;

  explicit OdeHull(const ConvexShape& shape) {
    const ConvexPolytope& polytope = *shape.polytope();
    for (const Vec3& p : vertices_of(shape)) points.insert(points.end(), p.data(), p.data() + 3);
    for (int f = 0; f < polytope.num_facets(); ++f) {
      const Vec3& normal = polytope.facet_normal(f);
      const auto corners = polytope.facet_vertices(f);
      planes.insert(planes.end(), {normal.x(), normal.y(), normal.z(), normal.dot(polytope.vertex(corners[0]))});
      polygons.push_back(static_cast<unsigned int>(corners.size()));
      polygons.insert(polygons.end(), corners.begin(), corners.end());
    }
    geom = dCreateConvex(nullptr, planes.data(), static_cast<unsigned int>(polytope.num_facets()), points.data(),
                         static_cast<unsigned int>(polytope.num_vertices()), polygons.data());
#ifdef PD_BENCH_WITH_ODE_DOOR
    ode_convex(geom, points.data(), static_cast<unsigned int>(polytope.num_vertices()));
#endif
  }
  ~OdeHull() {
#ifdef PD_BENCH_WITH_ODE_DOOR
    forget_ode_convex(geom);
#endif
    dGeomDestroy(geom);
  }
  OdeHull(const OdeHull&) = delete;
  OdeHull& operator=(const OdeHull&) = delete;

  void stand(const Pose& pose) const {
    const Vec3& t = pose.translation();
    dGeomSetPosition(geom, t.x(), t.y(), t.z());
    dMatrix3 rotation{};
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) rotation[4 * i + j] = pose.rotation()(i, j);
    }
    dGeomSetRotation(geom, rotation);
  }
};

class OdeAttempt final : public Attempt {
 public:
  explicit OdeAttempt(const Bodies& bodies) : a_(bodies.a), b_(bodies.b) {}
  void stand(const Pose& a, const Pose& b) override {
    a_.stand(a);
    b_.stand(b);
  }
  void run() override {
    count_ = dCollide(a_.geom, b_.geom, static_cast<int>(contacts_.size()), contacts_.data(), sizeof(dContactGeom));
  }
  /// The deepest contact point. ODE's normal points into the first body.
  [[nodiscard]] Answer answer() const override {
    const dContactGeom* deepest = nullptr;
    for (int i = 0; i < count_; ++i) {
      const dContactGeom& contact = contacts_[static_cast<std::size_t>(i)];
      if (deepest == nullptr || contact.depth > deepest->depth) deepest = &contact;
    }
    if (deepest == nullptr) return {};
    return {true, deepest->depth, deepest->depth * Vec3(deepest->normal[0], deepest->normal[1], deepest->normal[2])};
  }

 private:
  OdeHull a_;
  OdeHull b_;
  std::array<dContactGeom, 16> contacts_{};
  int count_ = 0;
};

class OdeSolver final : public Solver {
 public:
  /// @param through_door  pdepth's contacts, by its door into ODE
  explicit OdeSolver(bool through_door) : through_door_(through_door) { dInitODE2(0); }
  ~OdeSolver() override { dCloseODE(); }
  [[nodiscard]] std::string_view name() const override { return through_door_ ? kOdeByPdepth : kOde; }
  [[nodiscard]] Precision precision() const override { return Precision::binary64; }
  [[nodiscard]] std::unique_ptr<Attempt> prepare(const Bodies& bodies) override {
#ifdef PD_BENCH_WITH_ODE_DOOR
    // A run asks one solver: the table is not changed back and forth.
    if (through_door_ != installed_) {
      installed_ = through_door_ && install_ode().has_value();
      if (!through_door_) uninstall_ode();
    }
#endif
    return std::make_unique<OdeAttempt>(bodies);
  }

 private:
  bool through_door_;
  static inline bool installed_ = false;  ///< in the table, which belongs to the process
};

}  // namespace

void add_ode(Solvers& solvers) {
  solvers.push_back(std::make_unique<OdeSolver>(false));
#ifdef PD_BENCH_WITH_ODE_DOOR
  solvers.push_back(std::make_unique<OdeSolver>(true));
#endif
}

}  // namespace pd::bench
