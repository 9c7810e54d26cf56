#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "logs/file/log_event.hpp"

namespace vantage::logs {

/// Number of events between two progress reports of code that reads a log.
inline constexpr std::int64_t kEventsPerReport = 1000;

/// Result of checking the data of an event.
enum class DataCheck {
  kNone,      ///< unknown type, not checked
  kComplete,  ///< exactly one complete message of a known type
  /// Begins with the fingerprint of a known type, but the lengths inside are inconsistent.
  kDamaged,
};
/// Function that checks the data of an event. If it is empty, no data are checked.
using DataChecker = std::function<DataCheck(const LogEvent&)>;

struct LocatedEvent : LogEvent {
  std::size_t offset = 0;  ///< bytes from the start of the file to the header
  /// True if no header follows directly and the checker did not confirm the length. The end of the
  /// data may be missing.
  bool is_doubtful = false;
};

/// Range of the file that belongs to no event.
struct DamagedStretch {
  std::size_t offset = 0;
  std::size_t size_bytes = 0;
  bool is_tail = false;  ///< reaches the end of the file: the last event is incomplete
};

struct ScanCounts {
  std::int64_t events = 0;
  std::int64_t doubtful = 0;
  std::int64_t refused = 0;  ///< headers of events that the rules of LogScan refused
  std::int64_t stretches = 0;
  std::uint64_t bytes_damaged = 0;
};

/// Reader of the events of a log in file order. It tolerates any damage and always terminates.
///
/// An event is accepted directly if a header follows its end and one of two conditions is true: its
/// number and its neighbours' numbers are consecutive, or its data contain no sync word. Otherwise
/// the event's length may be wrong. The event is refused, and the search continues after its sync
/// word, if one of these rules applies. Rules 2 and 3 apply to data that the checker did not
/// confirm.
///  1. The checker reports damaged data.
///  2. A header inside its data has a number near the event's own number, or near the numbers that
///    are usual in this part of the log while the event's own number is not usual.
///  3. No header follows the event, and its data contain the header of an inner event that ends
///    beyond the outer event and is followed by its own successor. If the outer event's number is
///    usual, successors of the inner event must also continue to the end of the file.
/// Therefore sync words, headers and complete logs inside data do not split an event, and a wrong
/// length does not hide other events. An event is intact if all of its bytes are present. All
/// intact events are returned, with two exceptions where the bytes are ambiguous:
///  - The data contain a log with numbers near the event's own, the event's own number does not
///    continue both neighbours' numbers (one is damaged, or the logger does not count by one), and
///    the checker does not know the type.
///  - The event begins within the wrong length of another event, and the numbers of both
///    neighbours confirm the other event, so that no damage is visible there.
class LogScan {
 public:
  explicit LogScan(std::span<const std::uint8_t> log, DataChecker checker = {},
                   std::size_t offset = 0);

  /// Returns the next event; nullopt at the end of the file. Reads each byte of the passed part
  /// once or twice.
  /// @throws std::runtime_error if the log is a MappedFile that has become shorter since it was
  /// opened.
  std::optional<LocatedEvent> next();
  [[nodiscard]] const ScanCounts& counts() const { return counts_; }
  /// Returns the first damaged stretches, at most kStretchesKept; counts() counts all of them.
  [[nodiscard]] const std::vector<DamagedStretch>& stretches() const { return stretches_; }
  /// Returns the offset at which the search for the next event begins.
  [[nodiscard]] std::size_t position() const { return position_; }

  static constexpr std::size_t kStretchesKept = 1000;

 private:
  static constexpr std::size_t kRecent = 16;
  enum class Verdict { kSound, kDoubtful, kRefused };

  [[nodiscard]] Verdict judge(const LogEvent& event, std::size_t offset) const;
  [[nodiscard]] bool swallows(const LogEvent& event, std::size_t offset, bool is_followed) const;
  [[nodiscard]] std::int64_t usual_number(std::size_t offset) const;
  /// True if the event at `at` and successors with consecutive numbers reach the end of the file.
  [[nodiscard]] bool reaches_the_end(std::size_t at) const;
  /// Updates the usual numbers with the event at position_, which is being accepted.
  void remember(std::int64_t number);
  void close_stretch(std::size_t end);

  std::span<const std::uint8_t> log_;
  DataChecker checker_;
  std::size_t position_ = 0;
  std::size_t end_of_last_ = 0;   ///< end of the last accepted event, or start of the scan
  std::int64_t last_number_ = 0;  ///< number of the last accepted event
  std::vector<std::int64_t> usual_numbers_;  ///< recent event numbers that are near each other
  int unusual_in_a_row_ = 0;                 ///< consecutive accepted events with unusual numbers
  ScanCounts counts_;
  std::vector<DamagedStretch> stretches_;
};

}  // namespace vantage::logs
