#pragma once

#include <cstdint>

namespace vantage::python {

/// Check for Ctrl-C and other Python signals during work without the interpreter's lock. The object
/// must be created with the lock, in the thread that works, and must exist until the work ends.
/// Python handles signals only in its main thread: there has_raised() acquires the lock every 50 ms
/// and runs the signal handlers. In other threads has_raised() is always false.
class Interruption {
 public:
  Interruption();
  ~Interruption();
  Interruption(const Interruption&) = delete;
  Interruption& operator=(const Interruption&) = delete;
  Interruption(Interruption&&) = delete;
  Interruption& operator=(Interruption&&) = delete;

  /// True if a signal handler has raised an exception since the newest object of this thread was
  /// created. Argument for Deadline::with_cancellation().
  static bool has_raised();
  /// Must be called with the interpreter's lock after the work. @throws the exception of the signal
  /// handler, if any
  void rethrow() const;

 private:
  Interruption* outer_;  ///< enclosing object of this thread, if a signal handler starts a plan
  std::int64_t next_ns_;
  bool has_raised_ = false;
};

}  // namespace vantage::python
