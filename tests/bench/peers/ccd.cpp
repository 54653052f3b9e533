#include <ccd/ccd.h>
#include <ccd/quat.h>

#include <cmath>

#include "bench/peers/solver.hpp"

namespace pd::bench {

namespace {

/// A body for libccd: a scan over all vertices, as its own examples and FCL's default do it, or the formula of a curved
/// core, and the margin.
struct CcdBody {
  const ConvexShape* shape;
  std::vector<double> x;
  std::vector<double> y;
  std::vector<double> z;
  Vec3 centre;
  Mat3 rotation;
  Vec3 translation;
  mutable std::int64_t supports = 0;

  explicit CcdBody(const ConvexShape& body)
      : shape(&body), centre(body.polytope() ? body.polytope()->centre() : Vec3(Vec3::Zero())) {
    if (body.polytope() == nullptr) return;
    for (const Vec3& p : vertices_of(body)) {
      x.push_back(p.x());
      y.push_back(p.y());
      z.push_back(p.z());
    }
  }
};

void store(const Vec3& v, ccd_vec3_t* out) { ccdVec3Set(out, v.x(), v.y(), v.z()); }

Vec3 farthest_vertex(const CcdBody& hull, const Vec3& d) {
  std::size_t best = 0;
  double most = -std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < hull.x.size(); ++i) {
    const double value = hull.x[i] * d.x() + hull.y[i] * d.y() + hull.z[i] * d.z();
    if (value > most) {
      most = value;
      best = i;
    }
  }
  return {hull.x[best], hull.y[best], hull.z[best]};
}

/// Axes run along z.
Vec3 farthest_point(const CcdBody& body, const Vec3& d) {
  const ConvexShape::Core& core = body.shape->core();
  if (std::holds_alternative<ConvexPolytope>(core)) return farthest_vertex(body, d);
  if (const auto* e = std::get_if<Ellipsoid>(&core)) {
    const Vec3 scaled = e->radii.cwiseProduct(d);
    return e->radii.cwiseProduct(scaled) / scaled.norm();
  }
  if (const auto* spheres = std::get_if<SphereHull>(&core)) return spheres->support(d);
  const double across = std::sqrt(d.x() * d.x() + d.y() * d.y());
  const auto rim = [&](double radius, double z) {
    return across > 0 ? Vec3(d.x() * radius / across, d.y() * radius / across, z) : Vec3(0, 0, z);
  };
  if (const auto* c = std::get_if<Cylinder>(&core)) return rim(c->radius, std::copysign(c->half_height, d.z()));
  const auto& cone = std::get<Cone>(core);
  const bool apex = 2 * cone.half_height * d.z() > cone.radius * across;
  return apex ? Vec3(0, 0, cone.half_height) : rim(cone.radius, -cone.half_height);
}

void support(const void* object, const ccd_vec3_t* direction, ccd_vec3_t* out) {
  const auto& hull = *static_cast<const CcdBody*>(object);
  ++hull.supports;
  const Vec3 world(direction->v[0], direction->v[1], direction->v[2]);
  Vec3 point = hull.rotation * farthest_point(hull, hull.rotation.transpose() * world) + hull.translation;
  if (hull.shape->margin() > 0) point += hull.shape->margin() * world.normalized();
  store(point, out);
}

void centre(const void* object, ccd_vec3_t* out) {
  const auto& hull = *static_cast<const CcdBody*>(object);
  store(hull.rotation * hull.centre + hull.translation, out);
}

enum class CcdMethod : std::uint8_t { epa, mpr, gjk };

class CcdAttempt final : public Attempt {
 public:
  CcdAttempt(const Bodies& bodies, CcdMethod method) : method_(method), a_(bodies.a), b_(bodies.b) {
    CCD_INIT(&ccd_);
    ccd_.support1 = ccd_.support2 = support;
    ccd_.center1 = ccd_.center2 = centre;
    ccd_.max_iterations = 1000;  // GJK alone heeds it; without it GJK may cycle for ever
  }
  void stand(const Pose& a, const Pose& b) override {
    a_.rotation = a.rotation();
    a_.translation = a.translation();
    b_.rotation = b.rotation();
    b_.translation = b.translation();
  }
  void run() override {
    a_.supports = b_.supports = 0;
    if (method_ == CcdMethod::gjk) {
      status_ = ccdGJKIntersect(&a_, &b_, &ccd_) != 0 ? 0 : -1;
      return;
    }
    ccd_vec3_t position;
    const auto solve = method_ == CcdMethod::epa ? ccdGJKPenetration : ccdMPRPenetration;
    status_ = solve(&a_, &b_, &ccd_, &depth_, &direction_, &position);
  }
  [[nodiscard]] Answer answer() const override {
    if (method_ == CcdMethod::gjk) {
      return {status_ == 0, 0, Vec3::Zero(), status_ == 0 ? 0 : std::numeric_limits<double>::infinity()};
    }
    if (status_ != 0) return {};
    // libccd's direction moves B.
    return {true, depth_, Vec3(-depth_ * Vec3(direction_.v[0], direction_.v[1], direction_.v[2]))};
  }
  [[nodiscard]] double supports() const override { return static_cast<double>(a_.supports); }

 private:
  CcdMethod method_;
  CcdBody a_;
  CcdBody b_;
  ccd_t ccd_;
  int status_ = -1;
  double depth_ = 0;
  ccd_vec3_t direction_;
};

class CcdSolver final : public Solver {
 public:
  CcdSolver(std::string_view name, CcdMethod method) : name_(name), method_(method) {}
  [[nodiscard]] std::string_view name() const override { return name_; }
  [[nodiscard]] Precision precision() const override { return Precision::binary64; }
  [[nodiscard]] std::unique_ptr<Attempt> prepare(const Bodies& bodies) override {
    return std::make_unique<CcdAttempt>(bodies, method_);
  }

 private:
  std::string_view name_;
  CcdMethod method_;
};

}  // namespace

void add_ccd(Solvers& solvers) {
  static_assert(sizeof(ccd_real_t) == sizeof(double));
  solvers.push_back(std::make_unique<CcdSolver>("ccd-epa", CcdMethod::epa));
  solvers.push_back(std::make_unique<CcdSolver>("ccd-mpr", CcdMethod::mpr));
}

void add_ccd_apart(Solvers& solvers) { solvers.push_back(std::make_unique<CcdSolver>("ccd-gjk", CcdMethod::gjk)); }

}  // namespace pd::bench
