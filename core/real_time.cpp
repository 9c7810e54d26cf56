#include "core/real_time.hpp"

#include <cerrno>
#include <charconv>
#include <cstring>
#include <string>
#include <string_view>
#include <thread>

#include <pthread.h>
#include <sched.h>
#include <sys/mman.h>

#include "core/check.hpp"

namespace vantage {
namespace {

int number_of(const char* option, const char* text, int least, int most) {
  int value = 0;
  const std::string_view word = text == nullptr ? "" : text;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  require(error == std::errc{} && end == word.data() + word.size() && !word.empty() &&
              value >= least && value <= most,
          std::string(option) + ": must be a number from " + std::to_string(least) + " to " +
              std::to_string(most));
  return value;
}

/// Sets SCHED_FIFO for the calling thread. Returns 0, or an error number if the system refuses it.
int set_fifo(int priority) {
  sched_param parameters{};
  parameters.sched_priority = priority;
  return pthread_setschedparam(pthread_self(), SCHED_FIFO, &parameters);
}

[[noreturn]] void refuse(const std::string& what, int error, const std::string& remedy) {
  throw StartupError(what + ": refused (" + std::strerror(error) + "); " + remedy);
}

}  // namespace

RealTime take_real_time(int& argc, char** argv) {
  RealTime real_time;
  int kept = 1;
  for (int i = 1; i < argc; ++i) {
    const std::string_view word = argv[i];
    if (word == "--lock-memory") {
      real_time.lock_memory = true;
    } else if (word == "--fifo") {
      real_time.fifo_priority = number_of("--fifo", i + 1 < argc ? argv[++i] : nullptr, 1, 99);
    } else if (word == "--cpu") {
      real_time.cpu = number_of("--cpu", i + 1 < argc ? argv[++i] : nullptr, 0, CPU_SETSIZE - 1);
    } else {
      argv[kept++] = argv[i];
    }
  }
  argc = kept;
  argv[kept] = nullptr;
  return real_time;
}

void apply(const RealTime& real_time) {
  if (real_time.lock_memory && mlockall(MCL_CURRENT | MCL_FUTURE) != 0) {
    refuse("--lock-memory", errno, "raise the memlock limit (ulimit -l) or grant CAP_IPC_LOCK");
  }
  if (real_time.cpu >= 0) {
    cpu_set_t cpus;
    CPU_ZERO(&cpus);
    CPU_SET(static_cast<std::size_t>(real_time.cpu), &cpus);
    const int error = pthread_setaffinity_np(pthread_self(), sizeof(cpus), &cpus);
    if (error != 0) {
      refuse("--cpu " + std::to_string(real_time.cpu), error,
             "choose a CPU that exists and that this process may use (taskset -p shows them)");
    }
  }
  if (real_time.fifo_priority > 0) {
    const int error = set_fifo(real_time.fifo_priority);
    if (error != 0) {
      refuse("--fifo " + std::to_string(real_time.fifo_priority), error,
             "raise the rtprio limit (ulimit -r) or grant CAP_SYS_NICE");
    }
  }
}

bool grants_fifo(int priority) {
  bool is_granted = false;
  std::thread([&] { is_granted = set_fifo(priority) == 0; }).join();
  return is_granted;
}

bool runs_in_real_time() {
  const int policy = sched_getscheduler(0);  // includes SCHED_RESET_ON_FORK
  return policy == SCHED_FIFO || policy == SCHED_RR;
}

}  // namespace vantage
