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

}  // namespace

bool stop_requested() { return stop_count > 0; }
int stop_requests() { return stop_count; }
void request_stop() { ++stop_count; }

int run_process(const std::string& name, const std::function<int()>& body) {
  struct sigaction action {};
  action.sa_handler = on_signal;
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
  std::signal(SIGPIPE, SIG_IGN);
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
