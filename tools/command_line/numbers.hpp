#pragma once

#include <string>

#include <CLI/CLI.hpp>

namespace vantage::tools {

// Checks of options' values, as they were typed. What is no number is said to be none: CLI11's own
// speak of ranges, take "-1" for 2⁶⁴ − 1 and let NaN pass.

/// A finite number.
CLI::Validator any_number();
/// A finite number above 0.
CLI::Validator positive_number();
/// A finite number from 0 on.
CLI::Validator non_negative_number();
/// A finite number from `min` to `max`.
CLI::Validator number_between(double min, double max);
/// A whole number from 0 to 2⁶⁴ − 1.
CLI::Validator seed_number();

/// What may have been meant by the first command in `words` (those after the program's name) that
/// `root` does not have, as a sentence; empty when each is known.
std::string unknown_command(const CLI::App& root, const std::vector<std::string>& words);
/// The same of the first option that the chosen command does not have.
std::string unknown_option(const CLI::App& root, const std::vector<std::string>& words);

}  // namespace vantage::tools
