#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <random>
#include <set>
#include <vector>

namespace vantage::logs::test {

/// A log made up of random events, some with traps inside: sync words, headers and whole logs in
/// their data. `begins` has the offset of each event, then the size.
struct MadeLog {
  std::vector<std::uint8_t> bytes;
  std::vector<std::size_t> begins;
};
MadeLog random_log(std::mt19937_64& rng, int events);

/// A log after accidents, and where its untouched events are now.
struct DamagedLog {
  std::vector<std::uint8_t> bytes;
  /// Offsets and sizes of undamaged events, in order.
  std::map<std::size_t, std::size_t> intact;
  /// Offsets of the sync words before the damage: of events, and of the traps in their data.
  std::set<std::size_t> headers;
};

/// Up to six accidents of nine kinds: flipped bits, overwritten stretches, stretches set to 0,
/// whole blocks of the disk set to 0, lost stretches, inserted junk, a cut tail, stretches twice,
/// and lengths that lie (also so that they end exactly where some later event begins).
DamagedLog damage(const MadeLog& log, std::mt19937_64& rng);

}  // namespace vantage::logs::test
