// Film strips of the motions that evaluate generates for texts, and of the recorded motions: --strips.
#pragma once

#include <set>
#include <string>

#include "../files/motion_files.hpp"
#include "evaluate.hpp"

namespace program {

class FilmStrips {
 public:
  /// Without a folder it draws none. Throws io_error 401 if the folder cannot be written to.
  explicit FilmStrips(const EvaluationOptions& o) : folder_(o.strips), count_(o.count) {
    if (!folder_.empty()) make_output_folder("--strips", folder_);
  }

  /// Writes 1.svg from made() and 1_recorded.svg from recorded(), 2.svg, ..., for the first different texts.
  template <class Made, class Recorded>
  void add(const std::string& text, Made made, Recorded recorded) {
    if (folder_.empty() || std::ssize(shown_) >= count_ || !shown_.insert(text).second) return;
    write(".svg", text, made());
    write("_recorded.svg", text + " (recorded)", recorded());
  }

 private:
  void write(const char* end, const std::string& title, ml::Motion motion) const {
    motion.name = title;
    write_motion(folder_ / ml::concat_text(shown_.size(), end), motion);
  }

  std::filesystem::path folder_;
  ml::Index count_;
  std::set<std::string> shown_;
};

}  // namespace program
