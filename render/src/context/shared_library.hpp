/// @file
/// A library opened at run time, with its symbols kept to ourselves.
#pragma once

#include <dlfcn.h>

#include <initializer_list>
#include <utility>

namespace pd::render::detail {

class SharedLibrary {
 public:
  /// Opens the first name that is there (`opened` says whether one was).
  explicit SharedLibrary(std::initializer_list<const char*> names) {
    for (const char* name : names) {
      handle_ = dlopen(name, RTLD_NOW | RTLD_LOCAL);
      if (handle_ != nullptr) {
        break;
      }
    }
  }
  ~SharedLibrary() {
    if (handle_ != nullptr) {
      dlclose(handle_);
    }
  }
  SharedLibrary(SharedLibrary&& other) noexcept : handle_(std::exchange(other.handle_, nullptr)) {}
  SharedLibrary& operator=(SharedLibrary&&) = delete;

  [[nodiscard]] bool opened() const { return handle_ != nullptr; }

  /// Sets `function` to the symbol. @return whether it is there.
  template <class Function>
  [[nodiscard]] bool find(const char* symbol, Function*& function) const {
    function = reinterpret_cast<Function*>(dlsym(handle_, symbol));
    return function != nullptr;
  }

 private:
  void* handle_ = nullptr;
};

}  // namespace pd::render::detail
