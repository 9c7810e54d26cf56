#include "core/process.hpp"

#include <atomic>
#include <csignal>
#include <exception>
#include <iostream>
#include <new>

#include "core/check.hpp"
#include "core/utf8.hpp"

namespace vantage {
namespace {

std::atomic<int> stop_count{0};
std::atomic<int> last_signal{0};
static_assert(std::atomic<int>::is_always_lock_free, "a signal handler writes these variables");

void on_signal(int signal) {
  last_signal = signal;
  ++stop_count;
}

// A program can receive SIGHUP more than once when its terminal closes. All these signals count as
// one stop request; otherwise the second signal would request an urgent stop.
void on_hang_up(int signal) {
  last_signal = signal;
  int none = 0;
  stop_count.compare_exchange_strong(none, 1);
}

using Handler = void (*)(int);
Handler handler_of(int signal) { return signal == SIGHUP ? on_hang_up : on_signal; }

/// Installs `handler`; a SIGHUP that was ignored at start stays ignored.
void handle(int signal, Handler handler) {
  struct sigaction before {};
  sigaction(signal, nullptr, &before);
  if (signal == SIGHUP && before.sa_handler == SIG_IGN) {
    return;
  }
  struct sigaction action {};
  action.sa_handler = handler;
  sigaction(signal, &action, nullptr);
}

// Unblocks the stop signals, which a supervisor blocks until this process handles them.
void unblock_stop_signals() {
  sigset_t signals;
  sigemptyset(&signals);
  for (const int signal : kStopSignals) {
    sigaddset(&signals, signal);
  }
  sigprocmask(SIG_UNBLOCK, &signals, nullptr);
}

}  // namespace

bool stop_requested() { return stop_count > 0; }
int stop_requests() { return stop_count; }

DefaultSignalScope::DefaultSignalScope() {
  for (const int signal : kStopSignals) {
    handle(signal, SIG_DFL);
  }
  if (last_signal != 0) {
    std::raise(last_signal);
  }
}

DefaultSignalScope::~DefaultSignalScope() {
  for (const int signal : kStopSignals) {
    handle(signal, handler_of(signal));
  }
}

int run_process(const std::string& name, const std::function<int()>& body) {
  for (const int signal : kStopSignals) {
    handle(signal, handler_of(signal));
  }
  unblock_stop_signals();
  std::signal(SIGPIPE, SIG_IGN);
  std::signal(SIGCHLD, SIG_DFL);  // an inherited SIG_IGN would hide the exit codes of children
  std::signal(SIGXFSZ, SIG_IGN);  // write() then returns an error at the file size limit
  try {
    return body();
  } catch (const StartupError& e) {
    std::cerr << name << ": " << printable(e.what()) << '\n';
    return 2;
  } catch (const UsageError& e) {
    std::cerr << name << ": bad configuration: " << printable(e.what()) << '\n';
    return 2;
  } catch (const std::bad_alloc&) {
    std::cerr << name << ": out of memory\n";
    return 1;
  } catch (const std::exception& e) {
    std::cerr << name << ": " << printable(e.what()) << '\n';
    return 1;
  }
}

}  // namespace vantage
