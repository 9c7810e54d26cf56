#include "wire/mavlink/messages.hpp"

#include <algorithm>
#include <array>

namespace vantage::wire::mavlink {
namespace {

template <class... Message>
constexpr auto describe(const std::tuple<Message...>&) {
  return std::array<MessageInfo, sizeof...(Message)>{
      MessageInfo{Message::kMessage.name, Message::kMessage.id, crc_extra<Message>(),
                  static_cast<std::uint8_t>(base_bytes<Message>()),
                  static_cast<std::uint8_t>(full_bytes<Message>())}...};
}

constexpr auto kMessages = describe(AllMessages{});
static_assert(std::ranges::is_sorted(kMessages, {}, &MessageInfo::id));

}  // namespace

const MessageInfo* find_message(std::uint32_t id) {
  const auto* const found = std::ranges::lower_bound(kMessages, id, {}, &MessageInfo::id);
  return found != kMessages.end() && found->id == id ? &*found : nullptr;
}

}  // namespace vantage::wire::mavlink
