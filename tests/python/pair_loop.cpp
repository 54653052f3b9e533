/// @file
/// The same pairs in plain C++, for `bench_throughput.py`: hulls of two point files at poses of a third.
///
///   pair_loop POINTS_A POINTS_B POSES THREADS SINGLE
///
/// Files of doubles. Prints the seconds of all pairs, the sum of their signed depths, the least seconds a call of the
/// first SINGLE pairs asked one by one with poses made before, in pieces of 500, and the processor time of all pairs.
#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <fstream>
#include <limits>
#include <string>
#include <thread>
#include <vector>

#include "pd/depth/penetration_depth.hpp"
#include "pd/depth/scratch.hpp"

namespace {

std::vector<double> read_doubles(const char* path) {
  std::ifstream file(path, std::ios::binary | std::ios::ate);
  std::vector<double> numbers(static_cast<std::size_t>(file.tellg()) / sizeof(double));
  file.seekg(0);
  file.read(reinterpret_cast<char*>(numbers.data()), static_cast<std::streamsize>(numbers.size() * sizeof(double)));
  return numbers;
}

pd::ConvexShape hull_of(const char* path) {
  const std::vector<double> numbers = read_doubles(path);
  std::vector<pd::Vec3> points;
  for (std::size_t i = 0; i + 2 < numbers.size(); i += 3) {
    points.emplace_back(numbers[i], numbers[i + 1], numbers[i + 2]);
  }
  return pd::ConvexPolytope::from_points(points).value();
}

pd::Pose pose_of(const double* n) {
  pd::Mat3 rotation;
  rotation << n[0], n[1], n[2], n[4], n[5], n[6], n[8], n[9], n[10];
  return pd::Pose::from_matrix(rotation, {n[3], n[7], n[11]}).value();
}

/// Least of the pieces: what is left when nothing else ran.
double seconds_of_a_single_call(const pd::ConvexShape& a, const pd::ConvexShape& b, const std::vector<double>& numbers,
                                std::size_t count) {
  constexpr std::size_t kPiece = 500;
  constexpr int kRounds = 8;
  std::vector<pd::Pose> poses;
  for (std::size_t i = 0; i < count; ++i) poses.push_back(pose_of(numbers.data() + 16 * i));
  std::vector<double> least(count / kPiece, std::numeric_limits<double>::infinity());
  std::vector<pd::PenetrationDepth> answers(count);
  pd::Scratch scratch;
  for (int round = 0; round < kRounds; ++round) {
    for (std::size_t piece = 0; piece < least.size(); ++piece) {
      const auto start = std::chrono::steady_clock::now();
      for (std::size_t i = piece * kPiece; i < (piece + 1) * kPiece; ++i) {
        answers[i] = pd::penetration_depth({&a, poses[i]}, {&b, {}}, scratch);
      }
      const std::chrono::duration<double> spent = std::chrono::steady_clock::now() - start;
      least[piece] = std::min(least[piece], spent.count() / kPiece);
    }
  }
  double sum = 0;
  for (const double seconds : least) sum += seconds;
  return sum / static_cast<double>(least.size());
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 6) return 2;
  const pd::ConvexShape a = hull_of(argv[1]), b = hull_of(argv[2]);
  const std::vector<double> poses = read_doubles(argv[3]);
  const std::size_t count = poses.size() / 16;
  std::vector<pd::PenetrationDepth> answers(count);
  std::atomic<std::size_t> next{0};
  const auto start = std::chrono::steady_clock::now();
  const std::clock_t processor_start = std::clock();
  {
    std::vector<std::jthread> threads;
    for (int t = 0; t < std::atoi(argv[4]); ++t) {
      threads.emplace_back([&] {
        pd::Scratch scratch;
        for (std::size_t begin = next.fetch_add(64); begin < count; begin = next.fetch_add(64)) {
          for (std::size_t i = begin; i < std::min(begin + 64, count); ++i) {
            answers[i] = pd::penetration_depth({&a, pose_of(poses.data() + 16 * i)}, {&b, {}}, scratch);
          }
        }
      });
    }
  }
  const std::chrono::duration<double> spent = std::chrono::steady_clock::now() - start;
  const double processor = static_cast<double>(std::clock() - processor_start) / CLOCKS_PER_SEC;
  double sum = 0;
  for (const pd::PenetrationDepth& answer : answers) sum -= answer.signed_distance();
  const double single =
      seconds_of_a_single_call(a, b, poses, std::min<std::size_t>(count, std::strtoul(argv[5], nullptr, 10)));
  std::printf("%.9g %.17g %.9g %.9g\n", spent.count(), sum, single, processor);
}
