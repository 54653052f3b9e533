/// @file
/// The allocator of a context: all memory comes from it and goes back, a query allocates nothing once a context has
/// grown, and any allocation may fail.
#include <gtest/gtest.h>

#include <cstdlib>
#include <map>
#include <mutex>

#include "c_interface/c_library.hpp"
#include "scenes/shape_families.hpp"

namespace pd::c_test {
namespace {

/// The blocks that one allocator has handed out.
struct Books {
  std::mutex mutex;
  std::map<void*, std::pair<std::size_t, std::size_t>> blocks;
  std::int64_t allocations = 0;
  std::int64_t failing = -1;

  static void* allocate(void* user, std::size_t bytes, std::size_t alignment) {
    Books& books = *static_cast<Books*>(user);
    const std::scoped_lock lock(books.mutex);
    if (books.allocations++ == books.failing) return nullptr;
    void* const block = std::aligned_alloc(alignment, (bytes + alignment - 1) / alignment * alignment);
    books.blocks[block] = {bytes, alignment};
    return block;
  }
  static void release(void* user, void* block, std::size_t bytes, std::size_t alignment) {
    Books& books = *static_cast<Books*>(user);
    const std::scoped_lock lock(books.mutex);
    const auto found = books.blocks.find(block);
    ASSERT_NE(found, books.blocks.end());
    EXPECT_EQ(found->second, std::make_pair(bytes, alignment));
    books.blocks.erase(found);
    std::free(block);
  }
};

#ifdef PD_VALIDATE
/// Checks of surfaces keep a buffer for each thread until the thread ends.
constexpr bool kThreadsKeepBuffers = true;
#else
constexpr bool kThreadsKeepBuffers = false;
#endif

/// Counts, checks what comes back, and fails at one allocation if asked to.
class Ledger {
 public:
  Ledger() { allocator_ = {sizeof allocator_, 0, books_, &Books::allocate, &Books::release}; }
  ~Ledger() {
    if (kThreadsKeepBuffers) return;
    EXPECT_TRUE(books_->blocks.empty()) << books_->blocks.size() << " blocks were not given back";
  }
  Ledger(const Ledger&) = delete;
  Ledger& operator=(const Ledger&) = delete;

  [[nodiscard]] const pdepth_allocator* allocator() const { return &allocator_; }
  [[nodiscard]] std::int64_t allocations() const { return books_->allocations; }
  /// The allocation after `more` others fails, and only that.
  void fail_after(std::int64_t more) { books_->failing = books_->allocations + more; }

 private:
  static Books* new_books() {
    static std::vector<std::unique_ptr<Books>> all;  // until the process ends, when threads have given back all
    return all.emplace_back(std::make_unique<Books>()).get();
  }

  Books* books_ = new_books();
  pdepth_allocator allocator_{};
};

std::vector<double> ball(int n) {
  scenes::Random random(7);
  return numbers_of(scenes::sphere_hull(n, random));
}

/// Two hulls that overlap in a general way, and what a frame asks of them.
class Frame {
 public:
  explicit Frame(const pdepth_allocator* allocator)
      : context_(make_context(allocator)),
        a_(make_shape(context_, &pdepth_convex_hull, ball(40).data(), 40)),
        b_(make_shape(context_, &pdepth_cylinder, 0.7, 0.4, 2)),
        pair_(make_pair(context_)) {}

  /// @return the first status that is not OK.
  pdepth_status ask(double shift) {
    pdepth_question question = question_of(a_.get(), a_.get());
    question.pose_b = {PDEPTH_POSE_QUATERNION_WXYZ, 0, {1 + shift, 0.3, 0.2, 0.5, 0.5, 0.5, 0.5}};
    auto answer = sized<pdepth_answer>();
    auto manifold = sized<pdepth_manifold>();
    auto along = sized<pdepth_directional>();
    const std::array<double, 3> direction{0.3, 0.4, 0.5};
    pdepth_context* const c = context_.get();
    for (const pdepth_shape* b : {a_.get(), b_.get()}) {
      question.b = b;
      for (pdepth_pair* const pair : {static_cast<pdepth_pair*>(nullptr), pair_.get()}) {
        question.pair = pair;
        for (const std::int32_t bracket : {PDEPTH_BRACKET_CERTIFIED, PDEPTH_BRACKET_CONTACT}) {
          auto settings = sized<pdepth_settings>();
          settings.bracket = bracket;
          question.settings = &settings;
          if (const auto status = pdepth_depth(c, &question, &answer); status != PDEPTH_OK) return status;
          exact_signs_ += answer.exact_signs;
          if (const auto status = pdepth_contact_manifold(c, &question, 0.01, &manifold); status != PDEPTH_OK) {
            return status;
          }
        }
      }
    }
    question.pair = nullptr;
    question.settings = nullptr;
    return pdepth_depth_along(c, &question, direction.data(), &along);
  }

  [[nodiscard]] std::int64_t exact_signs() const { return exact_signs_; }
  [[nodiscard]] const Context& context() const { return context_; }

