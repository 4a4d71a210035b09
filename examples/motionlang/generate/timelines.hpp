// Reads the user's input, timelines or plain texts with durations, and prints what the library says about it.
#pragma once

#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <iostream>
#include <iterator>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include <motionlang/compose/cut_texts.hpp>
#include <motionlang/compose/in_turn.hpp>
#include <motionlang/core/utf8.hpp>
#include <motionlang/file/file.hpp>
#include <motionlang/generate/missing_parts.hpp>
#include <motionlang/generate/text_warnings.hpp>
#include <motionlang/generate/timelines_of_text.hpp>

#include "../progress_bar.hpp"

namespace program {

namespace ml = motionlang;

/// The name of standard input as a timeline file.
inline constexpr const char* standard_input = "-";

/// The name of a timeline file or of standard input in messages.
inline std::string timeline_source(const std::string& path) { return path == standard_input ? "standard input" : path; }

inline std::string read_timeline_text(const std::string& path) {
  constexpr std::uintmax_t longest = 64 << 20;
  if (path != standard_input) {
    std::error_code none;
    if (const auto size = std::filesystem::file_size(path, none); !none && size > longest)
      ml::raise<ml::io_error>(405, path, ": ", ml::counted(size, "byte"), ", a timeline has at most ", longest);
    return ml::read_file(path);
  }
  return {std::istreambuf_iterator<char>(std::cin), {}};
}

/// The timelines of a file or of standard input.
inline std::vector<ml::Timeline> read_timelines(const std::string& path, double fps) {
  const std::string text = read_timeline_text(path), name = timeline_source(path);
  return ml::timelines_of_text(text, {.fps = fps, .name = name});
}

/// Prints each warning on its own line; in processes that work for another one nothing.
inline void warn(const std::vector<std::string>& warnings) {
  for (const std::string& w : warnings) {
    if (!ProgressBar::quiet) std::fprintf(stderr, "%s\n", ml::printable(w, "\n").c_str());
  }
}

/// Options about texts that name no body part.
struct MissingParts {
  bool guess = false;
  std::filesystem::path answers;

  void add_to(CLI::App& command) {
    command.add_flag("--guess-parts", guess,
                     "Texts of a timeline without body parts get those that their words mean, and the command says so. "
                     "Otherwise they move the whole body");
    command
        .add_option("--body-parts", answers,
                    "Answers of a language model about body parts (of the command body-parts, or SINC's table), for "
                    "such texts; implies --guess-parts for the others")
        ->check(CLI::ExistingFile);
  }
  /// file: the text of the timelines.
  void fill(std::vector<ml::Timeline>& timelines, const std::string& file) const {
    if (!guess && answers.empty()) return;
    ml::BodyPartAnswers known;
    if (!answers.empty()) known = ml::read_body_part_answers(answers);
    warn(ml::fill_missing_parts(timelines, file, &known));
  }
};

inline constexpr const char* in_turn_help =
    "Split a text with several actions ('walk forward, then sit down; wave') and give each action an equal share of "
    "its time";

/// Splits each text into its actions in sequence; reports which texts.
inline void make_in_turn(std::vector<ml::Timeline>& timelines, double fps) {
  warn(ml::in_turn_notes(timelines, fps));
  for (ml::Timeline& t : timelines) t = ml::in_turn(t);
}

}  // namespace program
