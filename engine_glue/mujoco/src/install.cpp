#include "pd/mujoco/install.hpp"

#include <atomic>
#include <cstdio>
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

#include "collision_table.hpp"
#include "pair_contacts.hpp"

namespace pd {

namespace detail {

namespace {

/// The only state of the process: the entries in MuJoCo's table, and the counts of its threads.
struct Installed {
  ReplacedEntries entries;
  MujocoOptions options;
  std::atomic<std::int64_t> generation{0};  ///< of the report; counts of an earlier generation are void

  std::mutex mutex;  ///< guards what follows
  struct ThreadCounters* threads = nullptr;
  MujocoReport ended;  ///< of threads that have ended
  std::array<bool, kMujocoRefusals> named{};

  static Installed& instance() {
    static Installed installed;
    return installed;
  }
};

/// Written by its thread, read by anyone.
struct ThreadCounters {
  std::atomic<std::int64_t> generation{-1}, answered{0}, points{0}, conversions{0};
  std::array<std::atomic<std::int64_t>, kMujocoRefusals> left{};
  ThreadCounters* next = nullptr;

  ThreadCounters() {
    Installed& installed = Installed::instance();
    const std::scoped_lock lock(installed.mutex);
    next = std::exchange(installed.threads, this);
  }
  ~ThreadCounters() {
    Installed& installed = Installed::instance();
    const std::scoped_lock lock(installed.mutex);
    add_to(installed.ended, installed.generation);
    for (ThreadCounters** place = &installed.threads; *place != nullptr; place = &(*place)->next) {
      if (*place == this) {
        *place = next;
        break;
      }
    }
  }
  ThreadCounters(const ThreadCounters&) = delete;
  ThreadCounters& operator=(const ThreadCounters&) = delete;

  void begin(std::int64_t now) {
    if (generation.load(std::memory_order_relaxed) == now) return;
    for (auto* counter : {&answered, &points, &conversions}) counter->store(0, std::memory_order_relaxed);
    for (auto& counter : left) counter.store(0, std::memory_order_relaxed);
    generation.store(now, std::memory_order_release);
  }
  void add_to(MujocoReport& report, std::int64_t now) const {
    if (generation.load(std::memory_order_acquire) != now) return;
    report.answered += answered.load(std::memory_order_relaxed);
    report.contact_points += points.load(std::memory_order_relaxed);
    report.conversions += conversions.load(std::memory_order_relaxed);
    for (std::size_t i = 0; i < left.size(); ++i) report.left[i] += left[i].load(std::memory_order_relaxed);
  }
};

void add(std::atomic<std::int64_t>& counter, std::int64_t n) {
  counter.store(counter.load(std::memory_order_relaxed) + n, std::memory_order_relaxed);
}

void name_once(Installed& installed, const NamedRefusal& refusal) {
  const auto kind = static_cast<std::size_t>(refusal.kind);
  {
    const std::scoped_lock lock(installed.mutex);
    if (std::exchange(installed.named[kind], true)) return;
    installed.ended.first[kind] = refusal.text;
  }
  if (installed.options.warning == nullptr) return;
  const std::string line = "pdepth: " + refusal.text + ". MuJoCo's own contact answers for such pairs.";
  installed.options.warning(line.c_str(), installed.options.user);
}

struct ThreadState {
  ThreadCounters counters;
  PairContacts contacts;
};

int collide(const mjModel* model, CollisionData* data, CollisionContact* contacts, int geom1, int geom2,
            mjtNum margin) {
  Installed& installed = Installed::instance();
  const MujocoOptions& options = installed.options;
  const mjfCollision own = installed.entries.before(model->geom_type[geom1], model->geom_type[geom2]);
  if (options.takes_pair != nullptr && !options.takes_pair(model, geom1, geom2, options.user)) {
    return own(model, data, contacts, geom1, geom2, margin);
  }
  thread_local ThreadState state;
  ThreadCounters& counters = state.counters;
  counters.begin(installed.generation.load(std::memory_order_relaxed));
  const std::int64_t conversions = state.contacts.conversions();
  const auto refusal = state.contacts.ask({model, data, geom1, geom2, static_cast<double>(margin), 0}, options);
  add(counters.conversions, state.contacts.conversions() - conversions);
  if (refusal) {
    add(counters.left[static_cast<std::size_t>(refusal->kind)], 1);
    name_once(installed, *refusal);
    return own(model, data, contacts, geom1, geom2, margin);
  }
  const ContactManifold& found = state.contacts.points();
  const Vec3 normal = -found.normal;
  for (int i = 0; i < found.count; ++i) {
    const ContactPoint& point = found.points[static_cast<std::size_t>(i)];
    contacts[i].dist = static_cast<mjtNum>(-point.depth);
    for (int k = 0; k < 3; ++k) {
      contacts[i].pos[k] = static_cast<mjtNum>(point.position_a[k] + (point.position_b[k] - point.position_a[k]) / 2);
    }
    set_normal(contacts[i], normal.data());
  }
  add(counters.answered, 1);
  add(counters.points, found.count);
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
  installed.generation.fetch_add(1);
  installed.ended = {};
  installed.named = {};
  return installed.entries.put(&detail::collide, &detail::recorder_entries());
}

void uninstall_mujoco() {
  detail::Installed& installed = detail::Installed::instance();
  const std::scoped_lock lock(installed.mutex);
  installed.entries.put_back(&detail::recorder_entries());
}

MujocoReport mujoco_report() {
  detail::Installed& installed = detail::Installed::instance();
  const std::scoped_lock lock(installed.mutex);
  MujocoReport report = installed.ended;
  for (const auto* thread = installed.threads; thread != nullptr; thread = thread->next) {
    thread->add_to(report, installed.generation);
  }
  return report;
}

}  // namespace pd
