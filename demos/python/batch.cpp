#include "python/batch.hpp"

#include <pybind11/stl.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>

#include "pd/depth/derivatives.hpp"
#include "pd/depth/directional_depth.hpp"
#include "python/rows.hpp"

namespace pd::python {

namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

/// `row(i, workspace)` for every row, on `threads` threads.
template <class Row>
void for_each_row(std::int64_t count, int threads, Row&& row) {
  python::for_each_row(
      count, threads, []() -> Workspace& { return workspace(); }, row);
}

/// Poses of the rows, one for each or one for all: matrices [n, 4, 4], or an array of poses as the caller made them.
class RowPoses {
 public:
  RowPoses(py::handle poses, const char* argument) {
    if (py::isinstance<py::array>(poses) && py::reinterpret_borrow<py::array>(poses).dtype().kind() == 'O') {
      for (const py::handle pose : poses) made_.push_back(pose.cast<const Pose&>());
    } else {
      matrices_ = read_array(poses, argument, {-1, 4, 4});
    }
  }
  [[nodiscard]] std::int64_t count() const {
    return made_.empty() ? matrices_.shape(0) : static_cast<std::int64_t>(made_.size());
  }
  [[nodiscard]] Expected<Pose> of_row(std::int64_t i) const {
    const std::int64_t place = count() == 1 ? 0 : i;
    if (!made_.empty()) return made_[static_cast<std::size_t>(place)];
    return pose_of_matrix(matrices_.data() + 16 * place);
  }

 private:
  std::vector<Pose> made_;
  Array matrices_;
};

/// Bodies or poses of the rows: one for each, or one for all.
struct Pairs {
  std::vector<BodyRef> a, b;
  RowPoses poses_a, poses_b;
  std::int64_t count = 0;

  [[nodiscard]] const Body& body_a(std::int64_t i) const { return *a[a.size() == 1 ? 0 : static_cast<std::size_t>(i)]; }
  [[nodiscard]] const Body& body_b(std::int64_t i) const { return *b[b.size() == 1 ? 0 : static_cast<std::size_t>(i)]; }
  [[nodiscard]] Expected<Pose> pose_a(std::int64_t i) const { return poses_a.of_row(i); }
  [[nodiscard]] Expected<Pose> pose_b(std::int64_t i) const { return poses_b.of_row(i); }
};

Pairs read_pairs(std::vector<BodyRef> a, std::vector<BodyRef> b, py::handle poses_a, py::handle poses_b,
                 std::int64_t count) {
  Pairs pairs{std::move(a), std::move(b), RowPoses(poses_a, "poses_a"), RowPoses(poses_b, "poses_b"), count};
  const auto fits = [&](std::int64_t n) { return n == 1 || n == count; };
  if (!fits(static_cast<std::int64_t>(pairs.a.size())) || !fits(static_cast<std::int64_t>(pairs.b.size())) ||
      !fits(pairs.poses_a.count()) || !fits(pairs.poses_b.count())) {
    refuse("bad_value", "one of everything, or one a row", "pairs");
  }
  return pairs;
}

/// A column of `width` doubles a row, NaN where nothing is written.
struct Column {
  Column(std::int64_t count, py::ssize_t width)
      : array(width == 1 ? Array(count) : Array({static_cast<py::ssize_t>(count), width})),
        numbers(array.mutable_data()),
        stride(width) {
    std::fill_n(numbers, count * width, kNone);
  }
  void put(std::int64_t row, double number) { numbers[row] = number; }
  void put(std::int64_t row, const Vec3& vector, int offset = 0) {
    for (int k = 0; k < 3; ++k) numbers[row * stride + offset + k] = vector[k];
  }

