#include "pd/dimension/directional_width.hpp"

#include <utility>

#include "dimension/backends/cone_structure.hpp"
#include "dimension/backends/kernel_structure.hpp"
#include "dimension/backends/macbeath_structure.hpp"
#include "dimension/validate.hpp"
#include "numeric/floating_point_guard.hpp"

namespace pd::dimension {

template <int D>
Expected<DirectionalWidth<D>> DirectionalWidth<D>::build(const Body<D>& body, double epsilon, Backend backend) {
  const pd::detail::FloatingPointGuard guard;
  if (const auto error = detail::check_epsilon(epsilon)) return *error;
  DirectionalWidth r;
  r.sandwich_ = body.sandwich();
  r.epsilon_ = epsilon;
  r.backend_ = backend;
  switch (backend) {
    case Backend::exact:
      r.structure_ = detail::exact_structure<D>(body);
      break;
    case Backend::kernel:
      if (epsilon < detail::kLeastEpsilon) {
        return Error{ErrorCode::bad_value, "the kernel backend needs epsilon >= 1e-7", "epsilon"};
      }
      r.structure_ = detail::KernelStructure<D>::build(body, epsilon);
      break;
    case Backend::macbeath: {
      auto structure = detail::macbeath_structure<D>(body, epsilon);
      if (!structure) return structure.error();
      r.structure_ = std::move(structure).value();
      break;
    }
  }
  return r;
}

template class DirectionalWidth<2>;
template class DirectionalWidth<3>;
template class DirectionalWidth<4>;
template class DirectionalWidth<5>;

}  // namespace pd::dimension
