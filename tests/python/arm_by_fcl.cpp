/// @file
/// FCL's signed distances of the arm that `bench_robot.py CONFIGURATIONS FOLDER` left in a folder, beside pdepth's.
///
///   arm_by_fcl FOLDER
///
/// Prints the processor time, and how far the distances differ.
#include <fcl/fcl.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <fstream>
#include <memory>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

namespace {

std::vector<double> read_doubles(const std::string& path) {
  std::ifstream file(path, std::ios::binary | std::ios::ate);
  std::vector<double> numbers(static_cast<std::size_t>(file.tellg()) / sizeof(double));
  file.seekg(0);
  file.read(reinterpret_cast<char*>(numbers.data()), static_cast<std::streamsize>(numbers.size() * sizeof(double)));
  return numbers;
}

struct Arm {
  std::vector<std::shared_ptr<fcl::CollisionGeometryd>> shapes;
  std::vector<std::pair<std::size_t, std::size_t>> pairs;
};

Arm read_arm(const std::string& path) {
  std::ifstream file(path);
  Arm arm;
  for (std::string line; std::getline(file, line);) {
    std::istringstream words(line);
    std::string kind;
    double x = 0, y = 0, z = 0;
    words >> kind >> x >> y >> z;
    if (kind == "box") arm.shapes.push_back(std::make_shared<fcl::Boxd>(x, y, z));
    if (kind == "cylinder") arm.shapes.push_back(std::make_shared<fcl::Cylinderd>(x, y));
    if (kind == "capsule") arm.shapes.push_back(std::make_shared<fcl::Capsuled>(x, y));
    if (kind == "sphere") arm.shapes.push_back(std::make_shared<fcl::Sphered>(x));
    if (kind == "pair") arm.pairs.emplace_back(static_cast<std::size_t>(x), static_cast<std::size_t>(y));
  }
  return arm;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) return 2;
  const std::string folder = std::string(argv[1]) + "/";
  const Arm arm = read_arm(folder + "arm.txt");
  const std::vector<double> poses = read_doubles(folder + "poses.f64"), known = read_doubles(folder + "distances.f64");
  if (arm.shapes.empty() || arm.pairs.empty()) return 1;
  const std::size_t links = arm.shapes.size(), count = poses.size() / (16 * links);
  const fcl::DistanceRequestd request(true, true);
  std::vector<double> found;
  found.reserve(count * arm.pairs.size());
  std::vector<fcl::Transform3d> at(links);
  const std::clock_t begin = std::clock();
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t link = 0; link < links; ++link) {
      at[link].matrix() =
          Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>>(&poses[16 * (i * links + link)]);
    }
    for (const auto& [a, b] : arm.pairs) {
      fcl::DistanceResultd result;
      found.push_back(fcl::distance(arm.shapes[a].get(), at[a], arm.shapes[b].get(), at[b], request, result));
    }
  }
  const double seconds = static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
  std::size_t far = 0;
  double farthest = 0;
  for (std::size_t i = 0; i < std::min(found.size(), known.size()); ++i) {
    const double off = std::abs(found[i] - known[i]);
    far += off > 1e-4 ? 1 : 0;
    farthest = std::max(farthest, off);
  }
  std::printf("FCL %.3f s, %.2f us a pair and joint vector; %zu of %zu differ by more than 1e-4, at most by %.2g\n",
              seconds, 1e6 * seconds / static_cast<double>(found.size()), far, found.size(), farthest);
}
