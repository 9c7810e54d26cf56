#include "logs/export/mcap_writer.hpp"

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>

#include <fmt/format.h>
#include <zstd.h>

#include "core/check.hpp"
#include "core/saturated_time.hpp"
#include "logs/export/crc32.hpp"

namespace vantage::logs {
namespace {

constexpr std::string_view kMagic("\x89MCAP0\r\n", 8);
constexpr std::size_t kChunkBytes = std::size_t{1} << 20U;
constexpr std::size_t kTopicsMax = 65'535;

enum Opcode : std::uint8_t {
  kHeader = 0x01,
  kFooter = 0x02,
  kSchema = 0x03,
  kChannel = 0x04,
  kMessage = 0x05,
  kChunk = 0x06,
  kMessageIndex = 0x07,
  kChunkIndex = 0x08,
  kStatistics = 0x0B,
  kSummaryOffset = 0x0E,
  kDataEnd = 0x0F
};

/// Builder of a sequence of little-endian numbers and length-prefixed texts.
class Content {
 public:
  template <class Number>
  Content& number(Number value) {
    for (std::size_t i = 0; i < sizeof(Number); ++i) {
      bytes_.push_back(static_cast<char>(static_cast<std::uint64_t>(value) >> (8 * i)));
    }
    return *this;
  }
  Content& text(std::string_view value) {
    number(static_cast<std::uint32_t>(value.size()));
    bytes_ += value;
    return *this;
  }
  Content& long_bytes(std::string_view value) {
    number(static_cast<std::uint64_t>(value.size()));
    bytes_ += value;
    return *this;
  }
  Content& raw(std::string_view value) {
    bytes_ += value;
    return *this;
  }
  [[nodiscard]] const std::string& bytes() const { return bytes_; }

 private:
  std::string bytes_;
};

std::string record(Opcode opcode, const Content& content) {
  return Content().number(opcode).long_bytes(content.bytes()).bytes();
}

std::string part_of(const std::string& path) { return path + ".part"; }

}  // namespace

void McapWriter::TimeSpan::add(std::uint64_t time_ns) {
  first_ns = is_empty ? time_ns : std::min(first_ns, time_ns);
  last_ns = is_empty ? time_ns : std::max(last_ns, time_ns);
  is_empty = false;
}

struct McapWriter::Compressor {
  Compressor() : context(ZSTD_createCCtx()) {}
  ~Compressor() { ZSTD_freeCCtx(context); }
  Compressor(const Compressor&) = delete;
  Compressor& operator=(const Compressor&) = delete;
  Compressor(Compressor&&) = delete;
  Compressor& operator=(Compressor&&) = delete;

  /// Returns the compressed bytes as a view that is valid until the next call.
  std::string_view compress(std::string_view bytes) {
    out.resize(ZSTD_compressBound(bytes.size()));
    const std::size_t size =
        ZSTD_compressCCtx(context, out.data(), out.size(), bytes.data(), bytes.size(), kLevel);
    require(ZSTD_isError(size) == 0,
            "zstd must compress into a buffer of the size that it requires");
    return std::string_view(out).substr(0, size);
  }

