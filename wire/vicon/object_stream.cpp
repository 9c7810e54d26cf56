#include "wire/vicon/object_stream.hpp"

#include <algorithm>

namespace vantage::wire::vicon {
namespace {

using LittleReader = Reader<std::endian::little>;

constexpr std::uint8_t kTrackerObjectId = 0;

Eigen::Vector3d vector_from(LittleReader& from) {
  Eigen::Vector3d vector;
  for (double& component : vector) {
    component = from.f64();
  }
  return vector;
}

}  // namespace

std::string_view TrackerObject::name() const {
  const auto end = std::find(padded_name.begin(), padded_name.end(), '\0');
  return {padded_name.data(), static_cast<std::size_t>(end - padded_name.begin())};
}

void TrackerObject::set_name(std::string_view name) {
  padded_name.fill('\0');
  std::copy_n(name.begin(), std::min(name.size(), padded_name.size()), padded_name.begin());
}

bool decode_object_block(Bytes datagram, ObjectBlock& block) {
  block.objects.clear();
  block.skipped_items = 0;
  block.is_truncated = false;
  LittleReader reader(datagram);
  block.frame_number = reader.u32();
  const int items = reader.u8();
  if (!reader.ok()) {
    return false;
  }
  for (int item = 0; item < items; ++item) {
    const std::uint8_t id = reader.u8();
    const std::uint16_t item_bytes = reader.u16();
    LittleReader content(reader.take(item_bytes));
    if (!reader.ok()) {
      block.is_truncated = true;
      return true;
    }
    TrackerObject object;
    object.set_name(content.text(kObjectNameBytes));
    object.translation_mm = vector_from(content);
    object.euler_xyz_rad = vector_from(content);
    if (id != kTrackerObjectId || !content.ok() || object.name().empty()) {
      ++block.skipped_items;
      continue;
    }
    block.objects.push_back(object);
  }
  return true;
}

void encode_object_block(const ObjectBlock& block, std::size_t block_bytes,
                         std::vector<std::uint8_t>& datagram) {
  datagram.clear();
  Writer<std::endian::little> writer(datagram);
  writer.u32(block.frame_number);
  writer.u8(static_cast<std::uint8_t>(block.objects.size()));
  for (const TrackerObject& object : block.objects) {
    writer.u8(kTrackerObjectId);
    writer.u16(kObjectItemBytes);
    writer.text({object.padded_name.data(), object.padded_name.size()});
    for (const double component : object.translation_mm) {
      writer.f64(component);
    }
    for (const double component : object.euler_xyz_rad) {
      writer.f64(component);
    }
  }
  if (datagram.size() < block_bytes) {
    writer.zeros(block_bytes - datagram.size());
  }
}

}  // namespace vantage::wire::vicon
