#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace vantage::test {

/// Passes `input`, the bytes of one message, through decoder, checks and expansion of a compact
/// belief. Calls abort() when a promise is broken: an accepted message has finite means, positive
/// definite covariances, ascending ids, and no cell with a later time than the message.
void fuzz_compact_path(std::span<const std::uint8_t> input);

/// Returns the initial inputs: messages with targets of each dimension, with and without cells.
std::vector<std::vector<std::uint8_t>> compact_path_samples();

}  // namespace vantage::test