  Array array;
  double* numbers;
  py::ssize_t stride;
};

template <class Integer>
struct Words {
  Words(std::int64_t count, py::ssize_t width)
      : array(width == 1 ? py::array_t<Integer>(count)
                         : py::array_t<Integer>({static_cast<py::ssize_t>(count), width})),
        numbers(array.mutable_data()) {
    std::fill_n(numbers, count * width, Integer{0});
  }
  py::array_t<Integer> array;
  Integer* numbers;
};

std::uint8_t code_of(const Error& error) { return static_cast<std::uint8_t>(static_cast<int>(error.code) + 1); }

/// The columns that every depth has.
struct DepthColumns {
  explicit DepthColumns(std::int64_t n)
      : error(n, 1),
        contact(n, 1),
        feature_a(n, 4),
        feature_b(n, 4),
        depth(n, 1),
        lower(n, 1),
        upper(n, 1),
        distance(n, 1),
        distance_lower(n, 1),
        distance_upper(n, 1),
        translation(n, 3),
        normal(n, 3),
        witness_a(n, 3),
        witness_b(n, 3),
        reached(n, 1),
        warm(n, 1) {}

  void put(std::int64_t i, const UnionDepth& answer) {
    contact.numbers[i] = static_cast<std::uint8_t>(answer.contact);
    put_feature(feature_a.numbers + 4 * i, answer.part_a, answer.feature_a);
    put_feature(feature_b.numbers + 4 * i, answer.part_b, answer.feature_b);
    depth.put(i, answer.depth);
    lower.put(i, answer.lower);
    upper.put(i, answer.upper);
    distance.put(i, answer.distance);
    distance_lower.put(i, answer.distance_lower);
    distance_upper.put(i, answer.distance_upper);
    translation.put(i, answer.translation);
    normal.put(i, answer.normal);
    witness_a.put(i, answer.witness_a);
    witness_b.put(i, answer.witness_b);
    reached.numbers[i] = answer.bracket_reached && answer.closed;
    warm.numbers[i] = answer.warm;
  }

  [[nodiscard]] py::dict fields() const {
    py::dict all;
    all["error"] = error.array;
    all["contact"] = contact.array;
    all["depth"] = depth.array;
    all["lower"] = lower.array;
    all["upper"] = upper.array;
    all["distance"] = distance.array;
    all["distance_lower"] = distance_lower.array;
    all["distance_upper"] = distance_upper.array;
    all["translation"] = translation.array;
    all["normal"] = normal.array;
    all["witness_a"] = witness_a.array;
    all["witness_b"] = witness_b.array;
    all["feature_a"] = feature_a.array;
    all["feature_b"] = feature_b.array;
    all["bracket_reached"] = reached.array;
    all["warm"] = warm.array;
    return all;
  }

  Words<std::uint8_t> error, contact;
  Words<std::int32_t> feature_a, feature_b;
  Column depth, lower, upper, distance, distance_lower, distance_upper, translation, normal, witness_a, witness_b;
  Words<bool> reached, warm;

