#include "oracle/exact_pair.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <limits>

namespace pd::oracle {

namespace {

using ScaledMatrix = std::array<std::array<Scaled, 3>, 3>;

struct ExactPose {
  ScaledMatrix rotation;  // numerators
  Scaled weight;
  std::array<Scaled, 3> translation;
};

ExactPose exact_pose(const Pose& pose) {
  ExactPose r;
  for (int i = 0; i < 3; ++i) r.translation[i] = to_scaled(pose.translation()[i]);
  if (!pose.is_quaternion()) {
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) r.rotation[i][j] = to_scaled(pose.rotation()(i, j));
    }
    r.weight = to_scaled(1);
    return r;
  }
  const auto& q = pose.quaternion_wxyz();
  const Scaled w = to_scaled(q[0]);
  const Scaled x = to_scaled(q[1]);
  const Scaled y = to_scaled(q[2]);
  const Scaled z = to_scaled(q[3]);
  const Scaled two = to_scaled(2);
  const Scaled ww = w * w;
  const Scaled xx = x * x;
  const Scaled yy = y * y;
  const Scaled zz = z * z;
  r.rotation[0] = {ww + xx - yy - zz, two * (x * y - w * z), two * (x * z + w * y)};
  r.rotation[1] = {two * (x * y + w * z), ww - xx + yy - zz, two * (y * z - w * x)};
  r.rotation[2] = {two * (x * z - w * y), two * (y * z + w * x), ww - xx - yy + zz};
  r.weight = ww + xx + yy + zz;
  return r;
}

int lowest_exponent(const Scaled& s, int lowest) {
  if (s.mantissa.is_zero()) return lowest;
  const int e = s.exponent + static_cast<int>(boost::multiprecision::lsb(boost::multiprecision::abs(s.mantissa)));
  return std::min(e, lowest);
}
int highest_exponent(const Scaled& s, int highest) {
  if (s.mantissa.is_zero()) return highest;
  return std::max(
      highest, s.exponent + 1 + static_cast<int>(boost::multiprecision::msb(boost::multiprecision::abs(s.mantissa))));
}
Integer at_exponent(const Scaled& s, int exponent) {
  if (s.mantissa.is_zero()) return 0;
  const int left = s.exponent - exponent;
  return left >= 0 ? Integer(s.mantissa << left) : Integer(s.mantissa >> -left);
}

constexpr int kNone = std::numeric_limits<int>::max();

}  // namespace

ExactPair::ExactPair(const Body& a, const Pose& pose_a, const Body& b, const Pose& pose_b, const Vec3& move_a) {
  const Body* bodies[2] = {&a, &b};
  const ExactPose poses[2] = {exact_pose(pose_a), exact_pose(pose_b)};
  weight_ = poses[0].weight * poses[1].weight;

  // Posed references, times the weight.
  std::array<Scaled, 3> reference[2];
  ScaledMatrix maps[2];
  for (int s = 0; s < 2; ++s) {
    sides_[s].body = bodies[s];
    for (int i = 0; i < 3; ++i) {
      Scaled sum = poses[s].weight * poses[s].translation[i];
      for (int j = 0; j < 3; ++j) sum = sum + poses[s].rotation[i][j] * to_scaled(bodies[s]->reference[j]);
      if (s == 0) sum = sum + poses[s].weight * to_scaled(move_a[i]);
      reference[s][i] = sum * poses[1 - s].weight;
      for (int j = 0; j < 3; ++j) maps[s][i][j] = poses[s].rotation[i][j] * poses[1 - s].weight;
    }
  }
  std::array<Scaled, 3> offset;
  int lowest = kNone;
  int offset_top = -kNone;
  for (int i = 0; i < 3; ++i) {
    offset[i] = reference[1][i] - reference[0][i];
    lowest = lowest_exponent(offset[i], lowest);
    offset_top = highest_exponent(offset[i], offset_top);
  }
  int map_lowest[2] = {kNone, kNone};
  for (int s = 0; s < 2; ++s) {
    for (const auto& row : maps[s]) {
      for (const Scaled& m : row) map_lowest[s] = lowest_exponent(m, map_lowest[s]);
    }
    if (bodies[s]->dimension > 0) lowest = std::min(lowest, map_lowest[s] + bodies[s]->exponent);
  }
  exponent_ = lowest == kNone ? 0 : lowest;
  offset_ = {at_exponent(offset[0], exponent_), at_exponent(offset[1], exponent_), at_exponent(offset[2], exponent_)};

  const double weight = to_double(weight_);
  scale_ = offset_top == -kNone ? std::numeric_limits<int>::min() : offset_top;
  for (const Body* body : bodies) {
    if (body->dimension > 0) scale_ = std::max(scale_, body->scale_exponent);
  }
  if (scale_ == std::numeric_limits<int>::min()) scale_ = 0;
  for (int i = 0; i < 3; ++i) rounded_offset_[i] = to_double(offset[i].mantissa, offset[i].exponent - scale_) / weight;
  magnitude_ = rounded_offset_.lpNorm<Eigen::Infinity>();

  for (int s = 0; s < 2; ++s) {
    Side& side = sides_[s];
    const Body& body = *bodies[s];
    Mat3 rotation;
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) {
        if (body.dimension > 0) side.map[i][j] = at_exponent(maps[s][i][j], exponent_ - body.exponent);
        rotation(i, j) = to_double(poses[s].rotation[i][j]) / to_double(poses[s].weight);
      }
    }
    side.points.resize(body.exact.size());
    side.known.assign(body.exact.size(), 0);
    round_side(side, rotation);
  }
}

