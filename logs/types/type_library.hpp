#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "bus/convert/wire_walk.hpp"
#include "logs/types/lcm_language.hpp"

namespace vantage::logs {

/// Message types that can be decoded: vantage's own types, and types from .lcm files that the user
/// provides for other publishers.
class TypeLibrary {
 public:
  /// Contains vantage's own types only.
  TypeLibrary() = default;
  /// Contains vantage's types and the types from `paths`: .lcm files, or folders (searched
  /// recursively).
  /// @throws StartupError if a path does not exist or contains no .lcm file, if a file is not valid
  /// ("PATH:LINE: reason"), if the type of a member is undefined, or if two different types have
  /// the same name.
  explicit TypeLibrary(const std::vector<std::string>& paths);

  /// Returns the type with the fingerprint at the start of `message`; nullptr if there is none. If
  /// several types have the same layout, returns vantage's own type if there is one, otherwise the
  /// first name in alphabetical order.
  [[nodiscard]] const bus::WireSchema* find(std::span<const std::uint8_t> message) const;

  /// Returns the number of types from files.
  [[nodiscard]] std::size_t size() const { return structs_.size(); }
  /// Returns the fingerprint of `type` ("package.name_t") if it comes from a file, else nullopt.
  [[nodiscard]] std::optional<std::uint64_t> fingerprint(const std::string& type) const;

 private:
  struct Layout {
    LcmStruct source;
    std::string path;
    std::vector<bus::WireField> fields;
    bus::WireSchema schema;
  };

  void add_file(const std::string& path);
  void lay_out(Layout& layout);
  [[nodiscard]] std::uint64_t hash_of(const Layout& layout,
                                      std::vector<const Layout*>& parents) const;

  std::map<std::string, std::unique_ptr<Layout>> structs_;  ///< layouts by name of the type
  std::map<std::uint64_t, const Layout*> by_fingerprint_;
};

}  // namespace vantage::logs
