/// @file
/// Which P_k may cover a facet of the differences: a tree of cubes of translations, halved where facets pass through it
/// until one P_k holds a cube, or few P_k meet it.
///
/// Doubles with bounds decide (`RoughPlane`), one way only: what counts as covered is covered for certain. Where two
/// bodies are deep inside each other, most facets of the P_k lie deep inside the union. Several cubes then cover such a
/// facet together, and it needs neither an exact plane nor a cut.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "compound/part_differences.hpp"

namespace pd::detail {

class CoverCubes {
 public:
  /// Refers to the differences, and makes those that it needs.
  explicit CoverCubes(PartDifferences& differences);

  /// True if cubes that the P_k hold cover a facet of P_own, for certain. If they do not, `near` is set to P_k that
  /// cover what all P_k but P_own cover of the facet, each once.
  /// @param corners  of the facet, in doubles: off by 2^-43 of the extent at most
  bool covers(std::size_t own, const RoughPlane& plane, const std::vector<Vec3>& corners,
              std::vector<std::int32_t>& near);

  /// P_k that were held against a cube.
  [[nodiscard]] std::int64_t num_tests() const { return num_tests_; }

 private:
  static constexpr int kMaxDepth = 7;
  /// Cubes that more P_k meet are halved.
  static constexpr std::size_t kFew = 6;
  /// Beyond it cubes are halved no more.
  static constexpr std::size_t kMaxCubes = 200'000;

  struct Cube {
    enum class State : std::uint8_t { unknown, held, halved, leaf };
    Vec3 centre = Vec3::Zero();
    double half = 0;
    int depth = 0;
    State state = State::unknown;
    std::int32_t first_child = -1;
    /// The P_k that may meet the cube, or the one that holds it.
    std::shared_ptr<const std::vector<std::int32_t>> pieces;
  };
  struct FacetBox {
    const RoughPlane& plane;
    Vec3 low;
    Vec3 high;
  };
  /// True if all cubes that the facet passes through below a cube are held, for certain.
  bool held(std::size_t cube, const FacetBox& facet);
  void gather(std::size_t cube, const FacetBox& facet, std::vector<std::int32_t>& near);
  void look_at(std::size_t cube);
  [[nodiscard]] bool passes(const Cube& cube, const FacetBox& facet) const;

  PartDifferences& differences_;
  std::vector<Cube> cubes_;
  std::vector<std::int64_t> gathered_;  ///< by P_k: the last call that put it into `near`
  std::int64_t calls_ = 0;
  std::int64_t num_tests_ = 0;
};

}  // namespace pd::detail
