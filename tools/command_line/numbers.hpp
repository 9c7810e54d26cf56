#pragma once

#include <string>

#include <CLI/CLI.hpp>

namespace vantage::tools {

// Validators of option values. They report text that is not a number as such. CLI11's own
// validators report a range instead, read "-1" as 2⁶⁴ − 1 and accept NaN.

/// Accepts a finite number.
CLI::Validator any_number();
/// Accepts a finite number > 0.
CLI::Validator positive_number();
/// Accepts a finite number ≥ 0.
CLI::Validator non_negative_number();
/// Accepts a number in [min, max].
CLI::Validator number_between(double min, double max);
/// Accepts an integer in [0, 2⁶⁴ − 1].
CLI::Validator seed_number();

/// Returns an error with a suggestion for the first command in `words` that `root` does not have;
/// empty if all are known. `words`: the arguments after the program's name.
std::string unknown_command(const CLI::App& root, const std::vector<std::string>& words);
/// Returns the same for the first option that the chosen command does not have.
std::string unknown_option(const CLI::App& root, const std::vector<std::string>& words);

}  // namespace vantage::tools
