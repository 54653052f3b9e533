/// @file
/// Batches of `pdepth.h`: rows on one thread or many, each row by itself.

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <limits>
#include <system_error>
#include <thread>
#include <vector>

#include "c_interface/answers.hpp"
#include "c_interface/handles.hpp"
#include "c_interface/reading.hpp"

namespace pd::c_interface {

namespace {

constexpr std::int32_t kMostThreads = 256;

template <class T>
T* at_stride(T* first, std::ptrdiff_t stride, std::int64_t row) {
  using Byte = std::conditional_t<std::is_const_v<T>, const unsigned char, unsigned char>;
  return reinterpret_cast<T*>(reinterpret_cast<Byte*>(first) + stride * row);
}

Pose read_pose_of(const pdepth_pose_array& poses, std::int64_t row, const char* argument) {
  return poses.numbers == nullptr ? Pose()
                                  : read_pose(poses.form, at_stride(poses.numbers, poses.stride, row), argument);
}

/// The rows of a batch, read one at a time.
class Rows {
 public:
  Rows(const pdepth_batch* batch, SettingsRoom& room)
      : batch_(read_struct(batch, "batch")), settings_(read_settings(batch_.settings, room)) {
    if (batch_.count < 0) refuse(PDEPTH_BAD_VALUE, "must be 0 or more", "batch.count");
    if (batch_.threads < 0 || batch_.threads > kMostThreads) {
      refuse(PDEPTH_BAD_VALUE, "must lie in 0 to 256", "batch.threads");
    }
    require_unused(batch_.poses_a.reserved, "batch.poses_a");
    require_unused(batch_.poses_b.reserved, "batch.poses_b");
    if (batch_.count > 0) given(batch_.a, "batch.a"), given(batch_.b, "batch.b");
  }

  [[nodiscard]] std::int64_t count() const { return batch_.count; }
  [[nodiscard]] std::int64_t threads() const {
    return std::clamp<std::int64_t>(batch_.threads, 1, std::max<std::int64_t>(batch_.count, 1));
  }
  [[nodiscard]] Question question(std::int64_t row) const {
    const pdepth_shape& a = given(*at_stride(batch_.a, batch_.stride_a, row), "a");
    const pdepth_shape& b = given(*at_stride(batch_.b, batch_.stride_b, row), "b");
    return {a,
            b,
            {a.convex(), read_pose_of(batch_.poses_a, row, "pose_a")},
            {b.convex(), read_pose_of(batch_.poses_b, row, "pose_b")},
            settings_,
            batch_.pairs == nullptr ? nullptr : *at_stride(batch_.pairs, batch_.stride_pairs, row)};
  }

 private:
  const pdepth_batch& batch_;
  const Settings& settings_;
};

/// The first failure that one thread met.
struct Failure {
  std::int64_t row = std::numeric_limits<std::int64_t>::max();
  ErrorRecord error;
};

/// Threads that are joined at the end of a scope, also if it ends by an exception (std::jthread is missing in libc++
/// 13).
struct JoinedThreads {
  std::vector<std::thread> threads;
  ~JoinedThreads() {
    for (std::thread& thread : threads) thread.join();
  }
};

/// Calls `answer(row, workspace, out)`, which writes a row's struct, for every row.
template <class Struct, class Answer>
pdepth_status for_each_row(pdepth_context& context, const Rows& rows, Struct* first, std::ptrdiff_t stride,
                           Answer&& answer) {
  if (rows.count() == 0) return PDEPTH_OK;
  const std::uint32_t size = answer_struct(first, "answers").size;
  if (rows.count() > 1 && static_cast<std::size_t>(std::abs(stride)) < size) {
    refuse(PDEPTH_BAD_VALUE, "must be at least the size of an answer", "stride");
  }
  const auto threads = static_cast<std::size_t>(rows.threads());
  while (context.workspaces.size() < threads) context.workspaces.push_back(std::make_unique<Workspace>());
  std::vector<Failure> failures(threads);
  std::atomic<std::int64_t> next{0};
  // Small enough that the last piece keeps nobody waiting, large enough that taking one costs nothing.
  const std::int64_t piece = std::clamp<std::int64_t>(rows.count() / (8 * static_cast<std::int64_t>(threads)), 1, 64);
  const auto work = [&](std::size_t thread) noexcept {
    const AllocationScope scope(context.source);
    Failure& failure = failures[thread];
    for (;;) {
      const std::int64_t begin = next.fetch_add(piece);
      if (begin >= rows.count()) return;
      for (std::int64_t row = begin; row < std::min(begin + piece, rows.count()); ++row) {
        Struct& out = *at_stride(first, stride, row);
        out.size = size;
        try {
          answer(row, *context.workspaces[thread], out);
        } catch (...) {
          ErrorRecord error;
          out.status = error.take_exception(row);
          if (row < failure.row) failure = {row, error};
        }
      }
    }
  };
  {
    JoinedThreads others;
    others.threads.reserve(threads - 1);
    try {
      for (std::size_t t = 1; t < threads; ++t) others.threads.emplace_back(work, t);
    } catch (const std::system_error&) {
      // A thread that the system does not give leaves its rows to the others: the answers are the same.
    }
    work(0);
  }
  const Failure& worst = *std::min_element(failures.begin(), failures.end(),
                                           [](const Failure& x, const Failure& y) { return x.row < y.row; });
  if (worst.error.status != PDEPTH_OK) context.error = worst.error;
  return worst.error.status;
}

}  // namespace

}  // namespace pd::c_interface

using namespace pd;               // NOLINT(google-build-using-namespace): the functions of C stand in no namespace
using namespace pd::c_interface;  // NOLINT(google-build-using-namespace)

namespace {

/// A batch at the border: its own refusals, else the status of the first row that failed.
template <class Struct, class Answer>
pdepth_status ask_rows(pdepth_context* context, const pdepth_batch* batch, Struct* answers, std::ptrdiff_t stride,
                       Answer&& answer) {
  pdepth_status of_rows = PDEPTH_OK;
  const pdepth_status status = at_border(context, [&] {
    SettingsRoom room;
    const Rows rows(batch, room);
    of_rows = for_each_row(*context, rows, answers, stride, [&](std::int64_t row, Workspace& space, Struct& out) {
      answer(rows.question(row), space, out);
    });
  });
  return status != PDEPTH_OK ? status : of_rows;
}

}  // namespace

pdepth_status pdepth_depth_batch(pdepth_context* context, const pdepth_batch* batch, pdepth_answer* answers,
                                 ptrdiff_t stride) {
  return ask_rows(context, batch, answers, stride, [](const Question& question, Workspace& space, pdepth_answer& out) {
    ask_depth(question, space, out);
  });
}

pdepth_status pdepth_manifold_batch(pdepth_context* context, const pdepth_batch* batch, double breaking_threshold,
                                    pdepth_manifold* manifolds, ptrdiff_t stride) {
  return ask_rows(context, batch, manifolds, stride,
                  [&](const Question& question, Workspace& space, pdepth_manifold& out) {
                    ask_manifold(question, breaking_threshold, space, out);
                  });
}

pdepth_status pdepth_derivatives_batch(pdepth_context* context, const pdepth_batch* batch,
                                       pdepth_derivatives* derivatives, ptrdiff_t stride) {
  return ask_rows(context, batch, derivatives, stride,
                  [](const Question& question, Workspace& space, pdepth_derivatives& out) {
                    ask_derivatives(question, space, out, nullptr);
                  });
}
