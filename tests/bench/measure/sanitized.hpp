/// @file
/// PD_SANITIZED: defined under the address and the thread sanitizer, which stand in front of malloc and take memory of
/// their own. GCC says so by a macro of its own, Clang by a feature.
#pragma once

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define PD_SANITIZED 1
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
#define PD_SANITIZED 1
#endif
#endif
