#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "logs/file/log_event.hpp"

namespace vantage::logs {

/// Whoever goes through a log says how far it is after so many.
inline constexpr std::int64_t kEventsPerReport = 1000;

/// What is known of an event's data besides its length.
enum class Testimony {
  kNone,     ///< of an unknown type
  kWhole,    ///< exactly one message of a known type
  kDamaged,  ///< begins as a known type, but lengths inside do not add up
};
/// Judges an event by its data. May be empty: then nothing is known.
using Witness = std::function<Testimony(const LogEvent&)>;

struct PlacedEvent : LogEvent {
  std::size_t offset = 0;  ///< of the header in the file
  /// The next header does not follow at once and nothing else vouches for the length: the data may
  /// have lost its end.
  bool is_doubtful = false;
};

/// A stretch of the file that belongs to no event.
struct DamagedStretch {
  std::size_t offset = 0;
  std::size_t size_bytes = 0;
  bool is_tail = false;  ///< reaches the end of the file: the last event was cut off
};

struct ScanCounts {
  std::int64_t events = 0;
  std::int64_t doubtful = 0;
  std::int64_t refused = 0;  ///< headers whose event the rules below refused
  std::int64_t stretches = 0;
  std::uint64_t bytes_damaged = 0;
};

/// Reads the events of a log in file order, whatever has happened to it. Always ends.
///
/// An event is taken at once when a header follows its end and either the three numbers around it
/// run on or no sync word stands inside its data. Otherwise its length may be a lie, and it is
/// refused (then the search goes on behind its sync word) when
///  - the witness says that its data are damaged; else, unless the witness says they are whole,
///  - a header inside its data has a number near its own, or near those that are usual hereabouts
///    while its own is not (it swallows these), or
///  - it has no header behind it, and one inside it that has its successor behind it reaches beyond
///    its end (of unusual numbers: when its successors go on to the end of the file).
/// So sync words, headers and even whole logs inside data do not split an event, and a wrong length
/// swallows nothing. An event is intact when all of its bytes are there. Every intact one comes out
/// except where the bytes say two things: its data hold a log with numbers near its own while its
/// own does not run on from both neighbours (one is damaged, or the logger does not count by one)
/// and the witness does not know its type; or it begins inside the wrong length of another that
/// both neighbours' numbers vouch for, so that nothing looks damaged there.
class LogScan {
 public:
  explicit LogScan(std::span<const std::uint8_t> log, Witness witness = {}, std::size_t offset = 0);

  /// Returns the next event, nullopt at the end of the file. Cost: the bytes passed, once or twice.
  /// @throws std::runtime_error when the log is a MappedFile and has become shorter meanwhile.
  std::optional<PlacedEvent> next();
  [[nodiscard]] const ScanCounts& counts() const { return counts_; }
  /// The first of them, at most kStretchesKept; counts() has them all.
  [[nodiscard]] const std::vector<DamagedStretch>& stretches() const { return stretches_; }
  /// Where the search for the next event begins.
  [[nodiscard]] std::size_t position() const { return position_; }

  static constexpr std::size_t kStretchesKept = 1000;

 private:
  static constexpr std::size_t kRecent = 16;
  enum class Verdict { kSound, kDoubtful, kRefused };

  [[nodiscard]] Verdict judge(const LogEvent& event, std::size_t offset) const;
  [[nodiscard]] bool swallows(const LogEvent& event, std::size_t offset, bool is_followed) const;
  [[nodiscard]] std::int64_t usual_number(std::size_t offset) const;
  /// True when the event at `at` and its successors, one number after the other, fill the file.
  [[nodiscard]] bool reaches_the_end(std::size_t at) const;
  /// Learns from the event at position_, which is being taken.
  void remember(std::int64_t number);
  void close_stretch(std::size_t end);

  std::span<const std::uint8_t> log_;
  Witness witness_;
  std::size_t position_ = 0;
  std::size_t end_of_last_ = 0;              ///< of the last event taken, or where the scan began
  std::int64_t last_number_ = 0;             ///< of the last event taken
  std::vector<std::int64_t> usual_numbers_;  ///< of the last events that are near each other
  int strangers_ = 0;                        ///< events taken since whose numbers are not
  ScanCounts counts_;
  std::vector<DamagedStretch> stretches_;
};

}  // namespace vantage::logs
