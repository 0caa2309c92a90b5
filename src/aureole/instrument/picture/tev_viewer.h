// SPDX-License-Identifier: Apache-2.0
// Shows pictures in a running tev (https://github.com/Tom94/tev), an image viewer that listens on a TCP port, by packets
// of its protocol: CreateImage, and UpdateImage of version 3.
#pragma once

#include <string>

#include "aureole/core/image.h"

namespace aureole {

class TevViewer {
public:
  /// Connects to "HOST:PORT", "HOST" or ":PORT" (localhost and 14158 where one is left out). Throws Error if nothing
  /// listens there within 5 s.
  explicit TevViewer(const std::string& address);
  ~TevViewer();
  TevViewer(const TevViewer&) = delete;
  TevViewer& operator=(const TevViewer&) = delete;

  /// Sends all channels of a picture; the first picture of a name opens it in the viewer. Throws Error if the
  /// viewer has closed the connection, or accepts no data for 10 s.
  void show(const std::string& name, const Image& image);

private:
  void send_packet(const std::string& payload);

  std::string address_, opened_;
  int socket_ = -1;
};

}  // namespace aureole
