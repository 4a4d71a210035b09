// SPDX-License-Identifier: MIT
/// The model of Communicator (train/communicator.hpp) for MPI. Include it only where MPI is linked; Debian has it in
/// libopenmpi-dev and openmpi-bin. Without <mpi.h> this header declares only started_processes.
///
/// Source   Message Passing Interface Forum: "MPI: A Message-Passing Interface Standard", version 3.1 (2015)
#pragma once

#include <algorithm>  // max, min
#include <cstdlib>    // getenv, strtol
#include <span>       // messages
#include <vector>     // messages of another size

#include <motionlang/train/communicator.hpp>

#if __has_include(<mpi.h>)
#ifndef OMPI_SKIP_MPICXX
#define OMPI_SKIP_MPICXX 1  // without Open MPI's classes
#endif
#ifndef MPICH_SKIP_MPICXX
#define MPICH_SKIP_MPICXX 1
#endif
#include <mpi.h>
#endif

MOTIONLANG_NAMESPACE_BEGIN

/// The number of processes that mpirun or srun started together with this one, as Open MPI, MPICH and Slurm tell it in
/// the environment; 1 without them. A process alone need not initialise MPI, which takes up to a second.
inline Index started_processes() {
  for (const char* name : {"OMPI_COMM_WORLD_SIZE", "PMI_SIZE", "SLURM_STEP_NUM_TASKS"}) {
    if (const char* value = std::getenv(name)) return std::max<Index>(1, std::strtol(value, nullptr, 10));
  }
  return 1;
}

#if __has_include(<mpi.h>)

/// All processes that were started together. One object lives at a time, in the thread that uses it, until the work is
/// done. Without `abort`, its end waits for the other processes.
class MpiCommunicator {
 public:
  MpiCommunicator() {
    int level = 0;
    MPI_Init_thread(nullptr, nullptr, MPI_THREAD_FUNNELED, &level);
    MPI_Comm_rank(MPI_COMM_WORLD, &rank_);
    MPI_Comm_size(MPI_COMM_WORLD, &size_);
  }
  ~MpiCommunicator() { MPI_Finalize(); }
  MpiCommunicator(const MpiCommunicator&) = delete;
  MpiCommunicator& operator=(const MpiCommunicator&) = delete;

  Index rank() const { return rank_; }
  Index size() const { return size_; }
  void send(std::span<const std::byte> bytes, Index to) const {
    for_pieces(bytes, [&](auto piece, int count) {
      MPI_Send(piece.data(), count, MPI_BYTE, static_cast<int>(to), 0, MPI_COMM_WORLD);
    });
  }
  /// Throws shape_error 204 for a message of another size.
  void receive(std::span<std::byte> bytes, Index from) const {
    for_pieces(bytes,
               [&](auto piece, int count) { require_size(receive_piece(piece.data(), count, from), count, from); });
  }
  /// Throws shape_error 204 for a message of another size.
  void exchange(std::span<const std::byte> given, std::span<std::byte> taken, Index with) const {
    const auto next = [](auto& bytes) {
      const auto piece = bytes.first(std::min(longest_piece, bytes.size()));
      bytes = bytes.subspan(piece.size());
      return piece;
    };
    do {
      const auto out = next(given);
      const auto in = next(taken);
      MPI_Request sent{};
      MPI_Isend(out.data(), static_cast<int>(out.size()), MPI_BYTE, static_cast<int>(with), 0, MPI_COMM_WORLD, &sent);
      const int came = receive_piece(in.data(), static_cast<int>(in.size()), with);
      MPI_Wait(&sent, MPI_STATUS_IGNORE);
      require_size(came, static_cast<int>(in.size()), with);
    } while (!given.empty() || !taken.empty());
  }
  bool arrived(Index from) const {
    int there = 0;
    MPI_Iprobe(static_cast<int>(from), 0, MPI_COMM_WORLD, &there, MPI_STATUS_IGNORE);
    return there != 0;
  }
  void broadcast(std::span<std::byte> bytes, Index root) const {
    for_pieces(bytes, [&](auto piece, int count) {
      MPI_Bcast(piece.data(), count, MPI_BYTE, static_cast<int>(root), MPI_COMM_WORLD);
    });
  }
  void barrier() const { MPI_Barrier(MPI_COMM_WORLD); }

  /// Ends all processes at once: for one that cannot go on while the others wait for it.
  [[noreturn]] void abort(int code) const {
    MPI_Abort(MPI_COMM_WORLD, code);
    std::_Exit(code);
  }

 private:
  /// Takes a message and returns its size. One of another size is taken, too, but not kept, as its sender may wait. MPI
  /// itself would end the program for one that is too long.
  static int receive_piece(std::byte* piece, int count, Index from) {
    MPI_Status status{};
    int sent = 0;
    MPI_Probe(static_cast<int>(from), 0, MPI_COMM_WORLD, &status);
    MPI_Get_count(&status, MPI_BYTE, &sent);
    std::vector<std::byte> other(static_cast<std::size_t>(sent == count ? 0 : sent));
    MPI_Recv(sent == count ? piece : other.data(), sent, MPI_BYTE, static_cast<int>(from), 0, MPI_COMM_WORLD,
             MPI_STATUS_IGNORE);
    return sent;
  }
  static void require_size(int sent, int wanted, Index from) {
    if (sent != wanted)
      raise<shape_error>(204, "a message of ", counted(sent, "byte"), " from rank ", from, " where ", wanted,
                         " are wanted");
  }

  static constexpr std::size_t longest_piece = std::size_t{1} << 30;  // MPI counts bytes in an int

  template <class Byte, class F>
  static void for_pieces(std::span<Byte> bytes, const F& f) {
    do {
      const auto piece = bytes.first(std::min(longest_piece, bytes.size()));
      f(piece, static_cast<int>(piece.size()));
      bytes = bytes.subspan(piece.size());
    } while (!bytes.empty());
  }

  int rank_ = 0, size_ = 1;
};
static_assert(Communicator<MpiCommunicator>);

#endif

MOTIONLANG_NAMESPACE_END
