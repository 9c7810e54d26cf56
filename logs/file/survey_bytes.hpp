#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "logs/file/log_survey.hpp"

// A LogSurvey as bytes: numbers of 64 bits, big-endian, in the order of the struct; text and bit
// fields after their length; channels, blocks and stretches after their number.

namespace vantage::logs {

/// Appends `survey`.
void append_survey(const LogSurvey& survey, std::vector<std::uint8_t>& out);

/// Returns the survey that `bytes` are, nullopt when they are not exactly one of a log of
/// `log_bytes` in which an event was found. Never reads beyond their end; the memory that it takes
/// is at most proportional to their number.
std::optional<LogSurvey> survey_from(std::span<const std::uint8_t> bytes, std::size_t log_bytes);

}  // namespace vantage::logs