 private:
  Context context_;
  Shape a_;
  Shape b_;
  Pair pair_;
  std::int64_t exact_signs_ = 0;
};

TEST(CMemory, IsNotAllocatedOnceAContextHasGrown) {
  Ledger ledger;
  Frame frame(ledger.allocator());
  for (int i = 0; i < 3; ++i) ASSERT_EQ(frame.ask(0.01 * i), PDEPTH_OK);
  const std::int64_t grown = ledger.allocations(), exact = frame.exact_signs();
  EXPECT_GT(grown, 20);
  for (int i = 0; i < 50; ++i) ASSERT_EQ(frame.ask(0.001 * i), PDEPTH_OK);
  EXPECT_EQ(ledger.allocations(), grown);
  EXPECT_EQ(frame.exact_signs(), exact);
}

/// Every allocation of a frame fails once. The call says so, and the context answers as before.
TEST(CMemory, MayRunOutAtAnyAllocation) {
  std::int64_t failures = 0;
  for (std::int64_t k = 0; k < 10'000; ++k) {
    Ledger ledger;
    Frame frame(ledger.allocator());
    ledger.fail_after(k);
    const pdepth_status status = frame.ask(0);
    if (status == PDEPTH_OK) break;
    ASSERT_EQ(status, PDEPTH_OUT_OF_MEMORY) << k;
    ASSERT_NE(error_of(frame.context()).find("out_of_memory"), std::string::npos);
    ASSERT_EQ(frame.ask(0), PDEPTH_OK) << k;
    ++failures;
  }
  EXPECT_GT(failures, 10);
}

TEST(CMemory, MayRunOutWhereShapesAreMade) {
  const std::vector<double> points = ball(60);
  std::int64_t failures = 0;
  for (std::int64_t k = 0; k < 10'000; ++k) {
    Ledger ledger;
    ledger.fail_after(k);
    pdepth_context* made = nullptr;
    const pdepth_status created = pdepth_context_create(ledger.allocator(), &made);
    const Context context(made);
    if (created != PDEPTH_OK) {
      ASSERT_EQ(created, PDEPTH_OUT_OF_MEMORY);
      ++failures;
      continue;
    }
    pdepth_shape* hull = nullptr;
    pdepth_shape* swept = nullptr;
    pdepth_shape* whole = nullptr;
    pdepth_status status = pdepth_convex_hull(made, points.data(), 60, &hull);
    if (status == PDEPTH_OK) status = pdepth_with_margin(made, hull, 0.1, &swept);
    const std::array<pdepth_part, 2> parts{pdepth_part{hull, {}}, pdepth_part{swept, {}}};
    if (status == PDEPTH_OK) status = pdepth_compound(made, parts.data(), 2, &whole);
    for (pdepth_shape* shape : {hull, swept, whole}) pdepth_shape_release(shape);
    if (status == PDEPTH_OK) break;
    ASSERT_EQ(status, PDEPTH_OUT_OF_MEMORY);
    ++failures;
  }
  EXPECT_GT(failures, 20);
}

/// Shapes live on after their context, and are freed by whoever gives back the last reference.
TEST(CMemory, OfShapesOutlivesTheContext) {
  Ledger ledger;
  const std::array<double, 3> half{1, 2, 3};
  Context context = make_context(ledger.allocator());
  Shape box = make_shape(context, &pdepth_box, half.data());
  const pdepth_part part{box.get(), {}};
  const Shape whole = make_shape(context, &pdepth_compound, &part, 1);
  pdepth_shape_retain(box.get());
  pdepth_shape_release(box.get());
  box.reset();
  context.reset();
  const Context other = make_context();
  auto info = sized<pdepth_shape_info>();
  ASSERT_EQ(pdepth_shape_describe(other.get(), whole.get(), 0, &info), PDEPTH_OK);
  EXPECT_EQ(info.vertices, 8);
  EXPECT_EQ(info.facets, 6);
  EXPECT_EQ(info.dimension, 3);
  EXPECT_EQ(info.is_convex, 0);
}

/// An allocator that has none, or hands out blocks that are not aligned, is a named error.
TEST(CMemory, MisalignedIsRefused) {
  struct Crooked {
    static void* allocate(void*, std::size_t bytes, std::size_t) {
      return static_cast<char*>(std::malloc(bytes + 8)) + 8;
    }
    static void release(void*, void* block, std::size_t, std::size_t) { std::free(static_cast<char*>(block) - 8); }
  };
  pdepth_allocator allocator{sizeof allocator, 0, nullptr, &Crooked::allocate, &Crooked::release};
  pdepth_context* context = nullptr;
  EXPECT_EQ(pdepth_context_create(&allocator, &context), PDEPTH_OUT_OF_MEMORY);
  allocator.release = nullptr;
  EXPECT_EQ(pdepth_context_create(&allocator, &context), PDEPTH_NULL_ARGUMENT);
  allocator.size = 0;
  EXPECT_EQ(pdepth_context_create(&allocator, &context), PDEPTH_BAD_VALUE);
  EXPECT_EQ(context, nullptr);
}

}  // namespace
}  // namespace pd::c_test
