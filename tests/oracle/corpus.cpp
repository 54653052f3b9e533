#include "oracle/corpus.hpp"

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <stdexcept>

#include "scenes/single_precision.hpp"

namespace pd::oracle {

namespace {

using Json = nlohmann::ordered_json;

class Reader {
 public:
  explicit Reader(bool single) : single_(single) {}

  [[nodiscard]] double number(const Json& j) const {
    const double value = j.get<double>();
    return single_ ? scenes::to_single(value) : value;
  }
  [[nodiscard]] Vec3 vector(const Json& j) const { return {number(j.at(0)), number(j.at(1)), number(j.at(2))}; }

  [[nodiscard]] ShapeText shape(const Json& j) const {
    ShapeText s;
    s.type = j.at("type").get<std::string>();
    if (j.contains("axis")) s.axis = j.at("axis").get<std::string>()[0] - 'x';
    if (s.type == "box") {
      s.sizes = vector(j.at("half_extents"));
      for (int k = 0; k < 8; ++k) {
        s.points.emplace_back((k & 1) != 0 ? s.sizes.x() : -s.sizes.x(), (k & 2) != 0 ? s.sizes.y() : -s.sizes.y(),
                              (k & 4) != 0 ? s.sizes.z() : -s.sizes.z());
      }
    } else if (s.type == "convex") {
      for (const Json& v : j.at("vertices")) s.points.push_back(vector(v));
    } else if (s.type == "ellipsoid") {
      s.sizes = vector(j.at("radii"));
    } else if (s.type == "sphere") {
      s.margin = number(j.at("radius"));
      s.points = {Vec3::Zero()};
    } else {
      const double radius = number(j.at("radius"));
      const double half_height = number(j.at("half_height"));
      s.sizes = Vec3(radius, half_height, 0);
      if (s.type == "capsule") {
        s.margin = radius;
        s.points = {Vec3::Zero(), Vec3::Zero()};
        s.points[0][s.axis] = -half_height;
        s.points[1][s.axis] = half_height;
      }
    }
    return s;
  }

  [[nodiscard]] PoseText pose(const Json& j) const {
    PoseText p;
    if (j.contains("translation")) p.translation = vector(j.at("translation"));
    if (j.contains("quaternion_wxyz")) {
      const Json& q = j.at("quaternion_wxyz");
      p.quaternion_wxyz = {number(q.at(0)), number(q.at(1)), number(q.at(2)), number(q.at(3))};
    }
    if (j.contains("rotation_row_major")) {
      for (int k = 0; k < 9; ++k) p.rotation(k / 3, k % 3) = number(j.at("rotation_row_major").at(k));
    }
    return p;
  }

