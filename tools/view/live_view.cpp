#include "tools/view/live_view.hpp"

#include <chrono>
#include <exception>
#include <mutex>
#include <utility>

#include <fmt/format.h>

#include "bus/node/bus.hpp"
#include "bus/node/clock.hpp"
#include "core/deadline.hpp"
#include "tools/view/feed.hpp"
#include "tools/view/log_view.hpp"

namespace vantage::tools {
namespace {

constexpr auto kWait = std::chrono::milliseconds(50);
constexpr auto kPollPeriod = std::chrono::milliseconds(10);

constexpr std::size_t kLiveHistoryBytes = std::size_t{8} << 20U;

WebOptions with_history(WebOptions options, std::function<std::string()> history) {
  options.history = std::move(history);
  return options;
}

/// First exception of several threads, for the thread that waits for these threads.
class Failure {
 public:
  /// Calls `work` and stores the exception that it throws.
  template <class Work>
  void guard(const Work& work) {
    try {
      work();
    } catch (const std::exception&) {
      const std::lock_guard lock(mutex_);
      first_ = first_ ? first_ : std::current_exception();
    }
  }
  void rethrow() const {
    const std::lock_guard lock(mutex_);
    if (first_) {
      std::rethrow_exception(first_);
    }
  }

 private:
  mutable std::mutex mutex_;
  std::exception_ptr first_;
};

/// Thread that continues a log's first pass until this object is destroyed.
class FirstPass {
 public:
  FirstPass(logs::SeekableLog& log, Broker& broker, Failure& failure)
      : thread_([this, &log, &broker, &failure] {
          failure.guard([&] { read_first_pass(log, broker, [this] { return is_over_.load(); }); });
        }) {}
  ~FirstPass() {
    is_over_ = true;
    thread_.join();
  }
  FirstPass(const FirstPass&) = delete;
  FirstPass& operator=(const FirstPass&) = delete;
  FirstPass(FirstPass&&) = delete;
  FirstPass& operator=(FirstPass&&) = delete;

 private:
  std::atomic<bool> is_over_ = false;
  std::thread thread_;
};

std::string new_session() { return fmt::format("{:016x}", bus::random_run_id()); }

}  // namespace

LiveView::LiveView(std::unique_ptr<bus::Transport> transport, const WebOptions& options,
                   logs::TypeLibrary types)
    : transport_(std::move(transport)),
      types_(std::move(types)),
      broker_({options.source.empty() ? "vantage" : "vantage " + options.source, new_session(),
               std::nullopt}),
      history_(clock_, broker_, History::Forwarding::kRecords, kLiveHistoryBytes),
      server_(broker_, with_history(options, [this] { return history_.text(); })),
      thread_([this] { listen(); }) {}

LiveView::~LiveView() {
  is_over_ = true;
  thread_.join();
}

void LiveView::listen() {
  try {
    Feed feed(*transport_, clock_, history_, types_);
    while (!is_over_ && feed.handle(kWait) != bus::kSourceEnded) {
    }
  } catch (const std::exception& error) {
    const std::lock_guard lock(mutex_);
    failure_ = error.what();
  }
}

std::string LiveView::failure() const {
  const std::lock_guard lock(mutex_);
  return failure_;
}

void serve_log(logs::SeekableLog& log, const logs::TypeLibrary& types, const WebOptions& options,
               bool is_playing, const std::function<void(const WebServer&)>& ready,
               const std::function<bool()>& stop) {
  Broker broker({"vantage " + log.path(), new_session(), log.range()});
  WebOptions of_log =
      with_history(options, [text = log_history(log, types, broker, stop)] { return text; });
  Failure failure;  // e.g. the log became shorter while a thread of the server read it
  of_log.series = [&](const std::string& topic, const std::string& pointer) {
    std::string series = "[]";
    failure.guard([&] { series = log_series(log, types, topic, pointer); });
    return series;
  };
  LogView view(log, types, broker, first_picture(log, stop));
  if (is_playing) {
    view.play(monotonic_ns());
  }
  const WebServer server(broker, of_log);
  ready(server);
  const FirstPass pass(log, broker, failure);
  while (!stop()) {
    failure.rethrow();
    view.tick(monotonic_ns());
    std::this_thread::sleep_for(kPollPeriod);
  }
}

}  // namespace vantage::tools
