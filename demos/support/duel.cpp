#include "support/duel.hpp"

#include <fmt/core.h>

#include "support/demo_output.hpp"

namespace pd::demo {

namespace {

render::Headline figure(const Half& half, double shown_depth) {
  if (half.headline) return *half.headline;
  return {length_text(half.depth), "deepest penetration",
          half.depth > shown_depth ? render::palette::kTrouble : render::palette::kGood};
}

}  // namespace

DuelFilm::DuelFilm(const DuelPlan& plan, render::Renderer& renderer)
    : plan_(plan),
      renderer_(&renderer),
      camera_(render::frame_box(plan.view, render::panel_size(plan.size, 2), plan.direction)),
      strip_camera_(render::frame_box(plan.view, render::moment_size(), plan.direction)) {
  words_.title = plan.title;
  words_.statement = plan.strip_statement;
}

Expected<DuelFilm> DuelFilm::open(const DuelPlan& plan, render::Renderer& renderer) {
  DuelFilm result(plan, renderer);
  if (plan.video) {
    auto film = render::VideoWriter::open(plan.folder / (plan.name + ".mp4"), plan.size, kFramesPerSecond);
    if (!film) return film.error();
    result.film_ = std::move(film).value();
  }
  std::filesystem::create_directories(plan.folder / "frames");
  return result;
}

Expected<render::Panel> DuelFilm::draw_half(const Half& half) {
  // Grid and shadows are those of the stage, whatever is on it.
  render::Scene scene = half.scene;
  scene.focus = plan_.view;
  auto drawn = renderer_->draw(scene, camera_, render::panel_size(plan_.size, 2));
  if (!drawn) return drawn.error();
  render::Panel panel{std::move(drawn).value(), half.heading};
  render::Annotation words;
  words.status = half.status;
  words.headlines = {figure(half, plan_.shown_depth)};
  words.sparkline = half.curve;
  render::annotate(panel.image, words);
  return panel;
}

Expected<int> DuelFilm::add_frame(const Half& left, const Half& right, const std::string& said, int repeats) {
  std::vector<render::Panel> panels;
  for (const Half* half : {&left, &right}) {
    auto panel = draw_half(*half);
    if (!panel) return panel.error();
    panels.push_back(std::move(panel).value());
  }
  const render::Image picture = render::side_by_side(panels, plan_.title, said, plan_.size);
  const auto path = plan_.folder / "frames" / fmt::format("{}_{:04d}.png", plan_.name, frames_);
  const auto written = render::write_png(picture, path);
  if (!written) return written.error();
  for (int k = 0; film_ && k < repeats; ++k) {
    const auto added = film_->add(picture);
    if (!added) return added.error();
  }
  return ++frames_;
}

Expected<int> DuelFilm::add_moment(const Half& left, const Half& right, const std::string& time) {
  words_.left = left.heading;
  words_.right = right.heading;
  render::Moment moment;
  moment.time = time;
  for (const Half* half : {&left, &right}) {
    render::Scene scene = half->scene;
    scene.focus = plan_.view;
    scene.ground.scale_bar = false;
    for (render::Arrow& arrow : scene.arrows) arrow.label.clear();  // the figure below the picture says it
    auto drawn = renderer_->draw(scene, strip_camera_, render::moment_size());
    if (!drawn) return drawn.error();
    (half == &left ? moment.left : moment.right) = std::move(drawn).value();
  }
  moment.left_figure = figure(left, plan_.shown_depth);
  moment.right_figure = figure(right, plan_.shown_depth);
  moments_.push_back(std::move(moment));
  return static_cast<int>(moments_.size());
}

Expected<int> DuelFilm::finish() {
  if (!moments_.empty()) {
    const auto written =
        render::write_png(render::moment_strip(moments_, words_), plan_.folder / (plan_.name + "_strip.png"));
    if (!written) return written.error();
  }
  if (film_) {
    const auto finished = film_->finish();
    if (!finished) return finished.error();
  }
  return frames_;
}

}  // namespace pd::demo
