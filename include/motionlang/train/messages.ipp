// SPDX-License-Identifier: MIT
// Bodies of messages.hpp.
#pragma once

#include <motionlang/train/messages.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY void send_message(const AnyCommunicator& c, std::string_view message, Index to) {
  const std::uint64_t size = message.size();
  c.send(std::as_bytes(std::span(&size, 1)), to);
  c.send(std::as_bytes(std::span(message.data(), message.size())), to);
}

MOTIONLANG_BODY std::string receive_message(const AnyCommunicator& c, Index from) {
  std::uint64_t size = 0;
  c.receive(std::as_writable_bytes(std::span(&size, 1)), from);
  std::string out(size, '\0');
  c.receive(std::as_writable_bytes(std::span(out)), from);
  return out;
}

MOTIONLANG_BODY std::vector<std::string> messages_of_all(const AnyCommunicator& c, const std::string& mine) {
  if (c.size() == 1) return {mine};
  std::vector<std::string> out(static_cast<std::size_t>(c.size()));
  out[static_cast<std::size_t>(c.rank())] = mine;
  if (c.rank() > 0) send_message(c, mine, 0);
  for (Index r = 1; c.rank() == 0 && r < c.size(); ++r) out[static_cast<std::size_t>(r)] = receive_message(c, r);
  for (std::string& message : out) message = text_of_first(c, std::move(message));
  return out;
}

MOTIONLANG_NAMESPACE_END
