/// @file
/// Says in one line what a compiler without C++20 would say in hundreds.
#pragma once

// Clang 14 gives 202002L, GCC 10 and older 201709L under -std=c++20.
#if defined(__cplusplus) && __cplusplus < 202002L && !(defined(_MSVC_LANG) && _MSVC_LANG >= 202002L)
#error "pdepth needs C++20: compile with -std=c++20 (CMake: target_compile_features(app PRIVATE cxx_std_20))"
#endif
