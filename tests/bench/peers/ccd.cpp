#include <ccd/ccd.h>
#include <ccd/quat.h>

#include "bench/peers/solver.hpp"

namespace pd::bench {

namespace {

/// A hull for libccd: a scan over all vertices, as its own examples and FCL's default do it.
struct CcdHull {
  std::vector<double> x;
  std::vector<double> y;
  std::vector<double> z;
  Vec3 centre;
  Mat3 rotation;
  Vec3 translation;
  mutable std::int64_t supports = 0;

  explicit CcdHull(const ConvexShape& shape) : centre(shape.polytope()->centre()) {
    for (const Vec3& p : vertices_of(shape)) {
      x.push_back(p.x());
      y.push_back(p.y());
      z.push_back(p.z());
    }
  }
};

void store(const Vec3& v, ccd_vec3_t* out) { ccdVec3Set(out, v.x(), v.y(), v.z()); }

void support(const void* object, const ccd_vec3_t* direction, ccd_vec3_t* out) {
  const auto& hull = *static_cast<const CcdHull*>(object);
  ++hull.supports;
  const Vec3 d = hull.rotation.transpose() * Vec3(direction->v[0], direction->v[1], direction->v[2]);
  std::size_t best = 0;
  double most = -std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < hull.x.size(); ++i) {
    const double value = hull.x[i] * d.x() + hull.y[i] * d.y() + hull.z[i] * d.z();
    if (value > most) {
      most = value;
      best = i;
    }
  }
  store(hull.rotation * Vec3(hull.x[best], hull.y[best], hull.z[best]) + hull.translation, out);
}

void centre(const void* object, ccd_vec3_t* out) {
  const auto& hull = *static_cast<const CcdHull*>(object);
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
  CcdHull a_;
  CcdHull b_;
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
