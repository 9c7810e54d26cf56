#include "tools/view/web_server.hpp"

#include <algorithm>
#include <array>
#include <condition_variable>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <mutex>
#include <optional>
#include <set>
#include <string_view>
#include <thread>

#include <civetweb.h>
#include <fmt/format.h>
#include <sys/socket.h>

#include "core/check.hpp"
#include "core/deadline.hpp"
#include "tools/view/connection_table.hpp"
#include "tools/view/origin_check.hpp"
#include "tools/view/peer_sockets.hpp"

namespace vantage::tools {
namespace {

constexpr std::size_t kClientsMax = 24;
// One thread per viewer and per other connection (ConnectionTable::kOfAllMax).
constexpr const char* kThreads = "112";
static_assert(kClientsMax + ConnectionTable::kOfAllMax < 112);
constexpr auto kEndingPeriod = std::chrono::milliseconds(250);
constexpr int kOpcodeMask = 0x0F;
constexpr std::size_t kRequestBytesMax = 1U << 20U;
constexpr long long kVideoBytesMax = 2LL << 30;
constexpr std::string_view kRecordingPath = "/api/recording";
constexpr std::string_view kOperatePath = "/api/operate/";
constexpr long long kOrderBytesMax = 4096;

constexpr const char* kNoPage =
    "<!doctype html><meta charset=utf-8><title>vantage</title>"
    "<p>vantage was built without this page, because npm was not installed. "
    "Run <code>tools/setup</code> and build again. "
    "Foxglove and Lichtblick can connect to this address with <code>ws://</code> anyway.";

/// One viewer's connection, passed to its handlers.
struct Connection {
  std::shared_ptr<Client> client;
  std::thread writer;
  std::string text;  ///< received part of a message of several frames
  int opcode = 0;    ///< opcode of the first frame of `text`

  /// Ends the writer thread. No frame is sent after this function returns.
  void end_writing() {
    client->close();
    if (writer.joinable()) {
      writer.join();
    }
  }

