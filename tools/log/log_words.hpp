#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "logs/file/log_survey.hpp"

namespace vantage::tools {

/// What a log holds: span, size, versions, and a table of its channels.
std::vector<std::string> describe_content(const std::string& path, const logs::LogSurvey& survey,
                                          const std::string& flown_by);
/// What is wrong with it, one line each; empty for a log that is as its logger meant it.
/// Loss that happened before the log (missing messages) is named, but is no damage.
std::vector<std::string> describe_damage(const logs::LogSurvey& survey);
nlohmann::ordered_json to_json(const std::string& path, const logs::LogSurvey& survey);

/// "1.4 MiB".
std::string bytes_text(double bytes);

}  // namespace vantage::tools
