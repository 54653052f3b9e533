#include "pd/dimension/directional_width.hpp"

#include <cmath>
#include <utility>

#include "dimension/backends/cone_structure.hpp"
#include "dimension/backends/kernel_structure.hpp"
#include "dimension/backends/macbeath_structure.hpp"
#include "dimension/validate.hpp"
#include "numeric/floating_point_guard.hpp"

namespace pd::dimension {

Expected<detail::PreparedBody> detail::PreparedBody::build(const AnyBody& body, double epsilon, Backend backend) {
  const pd::detail::FloatingPointGuard guard;
  if (const auto error = check_epsilon(epsilon)) return *error;
  PreparedBody r{nullptr, body.sandwich, epsilon, backend};
  switch (backend) {
    case Backend::exact:
      r.structure = exact_structure(body);
      break;
    case Backend::kernel:
      if (epsilon < kLeastEpsilon) {
        return Error{ErrorCode::bad_value, "the kernel backend needs epsilon >= 1e-7", "epsilon"};
      }
      r.structure = KernelStructure::build(body, epsilon);
      break;
    case Backend::macbeath: {
      auto structure = macbeath_structure(body, epsilon);
      if (!structure) return structure.error();
      r.structure = std::move(structure).value();
      break;
    }
  }
  return r;
}

template <int D>
Expected<DirectionalWidth<D>> DirectionalWidth<D>::build(const Body<D>& body, double epsilon, Backend backend) {
  detail::AnyBody any = detail::any<D>(body);
  any.storage = std::make_shared<const Body<D>>(body);
  auto prepared = detail::PreparedBody::build(any, epsilon, backend);
  if (!prepared) return prepared.error();
  DirectionalWidth r;
  r.structure_ = prepared->structure;
  r.sandwich_ = body.sandwich();
  r.epsilon_ = epsilon;
  r.backend_ = backend;
  return r;
}

template <int D>
SupportPoint<D> DirectionalWidth<D>::support(const Vector<D>& direction, QueryCounters& counters) const {
  return detail::fixed<D>(structure_->support(detail::any<D>(direction), counters));
}

template <int D>
DirectionalWidthAnswer<D> DirectionalWidth<D>::width(const Vector<D>& direction, QueryCounters& counters) const {
  const double largest = direction.cwiseAbs().maxCoeff();
  const bool extreme = largest > 0 && std::isfinite(largest) && std::abs(std::ilogb(largest)) > 400;
  const int exponent = extreme ? std::ilogb(largest) : 0;
  Vector<D> v = direction;
  if (exponent != 0) {
    for (double& x : v) x = std::ldexp(x, -exponent);
  }
  DirectionalWidthAnswer<D> r{0, support(v, counters), support(-v, counters)};
  r.least.value = -r.least.value;
  r.width = (r.most.value - r.least.value) / v.norm();
  if (exponent != 0) {
    for (double* const value : {&r.most.value, &r.least.value}) *value = std::ldexp(*value, exponent);
  }
  return r;
}

template <int D>
StructureSize DirectionalWidth<D>::size() const {
  return structure_->size();
}

template class DirectionalWidth<2>;
template class DirectionalWidth<3>;
template class DirectionalWidth<4>;
template class DirectionalWidth<5>;

}  // namespace pd::dimension
