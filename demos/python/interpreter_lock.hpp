/// @file
/// The interpreter's lock, released and taken again by threads that may outlive the interpreter.
#pragma once

#include <pybind11/pybind11.h>
#include <unistd.h>

namespace pd::python {

/// Calls `take`, a function of Python that takes the interpreter's lock.
///
/// While Python ends, a daemon thread gets no lock. Python 3.9 to 3.13 unwind it by pthread_exit, through destructors
/// that need the lock and through every `catch (...)`, which ends the process. Here the thread sleeps until the process
/// is gone, as it does in Python 3.14.
template <class Take>
auto take_lock(const Take& take) noexcept {
  try {
    return take();
  } catch (...) {
    for (;;) ::pause();
  }
}

/// Releases the interpreter's lock for as long as it lives.
class Unlocked {
 public:
  Unlocked() : state_(PyEval_SaveThread()) {}
  ~Unlocked() {
    take_lock([this] { PyEval_RestoreThread(state_); });
  }
  Unlocked(const Unlocked&) = delete;
  Unlocked& operator=(const Unlocked&) = delete;

 private:
  PyThreadState* state_;
};

/// Takes the interpreter's lock for as long as it lives, in a thread that an Unlocked has released.
class Locked {
 public:
  Locked() : state_(take_lock([] { return PyGILState_Ensure(); })) {}
  ~Locked() { PyGILState_Release(state_); }
  Locked(const Locked&) = delete;
  Locked& operator=(const Locked&) = delete;

 private:
  PyGILState_STATE state_;
};

}  // namespace pd::python
