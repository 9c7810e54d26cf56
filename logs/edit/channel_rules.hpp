#pragma once

#include <map>
#include <optional>
#include <regex>
#include <string>
#include <string_view>
#include <vector>

namespace vantage::logs {

/// Which channels of a log are meant. Each rule is a regular expression that must match the whole
/// name, as everywhere in LCM ("VICON" is one channel; ".*VICON.*" is all that have it inside).
class ChannelFilter {
 public:
  /// A channel is taken when some of `include` matches (all, when there is none) and none of
  /// `exclude` does. @throws UsageError when one is no regular expression.
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
  /// The first rule that fits counts. @throws UsageError for a rule of another form.
  explicit ChannelRenames(const std::vector<std::string>& rules);
  ChannelRenames() = default;

  /// The channel's name from now on; nullopt when it would be longer than LCM carries.
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