 private:
  bool single_;
};

Json write(const Vec3& v) { return Json::array({v.x(), v.y(), v.z()}); }

Json write(const ShapeText& s) {
  Json j;
  j["type"] = s.type;
  const char axis[2] = {static_cast<char>('x' + s.axis), 0};
  if (s.type == "box") {
    j["half_extents"] = write(s.sizes);
  } else if (s.type == "convex") {
    j["vertices"] = Json::array();
    for (const Vec3& p : s.points) j["vertices"].push_back(write(p));
  } else if (s.type == "ellipsoid") {
    j["radii"] = write(s.sizes);
  } else if (s.type == "sphere") {
    j["radius"] = s.margin;
  } else {
    j["radius"] = s.sizes.x();
    j["half_height"] = s.sizes.y();
    j["axis"] = axis;
  }
  return j;
}

Json write(const PoseText& p) {
  Json j;
  j["translation"] = write(p.translation);
  if (p.quaternion_wxyz) {
    j["quaternion_wxyz"] = *p.quaternion_wxyz;
  } else {
    j["rotation_row_major"] = Json::array();
    for (int k = 0; k < 9; ++k) j["rotation_row_major"].push_back(p.rotation(k / 3, k % 3));
  }
  return j;
}

Json write(const PairText& pair, const std::string& note) {
  Json j;
  j["name"] = pair.name;
  j["family"] = pair.family;
  j["source"] = {{"origin", "own"}};
  j["number_format"] = "float64";
  j["shapeA"] = write(pair.shape_a);
  j["poseA"] = write(pair.pose_a);
  j["shapeB"] = write(pair.shape_b);
  j["poseB"] = write(pair.pose_b);
  j["expected_from_source"] = Json::object();
  j["tol"] = pair.tolerance;
  j["note"] = note;
  j["oracle"] = {
      {"method", "exact brute force"}, {"class", pair.contact}, {"signed_distance", pair.signed_distance_text}};
  return j;
}

}  // namespace

std::vector<PairText> read_pairs(const std::string& path) {
  std::ifstream file(path);
  if (!file) throw std::runtime_error("cannot read " + path);
  const Json document = Json::parse(file);
  std::vector<PairText> pairs;
  for (const Json& c : document.at("cases")) {
    const Reader reader(c.value("number_format", "float64") == "float32");
    PairText p;
    p.name = c.at("name").get<std::string>();
    p.family = c.value("family", "");
    p.shape_a = reader.shape(c.at("shapeA"));
    p.shape_b = reader.shape(c.at("shapeB"));
    p.pose_a = reader.pose(c.at("poseA"));
    p.pose_b = reader.pose(c.at("poseB"));
    p.tolerance = c.value("tol", 0.0);
    const Json& oracle = c.at("oracle");
    if (oracle.contains("class") && oracle.at("class").is_string()) p.contact = oracle.at("class").get<std::string>();
    if (oracle.contains("signed_distance") && oracle.at("signed_distance").is_string()) {
      p.signed_distance_text = oracle.at("signed_distance").get<std::string>();
      if (!p.signed_distance_text.empty()) p.signed_distance = std::strtod(p.signed_distance_text.c_str(), nullptr);
    }
    if (oracle.contains("normal_a_to_b") && oracle.at("normal_a_to_b").is_array()) {
      const Json& n = oracle.at("normal_a_to_b");
      p.normal_a_to_b = Vec3(n.at(0).get<double>(), n.at(1).get<double>(), n.at(2).get<double>());
    }
    if (oracle.contains("tied_directions") && oracle.at("tied_directions").is_number()) {
      p.tied_directions = oracle.at("tied_directions").get<int>();
    }
    const auto smooth = [](const ShapeText& s) { return !s.polytope() && !s.rounded(); };
    p.curved = smooth(p.shape_a) || smooth(p.shape_b);
    pairs.push_back(std::move(p));
  }
  return pairs;
}

std::vector<PairText> read_folder(const std::string& folder) {
  std::vector<std::string> names;
  std::error_code missing;
  for (const auto& entry : std::filesystem::directory_iterator(folder, missing)) {
    const std::string name = entry.path().filename().string();
    if (name.starts_with("pairs_") && name.ends_with(".json")) names.push_back(entry.path().string());
  }
  std::sort(names.begin(), names.end());
  std::vector<PairText> pairs;
  for (const std::string& name : names) {
    const std::vector<PairText> some = read_pairs(name);
    pairs.insert(pairs.end(), some.begin(), some.end());
  }
  return pairs;
}

std::string to_json(const PairText& pair, const std::string& note) { return write(pair, note).dump(); }

void append_pair(const std::string& path, const PairText& pair, const std::string& note) {
  Json document = {{"schema", "pd-hard-pairs/1"}, {"cases", Json::array()}};
  if (std::ifstream present(path); present) document = Json::parse(present);
  document["cases"].push_back(write(pair, note));
  std::ofstream(path) << document.dump(1) << '\n';
}

Pose make_pose(const PoseText& text) {
  if (text.quaternion_wxyz) {
    const auto pose = Pose::from_quaternion(*text.quaternion_wxyz, text.translation);
    if (!pose) throw std::runtime_error("pose refused: " + pose.error().message);
    return *pose;
  }
  const auto pose = Pose::from_matrix(text.rotation, text.translation);
  if (!pose) throw std::runtime_error("pose refused: " + pose.error().message);
  return *pose;
}

PairText describe(const std::string& name, const std::string& family, const std::vector<Vec3>& a, const Pose& pose_a,
                  const std::vector<Vec3>& b, const Pose& pose_b) {
  const auto text = [](const Pose& pose) {
    PoseText t;
    t.translation = pose.translation();
    if (pose.is_quaternion()) {
      t.quaternion_wxyz = pose.quaternion_wxyz();
    } else {
      t.rotation = pose.rotation();
    }
    return t;
  };
  PairText p;
  p.name = name;
  p.family = family;
  p.shape_a.type = p.shape_b.type = "convex";
  p.shape_a.points = a;
  p.shape_b.points = b;
  p.pose_a = text(pose_a);
  p.pose_b = text(pose_b);
  return p;
}

}  // namespace pd::oracle
