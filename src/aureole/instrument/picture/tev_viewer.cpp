// SPDX-License-Identifier: Apache-2.0
#include "aureole/instrument/picture/tev_viewer.h"

#include <fcntl.h>
#include <netdb.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <unistd.h>

#include <bit>
#include <cerrno>
#include <cstdint>
#include <cstring>
#include <limits>
#include <string>

#include "aureole/core/error.h"

namespace aureole {
namespace {

static_assert(std::endian::native == std::endian::little, "packets are little-endian");

constexpr int kConnectMs = 5000, kSendSeconds = 10;
enum class PacketType : unsigned char { create_image = 4, update_image_v3 = 6 };

template <class Number>
void append(std::string& packet, Number value) {
  packet.append(reinterpret_cast<const char*>(&value), sizeof value);
}
void append_text(std::string& packet, const std::string& text) {
  packet.append(text.c_str(), text.size() + 1);
}

/// A connected socket, or -1. Gives up after `kConnectMs`.
int connected(const addrinfo& to) {
  const int s = ::socket(to.ai_family, to.ai_socktype | SOCK_CLOEXEC, to.ai_protocol);
  if (s < 0) return -1;
  const int flags = ::fcntl(s, F_GETFL);
  ::fcntl(s, F_SETFL, flags | O_NONBLOCK);
  bool good = ::connect(s, to.ai_addr, to.ai_addrlen) == 0;
  if (!good && errno == EINPROGRESS) {
    pollfd wait{s, POLLOUT, 0};
    int problem = 0;
    socklen_t size = sizeof problem;
    good = ::poll(&wait, 1, kConnectMs) == 1 && ::getsockopt(s, SOL_SOCKET, SO_ERROR, &problem, &size) == 0 &&
           problem == 0;
  }
  if (!good) {
    ::close(s);
    return -1;
  }
  ::fcntl(s, F_SETFL, flags);
  const timeval longest{kSendSeconds, 0};
  ::setsockopt(s, SOL_SOCKET, SO_SNDTIMEO, &longest, sizeof longest);
  return s;
}

}  // namespace

TevViewer::TevViewer(const std::string& address) : address_(address) {
  const std::size_t colon = address.rfind(':');
  std::string host = address.substr(0, colon), port = colon == address.npos ? "" : address.substr(colon + 1);
  if (host.empty()) host = "localhost";
  if (port.empty()) port = "14158";
  if (port.find_first_not_of("0123456789") != port.npos || port.size() > 5 || std::stoi(port) > 65535)
    throw Error("\"" + address +
                "\" is no address such as localhost:14158: the port is a number up to 65535");
  addrinfo wanted{}, *found = nullptr;
  wanted.ai_socktype = SOCK_STREAM;
  if (const int code = ::getaddrinfo(host.c_str(), port.c_str(), &wanted, &found); code != 0)
    throw Error("\"" + address + "\" is no address such as localhost:14158: " + ::gai_strerror(code));
  for (const addrinfo* at = found; at && socket_ < 0; at = at->ai_next) socket_ = connected(*at);
  ::freeaddrinfo(found);
  if (socket_ < 0) throw Error("no viewer listens at " + host + ":" + port + "; start tev first");
}

TevViewer::~TevViewer() {
  if (socket_ >= 0) ::close(socket_);
}

void TevViewer::send_packet(const std::string& payload) {
  std::string head;
  append(head, std::uint32_t(payload.size() + 4));
  for (const std::string* part : {static_cast<const std::string*>(&head), &payload})
    for (std::size_t sent = 0; sent < part->size();) {
      const ssize_t n = ::send(socket_, part->data() + sent, part->size() - sent, MSG_NOSIGNAL);
      if (n < 0 && errno == EINTR) continue;
      if (n <= 0)
        throw Error("the viewer at " + address_ +
                    " takes no more pictures: " + std::strerror(n < 0 ? errno : ECONNRESET));
      sent += std::size_t(n);
    }
}

void TevViewer::show(const std::string& name, const Image& image) {
  const auto channels = std::int32_t(image.channel_count());
  const auto begin = [&](PacketType type) {
    std::string packet;
    append(packet, static_cast<unsigned char>(type));
    append(packet, static_cast<unsigned char>(0));  // 0: the viewer does not take the focus
    append_text(packet, name);
    return packet;
  };
  if (opened_ != name) {
    std::string create = begin(PacketType::create_image);
    append(create, std::int32_t(image.width)), append(create, std::int32_t(image.height));
    append(create, channels);
    for (const std::string& channel : image.channels) append_text(create, channel);
    send_packet(create);
    opened_ = name;
  }
  // The length of a packet is a 32-bit number, so that large pictures are sent in bands of rows.
  const std::size_t row_bytes = std::size_t(image.width) * image.channel_count() * sizeof(float);
  constexpr std::size_t kBand = std::size_t(1) << 28;
  const int rows = int(std::min(std::size_t(image.height), std::max<std::size_t>(1, kBand / row_bytes)));
  for (int y = 0; y < image.height; y += rows) {
    const int count = std::min(rows, image.height - y);
    std::string update = begin(PacketType::update_image_v3);
    append(update, channels);
    for (const std::string& channel : image.channels) append_text(update, channel);
    append(update, std::int32_t(0)), append(update, std::int32_t(y));
    append(update, std::int32_t(image.width)), append(update, std::int32_t(count));
    // For each channel the offset of its first value and the distance between values, both in floats.
    for (std::int64_t c = 0; c < channels; ++c) append(update, c);
    for (std::int64_t c = 0; c < channels; ++c) append(update, std::int64_t(channels));
    update.append(reinterpret_cast<const char*>(image.pixels.data()) + std::size_t(y) * row_bytes,
                  std::size_t(count) * row_bytes);
    send_packet(update);
  }
}

}  // namespace aureole
