#pragma once

#include <atomic>
#include <cstdint>
#include <deque>
#include <exception>
#include <mutex>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "tools/console/console.hpp"
#include "tools/console/operator_claim.hpp"
#include "tools/console/operator_link.hpp"
#include "tools/console/order_queue.hpp"
#include "tools/console/order_receipts.hpp"

namespace vantage::tools {

/// Answer to a request of an operator page.
struct DeskAnswer {
  int code = 200;  ///< HTTP status: 200, 400, 403, 409 or 429
  std::string json;
};

/// Operator station for a page in a browser. As in the console, orders pass through Station,
/// OrderSender and OrderQueue. One page at a time holds the claim. While no page holds it, the
/// station sends no heartbeat; after the next claim the station first listens for other stations. A
/// page without the claim, but with the key, may still send the emergency stop.
///
/// answer() is called on any thread and never waits for the bus. One thread handles the bus.
class OperatorDesk {
 public:
  static constexpr std::size_t kPendingMax = 64;  ///< maximum number of waiting orders
  static constexpr std::size_t kJournalMax = 100;
  static constexpr std::size_t kBodyBytesMax = 4096;

  /// @param key  secret that every request must contain
  OperatorDesk(OperatorLink& link, std::string key);
  ~OperatorDesk();
  OperatorDesk(const OperatorDesk&) = delete;
  OperatorDesk& operator=(const OperatorDesk&) = delete;
  OperatorDesk(OperatorDesk&&) = delete;
  OperatorDesk& operator=(OperatorDesk&&) = delete;

  /// Answers a request.
  /// - "claim": returns {"token"}; 409 while another page operates.
  /// - "state": returns the station, the vehicles, the receipts and the journal, and counts as
  ///   presence if `token` holds the claim.
  /// - "order": sends {"action": word, "robot": name or ""}; the words are those of the console.
  /// - "release": ends the claim.
  DeskAnswer answer(std::string_view what, std::string_view key, std::string_view token,
                    std::string_view body);
  /// Returns the error that ended the thread; empty while it runs.
  [[nodiscard]] std::string failure() const;

 private:
  struct Line {
    std::int64_t number = 0;
    double at_s = 0.0;  ///< s since the desk was opened
    std::string words;
  };
  void run();
  void step();
  void send_pending(Time now);
  void note(const std::vector<std::string>& lines, Time now);
  void write_state(Time now);
  [[nodiscard]] std::vector<std::string> robots_of(const std::string& robot) const;
  DeskAnswer order(std::string_view token, std::string_view body, Time now);

  OperatorLink& link_;
  const std::string key_;
  const Time start_;
  OrderSender sender_;
  OrderQueue orders_{sender_};
  OrderReceipts receipts_;
  std::deque<Line> journal_;
  std::int64_t lines_ = 0;
  std::atomic<bool> is_over_ = false;

  mutable std::mutex mutex_;  ///< guards all members below
  OperatorClaim claim_;
  std::vector<OrderQueue::Order> pending_;
  std::string state_ = "{}";  ///< JSON of the state, without members that depend on the page
  std::string failure_;
  std::thread thread_;  ///< last member, because it uses the others
};

/// Returns a secret of 128 random bits in hexadecimal digits.
std::string new_secret();

}  // namespace vantage::tools
