#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <random>
#include <set>
#include <vector>

namespace vantage::logs::test {

/// A log of random events. The data of some events contain traps: sync words, headers and complete
/// logs. `begins` has the offset of each event and, as the last entry, the size of the log.
struct MadeLog {
  std::vector<std::uint8_t> bytes;
  std::vector<std::size_t> begins;
};
MadeLog random_log(std::mt19937_64& rng, int events);

/// A damaged log, and the positions of its undamaged events.
struct DamagedLog {
  std::vector<std::uint8_t> bytes;
  /// Size of each undamaged event, by its offset.
  std::map<std::size_t, std::size_t> intact;
  /// Offsets of the sync words that remain of the original log: those of events and those in traps.
  std::set<std::size_t> headers;
};

/// Applies up to six damages of nine kinds to the log: flips bits, overwrites ranges, sets ranges
/// or whole disk blocks to 0, removes ranges, inserts random bytes, cuts off the end, duplicates
/// ranges, and writes wrong lengths (some of which end exactly at a later event).
DamagedLog damage(const MadeLog& log, std::mt19937_64& rng);

}  // namespace vantage::logs::test
