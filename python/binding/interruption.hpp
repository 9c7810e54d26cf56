#pragma once

#include <cstdint>

namespace vantage::python {

/// Checks for Ctrl-C and other Python signals during work without the interpreter's lock. Create it
/// under that lock in the working thread; it must live as long as the work. Python handles signals
/// only in its main thread: there has_raised() acquires the lock every 50 ms and runs the handlers.
/// In other threads it stays false.
class Interruption {
 public:
  Interruption();
  ~Interruption();
  Interruption(const Interruption&) = delete;
  Interruption& operator=(const Interruption&) = delete;
  Interruption(Interruption&&) = delete;
  Interruption& operator=(Interruption&&) = delete;

  /// True if a handler has raised since the newest object of this thread was created. For
  /// Deadline::unless.
  static bool has_raised();
  /// Must be called under the lock after the work. @throws the exception of the handler, if any
  void rethrow() const;

 private:
  Interruption* outer_;  ///< previous object of the same thread: a handler may start a plan, too
  std::int64_t next_ns_;
  bool came_ = false;
};

}  // namespace vantage::python