  static constexpr int kLevel = 3;  // zstd's default compression level
  ZSTD_CCtx* context;
  std::string out;
};

McapWriter::McapWriter(const std::string& path, McapEncoding encoding)
    : path_(path),
      encoding_(std::move(encoding)),
      compressor_(std::make_unique<Compressor>()),
      out_(part_of(path), std::ios::binary) {
  if (!out_) {
    throw StartupError(path + ": cannot be written: " + std::strerror(errno));
  }
  put(kMagic);
  put(record(kHeader, Content().text(encoding_.profile).text("vantage")));
}

McapWriter::~McapWriter() { static_cast<void>(finish()); }

void McapWriter::fail(const std::string& why) {
  if (failure_.empty()) {
    failure_ = why;
    out_.close();
    std::remove(part_of(path_).c_str());
  }
}

void McapWriter::put(std::string_view bytes) {
  if (!failure_.empty()) {
    return;
  }
  if (!out_.write(bytes.data(), static_cast<std::streamsize>(bytes.size()))) {
    fail(path_ + ": cannot be written: " + std::strerror(errno));
  }
  written_bytes_ += bytes.size();
  data_crc_ = crc32(bytes, data_crc_);
}

std::string McapWriter::schema_record(std::size_t index) const {
  const Schema& schema = schemas_[index];
  return record(kSchema, Content()
                             .number(static_cast<std::uint16_t>(index + 1))
                             .text(schema.name)
                             .text(encoding_.schema)
                             .text(schema.text));
}

std::string McapWriter::topic_record(std::size_t index) const {
  const Topic& topic = topics_[index];
  return record(kChannel, Content()
                              .number(static_cast<std::uint16_t>(index))
                              .number(topic.schema)
                              .text(topic.name)
                              .text(encoding_.message)
                              .number(std::uint32_t{0}));  // empty metadata
}

std::uint16_t McapWriter::topic(const std::string& name, const std::string& schema_name,
                                const std::string& schema_text) {
  if (const auto known = ids_.find(name); known != ids_.end()) {
    return known->second;
  }
  if (topics_.size() == kTopicsMax) {
    fail(
        fmt::format("{}: cannot be written: an MCAP file can have at most {} topics; "
                    "select channels with --channels, or leave out drawings with --messages-only",
                    path_, kTopicsMax));
    return 0;
  }
  auto schema = std::find_if(schemas_.begin(), schemas_.end(),
                             [&](const Schema& each) { return each.name == schema_name; });
  if (schema == schemas_.end()) {
    schemas_.push_back({schema_name, schema_text});
    schema = schemas_.end() - 1;
    chunk_ += schema_record(schemas_.size() - 1);
  }
  const auto id = static_cast<std::uint16_t>(topics_.size());
  topics_.push_back({name, static_cast<std::uint16_t>(schema - schemas_.begin() + 1), 0});
  ids_.emplace(name, id);
  chunk_ += topic_record(id);
  return id;
}

void McapWriter::write(std::uint16_t topic, Time logged, Time published, std::string_view message) {
  const std::uint64_t logged_ns = nanoseconds_of(logged);
  times_held_ += fits_nanoseconds(logged) && fits_nanoseconds(published) ? 0 : 1;
  chunk_times_[topic].emplace_back(logged_ns, chunk_.size());
  chunk_span_.add(logged_ns);
  chunk_ += record(kMessage, Content()
                                 .number(topic)
                                 .number(static_cast<std::uint32_t>(topics_[topic].messages))
                                 .number(logged_ns)
                                 .number(nanoseconds_of(published))
                                 .raw(message));
  ++topics_[topic].messages;
  ++messages_;
  if (chunk_.size() >= kChunkBytes) {
    close_chunk();
  }
}

void McapWriter::close_chunk() {
  if (chunk_.empty()) {
    return;
  }
  const std::uint64_t chunk_start = written_bytes_;
  const std::string_view compressed = compressor_->compress(chunk_);
  put(record(kChunk, Content()
                         .number(chunk_span_.first_ns)
                         .number(chunk_span_.last_ns)
                         .number(static_cast<std::uint64_t>(chunk_.size()))
                         .number(crc32(chunk_))
                         .text("zstd")
                         .long_bytes(compressed)));
  const auto compressed_bytes = static_cast<std::uint64_t>(compressed.size());
  const std::uint64_t index_start = written_bytes_;
  Content offsets;
  for (const auto& [topic, times] : chunk_times_) {
    offsets.number(topic).number(written_bytes_);
    Content entries;
    for (const auto& [time_ns, offset] : times) {
      entries.number(time_ns).number(offset);
    }
    put(record(kMessageIndex, Content().number(topic).text(entries.bytes())));
  }
  chunk_index_records_.push_back(
      record(kChunkIndex, Content()
                              .number(chunk_span_.first_ns)
                              .number(chunk_span_.last_ns)
                              .number(chunk_start)
                              .number(index_start - chunk_start)
                              .text(offsets.bytes())
                              .number(written_bytes_ - index_start)
                              .text("zstd")
                              .number(compressed_bytes)
                              .number(static_cast<std::uint64_t>(chunk_.size()))));
  if (!chunk_span_.is_empty) {
    span_.add(chunk_span_.first_ns);
    span_.add(chunk_span_.last_ns);
  }
  chunk_.clear();
  chunk_times_.clear();
  chunk_span_ = {};
}

std::string McapWriter::statistics_record() const {
  Content counts;
  for (std::size_t i = 0; i < topics_.size(); ++i) {
    counts.number(static_cast<std::uint16_t>(i)).number(topics_[i].messages);
  }
  return record(kStatistics, Content()
                                 .number(messages_)
                                 .number(static_cast<std::uint16_t>(schemas_.size()))
                                 .number(static_cast<std::uint32_t>(topics_.size()))
                                 .number(std::uint32_t{0})  // number of attachments
                                 .number(std::uint32_t{0})  // number of metadata records
                                 .number(static_cast<std::uint32_t>(chunk_index_records_.size()))
                                 .number(span_.first_ns)
                                 .number(span_.last_ns)
                                 .text(counts.bytes()));
}

bool McapWriter::finish() {
  if (is_finished_) {
    return failure_.empty();
  }
  is_finished_ = true;
  close_chunk();
  put(record(kDataEnd, Content().number(data_crc_)));

  const std::uint64_t summary_start = written_bytes_;
  std::string summary;
  std::string offsets;
  const auto add_group = [&](Opcode opcode, const std::vector<std::string>& records) {
    const std::uint64_t start = summary_start + summary.size();
    for (const std::string& each : records) {
      summary += each;
    }
    const std::uint64_t length = summary_start + summary.size() - start;
    if (length > 0) {
      offsets += record(kSummaryOffset, Content().number(opcode).number(start).number(length));
    }
  };
  std::vector<std::string> schemas;
  for (std::size_t i = 0; i < schemas_.size(); ++i) {
    schemas.push_back(schema_record(i));
  }
  std::vector<std::string> topics;
  for (std::size_t i = 0; i < topics_.size(); ++i) {
    topics.push_back(topic_record(i));
  }
  add_group(kSchema, schemas);
  add_group(kChannel, topics);
  add_group(kStatistics, {statistics_record()});
  add_group(kChunkIndex, chunk_index_records_);

  // The checksum covers the summary and the footer up to the checksum itself.
  constexpr std::uint64_t kFooterBytes = 8 + 8 + 4;
  const std::string until_crc = summary + offsets +
                                Content()
                                    .number(kFooter)
                                    .number(kFooterBytes)
                                    .number(summary_start)
                                    .number(summary_start + summary.size())
                                    .bytes();
  put(until_crc);
  put(Content().number(crc32(until_crc)).bytes());
  put(kMagic);
  out_.close();
  if (failure_.empty() && (!out_ || std::rename(part_of(path_).c_str(), path_.c_str()) != 0)) {
    fail(path_ + ": cannot be written: " + std::strerror(errno));
  }
  return failure_.empty();
}

}  // namespace vantage::logs
