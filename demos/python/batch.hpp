/// @file
/// Many pairs at once: numpy columns in and out, the interpreter's lock released, every core at work.
#pragma once

#include <cstdint>
#include <functional>

#include "python/pair_query.hpp"

namespace pd::python {

/// Calls `row(i, workspace)` for every i in [0, count), from `threads` threads; returns when all are done.
///
/// No order is promised between rows, so `row` writes to places of its own. Threads live as long as the call: a process
/// may fork between calls. The first exception thrown by a row is thrown here.
void for_each_row(std::int64_t count, int threads, const std::function<void(std::int64_t row, Workspace&)>& row);

/// Declares the queries of many pairs.
void bind_batch_queries(py::module_& module);

}  // namespace pd::python
