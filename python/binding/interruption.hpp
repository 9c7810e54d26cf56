#pragma once

#include <cstdint>

namespace vantage::python {

/// Ctrl-C, and whatever else Python's signal handlers are for, during work without the
/// interpreter's lock. Made under that lock by the thread that works, while it works; in the main
/// thread, which alone hears signals, the lock is then taken each 50 ms, for the handlers to run.
class Interruption {
 public:
  Interruption();
  ~Interruption();
  Interruption(const Interruption&) = delete;
  Interruption& operator=(const Interruption&) = delete;
  Interruption(Interruption&&) = delete;
  Interruption& operator=(Interruption&&) = delete;

  /// For Deadline::unless: whether a handler has raised since this thread's last one was made.
  static bool came();
  /// Under the lock, when the work has ended. @throws what the handler raised
  void rethrow() const;

 private:
  Interruption* outer_;  ///< of the same thread: a handler may plan, too
  std::int64_t next_ns_;
  bool came_ = false;
};

}  // namespace vantage::python
