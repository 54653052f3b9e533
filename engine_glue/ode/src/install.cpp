#include "pd/ode/install.hpp"

#include <algorithm>
#include <cstdio>
#include <string>
#include <utility>

#include "contact_record.hpp"
#include "door_counts.hpp"
#include "installed.hpp"
#include "own_colliders.hpp"
#include "pair_contacts.hpp"

namespace pd {

namespace detail {

namespace {

/// The number of contacts that the caller has room for.
constexpr int kCountMask = 0xffff;

using Counts = DoorCounts<OdeReport>;

void name_once(const OdeOptions& options, const NamedOdeRefusal& refusal) {
  if (!Counts::instance().first_of(static_cast<std::size_t>(refusal.kind), refusal.text)) return;
  if (options.warning == nullptr) return;
  const std::string line = "pdepth: " + refusal.text + ". ODE's own contact answers for such pairs.";
  options.warning(line.c_str(), options.user);
}

/// Writes the deepest points first. @return their number
int write_contacts(ContactManifold found, dGeomID first, dGeomID second, dContactGeom* contacts, int skip, int room) {
  const int count = std::min(found.count, room);
  for (int i = 0; i < count; ++i) {
    ContactPoint& point = found.points[static_cast<std::size_t>(i)];
    const auto deepest = std::max_element(&point, found.points.data() + found.count,
                                          [](const auto& p, const auto& q) { return p.depth < q.depth; });
    std::swap(point, *deepest);
    dContactGeom& contact = contact_at(contacts, skip, i);
    for (int k = 0; k < 3; ++k) {
      contact.pos[k] = static_cast<dReal>(point.position_a[k] + (point.position_b[k] - point.position_a[k]) / 2);
      contact.normal[k] = static_cast<dReal>(found.normal[k]);
    }
    contact.depth = static_cast<dReal>(std::max(point.depth, 0.0));
    contact.g1 = first;
    contact.g2 = second;
    contact.side1 = contact.side2 = -1;
  }
  return count;
}

int answer(dGeomID first, dGeomID second, int flags, dContactGeom* contacts, int skip) {
  const InstalledOde& installed = InstalledOde::instance();
  const OdeOptions& options = installed.options();
  if (!installed.answers() || (options.takes_pair != nullptr && !options.takes_pair(first, second, options.user))) {
    return collide_by_ode(first, second, flags, contacts, skip);
  }
  thread_local OdePairContacts pairs;
  Counts::Thread& counts = Counts::instance().here();
  const std::int64_t conversions = pairs.conversions();
  const auto refusal = pairs.ask(first, second, options);
  counts.converted(pairs.conversions() - conversions);
  if (refusal) {
    counts.left(static_cast<std::size_t>(refusal->kind));
    name_once(options, *refusal);
    return collide_by_ode(first, second, flags, contacts, skip);
  }
  const int count = write_contacts(pairs.points(), first, second, contacts, skip, flags & kCountMask);
  counts.answered(count);
  return count;
}

int collide(dGeomID first, dGeomID second, int flags, dContactGeom* contacts, int skip) {
  const int count = answer(first, second, flags, contacts, skip);
  if (OdeRecord* record = InstalledOde::instance().record()) record->write(first, second, contacts, skip, count);
  return count;
}

}  // namespace

void InstalledOde::put_or_put_back() {
  const bool wanted = answers_ || record() != nullptr;
  if (wanted == put_) return;
  for (std::size_t i = 0; i < own_colliders.size(); ++i) {
    const OwnCollider& own = own_colliders[i];
    if (wanted) {
      ours_[i] = stands_in_table(own);
      if (ours_[i]) dSetColliderOverride(own.first, own.second, &collide);
    } else if (ours_[i]) {
      put_back(own);
      ours_[i] = false;
    }
  }
  put_ = wanted;
}

int InstalledOde::begin_answers(const OdeOptions& options) {
  const std::scoped_lock lock(mutex_);
  options_ = options;
  answers_ = true;
  put_or_put_back();
  return static_cast<int>(std::count(ours_.begin(), ours_.end(), true));
}

void InstalledOde::end_answers() {
  const std::scoped_lock lock(mutex_);
  answers_ = false;
  put_or_put_back();
}

bool InstalledOde::begin_record(OdeRecord* record) {
  const std::scoped_lock lock(mutex_);
  if (record_.load() != nullptr) return false;
  record_.store(record);
  put_or_put_back();
  return true;
}

void InstalledOde::end_record(const OdeRecord* record) {
  const std::scoped_lock lock(mutex_);
  if (record_.load() != record) return;
  record_.store(nullptr);
  put_or_put_back();
}

}  // namespace detail

void OdeOptions::print_warning(const char* line, void* /*user*/) { std::fprintf(stderr, "%s\n", line); }

Expected<int> install_ode(const OdeOptions& options) {
  if (!(options.delta >= 0 && options.delta <= 1)) {
    return Error{ErrorCode::bad_value, "delta is a relative error from 0 to 1, and 0 stands for 1e-6", "delta"};
  }
  if (dCheckConfiguration(sizeof(dReal) == 8 ? "ODE_double_precision" : "ODE_single_precision") == 0) {
    return Error{ErrorCode::unsupported, "ODE's library has another precision than the headers: compile with its own",
                 "ode"};
  }
  detail::Counts::instance().restart();
  return detail::InstalledOde::instance().begin_answers(options);
}

void uninstall_ode() { detail::InstalledOde::instance().end_answers(); }

OdeReport ode_report() { return detail::Counts::instance().report(); }

}  // namespace pd