 private:
  static void put_feature(std::int32_t* row, int part, const Feature& feature) {
    row[0] = static_cast<std::int32_t>(feature.kind);
    row[1] = part;
    row[2] = feature.first;
    row[3] = feature.second;
  }
};

using Indices = py::array_t<std::int64_t, py::array::c_style | py::array::forcecast>;

void answer_row(const Pairs& pairs, std::int64_t i, const QuerySettings& settings, Workspace& space, PairMemory* memory,
                DepthColumns& columns) {
  const Expected<Pose> pose_a = pairs.pose_a(i), pose_b = pairs.pose_b(i);
  if (!pose_a || !pose_b) {
    columns.error.numbers[i] = code_of(pose_a ? pose_b.error() : pose_a.error());
    return;
  }
  const Expected<UnionDepth> answer = ask(pairs.body_a(i), *pose_a, pairs.body_b(i), *pose_b, settings, space, memory);
  if (answer) {
    columns.put(i, *answer);
  } else {
    columns.error.numbers[i] = code_of(answer.error());
  }
}

/// @param starts  empty: every row alone, cold. Else the first rows of stretches, ascending from 0. The rows of a
/// stretch are frames of one pair, each started from the last: the same bits for any number of threads.
py::dict depth_rows(std::vector<BodyRef> a, std::vector<BodyRef> b, py::handle poses_a, py::handle poses_b,
                    std::int64_t count, const QuerySettings& settings, const Indices& starts, int threads) {
  const Pairs pairs = read_pairs(std::move(a), std::move(b), poses_a, poses_b, count);
  const std::int64_t stretches = starts.size();
  const auto start = [&, first = starts.data()](std::int64_t s) { return s < stretches ? first[s] : count; };
  for (std::int64_t s = 0; s < stretches; ++s) {
    if (start(s) < 0 || start(s) > start(s + 1)) refuse("out_of_range", "rows in ascending order", "starts");
  }
  DepthColumns columns(count);
  {
    const Unlocked unlocked;
    if (stretches == 0) {
      for_each_row(count, threads,
                   [&](std::int64_t i, Workspace& space) { answer_row(pairs, i, settings, space, nullptr, columns); });
    } else {
      for_each_row(stretches, threads, [&](std::int64_t s, Workspace& space) {
        PairMemory memory;
        for (std::int64_t i = start(s); i < start(s + 1); ++i) answer_row(pairs, i, settings, space, &memory, columns);
      });
    }
  }
  return columns.fields();
}

py::dict directional_rows(std::vector<BodyRef> a, std::vector<BodyRef> b, py::handle poses_a, py::handle poses_b,
                          py::handle directions, std::int64_t count, int threads) {
  const Pairs pairs = read_pairs(std::move(a), std::move(b), poses_a, poses_b, count);
  const Array along = read_array(directions, "directions", {-1, 3});
  if (along.shape(0) != 1 && along.shape(0) != count) refuse("bad_value", "one, or one a row", "directions");
  Words<std::uint8_t> error(count, 1), contact(count, 1);
  Column depth(count, 1), lower(count, 1), upper(count, 1), normal(count, 3);
  const auto answer = [&](std::int64_t i, Workspace& space) {
    const Expected<Pose> pose_a = pairs.pose_a(i), pose_b = pairs.pose_b(i);
    const Vec3 direction = Eigen::Map<const Vec3>(along.data() + (along.shape(0) == 1 ? 0 : 3 * i));
    const Body &body_a = pairs.body_a(i), &body_b = pairs.body_b(i);
    const auto take = [&](const auto& found) {
      if (!found) {
        error.numbers[i] = code_of(found.error());
        return;
      }
      contact.numbers[i] = static_cast<std::uint8_t>(found->contact);
      depth.put(i, found->depth);
      lower.put(i, found->lower);
      upper.put(i, found->upper);
      normal.put(i, found->normal);
    };
    if (!pose_a || !pose_b) {
      error.numbers[i] = code_of(pose_a ? pose_b.error() : pose_a.error());
    } else if (body_a.convex() != nullptr && body_b.convex() != nullptr) {
      take(finite_or_error(
          directional_depth({body_a.convex(), *pose_a}, {body_b.convex(), *pose_b}, direction, space.scratch)));
    } else {
      const Compound whole_a = body_a.compound(), whole_b = body_b.compound();
      take(finite_or_error(directional_depth({&whole_a, *pose_a}, {&whole_b, *pose_b}, direction, space.scratch)));
    }
  };
  {
    const Unlocked unlocked;
    for_each_row(count, threads, answer);
  }
  py::dict fields;
  fields["error"] = error.array;
  fields["contact"] = contact.array;
  fields["depth"] = depth.array;
  fields["lower"] = lower.array;
  fields["upper"] = upper.array;
  fields["normal"] = normal.array;
  return fields;
}

py::dict derivative_rows(std::vector<BodyRef> a, std::vector<BodyRef> b, py::handle poses_a, py::handle poses_b,
                         std::int64_t count, int threads) {
  const Pairs pairs = read_pairs(std::move(a), std::move(b), poses_a, poses_b, count);
  DepthColumns columns(count);
  Column signed_depth(count, 1), by_a(count, 6), by_b(count, 6);
  Words<bool> direction(count, 1), witness(count, 1), stable(count, 1);
  const auto answer = [&](std::int64_t i, Workspace& space) {
    const Expected<Pose> pose_a = pairs.pose_a(i), pose_b = pairs.pose_b(i);
    const ConvexShape *const shape_a = pairs.body_a(i).convex(), *const shape_b = pairs.body_b(i).convex();
    if (!pose_a || !pose_b) {
      columns.error.numbers[i] = code_of(pose_a ? pose_b.error() : pose_a.error());
    } else if (shape_a == nullptr || shape_b == nullptr) {
      columns.error.numbers[i] = code_of({ErrorCode::unsupported, "", ""});
    } else {
      const DepthDerivatives found = depth_derivatives({shape_a, *pose_a}, {shape_b, *pose_b}, space.scratch);
      if (!is_finite(found.answer)) {
        columns.error.numbers[i] = code_of(past_doubles(""));
        return;
      }
      UnionDepth depth;
      static_cast<PenetrationDepth&>(depth) = found.answer;
      columns.put(i, depth);
      signed_depth.put(i, found.signed_depth);
      by_a.put(i, found.by_a.translation);
      by_a.put(i, found.by_a.rotation, 3);
      by_b.put(i, found.by_b.translation);
      by_b.put(i, found.by_b.rotation, 3);
      direction.numbers[i] = found.unique_direction;
      witness.numbers[i] = found.unique_witness;
      stable.numbers[i] = found.stable_features;
    }
  };
  {
    const Unlocked unlocked;
    for_each_row(count, threads, answer);
  }
  py::dict fields = columns.fields();
  fields["signed_depth"] = signed_depth.array;
  fields["unique_direction"] = direction.array;
  fields["unique_witness"] = witness.array;
  fields["stable_features"] = stable.array;
  fields["by_a"] = by_a.array;
  fields["by_b"] = by_b.array;
  return fields;
}

py::dict manifold_rows(std::vector<BodyRef> a, std::vector<BodyRef> b, py::handle poses_a, py::handle poses_b,
                       std::int64_t rows, double threshold, int threads) {
  const Pairs pairs = read_pairs(std::move(a), std::move(b), poses_a, poses_b, rows);
  Words<std::uint8_t> error(rows, 1), count(rows, 1);
  Words<std::int64_t> ids(rows, 4);
  Column normal(rows, 3), on_a(rows, 12), on_b(rows, 12), depth(rows, 4);
  const auto answer = [&](std::int64_t i, Workspace& space) {
    const Expected<Pose> pose_a = pairs.pose_a(i), pose_b = pairs.pose_b(i);
    const ConvexShape *const shape_a = pairs.body_a(i).convex(), *const shape_b = pairs.body_b(i).convex();
    if (!pose_a || !pose_b) {
      error.numbers[i] = code_of(pose_a ? pose_b.error() : pose_a.error());
      return;
    }
    if (shape_a == nullptr || shape_b == nullptr) {
      error.numbers[i] = code_of({ErrorCode::unsupported, "", ""});
      return;
    }
    const PosedShape first{shape_a, *pose_a}, second{shape_b, *pose_b};
    const PenetrationDepth found = penetration_depth(first, second, space.scratch);
    const ContactManifold manifold = contact_manifold(first, second, found, threshold, space.manifold);
    if (!is_finite(manifold)) {
      error.numbers[i] = code_of(past_doubles(""));
      return;
    }
    count.numbers[i] = static_cast<std::uint8_t>(manifold.count);
    normal.put(i, manifold.normal);
    for (int k = 0; k < manifold.count; ++k) {
      const ContactPoint& point = manifold.points[static_cast<std::size_t>(k)];
      on_a.put(i, point.position_a, 3 * k);
      on_b.put(i, point.position_b, 3 * k);
      depth.numbers[4 * i + k] = point.depth;
      ids.numbers[4 * i + k] = point.feature_id;
    }
  };
  {
    const Unlocked unlocked;
    for_each_row(rows, threads, answer);
  }
  py::dict fields;
  fields["error"] = error.array;
  fields["count"] = count.array;
  fields["normal"] = normal.array;
  fields["position_a"] = on_a.array;
  fields["position_b"] = on_b.array;
  fields["point_depth"] = depth.array;
  fields["feature_id"] = ids.array;
  return fields;
}

}  // namespace

void bind_batch_queries(py::module_& module) {
  module.def("depth_rows", &depth_rows);
  module.def("directional_rows", &directional_rows);
  module.def("manifold_rows", &manifold_rows);
  module.def("derivative_rows", &derivative_rows);
  py::list names;
  names.append("");
  for (int code = 0; code <= static_cast<int>(ErrorCode::limit_exceeded); ++code) {
    names.append(std::string(to_string(static_cast<ErrorCode>(code))));
  }
  module.attr("ERRORS") = py::tuple(names);
}

}  // namespace pd::python
