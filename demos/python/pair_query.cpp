#include "python/pair_query.hpp"

#include <pybind11/stl.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string_view>

#include "pd/depth/derivatives.hpp"
#include "pd/depth/difference_queries.hpp"
#include "pd/depth/directional_depth.hpp"

namespace pd::python {

namespace {

/// An answer, and the shapes whose numbers it names: Python's own objects, which alone know their class and arguments.
struct PairAnswer {
  UnionDepth depth;
  py::object a;
  py::object b;
};

const Body& body_of(const py::object& shape) { return shape.cast<const Body&>(); }

py::object feature_of(const Body& body, int part, const Feature& feature) {
  if (feature.kind == Feature::Kind::none) return py::none();
  constexpr const char* kWords[] = {"none", "vertex", "edge", "facet"};
  return py::make_tuple(kWords[static_cast<int>(feature.kind)], py::tuple(py::cast(feature_ids(body, part, feature))));
}

py::dict statistics_of(const Statistics& statistics) {
  py::dict fields;
  fields["support_calls"] = statistics.support_calls;
  fields["facets_visited"] = statistics.facets_visited;
  fields["exact_signs"] = statistics.exact_signs;
  return fields;
}

std::string repr_of_answer(const PairAnswer& answer) {
  const UnionDepth& depth = answer.depth;
  const auto number = [](double x) { return py::repr(py::float_(x)).cast<std::string>(); };
  std::string text = "<Depth " + std::string(to_string(depth.contact));
  if (depth.contact == ContactClass::overlapping) {
    text += " depth=" + number(depth.depth) + " in [" + number(depth.lower) + ", " + number(depth.upper) + "]";
  } else if (depth.contact == ContactClass::separated) {
    text += " distance=" + number(depth.distance);
  }
  return text + ">";
}

Expected<UnionDepth> ask_convex(const ConvexShape& a, const Pose& pose_a, const ConvexShape& b, const Pose& pose_b,
                                const QuerySettings& settings, Workspace& space, WarmCertificate* warm) {
  if (!supports(settings.depth.method, a, b)) {
    return Error{ErrorCode::unsupported,
                 "the method '" + std::string(to_string(settings.depth.method)) +
                     "' does not answer for these shapes; 'auto' does",
                 "method"};
  }
  UnionDepth answer;
  static_cast<PenetrationDepth&>(answer) =
      penetration_depth({&a, pose_a}, {&b, pose_b}, space.scratch, settings.depth, warm);
  return answer;
}

struct PosedBody {
  const Body& body;
  const Pose& pose;
};

/// The class alone: the place of the origin in the difference.
Expected<UnionDepth> ask_class(const PosedBody& a, const PosedBody& b, Workspace& space) {
  const auto found = [&]() -> Expected<ContactClass> {
    if (a.body.convex() != nullptr && b.body.convex() != nullptr) {
      return point_in_difference({a.body.convex(), a.pose}, {b.body.convex(), b.pose}, Vec3::Zero(), space.scratch);
    }
    const Compound whole_a = a.body.compound(), whole_b = b.body.compound();
    return point_in_difference({&whole_a, a.pose}, {&whole_b, b.pose}, Vec3::Zero(), space.scratch);
  }();
  if (!found) return found.error();
  UnionDepth answer;
  answer.contact = *found;
  return answer;
}

Expected<UnionDepth> ask_any(const PosedBody& a, const PosedBody& b, const QuerySettings& settings, Workspace& space,
                             PairMemory* memory) {
  if (settings.class_alone) return ask_class(a, b, space);
  if (a.body.convex() != nullptr && b.body.convex() != nullptr) {
    return ask_convex(*a.body.convex(), a.pose, *b.body.convex(), b.pose, settings, space,
                      memory == nullptr ? nullptr : &memory->convex);
  }
  if (settings.depth.method != Method::automatic) {
    return Error{ErrorCode::unsupported, "unions of parts are answered by the method 'auto'", "method"};
  }
  const Compound whole_a = a.body.compound(), whole_b = b.body.compound();
  return penetration_depth({&whole_a, a.pose}, {&whole_b, b.pose}, space.scratch, {.delta = settings.union_delta},
                           memory == nullptr ? nullptr : &memory->unions);
}

bool is_word(py::handle value, std::string_view word) {
  return py::isinstance<py::str>(value) && value.cast<std::string>() == word;
}

std::string repr_of(py::handle value) { return py::repr(value).cast<std::string>(); }

/// A pair whose memory the caller keeps: `Warm` of Python.
PairAnswer ask_pair(const py::object& a, const py::object& b, py::handle pose_a, py::handle pose_b,
                    const QuerySettings& settings, PairMemory* memory) {
  const Body &body_a = body_of(a), &body_b = body_of(b);
  const Pose first = read_pose(pose_a, "pose_a"), second = read_pose(pose_b, "pose_b");
  std::optional<PairMemory::Use> use;
  if (memory != nullptr) use.emplace(*memory);
  Expected<UnionDepth> answer = [&] {
    const Unlocked unlocked;
    return ask(body_a, first, body_b, second, settings, workspace(), memory);
  }();
  return {value_of(std::move(answer), "pair"), a, b};
}

/// A single pair with the settings by default, as quickly as can be; None where something else was given.
py::object ask_plain(const py::object& a, const py::object& b, py::handle pose_a, py::handle pose_b) {
  const auto single = [](py::handle pose) {
    return pose.is_none() || py::isinstance<Pose>(pose) || py::isinstance<py::tuple>(pose) ||
           (py::isinstance<py::array>(pose) && py::reinterpret_borrow<py::array>(pose).ndim() == 2);
  };
  if (!py::isinstance<Body>(a) || !py::isinstance<Body>(b) || !single(pose_a) || !single(pose_b)) return py::none();
  static const QuerySettings settings;
  return py::cast(ask_pair(a, b, pose_a, pose_b, settings, nullptr));
}

const ConvexShape& convex_of(const Body& body, const char* argument) {
  if (body.convex() == nullptr) refuse("unsupported", "this query takes convex shapes", argument);
  return *body.convex();
}

py::dict directional_pair(const BodyRef& a, const BodyRef& b, py::handle direction, py::handle pose_a,
                          py::handle pose_b) {
  const Pose first = read_pose(pose_a, "pose_a"), second = read_pose(pose_b, "pose_b");
  const Vec3 along = read_vector(direction, "direction");
  py::dict fields;
  const auto fill = [&](const auto& answer) {
    fields["contact"] = std::string(to_string(answer.contact));
    fields["depth"] = answer.depth;
    fields["lower"] = answer.lower;
    fields["upper"] = answer.upper;
    fields["normal"] = array_of(answer.normal);
  };
  if (a->convex() != nullptr && b->convex() != nullptr) {
    fill(value_of(
        finite_or_error(directional_depth({a->convex(), first}, {b->convex(), second}, along, workspace().scratch)),
        "direction"));
  } else {
    const Compound whole_a = a->compound(), whole_b = b->compound();
    fill(value_of(finite_or_error(directional_depth({&whole_a, first}, {&whole_b, second}, along, workspace().scratch)),
                  "direction"));
  }
  return fields;
}

py::dict manifold_pair(const BodyRef& a, const BodyRef& b, py::handle pose_a, py::handle pose_b, double threshold) {
  const PosedShape first{&convex_of(*a, "a"), read_pose(pose_a, "pose_a")};
  const PosedShape second{&convex_of(*b, "b"), read_pose(pose_b, "pose_b")};
  const PenetrationDepth answer = penetration_depth(first, second, workspace().scratch);
  const ContactManifold manifold = contact_manifold(first, second, answer, threshold, workspace().manifold);
  if (!is_finite(manifold)) refuse(past_doubles(""), "pair");
  return contact_fields(manifold.normal, {manifold.points.begin(), manifold.points.begin() + manifold.count});
}

py::dict derivatives_pair(const py::object& shape_a, const py::object& shape_b, py::handle pose_a, py::handle pose_b) {
  const PosedShape first{&convex_of(body_of(shape_a), "a"), read_pose(pose_a, "pose_a")};
  const PosedShape second{&convex_of(body_of(shape_b), "b"), read_pose(pose_b, "pose_b")};
  const DepthDerivatives found = [&] {
    const Unlocked unlocked;
    return depth_derivatives(first, second, workspace().scratch);
  }();
  if (!is_finite(found.answer)) refuse(past_doubles(""), "pair");
  const auto six = [](const PoseGradient& gradient) {
    Array array(6);
    for (int k = 0; k < 3; ++k) {
      array.mutable_at(k) = gradient.translation[k];
      array.mutable_at(3 + k) = gradient.rotation[k];
    }
    return array;
  };
  const auto three_by_six = [](const PoseJacobian& jacobian) {
    Array array({3, 6});
    for (int i = 0; i < 3; ++i) {
      for (int k = 0; k < 3; ++k) {
        array.mutable_at(i, k) = jacobian.translation(i, k);
        array.mutable_at(i, 3 + k) = jacobian.rotation(i, k);
      }
    }
    return array;
  };
  py::dict fields;
  UnionDepth depth;
  static_cast<PenetrationDepth&>(depth) = found.answer;
  fields["answer"] = PairAnswer{depth, shape_a, shape_b};
  fields["signed_depth"] = found.signed_depth;
  fields["unique_direction"] = found.unique_direction;
  fields["unique_witness"] = found.unique_witness;
  fields["stable_features"] = found.stable_features;
  fields["by_a"] = six(found.by_a);
  fields["by_b"] = six(found.by_b);
  fields["normal_by_a"] = three_by_six(found.normal_by_a);
  fields["normal_by_b"] = three_by_six(found.normal_by_b);
  fields["witness_a_by_a"] = three_by_six(found.witness_a_by_a);
  fields["witness_a_by_b"] = three_by_six(found.witness_a_by_b);
  fields["witness_b_by_a"] = three_by_six(found.witness_b_by_a);
  fields["witness_b_by_b"] = three_by_six(found.witness_b_by_b);
  return fields;
}

/// Calls `field` with every member of an answer that Python shows, in an order that states keep.
template <class Answer, class Field>
void for_each_member(Answer& x, const Field& field) {
  field(x.contact), field(x.method), field(x.warm), field(x.bracket_reached);
  for (auto* number : {&x.depth, &x.lower, &x.upper, &x.distance, &x.distance_lower, &x.distance_upper}) field(*number);
  for (auto* vector : {&x.translation, &x.normal, &x.witness_a, &x.witness_b}) {
    for (int k = 0; k < 3; ++k) field((*vector)[k]);
  }
  for (auto* feature : {&x.feature_a, &x.feature_b}) {
    field(feature->kind), field(feature->first), field(feature->second);
  }
  auto& counts = x.statistics;
  field(counts.support_calls), field(counts.facets_visited), field(counts.exact_signs);
  field(counts.pair_evaluations), field(counts.block_bounds), field(counts.lines_scanned);
  field(x.part_a), field(x.part_b), field(x.exact), field(x.closed);
}

py::tuple state_of(const PairAnswer& answer) {
  py::list state;
  state.append(answer.a);
  state.append(answer.b);
  for_each_member(answer.depth, [&](const auto& member) {
    using Member = std::decay_t<decltype(member)>;
    if constexpr (std::is_enum_v<Member>) {
      state.append(static_cast<int>(member));
    } else {
      state.append(member);
    }
  });
  return py::tuple(state);
}

PairAnswer answer_of_state(const py::tuple& state) {
  PairAnswer answer{{}, state[0], state[1]};
  std::size_t next = 2;
  for_each_member(answer.depth, [&](auto& member) {
    using Member = std::decay_t<decltype(member)>;
    if constexpr (std::is_enum_v<Member>) {
      member = static_cast<Member>(state[next++].cast<int>());
    } else {
      member = state[next++].template cast<Member>();
    }
  });
  return answer;
}

void bind_answer(py::module_& module) {
  py::class_<PairAnswer> depth(
      module, "Depth",
      "The answer for one pair. Lengths in the unit of the input, points and directions in the\n"
      "frame that A and B share. A moves by `translation`, B stays.");
  require_made(depth);
  depth
      .def_property_readonly(
          "contact", [](const PairAnswer& x) { return std::string(to_string(x.depth.contact)); },
          "'overlapping', 'touching' or 'separated', exact for polytopes.")
      .def_property_readonly(
          "depth", [](const PairAnswer& x) { return x.depth.depth; },
          "Length of the shortest move of A that separates; 0 unless overlapping.")
      .def_property_readonly(
          "lower", [](const PairAnswer& x) { return x.depth.lower; }, "Certified: lower <= depth.")
      .def_property_readonly(
          "upper", [](const PairAnswer& x) { return x.depth.upper; }, "Certified: depth <= upper.")
      .def_property_readonly(
          "distance", [](const PairAnswer& x) { return x.depth.distance; }, "0 unless separated.")
      .def_property_readonly(
          "distance_lower", [](const PairAnswer& x) { return x.depth.distance_lower; }, "Certified.")
      .def_property_readonly(
          "distance_upper", [](const PairAnswer& x) { return x.depth.distance_upper; }, "Certified.")
      .def_property_readonly(
          "signed_depth", [](const PairAnswer& x) { return -x.depth.signed_distance(); },
          "depth, or minus the distance.")
      .def_property_readonly(
          "translation", [](const PairAnswer& x) { return array_of(x.depth.translation); },
          "[3]: moves A clear of B, exactly as stored.")
      .def_property_readonly(
          "normal", [](const PairAnswer& x) { return array_of(x.depth.normal); }, "[3], unit: the way A leaves B.")
      .def_property_readonly(
          "witness_a", [](const PairAnswer& x) { return array_of(x.depth.witness_a); },
          "[3]: point of A; witness_b - witness_a = translation.")
      .def_property_readonly(
          "witness_b", [](const PairAnswer& x) { return array_of(x.depth.witness_b); }, "[3].")
      .def_property_readonly(
          "feature_a", [](const PairAnswer& x) { return feature_of(body_of(x.a), x.depth.part_a, x.depth.feature_a); },
          "(kind, row numbers of A's points), kind 'vertex', 'edge' or 'facet'; None where smooth.")
      .def_property_readonly(
          "feature_b", [](const PairAnswer& x) { return feature_of(body_of(x.b), x.depth.part_b, x.depth.feature_b); },
          "As feature_a, of B.")
      .def_property_readonly(
          "part_a", [](const PairAnswer& x) { return x.depth.part_a; }, "Part of a union, from 0.")
      .def_property_readonly(
          "part_b", [](const PairAnswer& x) { return x.depth.part_b; }, "Part of a union, from 0.")
      .def_property_readonly(
          "bracket_reached", [](const PairAnswer& x) { return x.depth.bracket_reached && x.depth.closed; },
          "False: [lower, upper] is certified, but wider than asked.")
      .def_property_readonly(
          "method", [](const PairAnswer& x) { return std::string(to_string(x.depth.method)); },
          "The engine that answered.")
      .def_property_readonly(
          "warm", [](const PairAnswer& x) { return x.depth.warm; }, "A warm start held.")
      .def_property_readonly(
          "stats", [](const PairAnswer& x) { return statistics_of(x.depth.statistics); }, "Counts of work.")
      .def_property_readonly(
          "shape_a", [](const PairAnswer& x) { return x.a; }, "A.")
      .def_property_readonly(
          "shape_b", [](const PairAnswer& x) { return x.b; }, "B.")
      .def("__repr__", &repr_of_answer)
      .def(py::pickle(&state_of, &answer_of_state));
}

}  // namespace

PairMemory::Use::Use(PairMemory& memory) : memory_(memory) {
  if (memory.in_use.exchange(true, std::memory_order_acquire)) {
    refuse("in_use", "another thread asks with this Warm; give each thread one of its own", "warm");
  }
}

Workspace& workspace() {
  thread_local Workspace space;
  return space;
}

QuerySettings read_settings(py::handle method, py::handle delta, py::handle bracket, py::handle beyond) {
  QuerySettings settings;
  if (!beyond.is_none()) {
    const Array number = read_array(beyond, "beyond", {});
    if (!(*number.data() >= 0)) refuse("bad_value", "must be a distance >= 0, or None", "beyond");
    settings.depth.beyond = *number.data();
  }
  if (!delta.is_none()) {
    const Array number = read_array(delta, "delta", {});
    if (!(*number.data() > 0 && *number.data() <= 1)) refuse("bad_value", "must lie in (0, 1]", "delta");
    settings.depth.delta = settings.union_delta = *number.data();
  }
  constexpr std::array kMethods{Method::automatic,     Method::expansion, Method::overlay,
                                Method::decomposition, Method::shallow,   Method::grid};
  bool known = false;
  for (const Method each : kMethods) {
    if (!is_word(method, to_string(each))) continue;
    settings.depth.method = each;
    known = true;
  }
  if (!known) {
    refuse("bad_value", "known: auto, expansion, overlay, decomposition, shallow, grid; not " + repr_of(method),
           "method");
  }
  if (is_word(bracket, "certified")) {
    settings.depth.bracket = Bracket::certified;
  } else if (is_word(bracket, "contact")) {
    settings.depth.bracket = Bracket::contact;
  } else if (!is_word(bracket, "tightest")) {
    refuse("bad_value", "known: tightest, certified, contact; not " + repr_of(bracket), "bracket");
  }
  return settings;
}

Expected<UnionDepth> ask(const Body& a, const Pose& pose_a, const Body& b, const Pose& pose_b,
                         const QuerySettings& settings, Workspace& space, PairMemory* memory) {
  return finite_or_error(ask_any({a, pose_a}, {b, pose_b}, settings, space, memory));
}

py::dict contact_fields(const Vec3& normal, const std::vector<ContactPoint>& points) {
  const auto count = static_cast<py::ssize_t>(points.size());
  Array on_a({count, py::ssize_t{3}}), on_b({count, py::ssize_t{3}}), depths(count);
  py::array_t<std::int64_t> ids(count);
  for (py::ssize_t i = 0; i < count; ++i) {
    const ContactPoint& point = points[static_cast<std::size_t>(i)];
    for (int k = 0; k < 3; ++k) {
      on_a.mutable_at(i, k) = point.position_a[k];
      on_b.mutable_at(i, k) = point.position_b[k];
    }
    depths.mutable_at(i) = point.depth;
    ids.mutable_at(i) = point.feature_id;
  }
  py::dict fields;
  fields["normal"] = array_of(normal);
  fields["position_a"] = on_a;
  fields["position_b"] = on_b;
  fields["depth"] = depths;
  fields["feature_id"] = ids;
  return fields;
}

void bind_pair_queries(py::module_& module) {
  bind_answer(module);
  py::class_<QuerySettings> settings(module, "Settings", "Settings of a query, read once.");
  require_made(settings);
  module.def("settings", &read_settings);
  module.attr("DEFAULTS") = QuerySettings();
  module.attr("CLASS_ALONE") = QuerySettings{.depth = {}, .class_alone = true};
  py::class_<PairMemory> warm(
      module, "Warm",
      "The memory of one pair between frames: pass it as `warm` to depth. Nothing in it is\n"
      "trusted; a warm answer has the same proof as a cold one. While one thread asks with it,\n"
      "another is Refused: 'in_use'.");
  require_made(warm);
  warm.def(py::init<>())
      .def(
          "clear",
          [](PairMemory& memory) {
            const PairMemory::Use use(memory);
            memory.convex.clear();
            memory.unions.clear();
          },
          "Forgets everything.")
      .def_property_readonly(
          "nbytes",
          [](PairMemory& memory) {
            const PairMemory::Use use(memory);
            return memory.convex.memory_bytes() + memory.unions.memory_bytes();
          },
          "Bytes held.");
  module.def("ask", &ask_pair);
  module.def("ask_plain", &ask_plain);
  module.def("directional", &directional_pair);
  module.def("manifold", &manifold_pair);
  module.def("derivatives", &derivatives_pair);
}

}  // namespace pd::python
