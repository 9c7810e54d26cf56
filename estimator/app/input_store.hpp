#pragma once

#include <cstddef>
#include <deque>
#include <map>
#include <memory>
#include <string>
#include <tuple>
#include <utility>

#include "estimator/app/step_material.hpp"
#include "models/exchange/messages.hpp"

namespace vantage::estimator {

/// The newest `capacity` messages of one kind, to be found again by name.
template <class Content>
class InputStore {
 public:
  explicit InputStore(std::size_t capacity) : capacity_(capacity) {}

  void put(const models::InputRef& ref, Content content) {
    if (order_.size() == capacity_) {
      by_name_.erase(order_.front());
      order_.pop_front();
    }
    const Key key{ref.channel, ref.run_id, ref.sequence};
    if (by_name_.emplace(key, std::make_shared<const Content>(std::move(content))).second) {
      order_.push_back(key);
    }
  }

  /// nullptr when it never came or is forgotten.
  [[nodiscard]] std::shared_ptr<const Content> find(const models::InputRef& ref) const {
    const auto found = by_name_.find({ref.channel, ref.run_id, ref.sequence});
    return found == by_name_.end() ? nullptr : found->second;
  }

 private:
  using Key = std::tuple<std::string, std::int64_t, std::int64_t>;
  std::size_t capacity_;
  std::map<Key, std::shared_ptr<const Content>> by_name_;
  std::deque<Key> order_;  ///< oldest first
};

}  // namespace vantage::estimator
