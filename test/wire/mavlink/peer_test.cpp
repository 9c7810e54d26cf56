// Compares this codec with node-mavlink, which shares no code with it.

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <unistd.h>

#include "test/wire/mavlink/random_message.hpp"
#include "wire/mavlink/parser.hpp"
#include "wire/mavlink/signing.hpp"

namespace vantage::wire::mavlink {
namespace {

namespace fs = std::filesystem;
using Bytes = std::vector<std::uint8_t>;

const std::string kPeer = std::string(VANTAGE_SOURCE_DIR) + "/test/wire/mavlink/peer";
constexpr int kMessages = 10'000;
constexpr Time kNow = from_utime(1'767'225'600'000'000);

std::string text_of(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

void write(const fs::path& path, const auto& content) {
  std::ofstream out(path, std::ios::binary);
  std::copy(content.begin(), content.end(), std::ostreambuf_iterator<char>(out));
}

/// Returns all numbers of a message in the text format of the peer (peer/peer.mjs).
template <class Message>
std::string line_of(const Message& message) {
  std::ostringstream out;
  const auto print = [&out](auto element) {
    out << (out.tellp() == 0 ? "" : " ");
    if constexpr (std::is_same_v<decltype(element), float>) {
      out << std::bit_cast<std::uint32_t>(element);
    } else {
      out << +element;
    }
  };
  const auto visit = [&](std::string_view, const auto& field) {
    using Shape = FieldShape<std::remove_cvref_t<decltype(field)>>;
    if constexpr (Shape::kCount == 0) {
      print(field);
    } else {
      std::for_each(field.begin(), field.end(), print);
    }
  };
  Message::Fields::for_each(message, visit);
  Message::Extensions::for_each(message, visit);
  return out.str() + "\n";
}

template <class Message>
std::string header_of() {
  std::ostringstream out;
  const Message message;
  const auto visit = [&out](std::string_view name, const auto& field) {
    using Shape = FieldShape<std::remove_cvref_t<decltype(field)>>;
    out << (out.tellp() == 0 ? "" : " ") << type_name<typename Shape::Element>() << " " << name
        << " " << Shape::kCount;
  };
  Message::Fields::for_each(message, visit);
  Message::Extensions::for_each(message, visit);
  std::ostringstream head;
  head << Message::kMessage.id << " " << Message::kMessage.name << "\n" << out.str() << "\n";
  return head.str();
}

Bytes bytes_of(const std::string& text) { return {text.begin(), text.end()}; }

class Peer : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!fs::exists(kPeer + "/node_modules/node-mavlink")) {
      GTEST_SKIP() << "node-mavlink is not installed: tools/setup";
    }
    folder_ = fs::temp_directory_path() / ("vantage_mavlink_" + std::to_string(::getpid()));
    fs::create_directories(folder_);
  }
  void TearDown() override {
    if (!folder_.empty()) {
      fs::remove_all(folder_);
    }
  }
  fs::path file(std::string_view name, const std::string& kind) const {
    return folder_ / (std::string(name) + "." + kind);
  }
  int run_peer() const {
    return std::system(("node " + kPeer + "/peer.mjs " + folder_.string()).c_str());
  }

  fs::path folder_;
};

TEST_F(Peer, ExchangesMessagesWithThisCodec) {
  std::mt19937_64 rng(5);
  test::for_each_message([&]<class Message>() {
    std::string values = header_of<Message>();
    Bytes frames;
    for (int i = 0; i < kMessages; ++i) {
      const auto message = test::random_message<Message>(rng);
      values += line_of(message);
      append_bytes(pack(message, {1, 191, static_cast<std::uint8_t>(i)}), frames);
    }
    write(file(Message::kMessage.name, "values"), values);
    write(file(Message::kMessage.name, "frames"), frames);
  });
  Bytes signed_frames;
  const SigningKey key{9, 8, 7, 6};
  Signer signer(key, 5);
  for (int i = 0; i < 1000; ++i) {
    Frame frame =
        pack(test::random_message<Heartbeat>(rng), {1, 191, static_cast<std::uint8_t>(i)});
    signer.sign(frame, kNow + i * Duration{1000});
    append_bytes(frame, signed_frames);
  }
  write(file("signed", "frames"), signed_frames);
  write(file("signed", "key"), key);

  ASSERT_EQ(run_peer(), 0);

  test::for_each_message([&]<class Message>() {
    const std::string_view name = Message::kMessage.name;
    EXPECT_TRUE(text_of(file(name, "decoded")) == text_of(file(name, "values"))) << name;
    std::string decoded = header_of<Message>();
    Parser parser;
    parser.feed(bytes_of(text_of(file(name, "encoded"))), [&](const Frame& frame) {
      const auto message = unpack<Message>(frame);
      ASSERT_TRUE(message.has_value()) << name;
      decoded += line_of(*message);
    });
    EXPECT_EQ(parser.counts().frames, kMessages) << name;
    EXPECT_EQ(parser.counts().bytes_skipped, 0) << name;
    EXPECT_TRUE(decoded == text_of(file(name, "values"))) << name;
  });

  EXPECT_EQ(text_of(file("signed", "good")), "1000\n");
  Signer receiver(key, 0);
  Parser parser;
  int good = 0;
  parser.feed(bytes_of(text_of(file("signed", "resigned"))), [&](const Frame& frame) {
    good += receiver.check(frame, kNow) == SignatureVerdict::kGood ? 1 : 0;
  });
  EXPECT_EQ(good, 1000);
}

}  // namespace
}  // namespace vantage::wire::mavlink
