#include "core/process.hpp"

#include <atomic>
#include <csignal>
#include <exception>
#include <iostream>
#include <new>

#include "core/check.hpp"

namespace vantage {
namespace {

std::atomic<int> stop_count{0};
static_assert(std::atomic<int>::is_always_lock_free, "written from a signal handler");

void on_signal(int /*signal*/) { ++stop_count; }

// A terminal that closes says so more than once, to its shell and to what runs in it: that is one
// request, and never a hurried one.
void on_hang_up(int /*signal*/) {
  int none = 0;
  stop_count.compare_exchange_strong(none, 1);
}

}  // namespace

bool stop_requested() { return stop_count > 0; }
int stop_requests() { return stop_count; }
void request_stop() { ++stop_count; }

int run_process(const std::string& name, const std::function<int()>& body) {
  struct sigaction action {};
  action.sa_handler = on_signal;
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
  action.sa_handler = on_hang_up;
  struct sigaction before {};
  sigaction(SIGHUP, nullptr, &before);
  if (before.sa_handler != SIG_IGN) {  // nohup
    sigaction(SIGHUP, &action, nullptr);
  }
  std::signal(SIGPIPE, SIG_IGN);
  std::signal(SIGXFSZ, SIG_IGN);  // a file that may not grow is an error of write()
  try {
    return body();
  } catch (const StartupError& e) {
    std::cerr << name << ": " << e.what() << '\n';
    return 2;
  } catch (const UsageError& e) {
    std::cerr << name << ": bad configuration: " << e.what() << '\n';
    return 2;
  } catch (const std::bad_alloc&) {
    std::cerr << name << ": out of memory\n";
    return 1;
  } catch (const std::exception& e) {
    std::cerr << name << ": " << e.what() << '\n';
    return 1;
  }
}

}  // namespace vantage
