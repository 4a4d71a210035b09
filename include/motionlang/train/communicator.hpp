// SPDX-License-Identifier: MIT
/// Processes that train together, and their messages: a concept with the model for one process. train/mpi.hpp has the
/// model for MPI.
///
/// A training uses no sum of a message library, because its order of additions changes with the number of processes.
/// The order of `sum_of_parts` (train/batch_parts.hpp) depends on the number of parts alone.
#pragma once

#include <concepts>  // convertible_to
#include <cstddef>   // bytes
#include <cstdint>   // sizes of messages
#include <span>      // messages
#include <string>    // messages
#include <vector>    // lines

#include <motionlang/core/concepts.hpp>
#include <motionlang/core/error.hpp>
#include <motionlang/core/shape.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// Processes with the numbers (ranks) 0 ... size - 1. Each process has an object of its own.
///   send, receive   bytes for one rank, bytes from one rank; either may wait for the other
///   exchange        sends bytes to a rank and takes those that it sends, at the same time; both ranks call it
///   arrived         true if a message of a rank is there, so that receive does not wait. It never waits itself
///   broadcast       all have the bytes of `root` afterwards
///   barrier         returns once all have called it
/// Laws    messages between two ranks arrive in their order; receive and exchange throw shape_error 204 for a message
///         of another size than they ask for, which they take and drop, so that its sender does not wait (of messages
///         up to 1 GiB); all ranks call broadcast and barrier in one order, with one size and root
/// Errors  an exception in a function that all ranks call leaves the others waiting for messages. A program that does
///         not expect it in all ranks must then end all of them: MpiCommunicator::abort
/// Models  OneProcess, AnyCommunicator, MpiCommunicator
template <class C>
concept Communicator = requires(const C& c, std::span<const std::byte> given, std::span<std::byte> taken, Index rank) {
  { c.rank() } -> std::convertible_to<Index>;
  { c.size() } -> std::convertible_to<Index>;
  c.send(given, rank);
  c.receive(taken, rank);
  c.exchange(given, taken, rank);
  { c.arrived(rank) } -> std::convertible_to<bool>;
  c.broadcast(taken, rank);
  c.barrier();
};

/// A process alone. It has nobody to send to.
struct OneProcess {
  static Index rank() { return 0; }
  static Index size() { return 1; }
  [[noreturn]] static void send(std::span<const std::byte>, Index to) { refuse(to); }
  [[noreturn]] static void receive(std::span<std::byte>, Index from) { refuse(from); }
  [[noreturn]] static void exchange(std::span<const std::byte>, std::span<std::byte>, Index with) { refuse(with); }
  static bool arrived(Index) { return false; }
  static void broadcast(std::span<std::byte>, Index) {}
  static void barrier() {}

 private:
  [[noreturn]] static void refuse(Index rank) { raise<config_error>(101, "OneProcess: there is no rank ", rank); }
};
static_assert(Communicator<OneProcess>);

/// A reference to any communicator, OneProcess by default. Code that takes it is compiled once for all of them.
class AnyCommunicator {
 public:
  AnyCommunicator() : AnyCommunicator(one_process()) {}
  /// The communicator must outlive this object, so a temporary one does not compile.
  template <Communicator C>
  requires(!std::same_as<C, AnyCommunicator>) explicit AnyCommunicator(const C& c)
      : communicator_(&c), functions_(&functions_of<C>), rank_(c.rank()), size_(c.size()) {}
  template <Communicator C>
  requires(!std::same_as<C, AnyCommunicator>) explicit AnyCommunicator(const C&& c) = delete;

  Index rank() const { return rank_; }
  Index size() const { return size_; }
  void send(std::span<const std::byte> bytes, Index to) const { functions_->send(communicator_, bytes, to); }
  void receive(std::span<std::byte> bytes, Index from) const { functions_->receive(communicator_, bytes, from); }
  void exchange(std::span<const std::byte> given, std::span<std::byte> taken, Index with) const {
    functions_->exchange(communicator_, given, taken, with);
  }
  bool arrived(Index from) const { return functions_->arrived(communicator_, from); }
  void broadcast(std::span<std::byte> bytes, Index root) const { functions_->broadcast(communicator_, bytes, root); }
  void barrier() const { functions_->barrier(communicator_); }

 private:
  struct Functions {
    void (*send)(const void*, std::span<const std::byte>, Index);
    void (*receive)(const void*, std::span<std::byte>, Index);
    void (*exchange)(const void*, std::span<const std::byte>, std::span<std::byte>, Index);
    bool (*arrived)(const void*, Index);
    void (*broadcast)(const void*, std::span<std::byte>, Index);
    void (*barrier)(const void*);
  };
  template <class C>
  static const C& of(const void* c) {
    return *static_cast<const C*>(c);
  }
  template <class C>
  static constexpr Functions functions_of{
      .send = [](const void* c, std::span<const std::byte> bytes, Index to) { of<C>(c).send(bytes, to); },
      .receive = [](const void* c, std::span<std::byte> bytes, Index from) { of<C>(c).receive(bytes, from); },
      .exchange = [](const void* c, std::span<const std::byte> given, std::span<std::byte> taken,
                     Index with) { of<C>(c).exchange(given, taken, with); },
      .arrived = [](const void* c, Index from) { return static_cast<bool>(of<C>(c).arrived(from)); },
      .broadcast = [](const void* c, std::span<std::byte> bytes, Index root) { of<C>(c).broadcast(bytes, root); },
      .barrier = [](const void* c) { of<C>(c).barrier(); }};
  static const OneProcess& one_process() {
    static constexpr OneProcess one{};
    return one;
  }

  const void* communicator_;
  const Functions* functions_;
  Index rank_, size_;
};
static_assert(Communicator<AnyCommunicator>);

/// The text of rank 0, in all processes.
std::string text_of_first(const AnyCommunicator& c, std::string text);
/// The lines of rank 0, in all processes.
std::vector<std::string> lines_of_first(const AnyCommunicator& c, const std::vector<std::string>& lines);
/// The numbers of rank 0, in all processes. Others need not know how many there are.
template <Scalar S>
void numbers_of_first(const AnyCommunicator& c, std::vector<S>& numbers);
/// The answer of rank 0, in all processes.
bool answer_of_first(const AnyCommunicator& c, bool answer);
/// The number of the first rank whose text differs from that of rank 0, in all processes; -1 if all are equal.
Index first_other_text(const AnyCommunicator& c, const std::string& text);

template <Scalar S>
void numbers_of_first(const AnyCommunicator& c, std::vector<S>& numbers) {
  std::uint64_t size = numbers.size();
  c.broadcast(std::as_writable_bytes(std::span(&size, 1)), 0);
  numbers.resize(size);
  c.broadcast(std::as_writable_bytes(std::span(numbers)), 0);
}

/// The kernels of this process (core/instruction_set.hpp). Processes whose kernels differ compute other bits.
std::string kernels_in_use();

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/train/communicator.ipp>
#endif
