/// @file
/// One pair asked: the settings that Python names, the workspace of a thread, and the answer as an object.
#pragma once

#include <atomic>
#include <string>
#include <vector>

#include "pd/compound/compound_depth.hpp"
#include "pd/compound/warm_union.hpp"
#include "pd/contact/finite_answer.hpp"
#include "pd/contact/manifold.hpp"
#include "pd/depth/penetration_depth.hpp"
#include "pd/depth/scratch.hpp"
#include "pd/depth/warm_certificate.hpp"
#include "python/body.hpp"
#include "python/pose_argument.hpp"

namespace pd::python {

/// What a thread keeps between queries.
struct Workspace {
  Scratch scratch;
  ManifoldScratch manifold;
};

/// The calling thread's own.
[[nodiscard]] Workspace& workspace();

/// The memory of one pair between frames: Python's `Warm`.
struct PairMemory {
  /// Holds a memory for one call of one thread. @throws Refused in_use while another thread holds it
  class Use {
   public:
    explicit Use(PairMemory& memory);
    ~Use() { memory_.in_use.store(false, std::memory_order_release); }
    Use(const Use&) = delete;
    Use& operator=(const Use&) = delete;

   private:
    PairMemory& memory_;
  };

  WarmCertificate convex;
  WarmUnion unions;
  std::atomic<bool> in_use{false};
};

struct QuerySettings {
  DepthSettings depth;
  double union_delta = 1e-2;
  bool class_alone = false;  ///< no number of the answer but `contact` is asked for; the rest stays zero
};

/// @param delta   None: the protocol's defaults (exact; 1e-6 for curved bodies, 1e-2 for unions).
/// @param beyond  None: closest points at any distance. Unions are answered as if it were.
/// @throws Refused bad_value with the known words.
[[nodiscard]] QuerySettings read_settings(py::handle method, py::handle delta, py::handle bracket, py::handle beyond);

/// Depth, or distance, of any two bodies. Holds no lock and may be called from any thread.
/// @param memory  of the same two bodies; null: the pair is answered cold.
/// @return unsupported where the method does not answer for these bodies; as `penetration_depth` of unions;
/// out_of_range for an answer that is not finite.
[[nodiscard]] Expected<UnionDepth> ask(const Body& a, const Pose& pose_a, const Body& b, const Pose& pose_b,
                                       const QuerySettings& settings, Workspace& space, PairMemory* memory = nullptr);

/// Makes the fields that Python shows of contact points: their normal, and an array for each property.
[[nodiscard]] py::dict contact_fields(const Vec3& normal, const std::vector<ContactPoint>& points);

/// Declares `Depth` and the queries of one pair.
void bind_pair_queries(py::module_& module);
/// Declares `Sheet` and the contacts of unions and sheets.
void bind_union_contacts(py::module_& module);

}  // namespace pd::python
