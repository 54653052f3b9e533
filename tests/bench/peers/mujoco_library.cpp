/// The installed MuJoCo as its users call it: a model of two geoms and `mj_collision`, with its own contacts and with
/// pdepth's.
#include <mujoco/mujoco.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <stdexcept>
#include <string>

#include "bench/peers/solver.hpp"
#include "mujoco/mujoco_model.hpp"
#include "pd/mujoco/install.hpp"

namespace pd::bench {

namespace {

std::string text_of(double x) {
  char text[40];
  std::snprintf(text, sizeof text, "%.9g ", x);
  return text;
}

/// A body as MuJoCo's XML has it: the attributes of its geom, and the mesh to which they refer.
struct GeomText {
  std::string geom, mesh;
};

GeomText text_of(const ConvexShape& shape, const std::string& name) {
  if (const auto half = half_extents_of(shape)) {
    return {"type='box' size='" + text_of(half->x()) + text_of(half->y()) + text_of(half->z()) + "'", ""};
  }
  std::string vertices;
  for (const Vec3& p : vertices_of(shape)) vertices += text_of(p.x()) + text_of(p.y()) + text_of(p.z());
  return {"type='mesh' mesh='" + name + "'", "<mesh name='" + name + "' vertex='" + vertices + "'/>"};
}

/// The compiler of models moves a mesh to its own axes and rounds it there. The corners are put back in their own
/// frame, so that MuJoCo works on the numbers of the record. Neighbours on the hull stay neighbours.
void put_corners_back(mjModel& model, int geom, const ConvexShape& shape) {
  const int mesh = model.geom_dataid[geom];
  double radius = 0;
  for (const Vec3& p : vertices_of(shape)) radius = std::max(radius, p.norm());
  model.geom_rbound[geom] = radius;
  if (mesh < 0) return;
  const scenes::Points corners = vertices_of(shape);
  if (model.mesh_vertnum[mesh] != static_cast<int>(corners.size())) throw std::runtime_error("MuJoCo merged corners");
  float* written = model.mesh_vert + 3 * model.mesh_vertadr[mesh];
  for (const Vec3& p : corners) {
    for (int k = 0; k < 3; ++k) *written++ = static_cast<float>(p[k]);
  }
}

test::MujocoModel model_of(const Bodies& bodies) {
  const GeomText a = text_of(bodies.a, "a"), b = text_of(bodies.b, "b");
  test::MujocoModel model = test::two_geoms(a.geom, b.geom, a.mesh + b.mesh);
  put_corners_back(*model, 0, bodies.a);
  put_corners_back(*model, 1, bodies.b);
  return model;
}

class MujocoLibraryAttempt final : public Attempt {
 public:
  explicit MujocoLibraryAttempt(const Bodies& bodies) : model_(model_of(bodies)), data_(test::mujoco_data(model_)) {}
  void stand(const Pose& a, const Pose& b) override {
    place(0, a);
    place(1, b);
  }
  void run() override { mj_collision(model_.get(), data_.get()); }
  /// The deepest contact. MuJoCo's normal points from the first geom to the second.
  [[nodiscard]] Answer answer() const override {
    const mjContact* deepest = nullptr;
    for (int i = 0; i < data_->ncon; ++i) {
      if (deepest == nullptr || data_->contact[i].dist < deepest->dist) deepest = data_->contact + i;
    }
    if (deepest == nullptr || !(deepest->dist < 0)) return {};
    const Vec3 normal(deepest->frame[0], deepest->frame[1], deepest->frame[2]);
    return {true, -deepest->dist, (deepest->geom1 == 0 ? deepest->dist : -deepest->dist) * normal};
  }

 private:
  void place(int geom, const Pose& pose) {
    for (int i = 0; i < 3; ++i) data_->geom_xpos[3 * geom + i] = pose.translation()[i];
    for (int i = 0; i < 9; ++i) data_->geom_xmat[9 * geom + i] = pose.rotation()(i / 3, i % 3);
  }

  test::MujocoModel model_;
  test::MujocoData data_;
};

class MujocoLibrary final : public Solver {
 public:
  /// @param through_door  pdepth's contacts, by its door into MuJoCo
  explicit MujocoLibrary(bool through_door) : through_door_(through_door) {
    // Warnings would go into a file of the working folder, and an error would end the program as if all were well.
    mju_user_warning = [](const char*) {};
    mju_user_error = [](const char* message) {
      std::fprintf(stderr, "%s\n", message);
      std::abort();
    };
  }
  [[nodiscard]] std::string_view name() const override { return through_door_ ? kMujocoByPdepth : kMujoco; }
  [[nodiscard]] Precision precision() const override { return Precision::binary32; }
  /// False for meshes that MuJoCo's compiler of models refuses.
  [[nodiscard]] bool takes(const Bodies& bodies) const override {
    try {
      return model_of(bodies) != nullptr;
    } catch (const std::runtime_error&) {
      return false;
    }
  }
  [[nodiscard]] std::unique_ptr<Attempt> prepare(const Bodies& bodies) override {
    // A run asks one solver: the table is not changed back and forth.
    if (through_door_ != installed_) {
      installed_ = through_door_ && install_mujoco().has_value();
      if (!through_door_) uninstall_mujoco();
    }
    return std::make_unique<MujocoLibraryAttempt>(bodies);
  }

 private:
  bool through_door_;
  static inline bool installed_ = false;  ///< in the table, which belongs to the process
};

}  // namespace

void add_mujoco_library(Solvers& solvers) {
  solvers.push_back(std::make_unique<MujocoLibrary>(false));
  solvers.push_back(std::make_unique<MujocoLibrary>(true));
}

}  // namespace pd::bench
