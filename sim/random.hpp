#pragma once

#include <cstdint>
#include <random>
#include <string_view>

namespace vantage::sim {

/// An engine of its own for each purpose, so that what one body draws never shifts what another
/// draws: the same seed and purpose give the same numbers for ever (std::seed_seq and
/// std::mt19937_64 are fixed by the C++ standard).
std::mt19937_64 random_stream(std::uint64_t seed, std::string_view purpose);

}  // namespace vantage::sim
