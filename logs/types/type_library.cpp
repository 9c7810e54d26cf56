#include "logs/types/type_library.hpp"

#include <algorithm>
#include <bit>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <system_error>
#include <utility>

#include "core/check.hpp"
#include "logs/file/log_event.hpp"
#include "logs/file/wire_check.hpp"

namespace vantage::logs {
namespace {

namespace fs = std::filesystem;
using bus::WireKind;
using bus::WireNumber;

constexpr std::size_t kFingerprintBytes = 8;

struct Basic {
  WireKind kind;
  WireNumber number;
  std::int32_t bytes;  ///< smallest size; for a string the size of its length field and its NUL
};

Basic basic(const std::string& type) {
  static const std::map<std::string, Basic> kTypes = {
      {"boolean", {WireKind::kBytes, WireNumber::kBoolean, 1}},
      {"byte", {WireKind::kBytes, WireNumber::kByte, 1}},
      {"float", {WireKind::kBytes, WireNumber::kFloat, 4}},
      {"double", {WireKind::kBytes, WireNumber::kDouble, 8}},
      {"int8_t", {WireKind::kInteger, WireNumber::kInt8, 1}},
      {"int16_t", {WireKind::kInteger, WireNumber::kInt16, 2}},
      {"int32_t", {WireKind::kInteger, WireNumber::kInt32, 4}},
      {"int64_t", {WireKind::kInteger, WireNumber::kInt64, 8}},
      {"string", {WireKind::kString, WireNumber::kNone, 5}}};
  return kTypes.at(type);
}

/// Returns the hash of the struct alone: without nested structs and without its name.
/// Source: lcm-gen's hash of a struct, in 64 bits, with an arithmetic shift to the right.
std::uint64_t own_hash(const LcmStruct& source) {
  std::uint64_t hash = 0x12345678;
  const auto add = [&hash](std::uint64_t value) {
    const auto high = static_cast<std::uint64_t>(std::bit_cast<std::int64_t>(hash) >> 55);
    hash = ((hash << 8U) ^ high) + value;
  };
  const auto add_text = [&add](const std::string& text) {
    add(text.size());
    for (const char letter : text) {
      add(static_cast<std::uint64_t>(letter));
    }
  };
  for (const LcmMember& member : source.members) {
    add_text(member.name);
    if (is_basic_lcm_type(member.type)) {
      add_text(member.type);
    }
    add(member.dimensions.size());
    for (const LcmDimension& dimension : member.dimensions) {
      add(dimension.member < 0 ? 0 : 1);
      add_text(dimension.size);
    }
  }
  return hash;
}

std::vector<std::string> files_of(const std::string& path) {
  std::error_code error;
  if (!fs::is_directory(path, error)) {
    return {path};
  }
  std::vector<std::string> files;
  for (const auto& entry : fs::recursive_directory_iterator(
           path, fs::directory_options::skip_permission_denied, error)) {
    if (entry.path().extension() == ".lcm" && entry.is_regular_file(error)) {
      files.push_back(entry.path().string());
    }
  }
  std::sort(files.begin(), files.end());
  return files;
}

std::string text_of(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  std::error_code error;
  if (!in || fs::is_directory(path, error)) {
    throw StartupError(path + ": cannot be read");
  }
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

}  // namespace

TypeLibrary::TypeLibrary(const std::vector<std::string>& paths) {
  for (const std::string& path : paths) {
    const std::size_t before = structs_.size();
    const std::vector<std::string> files = files_of(path);
    std::for_each(files.begin(), files.end(), [this](const auto& file) { add_file(file); });
    if (structs_.size() == before && files.empty()) {
      throw StartupError(path + ": contains no .lcm file");
    }
  }
  for (const auto& [name, layout] : structs_) {
    lay_out(*layout);
  }
  for (const auto& [name, layout] : structs_) {
    std::vector<const Layout*> parents;
    by_fingerprint_.emplace(hash_of(*layout, parents), layout.get());
  }
}

void TypeLibrary::add_file(const std::string& path) {
  for (LcmStruct& source : parse_lcm(text_of(path), path)) {
    const auto known = structs_.find(source.name);
    if (known == structs_.end()) {
      const std::string name = source.name;
      structs_.emplace(name, std::make_unique<Layout>(Layout{std::move(source), path, {}, {}}));
    } else if (own_hash(known->second->source) != own_hash(source)) {
      throw StartupError(path + ":" + std::to_string(source.line) + ": " + source.name +
                         " differs from its definition in " + known->second->path);
    }
  }
}

void TypeLibrary::lay_out(Layout& layout) {
  const auto fail = [&](const std::string& why) {
    throw StartupError(layout.path + ":" + std::to_string(layout.source.line) + ": " +
                       layout.source.name + ": " + why);
  };
  if (layout.source.members.size() > bus::kWireFieldsMax) {
    fail("more than " + std::to_string(bus::kWireFieldsMax) + " members");
  }
  for (const LcmMember& member : layout.source.members) {
    bus::WireField field{WireKind::kStruct,
                         0,
                         nullptr,
                         {},
                         member.name,
                         WireNumber::kNone,
                         static_cast<std::int32_t>(member.dimensions.size())};
    if (is_basic_lcm_type(member.type)) {
      const Basic known = basic(member.type);
      field.kind = known.kind;
      field.number = known.number;
      field.least_bytes = known.bytes;
    } else {
      const auto nested = structs_.find(member.type);
      if (nested == structs_.end()) {
        fail("its member " + member.name + " has type " + member.type +
             ", which none of the given files defines");
      }
      field.nested = &nested->second->schema;
    }
    if (member.dimensions.size() > bus::kWireDims) {
      fail("its member " + member.name + " has more than " + std::to_string(bus::kWireDims) +
           " dimensions");
    }
    field.dims.fill({1, -1});
    for (std::size_t d = 0; d < member.dimensions.size(); ++d) {
      field.dims[d] = {member.dimensions[d].constant, member.dimensions[d].member};
    }
    layout.fields.push_back(field);
  }
  layout.schema = {layout.source.name, layout.fields};
}

// A struct that contains itself contributes 0 at the inner occurrence.
std::uint64_t TypeLibrary::hash_of(const Layout& layout,
                                   std::vector<const Layout*>& parents) const {
  if (std::find(parents.begin(), parents.end(), &layout) != parents.end()) {
    return 0;
  }
  parents.push_back(&layout);
  std::uint64_t hash = own_hash(layout.source);
  for (const LcmMember& member : layout.source.members) {
    if (!is_basic_lcm_type(member.type)) {
      hash += hash_of(*structs_.at(member.type), parents);
    }
  }
  parents.pop_back();
  return std::rotl(hash, 1);
}

const bus::WireSchema* TypeLibrary::find(std::span<const std::uint8_t> message) const {
  if (const bus::WireSchema* own = type_of(message); own != nullptr || structs_.empty()) {
    return own;
  }
  if (message.size() < kFingerprintBytes) {
    return nullptr;
  }
  const auto found = by_fingerprint_.find(read_big_endian(message.data(), kFingerprintBytes));
  return found == by_fingerprint_.end() ? nullptr : &found->second->schema;
}

std::optional<std::uint64_t> TypeLibrary::fingerprint(const std::string& type) const {
  const auto found = structs_.find(type);
  if (found == structs_.end()) {
    return std::nullopt;
  }
  std::vector<const Layout*> parents;
  return hash_of(*found->second, parents);
}

}  // namespace vantage::logs
