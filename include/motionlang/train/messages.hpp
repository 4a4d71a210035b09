// SPDX-License-Identifier: MIT
/// Messages of numbers, lists and texts between processes (train/communicator.hpp).
///
///     MessageWriter out;
///     out.value(seed), out.list(std::span<const float>(rows));
///     for (const std::string& message : messages_of_all(all, out.bytes())) {
///       MessageReader in(message);
///       const auto seed = in.value<std::uint64_t>();
///       const auto rows = in.list<float>();
///     }
#pragma once

#include <cstdint>      // sizes
#include <string>       // bytes
#include <string_view>  // texts
#include <vector>       // lists

#include <motionlang/file/detail/bytes.hpp>
#include <motionlang/train/communicator.hpp>

MOTIONLANG_NAMESPACE_BEGIN

class MessageWriter {
 public:
  template <detail::Plain T>
  void value(const T& v) {
    list(std::span<const T>(&v, 1), false);
  }
  template <detail::Plain T>
  void list(std::span<const T> values, bool with_size = true) {
    if (with_size) value(std::uint64_t{values.size()});
    bytes_.append(reinterpret_cast<const char*>(values.data()), values.size_bytes());
  }
  void text(std::string_view t) { list(std::span<const char>(t.data(), t.size())); }
  const std::string& bytes() const { return bytes_; }

 private:
  std::string bytes_;
};

/// Reads what a MessageWriter wrote, in the same order. Throws io_error 402 if the message ends too early.
class MessageReader {
 public:
  explicit MessageReader(std::string_view bytes) : bytes_(bytes) {}
  MessageReader(std::string&&) = delete;  // the message must outlive the reader

  template <detail::Plain T>
  T value() {
    T out{};
    std::memcpy(static_cast<void*>(&out), next(sizeof(T)).data(), sizeof(T));
    return out;
  }
  template <detail::Plain T>
  std::vector<T> list() {
    const auto size = value<std::uint64_t>();
    if (size > (bytes_.size() - at_) / sizeof(T)) raise<io_error>(402, "a message ends inside a list of ", size);
    std::vector<T> out(size);
    const std::string_view from = next(size * sizeof(T));
    if (size > 0) std::memcpy(static_cast<void*>(out.data()), from.data(), from.size());
    return out;
  }
  std::string text() {
    const auto size = value<std::uint64_t>();
    return std::string(next(size));
  }
  bool at_end() const { return at_ == bytes_.size(); }

 private:
  std::string_view next(std::uint64_t size) {
    if (size > bytes_.size() - at_) raise<io_error>(402, "a message ends at byte ", bytes_.size());
    at_ += size;
    return bytes_.substr(at_ - size, size);
  }

  std::string_view bytes_;
  std::size_t at_ = 0;
};

void send_message(const AnyCommunicator& c, std::string_view message, Index to);
std::string receive_message(const AnyCommunicator& c, Index from);
/// The messages of all processes in the order of their ranks, in all processes.
std::vector<std::string> messages_of_all(const AnyCommunicator& c, const std::string& mine);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/train/messages.ipp>
#endif
