/// @file
/// The unit of build_cost.py: a source that nobody has a reason to change, of headers and templates as the project's
/// sources have them.

#include <Eigen/Core>
#include <algorithm>
#include <map>
#include <string>
#include <vector>

Eigen::Matrix3d product(const std::vector<Eigen::Matrix3d>& factors) {
  Eigen::Matrix3d result = Eigen::Matrix3d::Identity();
  for (const Eigen::Matrix3d& factor : factors) result = result * factor.transpose() - 0.5 * factor;
  return result;
}

std::map<std::string, double> sums(std::vector<std::pair<std::string, double>> numbers) {
  std::sort(numbers.begin(), numbers.end());
  std::map<std::string, double> result;
  for (const auto& [name, number] : numbers) result[name] += number;
  return result;
}