void ExactPair::round_side(Side& side, const Mat3& rotation) {
  const Body& body = *side.body;
  Mat3 cofactor;
  for (int i = 0; i < 3; ++i) {
    const Vec3 row = rotation.row((i + 1) % 3).cross(rotation.row((i + 2) % 3));
    cofactor.row(i) = row.transpose();
  }
  Rounded& r = side.rounded;
  const double factor = std::ldexp(1.0, std::max(body.scale_exponent - scale_, -1000));
  r.magnitude = body.dimension > 0 ? 2 * factor : 0;
  magnitude_ += r.magnitude;
  const std::size_t count = body.vertices.size();
  const std::size_t padded = (count + 7) / 8 * 8;
  r.x.resize(padded);
  r.y.resize(padded);
  r.z.resize(padded);
  for (std::size_t k = 0; k < padded; ++k) {
    const Vec3 p = rotation * (body.relative[body.vertices[k < count ? k : 0]] * factor);
    r.x[k] = p.x();
    r.y[k] = p.y();
    r.z[k] = p.z();
  }
  r.edge_units.reserve(body.edges.size());
  for (const Vec3& e : body.edge_units) r.edge_units.push_back((rotation * e).normalized());
  r.facet_normals.reserve(body.facets.size());
  for (const Body::Facet& f : body.facets) r.facet_normals.push_back((cofactor * f.unit_normal).normalized());
}

const IVec& ExactPair::point(const Side& side, int i) const {
  if (!side.known[i]) {
    const IVec& p = side.body->exact[i];
    const auto& m = side.map;
    side.points[i] = {m[0][0] * p.x + m[0][1] * p.y + m[0][2] * p.z, m[1][0] * p.x + m[1][1] * p.y + m[1][2] * p.z,
                      m[2][0] * p.x + m[2][1] * p.y + m[2][2] * p.z};
    side.known[i] = 1;
  }
  return side.points[i];
}

ExactLength ExactPair::length(const Integer& numerator_squared, const Integer& denominator) const {
  return {numerator_squared, denominator * weight_.mantissa * weight_.mantissa, 2 * (exponent_ - weight_.exponent)};
}

bool ExactPair::flat_difference() const {
  if (a().dimension == 3 || b().dimension == 3) return false;
  std::vector<IVec> spanning;
  const auto add = [&](const Body& body, bool second) {
    for (const Body::Edge& e : body.edges) {
      if (static_cast<int>(spanning.size()) > 64) break;
      spanning.push_back(second ? point_b(e.to) - point_b(e.from) : point_a(e.to) - point_a(e.from));
    }
  };
  // Two edges that are not parallel span a polygon's plane; neighbours in its loop never are.
  add(a(), false);
  if (a().dimension == 2) spanning.resize(2);
  const std::size_t mark = spanning.size();
  add(b(), true);
  if (b().dimension == 2) spanning.resize(mark + 2);
  for (std::size_t i = 0; i < spanning.size(); ++i) {
    for (std::size_t j = i + 1; j < spanning.size(); ++j) {
      const IVec n = cross(spanning[i], spanning[j]);
      if (is_zero(n)) continue;
      return std::all_of(spanning.begin(), spanning.end(), [&](const IVec& v) { return dot(n, v).is_zero(); });
    }
  }
  return true;
}

namespace {

double largest_dot(const ExactPair::Rounded& r, const Vec3& n) {
  double lane[8];
  std::fill(lane, lane + 8, -std::numeric_limits<double>::infinity());
  const double nx = n.x();
  const double ny = n.y();
  const double nz = n.z();
  for (std::size_t k = 0; k < r.x.size(); k += 8) {
    for (std::size_t l = 0; l < 8; ++l) {
      const double value = r.x[k + l] * nx + r.y[k + l] * ny + r.z[k + l] * nz;
      lane[l] = value > lane[l] ? value : lane[l];
    }
  }
  return *std::max_element(lane, lane + 8);
}

}  // namespace

double ExactPair::support(const Vec3& n) const {
  return rounded_offset_.dot(n) + largest_dot(sides_[1].rounded, n) + largest_dot(sides_[0].rounded, -n);
}

void ExactPair::near_support(bool of_b, const Vec3& unit, double slack, std::vector<int>& result) const {
  const Side& side = sides_[of_b ? 1 : 0];
  const Rounded& r = side.rounded;
  const double floor = largest_dot(r, unit) - r.magnitude * 0x1p-44 - slack;
  result.clear();
  for (std::size_t k = 0; k < side.body->vertices.size(); ++k) {
    if (r.x[k] * unit.x() + r.y[k] * unit.y() + r.z[k] * unit.z() >= floor) result.push_back(side.body->vertices[k]);
  }
}

Integer ExactPair::exact_support(const IVec& n, const Vec3& unit) const {
  std::vector<int> near;
  Integer value = dot(offset_, n);
  for (const bool of_b : {false, true}) {
    near_support(of_b, of_b ? unit : Vec3(-unit), 0, near);
    bool any = false;
    Integer best;
    for (const int i : near) {
      Integer d = of_b ? dot(point_b(i), n) : -dot(point_a(i), n);
      if (!any || d > best) best = std::move(d);
      any = true;
    }
    value += best;
  }
  return value;
}

}  // namespace pd::oracle
