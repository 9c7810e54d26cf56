#pragma once

#include <string>
#include <vector>

#include <CLI/CLI.hpp>

namespace vantage::tools {

// Validators of option values. For a text that is not a number, the error states this. CLI11's own
// validators instead report a range, read "-1" as 2⁶⁴ − 1 and accept NaN.

/// Accepts a finite number.
CLI::Validator any_number();
/// Accepts a finite number > 0.
CLI::Validator positive_number();
/// Accepts a finite number ≥ 0.
CLI::Validator non_negative_number();
/// Accepts a number in [min, max].
CLI::Validator number_between(double min, double max);
/// Accepts one of `words`; the error suggests the nearest one.
CLI::Validator one_of(const std::vector<std::string>& words);
/// Accepts an integer in [0, 2⁶⁴ − 1].
CLI::Validator seed_number();

/// Returns an error with a suggestion for the first unknown command of `root` in `words`; empty if
/// all commands are known. `words`: the arguments after the program's name.
std::string unknown_command(const CLI::App& root, const std::vector<std::string>& words);
/// Returns an error with a suggestion for the first unknown option of the chosen command.
std::string unknown_option(const CLI::App& root, const std::vector<std::string>& words);

}  // namespace vantage::tools
