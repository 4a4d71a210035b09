// SPDX-License-Identifier: MIT
/// Runs the motionlang program, collects what it says, and interrupts it.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

struct Outcome {
  int code = -1;     // exit status; 256 + signal when it died of one
  std::string text;  // standard output and error
};

/// Runs `motionlang` with these arguments in `folder`. When `interrupt_at` is not empty, Ctrl-C is sent as soon as the
/// program has said it. `input` is a file of the folder that it reads as standard input.
Outcome run(const std::vector<std::string>& arguments, const std::filesystem::path& folder,
            const std::string& interrupt_at = "", const std::string& input = "/dev/null");

/// Runs a line of the shell in `folder`, in which `motionlang` is the program.
Outcome shell(const std::string& line, const std::filesystem::path& folder);

inline bool contains(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }
