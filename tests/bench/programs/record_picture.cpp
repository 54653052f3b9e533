/// @file
/// One state of a contact record as a picture: its bodies, each once, and the contact points that the engine reported.
/// Points are red if the audit calls their pair a phantom or wrong by more than 1e-3 of its size; bodies are red if the
/// engine missed that they meet by more than 1e-6.
#include <fcntl.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <cstdio>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "audit/audit_stream.hpp"
#include "pd/render/camera.hpp"
#include "pd/render/image.hpp"
#include "pd/render/renderer.hpp"

namespace {

using namespace pd;
namespace palette = render::palette;

constexpr render::Insets kInsets{.left = 0.04, .right = 0.04, .top = 0.05, .bottom = 0.05};
/// Relative to a pair's size.
constexpr double kWrong = 1e-3, kMissed = 1e-6;

struct View {
  int width = 640;
  int height = 440;
  double azimuth = -58;
  double elevation = 28;
  double widest = 1;  ///< bodies that are wider than this are left out: grounds and walls
};

class Drawing {
 public:
  explicit Drawing(const View& view) : view_(view) {}

  void add(const audit::RecordedContact& contact, const audit::Judgement& judgement) {
    for (const auto& [shape, pose] : {std::pair{contact.a, contact.pose_a}, std::pair{contact.b, contact.pose_b}}) {
      const Parts parts = parts_of(*shape, pose);
      for (std::size_t i = parts.begin; judgement.missed && i < parts.end; ++i) {
        scene_.bodies[i].colour = palette::kDepth;
        scene_.bodies[i].opacity = 0.8F;
      }
    }
    const double depth_error = std::abs(judgement.depth_error.value_or(0));
    const bool wrong = judgement.phantom || depth_error > kWrong || judgement.normal_excess.value_or(0) > kWrong;
    if (!contact.report || !contact.report->normal) return;
    for (const auto& point : contact.report->points) {
      if (!point.position_a || !point.position_b) continue;
      scene_.discs.push_back({.point = (*point.position_a + *point.position_b) / 2,
                              .normal = contact.report->normal->normalized(),
                              .colour = wrong ? palette::kDepth : palette::kContact});
    }
  }

  /// @return false with a line on the standard error stream if nothing can be drawn
  bool write(const std::string& path) {
    const render::Box box = render::bounds(scene_);
    scene_.ground.height = std::isfinite(ground_) ? ground_ : box.lower.z();
    scene_.ground.scale_bar = false;
    scene_.focus = box;
    auto created = render::Renderer::create();
    if (!created) return complain(created.error().message);
    render::Renderer renderer = std::move(created).value();
    const render::Size size{view_.width, view_.height};
    const auto camera = render::frame_box(box, size, {view_.azimuth, view_.elevation}, kInsets);
    const auto image = renderer.draw(scene_, camera, size);
    if (!image) return complain(image.error().message);
    const auto written = render::write_png(*image, path);
    return written.has_value() || complain(written.error().message);
  }
  [[nodiscard]] std::size_t bodies() const { return scene_.bodies.size(); }
  [[nodiscard]] std::size_t points() const { return scene_.discs.size(); }

 private:
  static bool complain(const std::string& message) {
    std::fprintf(stderr, "%s\n", message.c_str());
    return false;
  }

  /// The places of a body's parts in the scene; none for what is not drawn.
  struct Parts {
    std::size_t begin = 0, end = 0;
  };

  Parts parts_of(const audit::RecordedShape& shape, const Pose& pose) {
    if (shape.halfspace) {
      const Vec3 up = pose.rotation() * shape.halfspace->normal;
      if (up.z() > 0.999) ground_ = pose.translation().z() + shape.halfspace->offset;
      return {};
    }
    if (shape.extent > view_.widest) return {};
    const Vec3& at = pose.translation();
    const auto [place, is_new] = seen_.try_emplace({static_cast<double>(shape.line), at.x(), at.y(), at.z()}, Parts{});
    if (!is_new) return place->second;
    const auto posed = shape.body->posed(pose);
    if (!posed) return {};
    place->second = {scene_.bodies.size(), scene_.bodies.size() + posed->size()};
    const auto number = static_cast<std::uint32_t>(seen_.size());
    for (const PosedShape& part : *posed) {
      render::MeshRef& mesh = meshes_[part.shape];
      if (!mesh) mesh = render::shape_mesh(*part.shape);
      scene_.bodies.push_back({.mesh = mesh,
                               .pose = part.pose,
                               .colour = palette::varied(palette::categorical(number % 6), number),
                               .opacity = 0.5F});
    }
    return place->second;
  }

  View view_;
  render::Scene scene_;
  double ground_ = std::nan("");
  std::map<std::vector<double>, Parts> seen_;  ///< by a shape's line and place
  std::map<const ConvexShape*, render::MeshRef> meshes_;
};

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("A state of a contact record as a picture");
  std::string record, out;
  View view;
  app.add_option("record", record, "a record of one state")->required()->check(CLI::ExistingFile);
  app.add_option("out", out, "the PNG")->required();
  app.add_option("--width", view.width)->check(CLI::Range(16, 8192));
  app.add_option("--height", view.height)->check(CLI::Range(16, 8192));
  app.add_option("--azimuth", view.azimuth, "of the view, in degrees");
  app.add_option("--elevation", view.elevation, "of the view, in degrees");
  app.add_option("--widest", view.widest, "bodies that are wider are left out");
  CLI11_PARSE(app, argc, argv);
  const int input = ::open(record.c_str(), O_RDONLY | O_CLOEXEC);
  audit::Audit audit;
  Drawing drawing(view);
  audit::audit_record(
      input, {.tolerance = kMissed},
      [&](const auto& contact, const auto& judgement, std::int64_t) { drawing.add(contact, judgement); }, audit);
  ::close(input);
  if (audit.end != audit::Audit::End::read || drawing.bodies() == 0) {
    std::fprintf(stderr, "%s holds no state that can be drawn\n", record.c_str());
    return 1;
  }
  if (!drawing.write(out)) return 1;
  std::printf("%zu bodies, %zu contact points\n", drawing.bodies(), drawing.points());
}
