// Memory of this program, and the program started again: memory and times from the start can be shown only once in its
// life.
#pragma once

#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

namespace bench {

/// The most memory that this program had at once since it began, in MB (1e6 bytes), as Linux counts it.
inline double peak_memory() {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);) {
    if (line.starts_with("VmHWM:")) return 1.024e-3 * std::atof(line.c_str() + 6);
  }
  return 0;
}

/// Runs this program with these arguments and waits. True if it succeeded.
inline bool run_again(std::vector<std::string> arguments) {
  static std::string name = "again";
  std::vector<char*> words{name.data()};
  for (std::string& a : arguments) words.push_back(a.data());
  words.push_back(nullptr);
  const pid_t child = ::fork();
  if (child == 0) {
    ::execv("/proc/self/exe", words.data());
    ::_exit(127);
  }
  int status = 1;
  ::waitpid(child, &status, 0);
  return status == 0;
}

/// A file for as long as the object lives.
struct TemporaryFile {
  std::filesystem::path path =
      std::filesystem::temp_directory_path() / ("motionlang_bench_" + std::to_string(::getpid()) + ".safetensors");

  TemporaryFile() = default;
  ~TemporaryFile() { std::filesystem::remove(path); }
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;
};

}  // namespace bench
