#include "tools/ros2/cdr_type.hpp"

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <memory>
#include <vector>

#include <dds/dds.h>
#include <dds/ddsi/ddsi_serdata.h>
#include <dds/ddsi/ddsi_sertype.h>
#include <dds/ddsi/q_radmin.h>

// Cyclone DDS owns types and messages by reference counts, and calls the functions of two tables.
// The functions for samples of generated types are never called, because messages are written by
// dds_writecdr() and read by dds_takecdr().

namespace vantage::tools::ros2 {
namespace {

struct CdrMessage : ddsi_serdata {
  std::vector<std::uint8_t> bytes;
};

const CdrMessage& as_message(const ddsi_serdata* message) {
  return static_cast<const CdrMessage&>(*message);
}

CdrMessage* new_message(const ddsi_sertype* type, ddsi_serdata_kind kind) {
  auto out = std::make_unique<CdrMessage>();
  ddsi_serdata_init(out.get(), type, kind);
  return out.release();
}

// All messages of a type without keys belong to one instance.
bool has_same_key(const ddsi_serdata* /*a*/, const ddsi_serdata* /*b*/) { return true; }

std::uint32_t size_of(const ddsi_serdata* message) {
  return static_cast<std::uint32_t>(as_message(message).bytes.size());
}

// Copies the pieces of a received message. Pieces are sorted by their begin and may overlap.
ddsi_serdata* from_pieces(const ddsi_sertype* type, ddsi_serdata_kind kind, const nn_rdata* piece,
                          std::size_t size) {
  CdrMessage* const out = new_message(type, kind);
  out->bytes.resize(size);
  std::size_t filled = 0;
  for (; piece != nullptr; piece = piece->nextfrag) {
    const std::size_t end = std::min<std::size_t>(piece->maxp1, size);
    if (end > filled) {
      const unsigned char* const payload =
          NN_RMSG_PAYLOADOFF(piece->rmsg, NN_RDATA_PAYLOAD_OFF(piece));
      std::memcpy(out->bytes.data() + filled, payload + (filled - piece->min), end - filled);
      filled = end;
    }
  }
  return out;
}

ddsi_serdata* from_vectors(const ddsi_sertype* type, ddsi_serdata_kind kind,
                           ddsrt_msg_iovlen_t count, const ddsrt_iovec_t* vectors,
                           std::size_t size) {
  CdrMessage* const out = new_message(type, kind);
  out->bytes.reserve(size);
  for (std::size_t i = 0; i < count; ++i) {
    const auto* const begin = static_cast<const std::uint8_t*>(vectors[i].iov_base);
    out->bytes.insert(out->bytes.end(), begin, begin + vectors[i].iov_len);
  }
  return out;
}

ddsi_serdata* from_key(const ddsi_sertype* type, const ddsi_keyhash* /*hash*/) {
  return new_message(type, SDK_KEY);
}

ddsi_serdata* from_sample(const ddsi_sertype* /*type*/, ddsi_serdata_kind /*kind*/,
                          const void* /*sample*/) {
  return nullptr;
}

// Cyclone DDS rounds sizes up to multiples of four; the bytes beyond the message are 0.
void copy_to(const ddsi_serdata* message, std::size_t offset, std::size_t size, void* buffer) {
  const std::vector<std::uint8_t>& bytes = as_message(message).bytes;
  const std::size_t begin = std::min(offset, bytes.size());
  const std::size_t known = std::min(size, bytes.size() - begin);
  std::memset(buffer, 0, size);
  std::memcpy(buffer, bytes.data() + begin, known);
}

ddsi_serdata* lend(const ddsi_serdata* message, std::size_t offset, std::size_t size,
                   ddsrt_iovec_t* out) {
  out->iov_base = const_cast<std::uint8_t*>(as_message(message).bytes.data() + offset);  // NOLINT
  out->iov_len = static_cast<ddsrt_iov_len_t>(size);
  return ddsi_serdata_ref(message);
}

void end_lend(ddsi_serdata* message, const ddsrt_iovec_t* /*lent*/) { ddsi_serdata_unref(message); }

bool to_sample(const ddsi_serdata* /*message*/, void* /*sample*/, void** /*begin*/, void* /*end*/) {
  return false;
}

ddsi_serdata* to_untyped(const ddsi_serdata* message) {
  return new_message(message->type, SDK_KEY);
}

bool untyped_to_sample(const ddsi_sertype* /*type*/, const ddsi_serdata* /*message*/,
                       void* /*sample*/, void** /*begin*/, void* /*end*/) {
  return false;
}

void free_message(ddsi_serdata* message) { delete static_cast<CdrMessage*>(message); }  // NOLINT

std::size_t print(const ddsi_sertype* /*type*/, const ddsi_serdata* /*message*/, char* buffer,
                  std::size_t size) {
  if (size > 0) {
    buffer[0] = '\0';
  }
  return 0;
}

void key_hash(const ddsi_serdata* /*message*/, ddsi_keyhash* out, bool /*force_md5*/) { *out = {}; }

void free_type(ddsi_sertype* type) {
  ddsi_sertype_fini(type);
  delete type;  // NOLINT
}

void zero_samples(const ddsi_sertype* /*type*/, void* /*samples*/, std::size_t /*count*/) {}
void realloc_samples(void** /*pointers*/, const ddsi_sertype* /*type*/, void* /*old*/,
                     std::size_t /*old_count*/, std::size_t /*count*/) {}
void free_samples(const ddsi_sertype* /*type*/, void** /*pointers*/, std::size_t /*count*/,
                  dds_free_op_t /*operation*/) {}
// The caller compares the names.
bool is_equal(const ddsi_sertype* /*a*/, const ddsi_sertype* /*b*/) { return true; }
std::uint32_t hash(const ddsi_sertype* /*type*/) { return 0; }

const ddsi_sertype_ops& type_operations() {
  static const ddsi_sertype_ops kTable = [] {
    ddsi_sertype_ops table{};
    table.version = ddsi_sertype_v0;
    table.free = free_type;
    table.zero_samples = zero_samples;
    table.realloc_samples = realloc_samples;
    table.free_samples = free_samples;
    table.equal = is_equal;
    table.hash = hash;
    return table;
  }();
  return kTable;
}

const ddsi_serdata_ops& message_operations() {
  static const ddsi_serdata_ops kTable = [] {
    ddsi_serdata_ops table{};
    table.eqkey = has_same_key;
    table.get_size = size_of;
    table.from_ser = from_pieces;
    table.from_ser_iov = from_vectors;
    table.from_keyhash = from_key;
    table.from_sample = from_sample;
    table.to_ser = copy_to;
    table.to_ser_ref = lend;
    table.to_ser_unref = end_lend;
    table.to_sample = to_sample;
    table.to_untyped = to_untyped;
    table.untyped_to_sample = untyped_to_sample;
    table.free = free_message;
    table.print = print;
    table.get_keyhash = key_hash;
    return table;
  }();
  return kTable;
}

}  // namespace

ddsi_sertype* new_cdr_type(const std::string& name) {
  constexpr bool kHasNoKey = true;
  auto out = std::make_unique<ddsi_sertype>();
  ddsi_sertype_init(out.get(), name.c_str(), &type_operations(), &message_operations(), kHasNoKey);
  return out.release();
}

ddsi_serdata* new_cdr_message(const ddsi_sertype* type, std::span<const std::uint8_t> cdr) {
  constexpr std::size_t kWord = 4;
  CdrMessage* const out = new_message(type, SDK_DATA);
  out->bytes.assign(cdr.begin(), cdr.end());
  // Cyclone DDS sends whole words. The last bits of the header are the number of bytes added.
  const std::size_t padding = (kWord - cdr.size() % kWord) % kWord;
  out->bytes.resize(cdr.size() + padding);
  return out;
}

std::span<const std::uint8_t> cdr_of(const ddsi_serdata* message) {
  return as_message(message).bytes;
}

}  // namespace vantage::tools::ros2
