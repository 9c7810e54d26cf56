#pragma once

#include <map>
#include <optional>
#include <regex>
#include <string>
#include <string_view>
#include <vector>

namespace vantage::logs {

/// Selection of channels of a log. Each rule is a regular expression that must match the complete
/// name, as in LCM ("VICON" selects one channel, ".*VICON.*" all names that contain VICON).
class ChannelFilter {
 public:
  /// Selects a channel if it matches one of `include` (or if `include` is empty), unless it matches
  /// one of `exclude`.
  /// @throws UsageError if a rule is not a regular expression.
  ChannelFilter(const std::vector<std::string>& include, const std::vector<std::string>& exclude);
  ChannelFilter() = default;

  [[nodiscard]] bool takes(std::string_view channel);

 private:
  std::vector<std::regex> include_;
  std::vector<std::regex> exclude_;
  std::map<std::string, bool, std::less<>> known_;
};

/// New names for channels: "OLD=NEW", or "OLD*=NEW*" for every name that begins with OLD.
class ChannelRenames {
 public:
  /// Only the first rule that matches is applied. @throws UsageError for a rule of another form.
  explicit ChannelRenames(const std::vector<std::string>& rules);
  ChannelRenames() = default;

  /// Returns the new name of `channel`; nullopt if the new name would be empty or too long for LCM.
  [[nodiscard]] std::optional<std::string> rename(std::string_view channel) const;

 private:
  struct Rule {
    std::string from;
    std::string to;
    bool is_prefix = false;
  };
  std::vector<Rule> rules_;
};

}  // namespace vantage::logs
