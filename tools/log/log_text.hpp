#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "logs/file/log_survey.hpp"

namespace vantage::tools {

/// Returns lines with the span, size and versions of a log, and a table of its channels.
std::vector<std::string> describe_content(const std::string& path, const logs::LogSurvey& survey,
                                          const std::string& flown_by);
/// Returns one line per defect of a log; empty if there is none. Includes messages that were lost
/// before they were logged, which do not count as damage.
std::vector<std::string> describe_damage(const logs::LogSurvey& survey);
nlohmann::ordered_json to_json(const std::string& path, const logs::LogSurvey& survey);

/// Formats a number of bytes: "1.4 MiB".
std::string bytes_text(double bytes);

}  // namespace vantage::tools
