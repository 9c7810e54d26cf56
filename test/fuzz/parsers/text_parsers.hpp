#pragma once

#include <cstdint>
#include <span>

// Harnesses for the parsers of files that people write. Invalid input must be refused by
// StartupError with a message; any other exception, or an abort(), is a bug. The initial inputs are
// the files in config/ and test/tools/problems.

namespace vantage::test {

void fuzz_scenario(std::span<const std::uint8_t> input);
void fuzz_problem(std::span<const std::uint8_t> input);

}  // namespace vantage::test
