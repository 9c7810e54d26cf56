#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "logs/file/log_survey.hpp"

// Binary format of a LogSurvey: 64-bit big-endian numbers in the order of the struct. Text and bit
// fields are preceded by their length; channels, blocks and stretches by their number.

namespace vantage::logs {

/// Appends `survey`.
void append_survey(const LogSurvey& survey, std::vector<std::uint8_t>& out);

/// Returns the survey in `bytes`; nullopt unless they are exactly the survey of a log of
/// `log_bytes` with at least one event. Never reads beyond `bytes`; memory use is at most
/// proportional to the number of bytes.
std::optional<LogSurvey> survey_from(std::span<const std::uint8_t> bytes, std::size_t log_bytes);

}  // namespace vantage::logs
