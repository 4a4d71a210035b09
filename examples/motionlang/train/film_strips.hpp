// Film strips of the motions that evaluate generates for texts, and of the recorded motions: --strips.
#pragma once

#include <set>
#include <string>

#include "../files/motion_files.hpp"
#include "evaluate.hpp"
#include "processes.hpp"

namespace program {

class FilmStrips {
 public:
  /// Without a folder it draws none. Throws io_error 401 if the folder cannot be written to.
  explicit FilmStrips(const EvaluationOptions& o) : folder_(o.strips), count_(o.count) {
    if (!folder_.empty()) make_output_folder("--strips", folder_);
  }

  bool wanted() const { return !folder_.empty(); }
  /// True for the first different texts, in the order of the calls. It is ml::ShownTexts.
  bool shows(const std::string& text) { return std::ssize(shown_) < count_ && shown_.insert(text).second; }
  /// Writes 1.svg from made() and 1_recorded.svg from recorded(), 2.svg, ... Of several processes the first one writes.
  template <class Made, class Recorded>
  void add(const std::string& text, Made made, Recorded recorded) {
    if (processes().rank() > 0) return;
    ++written_;
    write(".svg", text, made());
    write("_recorded.svg", text + " (recorded)", recorded());
  }

 private:
  void write(const char* end, const std::string& title, ml::Motion motion) const {
    motion.name = title;
    write_motion(folder_ / ml::concat_text(written_, end), motion);
  }

  std::filesystem::path folder_;
  ml::Index count_, written_ = 0;
  std::set<std::string> shown_;
};

}  // namespace program
