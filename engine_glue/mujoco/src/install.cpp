#include "pd/mujoco/install.hpp"

#include <cstdio>
#include <mutex>

#include "collision_table.hpp"
#include "door_counts.hpp"
#include "pair_contacts.hpp"

namespace pd {

namespace detail {

namespace {

/// The only state of the process: the entries in MuJoCo's table.
struct Installed {
  std::mutex mutex;  ///< of install and uninstall
  ReplacedEntries entries;
  MujocoOptions options;

  static Installed& instance() {
    static Installed installed;
    return installed;
  }
};

using Counts = DoorCounts<MujocoReport>;

void name_once(const MujocoOptions& options, const NamedRefusal& refusal) {
  if (!Counts::instance().first_of(static_cast<std::size_t>(refusal.kind), refusal.text)) return;
  if (options.warning == nullptr) return;
  const std::string line = "pdepth: " + refusal.text + ". MuJoCo's own contact answers for such pairs.";
  options.warning(line.c_str(), options.user);
}

int collide(const mjModel* model, CollisionData* data, CollisionContact* contacts, int geom1, int geom2,
            mjtNum margin) {
  const Installed& installed = Installed::instance();
  const MujocoOptions& options = installed.options;
  const mjfCollision own = installed.entries.before(model->geom_type[geom1], model->geom_type[geom2]);
  if (options.takes_pair != nullptr && !options.takes_pair(model, geom1, geom2, options.user)) {
    return own(model, data, contacts, geom1, geom2, margin);
  }
  thread_local PairContacts pairs;
  Counts::Thread& counts = Counts::instance().here();
  const std::int64_t conversions = pairs.conversions();
  const auto refusal = pairs.ask({model, data, geom1, geom2, static_cast<double>(margin)}, options);
  counts.converted(pairs.conversions() - conversions);
  if (refusal) {
    counts.left(static_cast<std::size_t>(refusal->kind));
    name_once(options, *refusal);
    return own(model, data, contacts, geom1, geom2, margin);
  }
  const ContactManifold& found = pairs.points();
  const Vec3 normal = -found.normal;
  for (int i = 0; i < found.count; ++i) {
    const ContactPoint& point = found.points[static_cast<std::size_t>(i)];
    contacts[i].dist = static_cast<mjtNum>(-point.depth);
    for (int k = 0; k < 3; ++k) {
      contacts[i].pos[k] = static_cast<mjtNum>(point.position_a[k] + (point.position_b[k] - point.position_a[k]) / 2);
    }
    set_normal(contacts[i], normal.data());
  }
  counts.answered(found.count);
  return found.count;
}

}  // namespace

}  // namespace detail

void MujocoOptions::print_warning(const char* line, void* /*user*/) { std::fprintf(stderr, "%s\n", line); }

Expected<int> install_mujoco(const MujocoOptions& options) {
  if (mj_version() != mjVERSION_HEADER) {
    return Error{ErrorCode::unsupported,
                 "MuJoCo's library is version " + std::to_string(mj_version()) + ", but pdepth was compiled with the " +
                     "headers of version " + std::to_string(mjVERSION_HEADER) +
                     ": compile pdepth with the library's own",
                 "mujoco"};
  }
  if (!(options.delta >= 0 && options.delta <= 1)) {
    return Error{ErrorCode::bad_value, "delta is a relative error from 0 to 1, and 0 stands for 1e-6", "delta"};
  }
  detail::Installed& installed = detail::Installed::instance();
  const std::scoped_lock lock(installed.mutex);
  installed.options = options;
  detail::Counts::instance().restart();
  return installed.entries.put(&detail::collide, &detail::recorder_entries());
}

void uninstall_mujoco() {
  detail::Installed& installed = detail::Installed::instance();
  const std::scoped_lock lock(installed.mutex);
  installed.entries.put_back(&detail::recorder_entries());
}

MujocoReport mujoco_report() { return detail::Counts::instance().report(); }

}  // namespace pd
