/// @file
/// Many pairs at once: numpy columns in and out, the interpreter's lock released, every core at work.
#pragma once

#include "python/pair_query.hpp"

namespace pd::python {

/// Declares the queries of many pairs.
void bind_batch_queries(py::module_& module);

}  // namespace pd::python
