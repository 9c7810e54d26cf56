#pragma once

#include <cstdint>
#include <random>
#include <string_view>

namespace vantage::sim {

/// Returns a separate random engine for each purpose, so that the random numbers of one body do not
/// depend on those of another. The same seed and purpose give the same numbers on every platform
/// (std::seed_seq and std::mt19937_64 are fixed by the C++ standard).
std::mt19937_64 random_stream(std::uint64_t seed, std::string_view purpose);

}  // namespace vantage::sim
