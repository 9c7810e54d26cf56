#include "python/binding/interruption.hpp"

#include <ctime>
#include <limits>

#include <unistd.h>

#include "python/binding/bind.hpp"

namespace vantage::python {
namespace {

constexpr std::int64_t kEvery_ns = 50'000'000;

thread_local Interruption* innermost = nullptr;

// Returns the time of a monotonic clock with a resolution of a few milliseconds. The call is cheap,
// because searches read the time at each node.
std::int64_t coarse_ns() {
  timespec now{};
  ::clock_gettime(CLOCK_MONOTONIC_COARSE, &now);
  return std::int64_t{1'000'000'000} * now.tv_sec + now.tv_nsec;
}

}  // namespace

Interruption::Interruption()
    : outer_(innermost),
      next_ns_(::gettid() == ::getpid() ? coarse_ns() + kEvery_ns
                                        : std::numeric_limits<std::int64_t>::max()) {
  innermost = this;
}

Interruption::~Interruption() { innermost = outer_; }

bool Interruption::has_raised() {
  Interruption* const self = innermost;
  if (self == nullptr || self->has_raised_ || coarse_ns() < self->next_ns_) {
    return self != nullptr && self->has_raised_;
  }
  const py::gil_scoped_acquire lock;
  self->has_raised_ = PyErr_CheckSignals() != 0;  // Python stores the exception until rethrow()
  self->next_ns_ = coarse_ns() + kEvery_ns;
  return self->has_raised_;
}

void Interruption::rethrow() const {
  if (has_raised_) {
    throw py::error_already_set();
  }
}

}  // namespace vantage::python
