#pragma once

#include <cstdint>
#include <span>

// Harnesses of files that people write. What is not right is refused by StartupError, in words;
// anything else that is thrown, or an abort(), is a fault. They start from the files in config/ and
// test/tools/problems.

namespace vantage::test {

void fuzz_scenario(std::span<const std::uint8_t> input);
void fuzz_problem(std::span<const std::uint8_t> input);

}  // namespace vantage::test