  void write_all(mg_connection* socket) const {
    while (std::optional<Frame> frame = client->wait_pop()) {
      const int kind = frame->is_text ? MG_WEBSOCKET_OPCODE_TEXT : MG_WEBSOCKET_OPCODE_BINARY;
      std::string bytes = std::move(frame->head);
      if (frame->body) {
        bytes += *frame->body;
      }
      // If the viewer stops reading, the write times out and sends a part of the message. The
      // connection must then end, as any further bytes would be read as the rest of that message.
      const int written = mg_websocket_write(socket, kind, bytes.data(), bytes.size());
      if (written < 0 || static_cast<std::size_t>(written) != bytes.size()) {
        client->close();
      }
    }
  }
};

std::string content_policy() {
  // The page is loaded from this server and connects only to it.
  return "default-src 'self'; style-src 'self' 'unsafe-inline'; img-src 'self' data: blob:; "
         "connect-src 'self' ws: wss:";
}

void answer(mg_connection* socket, const char* type, const std::string& body, int code = 200) {
  mg_printf(socket,
            "HTTP/1.1 %d %s\r\nContent-Type: %s\r\nContent-Length: %zu\r\n"
            "Cache-Control: no-store\r\nX-Content-Type-Options: nosniff\r\n"
            "Connection: close\r\n\r\n",
            code, mg_get_response_code_text(socket, code), type, body.size());
  mg_write(socket, body.data(), body.size());
}

// Refuses a request. Writes the headers, because civetweb writes none if a WebSocket is requested.
int refuse(mg_connection* socket, int code, const char* reason, const char* why) {
  mg_printf(socket,
            "HTTP/1.1 %d %s\r\nContent-Type: text/plain\r\nContent-Length: %zu\r\n"
            "Connection: close\r\n\r\n%s",
            code, reason, std::string_view(why).size(), why);
  return code;
}

ConnectionTable::Peer peer_of(const mg_connection* socket) {
  const mg_request_info& info = *mg_get_request_info(socket);
  return {info.remote_addr, info.remote_port};
}

Time now() { return from_utime(monotonic_ns() / 1'000); }

}  // namespace

struct WebServer::State {
  State(Broker& of, WebOptions with) : broker(of), options(std::move(with)) {}

  Broker& broker;
  WebOptions options;
  mg_context* context = nullptr;
  bool has_page = false;
  int port = 0;
  std::mutex series_mutex;

  std::mutex connections_mutex;
  ConnectionTable connections;
  bool is_over = false;
  std::condition_variable over;
  std::thread ender;

  void end_slow_connections() {
    std::unique_lock lock(connections_mutex);
    while (!over.wait_for(lock, kEndingPeriod, [this] { return is_over; })) {
      const std::map<ConnectionTable::Peer, int> sockets = connections_to(port);
      std::set<ConnectionTable::Peer> open;
      for (const auto& [peer, descriptor] : sockets) {
        open.insert(peer);
      }
      for (const ConnectionTable::Peer& peer : connections.update(open, now())) {
        const int descriptor = sockets.at(peer);
        if (peer_at(descriptor, port) == peer) {
          ::shutdown(descriptor, SHUT_RDWR);
        }
      }
    }
  }

  static State& of(const mg_connection* socket) {
    return *static_cast<State*>(mg_get_user_context_data(socket));
  }
  static Connection* connection(const mg_connection* socket) {
    return static_cast<Connection*>(mg_get_user_connection_data(socket));
  }

  // A foreign page in a browser of this network must not read the bus. The Host check prevents DNS
  // rebinding; the Origin check prevents cross-origin requests.
  static bool is_permitted(const mg_connection* socket, const WebOptions& options) {
    const char* host = mg_get_header(socket, "Host");
    if (host != nullptr && !is_our_host(host, options.hosts)) {
      return false;
    }
    const char* origin = mg_get_header(socket, "Origin");
    return origin == nullptr ||
           is_known_origin(origin, host == nullptr ? "" : host, options.origins);
  }

  // Checks a new request. A refused request gets an answer, because civetweb alone would only close
  // the connection. Returns 0 if the request is permitted.
  static int on_begin(mg_connection* socket) {
    {
      const std::lock_guard lock(of(socket).connections_mutex);
      of(socket).connections.on_request(peer_of(socket), now());
    }
    const std::string_view method = mg_get_request_info(socket)->request_method;
    const bool is_recording = method == "POST" && of(socket).options.recording != nullptr &&
                              mg_get_request_info(socket)->local_uri == kRecordingPath;
    const bool is_order =
        method == "POST" && of(socket).options.operate &&
        std::string_view(mg_get_request_info(socket)->local_uri).starts_with(kOperatePath);
    if (method != "GET" && method != "HEAD" && !is_recording && !is_order) {
      return refuse(socket, 405, "Method Not Allowed", "this server is read-only");
    }
    if (!is_permitted(socket, of(socket).options)) {
      return refuse(socket, 403, "Forbidden",
                    "host name or page origin not allowed; allow a name with --host, an origin "
                    "with --origin");
    }
    if (mg_get_header(socket, "Upgrade") == nullptr) {
      return 0;
    }
    const char* offered = mg_get_header(socket, "Sec-WebSocket-Protocol");
    if (offered == nullptr || !offers_our_protocol(offered)) {
      return refuse(socket, 400, "Bad Request",
                    "subprotocol must be foxglove.sdk.v1 or foxglove.websocket.v1");
    }
    if (of(socket).broker.clients() >= kClientsMax) {
      return refuse(socket, 503, "Service Unavailable", "too many viewers are connected");
    }
    return 0;
  }

  static int on_connect(const mg_connection* /*socket*/, void* /*state*/) { return 0; }

  static void on_ready(mg_connection* socket, void* state) {
    {
      const std::lock_guard lock(of(socket).connections_mutex);
      of(socket).connections.on_viewer(peer_of(socket), now());
    }
    auto* connection = new Connection;  // deleted by on_close, which civetweb always calls
    const char* protocol = mg_get_request_info(socket)->acceptedWebSocketSubprotocol;
    const bool speaks_sdk = protocol != nullptr && std::string_view(protocol) == kSubprotocols[0];
    connection->client = static_cast<State*>(state)->broker.connect(speaks_sdk);
    mg_set_user_connection_data(socket, connection);
    connection->writer = std::thread([connection, socket] { connection->write_all(socket); });
  }

  static int on_data(mg_connection* socket, int bits, char* bytes, std::size_t size, void* state) {
    Connection* viewer = connection(socket);
    const int opcode = bits & kOpcodeMask;
    if (viewer == nullptr) {
      return 0;
    }
    if (opcode == MG_WEBSOCKET_OPCODE_CONNECTION_CLOSE) {
      // Answers with the received code after the last outgoing frame (RFC 6455, 5.5.1).
      constexpr std::size_t kCodeBytes = 2;
      viewer->end_writing();
      mg_websocket_write(socket, MG_WEBSOCKET_OPCODE_CONNECTION_CLOSE, bytes,
                         size < kCodeBytes ? 0 : kCodeBytes);
      return 0;
    }
    if (viewer->client->is_closed()) {
      return 0;
    }
    if (opcode > MG_WEBSOCKET_OPCODE_BINARY) {
      return 1;  // civetweb answers ping and pong
    }
    if (opcode != MG_WEBSOCKET_OPCODE_CONTINUATION) {
      viewer->text.clear();
      viewer->opcode = opcode;
    }
    if (viewer->text.size() + size > kRequestBytesMax) {
      return 0;
    }
    viewer->text.append(bytes, size);
    constexpr int kLastFrame = 0x80;
    if ((bits & kLastFrame) != 0) {
      const Request request = viewer->opcode == MG_WEBSOCKET_OPCODE_TEXT
                                  ? parse_text(viewer->text)
                                  : parse_binary(viewer->text);
      static_cast<State*>(state)->broker.on_request(*viewer->client, request);
      viewer->text.clear();
    }
    return 1;
  }

  static void on_close(const mg_connection* socket, void* state) {
    const std::unique_ptr<Connection> viewer(connection(socket));
    if (viewer) {
      mg_set_user_connection_data(socket, nullptr);
      static_cast<State*>(state)->broker.disconnect(viewer->client);
      viewer->end_writing();
    }
  }

  static int on_history(mg_connection* socket, void* state) {
    const auto& history = static_cast<State*>(state)->options.history;
    answer(socket, "application/json", history ? history() : "[]");
    return 200;
  }

  static int on_topics(mg_connection* socket, void* state) {
    answer(socket, "application/json", static_cast<State*>(state)->broker.topics_text());
    return 200;
  }

  static std::string parameter(const mg_connection* socket, const char* name) {
    const char* query = mg_get_request_info(socket)->query_string;
    char value[1024] = "";
    if (query != nullptr) {
      mg_get_var(query, std::string_view(query).size(), name, value, sizeof value);
    }
    return value;
  }

  static int on_series(mg_connection* socket, void* state) {
    auto& self = *static_cast<State*>(state);
    // One call at a time, because each call reads the complete log in addition to the player.
    const std::lock_guard lock(self.series_mutex);
    const auto& series = self.options.series;
    answer(socket, "application/json",
           series ? series(parameter(socket, "topic"), parameter(socket, "field")) : "[]");
    return 200;
  }

  /// Receives the progress of the recording (done=SHARE), its failure (failed=1) or the video.
  static int on_recording(mg_connection* socket, void* state) {
    RecordingReceiver& receiver = *static_cast<State*>(state)->options.recording;
    if (!receiver.is_key(parameter(socket, "key"))) {
      return refuse(socket, 403, "Forbidden", "the key does not belong to this recording");
    }
    if (const std::string done = parameter(socket, "done"); !done.empty()) {
      receiver.report_progress(std::strtod(done.c_str(), nullptr));
      answer(socket, "text/plain", "");
      return 200;
    }
    const long long size = mg_get_request_info(socket)->content_length;
    if (size <= 0 || size > kVideoBytesMax) {
      receiver.fail("the video has an invalid size: " + std::to_string(size) + " bytes");
      return refuse(socket, 413, "Payload Too Large", "the video is empty or too large");
    }
    std::string body(static_cast<std::size_t>(size), '\0');
    std::size_t read = 0;
    for (int part = 1; part > 0 && read < body.size(); read += static_cast<std::size_t>(part)) {
      part = std::max(0, mg_read(socket, body.data() + read, body.size() - read));
    }
    if (read < body.size()) {
      receiver.fail("the video was cut off during the upload");
    } else if (parameter(socket, "failed") == "1") {
      receiver.fail(body);
    } else {
      receiver.take(std::move(body));
    }
    answer(socket, "text/plain", "");
    return 200;
  }

  /// Passes a request of an operator page on. The headers with key and token cannot be sent by a
  /// page of another origin without a preflight request, which this server refuses.
  static int on_operate(mg_connection* socket, void* state) {
    const auto header = [socket](const char* name) {
      const char* value = mg_get_header(socket, name);
      return std::string(value == nullptr ? "" : value);
    };
    const mg_request_info& info = *mg_get_request_info(socket);
    if (std::string_view(info.request_method) != "POST") {
      return refuse(socket, 405, "Method Not Allowed", "orders are sent with POST");
    }
    if (!is_same_origin(header("Origin"), header("Host"))) {
      return refuse(socket, 403, "Forbidden", "orders are accepted from this server's page only");
    }
    if (header("Content-Type") != "application/json") {
      return refuse(socket, 415, "Unsupported Media Type", "orders are JSON");
    }
    if (info.content_length < 0 || info.content_length > kOrderBytesMax) {
      return refuse(socket, 413, "Payload Too Large", "the order is too long or has no length");
    }
    std::string body(static_cast<std::size_t>(info.content_length), '\0');
    std::size_t read = 0;
    for (int part = 1; part > 0 && read < body.size(); read += static_cast<std::size_t>(part)) {
      part = std::max(0, mg_read(socket, body.data() + read, body.size() - read));
    }
    body.resize(read);
    const std::string what = std::string(info.local_uri).substr(kOperatePath.size());
    const auto [code, json] = static_cast<State*>(state)->options.operate(
        what, header("X-Vantage-Key"), header("X-Vantage-Token"), body);
    answer(socket, "application/json", json, code);
    return code;
  }

  static int on_no_page(mg_connection* socket, void* /*state*/) {
    answer(socket, "text/html; charset=utf-8", kNoPage);
    return 200;
  }

  static int on_message(const mg_connection* /*socket*/, const char* /*text*/) { return 1; }

  void set_handlers() {
    static const char* subprotocols[] = {kSubprotocols[0], kSubprotocols[1]};
    static mg_websocket_subprotocols accepted{2, subprotocols};
    mg_set_websocket_handler_with_subprotocols(context, "/", &accepted, &on_connect, &on_ready,
                                               &on_data, &on_close, this);
    mg_set_request_handler(context, "/api/history", &on_history, this);
    mg_set_request_handler(context, "/api/topics", &on_topics, this);
    mg_set_request_handler(context, "/api/series", &on_series, this);
    if (options.operate) {
      mg_set_request_handler(context, std::string(kOperatePath).append("*").c_str(), &on_operate,
                             this);
    }
    if (options.recording != nullptr) {
      mg_set_request_handler(context, kRecordingPath.data(), &on_recording, this);
    }
    if (!has_page) {
      mg_set_request_handler(context, "/", &on_no_page, this);
    }
  }
};

namespace {

// Returns `host` in the form for URLs and port lists: an IPv6 address is in brackets.
std::string in_brackets(const std::string& host) {
  return host.find(':') == std::string::npos ? host : "[" + host + "]";
}

}  // namespace

WebServer::WebServer(Broker& broker, const WebOptions& options)
    : state_(std::make_unique<State>(broker, options)) {
  state_->has_page =
      !options.page_folder.empty() &&
      std::filesystem::exists(std::filesystem::path(options.page_folder) / "index.html");
  const std::string address = fmt::format("{}:{}", in_brackets(options.bind), options.port);
  const std::string headers = "Content-Security-Policy: " + content_policy() + "\r\n";
  const char* settings[] = {"listening_ports",
                            address.c_str(),
                            "num_threads",
                            kThreads,
                            "request_timeout_ms",  // also the time limit of a write
                            "30000",
                            "websocket_timeout_ms",
                            "20000",
                            "enable_websocket_ping_pong",
                            "yes",
                            "enable_directory_listing",
                            "no",
                            "cgi_pattern",
                            "",
                            "ssi_pattern",
                            "",
                            "static_file_max_age",
                            "0",
                            "tcp_nodelay",
                            "1",
                            "additional_header",
                            headers.c_str(),
                            state_->has_page ? "document_root" : nullptr,
                            options.page_folder.c_str(),
                            nullptr};
  mg_callbacks callbacks{};
  callbacks.begin_request = &State::on_begin;
  callbacks.log_message = &State::on_message;
  mg_init_library(0);
  state_->context = mg_start(&callbacks, state_.get(), settings);
  if (state_->context == nullptr) {
    mg_exit_library();
    throw StartupError("cannot serve on " + address +
                       ": the port is in use or the address is not on this computer");
  }
  mg_server_port ports[4] = {};
  if (mg_get_server_ports(state_->context, 4, ports) > 0) {
    state_->port = ports[0].port;
  }
  state_->set_handlers();
  state_->ender = std::thread([state = state_.get()] { state->end_slow_connections(); });
}

WebServer::~WebServer() {
  mg_stop(state_->context);
  {
    const std::lock_guard lock(state_->connections_mutex);
    state_->is_over = true;
  }
  state_->over.notify_all();
  state_->ender.join();
  mg_exit_library();
}

std::string WebServer::url() const {
  const std::string& bind = state_->options.bind;
  const std::string host = bind == "0.0.0.0" ? "127.0.0.1" : bind == "::" ? "::1" : bind;
  return fmt::format("http://{}:{}", in_brackets(host), state_->port);
}

bool WebServer::has_page() const { return state_->has_page; }

}  // namespace vantage::tools
