#include "pd/union_contact/patches.hpp"

#include <algorithm>

namespace pd {

namespace {

/// cos 25 degrees.
constexpr double kOnePatch = 0.9;
/// cos 60 degrees.
constexpr double kAlong = 0.5;
/// Depths of a resting contact differ by this share of the breaking threshold from step to step.
constexpr double kNoise = 1e-3;
/// Points that are nearer than this share of the breaking threshold are one. (Bullet merges points within all of it.)
constexpr double kMerge = 0.05;
/// cos 3 degrees: points that push no farther apart hold a body as one.
constexpr double kOneWay = 0.9986;
/// Points with a gap of this share of the breaking threshold are worth half of those that touch.
constexpr double kApart = 1.0 / 16;
/// The squared distances and areas of a point of the last step count so many times.
constexpr double kLasting = 1.2;

/// If there are so few points, each is compared with those that are kept; more are put in order first.
constexpr std::size_t kFew = 32;

/// The number of a piece's feature pair among those of all pieces.
std::int64_t feature_of_piece(std::int64_t feature, int i, int j) {
  const auto number = static_cast<std::uint64_t>(feature) * 0x9E3779B97F4A7C15ULL +
                      static_cast<std::uint64_t>(static_cast<std::uint32_t>(i)) * 0xC2B2AE3D27D4EB4FULL +
                      static_cast<std::uint64_t>(static_cast<std::uint32_t>(j)) * 0x165667B19E3779F9ULL;
  return static_cast<std::int64_t>(number >> 11U);
}

}  // namespace

bool Patches::overlap() const {
  return std::any_of(points_.begin(), points_.end(), [](const Point& point) { return point.contact.depth > 0; });
}

void Patches::clear() {
  points_.clear();
  patches_.clear();
}

void Patches::add(const ContactManifold& manifold, int piece, int i, int j) {
  for (int k = 0; k < manifold.count; ++k) {
    points_.push_back({{manifold.normal, manifold.points[static_cast<std::size_t>(k)], piece}, -1, false});
    std::int64_t& feature = points_.back().contact.feature_id;
    feature = feature_of_piece(feature, i, j);
  }
}

void Patches::keep_along(const Vec3& normal, double deepest) {
  std::erase_if(points_,
                [&](const Point& point) { return point.normal.dot(normal) < kAlong || point.contact.depth > deepest; });
}

void Patches::add(const PatchPoint& point, Patch& patch) {
  patch.points[static_cast<std::size_t>(patch.count++)] = point;
}

void Patches::go_on(std::span<const LastPatch> last) {
  for (std::size_t i = 0; i < last.size(); ++i) {
    const auto belongs = [&](const auto& of) { return last[i].normal.dot(of.normal) >= kOnePatch; };
    if (std::none_of(points_.begin(), points_.end(), belongs)) continue;
    if (std::any_of(patches_.begin(), patches_.end(), belongs)) continue;  // they have turned into one
    patches_.emplace_back();
    patches_.back().normal = last[i].normal;
    patches_.back().last = static_cast<int>(i);
  }
}

void Patches::sort_by_depth() {
  // Points are large: their numbers are sorted, and each is moved once.
  by_depth_.clear();
  for (std::size_t i = 0; i < points_.size(); ++i) by_depth_.emplace_back(-points_[i].contact.depth, i);
  std::sort(by_depth_.begin(), by_depth_.end());
  sorted_.clear();
  for (const auto& [depth, i] : by_depth_) sorted_.push_back(points_[i]);
  points_.swap(sorted_);
}

void Patches::choose(int most, double breaking_threshold, std::span<const LastPatch> last) {
  patches_.clear();
  go_on(last);
  sort_by_depth();
  for (Point& point : points_) {
    point.lasting = false;
    double nearest = -2;
    for (std::size_t i = 0; i < patches_.size(); ++i) {
      const double cosine = patches_[i].normal.dot(point.normal);
      if (cosine > nearest) {
        nearest = cosine;
        point.patch = static_cast<int>(i);
      }
    }
    if (nearest < kOnePatch && static_cast<int>(patches_.size()) < most) {
      point.patch = static_cast<int>(patches_.size());
      patches_.emplace_back();
      patches_.back().normal = point.normal;
    }
  }
  twins_.clear();
  for (std::size_t i = 0; i < patches_.size(); ++i) choose_in(static_cast<int>(i), breaking_threshold, last);
  add_twins(most, last);
}

void Patches::find_twins(double breaking_threshold) {
  const auto beside = [&](const Point* x, const Point* y) {
    const double squared = (x->contact.position_b - y->contact.position_b).squaredNorm();
    return squared < breaking_threshold * breaking_threshold;
  };
  // The twins come after the four.
  const auto num_chosen = static_cast<std::ptrdiff_t>(chosen_.size());
  for (const Point* point : left_) {
    if (point->contact.depth < -kNoise * breaking_threshold) break;
    if (static_cast<std::ptrdiff_t>(chosen_.size()) == num_chosen + 4) break;
    const auto near = [&](const Point* other) { return beside(point, other); };
    const auto repeats = [&](const Point* other) { return near(other) && point->normal.dot(other->normal) >= kOneWay; };
    if (std::any_of(chosen_.begin(), chosen_.begin() + num_chosen, near) &&
        std::none_of(chosen_.begin(), chosen_.end(), repeats)) {
      chosen_.push_back(point);
    }
  }
  const std::span<const Point* const> twins = std::span(chosen_).subspan(static_cast<std::size_t>(num_chosen));
  if (twins.empty()) return;
  Patch& patch = twins_.emplace_back();
  patch.normal = twins.front()->normal;
  for (const Point* twin : twins) add(*twin, patch);
}

void Patches::add_twins(int most, std::span<const LastPatch> last) {
  for (Patch& twin : twins_) {
    if (static_cast<int>(patches_.size()) == most) return;
    double nearest = kOnePatch;
    for (std::size_t i = 0; i < last.size(); ++i) {
      const auto number = static_cast<int>(i);
      const double cosine = last[i].normal.dot(twin.normal);
      const auto goes_on = [&](const Patch& patch) { return patch.last == number; };
      if (cosine < nearest || std::any_of(patches_.begin(), patches_.end(), goes_on)) continue;
      nearest = cosine;
      twin.last = number;
    }
    patches_.push_back(twin);
  }
}

void Patches::keep_one_of_each(int patch, double merge) {
  const auto repeats = [&](const Point& kept, const Point& point) {
    return (kept.contact.position_b - point.contact.position_b).squaredNorm() < merge * merge &&
           kept.normal.dot(point.normal) > kOnePatch;
  };
  left_.clear();
  if (points_.size() <= kFew) {
    for (const Point& point : points_) {
      if (point.patch != patch) continue;
      const auto repeated = [&](const Point* kept) { return repeats(*kept, point); };
      if (std::none_of(left_.begin(), left_.end(), repeated)) left_.push_back(&point);
    }
    return;
  }
  // No edge of a mesh is likely to run across this, so that few points lie level along it.
  const Vec3 way(0.36, 0.48, 0.8);
  places_.clear();
  for (std::size_t i = 0; i < points_.size(); ++i) {
    if (points_[i].patch == patch) places_.push_back({points_[i].contact.position_b.dot(way), i, false});
  }
  std::sort(places_.begin(), places_.end(), [](const Place& x, const Place& y) {
    return x.along < y.along || (x.along == y.along && x.point < y.point);
  });
  ranks_.resize(points_.size());
  for (std::size_t r = 0; r < places_.size(); ++r) ranks_[places_[r].point] = r;
  const double level = 1.01 * merge;
  for (std::size_t i = 0; i < points_.size(); ++i) {
    const Point& point = points_[i];
    if (point.patch != patch) continue;
    const std::size_t rank = ranks_[i];
    Place& here = places_[rank];
    const auto repeated_by = [&](const Place& other) { return other.kept && repeats(points_[other.point], point); };
    bool repeated = false;
    for (std::size_t k = rank; !repeated && k-- > 0 && here.along - places_[k].along < level;) {
      repeated = repeated_by(places_[k]);
    }
    for (std::size_t k = rank + 1; !repeated && k < places_.size() && places_[k].along - here.along < level; ++k) {
      repeated = repeated_by(places_[k]);
    }
    if (repeated) continue;
    here.kept = true;
    left_.push_back(&point);
  }
}

void Patches::choose_in(int index, double breaking_threshold, std::span<const LastPatch> last) {
  Patch& patch = patches_[static_cast<std::size_t>(index)];
  const Vec3& n = patch.normal;
  keep_one_of_each(index, kMerge * breaking_threshold);
  chosen_.clear();
  const auto take = [&](const Point* point) {
    add(*point, patch);
    chosen_.push_back(point);
    left_.erase(std::find(left_.begin(), left_.end(), point));
  };
  const auto best = [&](auto&& score) {
    const Point* first = nullptr;
    double most = 0;
    for (const Point* point : left_) {
      const double worth = score(*point);
      if (first != nullptr && !(most < worth)) continue;
      first = point;
      most = worth;
    }
    return first;
  };
  const auto place = [](const Point& point) -> const Vec3& { return point.contact.position_b; };
  const auto weight = [&](const Point& point) {
    const double gap = std::max(-point.contact.depth, 0.0) / (kApart * breaking_threshold);
    return (point.lasting ? kLasting : 1.0) / (1 + gap * gap);
  };
  if (left_.size() <= 4) {
    while (!left_.empty()) take(left_.front());
    return;
  }
  if (patch.last >= 0) {
    const LastPatch& before = last[static_cast<std::size_t>(patch.last)];
    for (Point& point : points_) {
      point.lasting = point.patch == index &&
                      std::any_of(before.places.begin(), before.places.begin() + before.count, [&](const Vec3& x) {
                        return (x - point.contact.position_b).squaredNorm() < breaking_threshold * breaking_threshold;
                      });
    }
  }
  // No face's edges are likely to have this direction.
  const Vec3 u = n.unitOrthogonal();
  const Vec3 out = u + 0.3 * n.cross(u);
  const double deep = left_.front()->contact.depth - kNoise * breaking_threshold;
  const bool goes_on =
      std::any_of(left_.begin(), left_.end(), [&](const Point* p) { return p->lasting && p->contact.depth >= deep; });
  const Point* first = best(
      [&](const Point& p) { return p.contact.depth >= deep && p.lasting == goes_on ? place(p).dot(out) : -1e300; });
  take(first);
  const Point* second = best([&](const Point& p) { return weight(p) * (place(p) - place(*first)).squaredNorm(); });
  take(second);
  const Vec3 across = n.cross(place(*second) - place(*first));
  const Point* third = best([&](const Point& p) { return weight(p) * (place(p) - place(*first)).dot(across); });
  const Point* fourth = best([&](const Point& p) { return -weight(p) * (place(p) - place(*first)).dot(across); });
  take(third);
  if (fourth != third) take(fourth);
  find_twins(breaking_threshold);
}

}  // namespace pd
