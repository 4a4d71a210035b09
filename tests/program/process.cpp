#include "process.hpp"

#include <fcntl.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <stdexcept>

namespace {

/// In the child: becomes the program. Never returns.
[[noreturn]] void become(const char* program, const std::vector<std::string>& arguments,
                         const std::filesystem::path& folder, const std::string& input, int output) {
  std::vector<char*> argv{const_cast<char*>("motionlang")};
  for (const std::string& a : arguments) argv.push_back(const_cast<char*>(a.c_str()));
  argv.push_back(nullptr);
  ::dup2(output, STDOUT_FILENO);
  ::dup2(output, STDERR_FILENO);
  ::close(output);
  if (::chdir(folder.c_str()) == 0 && ::dup2(::open(input.c_str(), O_RDONLY), STDIN_FILENO) == STDIN_FILENO)
    ::execv(program, argv.data());
  ::_exit(127);
}

Outcome run_program(const char* program, const std::vector<std::string>& arguments, const std::filesystem::path& folder,
                    const std::string& interrupt_at, const std::string& input) {
  std::array<int, 2> ends{};
  if (::pipe(ends.data()) != 0) throw std::runtime_error("pipe");
  const pid_t child = ::fork();
  if (child < 0) throw std::runtime_error("fork");
  if (child == 0) {
    ::close(ends[0]);
    become(program, arguments, folder, input, ends[1]);
  }
  ::close(ends[1]);

  Outcome out;
  bool interrupted = interrupt_at.empty();
  std::array<char, 4096> buffer{};
  for (ssize_t n; (n = ::read(ends[0], buffer.data(), buffer.size())) > 0;) {
    out.text.append(buffer.data(), static_cast<std::size_t>(n));
    if (!interrupted && out.text.find(interrupt_at) != std::string::npos) {
      ::kill(child, SIGINT);
      interrupted = true;
    }
  }
  ::close(ends[0]);
  int status = 0;
  ::waitpid(child, &status, 0);
  out.code = WIFEXITED(status) ? WEXITSTATUS(status) : 256 + WTERMSIG(status);
  return out;
}

}  // namespace

Outcome run(const std::vector<std::string>& arguments, const std::filesystem::path& folder,
            const std::string& interrupt_at, const std::string& input) {
  return run_program(MOTIONLANG_PROGRAM, arguments, folder, interrupt_at, input);
}

Outcome shell(const std::string& line, const std::filesystem::path& folder) {
  return run_program("/bin/sh", {"-c", "motionlang() { '" MOTIONLANG_PROGRAM "' \"$@\"; }\n" + line}, folder, "",
                     "/dev/null");
}
