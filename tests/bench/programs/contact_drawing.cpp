/// @file
/// The contacts that `pd::draw_contacts` hands to a `btIDebugDraw`, as a picture: a plate that is deep in the floor, a
/// turned block that is deep in the plate, and a ball and a block that touch them.
#include <btBulletDynamicsCommon.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "pd/bullet/debug_draw.hpp"
#include "pd/bullet/install.hpp"
#include "pd/bullet/scalar.hpp"
#include "pd/render/camera.hpp"
#include "pd/render/image.hpp"
#include "pd/render/renderer.hpp"

namespace {

using namespace pd;
namespace palette = render::palette;

/// Puts what it is asked to draw into a scene.
class SceneDrawer final : public btIDebugDraw {
 public:
  explicit SceneDrawer(render::Scene& scene) : scene_(scene) {}

  void drawLine(const btVector3& from, const btVector3& to, const btVector3& colour) override {
    const bool deep = colour.x() > colour.z();
    scene_.lines.push_back({.points = {to_pd(from), to_pd(to)},
                            .colour = deep ? palette::kDepth : palette::categorical(0),
                            .width_pixels = 3});
  }
  void draw3dText(const btVector3& at, const char* text) override { scene_.labels.push_back({to_pd(at), text}); }
  void drawContactPoint(const btVector3&, const btVector3&, btScalar, int, const btVector3&) override {}
  void reportErrorWarning(const char*) override {}
  void setDebugMode(int) override {}
  [[nodiscard]] int getDebugMode() const override { return DBG_DrawContactPoints; }

 private:
  render::Scene& scene_;
};

/// Bodies in a Bullet world and in the picture.
class World {
 public:
  World() : world_(&dispatcher_, &broadphase_, &impulses_, &configuration_) {
    install(world_, solver_);
    add(std::make_unique<btStaticPlaneShape>(btVector3(0, 0, 1), btScalar(0)), btTransform::getIdentity(), 0);
  }
  ~World() {
    for (const auto& body : bodies_) world_.removeRigidBody(body.get());
  }
  World(const World&) = delete;
  World& operator=(const World&) = delete;

  void add_box(const Vec3& half_extents, const btTransform& pose) {
    add(std::make_unique<btBoxShape>(to_bullet(half_extents)), pose, 1);
    draw(*ConvexPolytope::box(half_extents), pose);
  }
  void add_ball(double radius, const btTransform& pose) {
    add(std::make_unique<btSphereShape>(btScalar(radius)), pose, 1);
    draw(*ConvexShape::sphere(radius), pose);
  }
  /// The picture's scene with the contacts of all bodies where they are.
  render::Scene& with_contacts() {
    world_.performDiscreteCollisionDetection();
    SceneDrawer drawer(scene_);
    ContactDrawing drawing;
    drawing.normal_length = 0.35;
    draw_contacts(world_, drawer, drawing);
    return scene_;
  }

 private:
  void add(std::unique_ptr<btCollisionShape> shape, const btTransform& pose, double mass) {
    const btRigidBody::btRigidBodyConstructionInfo info(btScalar(mass), nullptr, shape.get(), btVector3(1, 1, 1));
    bodies_.push_back(std::make_unique<btRigidBody>(info));
    bodies_.back()->setWorldTransform(pose);
    world_.addRigidBody(bodies_.back().get());
    shapes_.push_back(std::move(shape));
  }
  void draw(const ConvexShape& shape, const btTransform& pose) {
    scene_.bodies.push_back({.mesh = render::shape_mesh(shape),
                             .pose = to_pd(pose),
                             .colour = palette::categorical(scene_.bodies.size() % 6),
                             .opacity = 0.45F});
  }

  btDefaultCollisionConfiguration configuration_;
  btCollisionDispatcher dispatcher_{&configuration_};
  btDbvtBroadphase broadphase_;
  btSequentialImpulseConstraintSolver impulses_;
  BulletPenetrationDepthSolver solver_;
  std::vector<std::unique_ptr<btCollisionShape>> shapes_;
  std::vector<std::unique_ptr<btRigidBody>> bodies_;
  btDiscreteDynamicsWorld world_;
  render::Scene scene_;
};

btTransform turned(double degrees, double x, double y, double z) {
  return btTransform(btQuaternion(btVector3(0, 0, 1), btRadians(btScalar(degrees))),
                     btVector3(btScalar(x), btScalar(y), btScalar(z)));
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("The contacts that pd::draw_contacts draws, as a picture");
  std::string out;
  render::Size size{960, 540};
  app.add_option("out", out, "the PNG")->required();
  app.add_option("--width", size.width)->check(CLI::Range(16, 8192));
  app.add_option("--height", size.height)->check(CLI::Range(16, 8192));
  CLI11_PARSE(app, argc, argv);

  World world;
  world.add_box({1, 0.7, 0.2}, turned(0, 0, 0, 0.125));
  world.add_box({0.35, 0.35, 0.3}, turned(30, -0.35, 0, 0.5));
  world.add_ball(0.3, turned(0, 0.6, 0.1, 0.55));
  world.add_box({0.2, 0.5, 0.35}, turned(0, 1.21, 0, 0.345));
  render::Scene& scene = world.with_contacts();
  scene.ground.scale_bar = false;
  const render::Box box = render::bounds(scene);
  scene.focus = box;
  auto created = render::Renderer::create();
  if (!created) {
    std::fprintf(stderr, "%s\n", created.error().message.c_str());
    return 1;
  }
  render::Renderer renderer = std::move(created).value();
  const render::Insets insets{.left = 0.05, .right = 0.05, .top = 0.08, .bottom = 0.06};
  const auto image = renderer.draw(scene, render::frame_box(box, size, {-62, 24}, insets), size);
  const auto written = image ? render::write_png(*image, out) : Expected<std::filesystem::path>(image.error());
  if (!written) {
    std::fprintf(stderr, "%s\n", written.error().message.c_str());
    return 1;
  }
  std::printf("%zu lines and %zu depths\n", scene.lines.size(), scene.labels.size());
}
