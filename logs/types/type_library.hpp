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

/// The message types that can be read: the house's own, and those of .lcm files that a person gives
/// for what others publish.
class TypeLibrary {
 public:
  /// The house's types alone.
  TypeLibrary() = default;
  /// And those of `paths`: .lcm files, or folders, which are searched with all that is in them.
  /// @throws StartupError for a path that is not there or has no type, a file that breaks the
  /// language ("PATH:LINE: why"), a member of a type that no file has, two types of one name.
  explicit TypeLibrary(const std::vector<std::string>& paths);

  /// The type whose fingerprint `message` begins with, of two with one layout the house's, else
  /// that of the name first in the alphabet; nullptr when there is none.
  [[nodiscard]] const bus::WireSchema* find(std::span<const std::uint8_t> message) const;

  /// How many types the files have.
  [[nodiscard]] std::size_t size() const { return structs_.size(); }
  /// The fingerprint of `type` ("package.name_t") of the files; nullopt for any other.
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

  std::map<std::string, std::unique_ptr<Layout>> structs_;  ///< by name
  std::map<std::uint64_t, const Layout*> by_fingerprint_;
};

}  // namespace vantage::logs
