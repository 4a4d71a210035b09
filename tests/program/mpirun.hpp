// SPDX-License-Identifier: MIT
/// The program under mpirun, where its output is compared with that of one process. Built where MPI is installed. `run`
/// starts a shell there.
#pragma once

#include <initializer_list>
#include <string>

#include <doctest/doctest.h>

#include <motionlang/file/file.hpp>

#include "process.hpp"

/// Variables that make Open MPI accept the user root, and more processes than processors.
inline constexpr const char* open_mpi_variables =
    "export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 "
    "OMPI_MCA_rmaps_base_oversubscribe=1 PRTE_MCA_rmaps_default_mapping_policy=:oversubscribe\n";

/// Folder: a temporary folder, in which the program runs.
template <class Folder>
struct UnderMpirun : Folder {
  /// A command line of motionlang under so many processes, 0: without mpirun. A wait that has no end is code 124.
  Outcome call(int processes, const std::string& arguments) const {
    const std::string mpirun = processes == 0 ? "" : MOTIONLANG_MPIRUN " -n " + std::to_string(processes) + " ";
    return run({"-c", open_mpi_variables + ("timeout 300 " + mpirun) + MOTIONLANG_TRAINED_PROGRAM " " + arguments},
               this->path);
  }
  /// Its standard output.
  std::string printed(int processes, const std::string& arguments) const {
    const Outcome o = call(processes, arguments + " > printed.txt");
    CAPTURE(arguments);
    CAPTURE(processes);
    REQUIRE_MESSAGE(o.code == 0, o.text);
    return motionlang::read_file(*this / "printed.txt");
  }
  /// The output of `evaluate`.
  std::string table(int processes, const std::string& arguments) const {
    return printed(processes, "evaluate " + arguments + " --threads 1");
  }
  /// Checks that so many processes print the table of one, and returns it.
  std::string same_table(std::initializer_list<int> of, const std::string& arguments) const {
    const std::string alone = table(0, arguments);
    CAPTURE(arguments);
    CHECK(alone.size() > 20);
    for (const int processes : of) {
      CAPTURE(processes);
      CHECK(table(processes, arguments) == alone);
    }
    return alone;
  }
  void train(const std::string& arguments) const {
    const Outcome o = call(0, arguments + " --preset small --threads 1");
    REQUIRE_MESSAGE(o.code == 0, o.text);
  }
};

/// Arguments that set so many values.
inline std::string settings(std::initializer_list<const char*> assignments) {
  std::string out;
  for (const char* a : assignments) out += std::string(" --set ") + a;
  return out;
}
