// SPDX-License-Identifier: MIT
// Writes single_include/: headers that each replace a tree of headers.
//
//     amalgamate <repository>            writes them
//     amalgamate <repository> --check    fails if they are not what would be written
//
// Every `#include <motionlang/...>` is replaced by the text of that file, once if it says #pragma once, else at every
// place. Other includes stay, once each. Text below an #if counts as present only below the same #if, because its
// condition may be false. Every file is guarded by a macro of its own, so that the same text in several places does no
// harm. No library goes with these headers: MOTIONLANG_INSTANTIATED counts as undefined.
//
// A file *.inc that is included several times (the kernels, once per instruction set) is written once, at the end,
// below an #if. Where it belongs, the header defines the macro of that #if and includes itself by its own name.
#include <algorithm>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <iterator>
#include <map>
#include <set>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace {

namespace fs = std::filesystem;

struct Output {
  std::string name;
  std::string base;                  // another output that is included instead of copied; may be empty
  std::vector<std::string> headers;  // what it replaces; a folder stands for its headers
};
const std::vector<Output> outputs = {
    {"motionlang.hpp", "", {"motionlang/motionlang.hpp"}},
    {"motionlang_fwd.hpp", "", {"motionlang/fwd.hpp"}},
    {"motionlang_eigen.hpp", "motionlang/motionlang.hpp", {"motionlang/backend/eigen.hpp"}},
    {"motionlang_xtensor.hpp", "motionlang/motionlang.hpp", {"motionlang/backend/xtensor.hpp"}},
    {"motionlang_io.hpp",
     "motionlang/motionlang.hpp",
     {"motionlang/file", "motionlang/formats", "motionlang/datasets", "motionlang/search", "motionlang/weights",
      "motionlang/view"}},
    {"stmc.hpp", "", {"motionlang/stmc.hpp"}},
};

std::string read_text(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) throw std::runtime_error("amalgamate: cannot read " + path.string());
  return {std::istreambuf_iterator<char>(file), {}};
}
std::vector<std::string> read_lines(const fs::path& path) {
  std::vector<std::string> lines;
  std::string text = read_text(path);
  for (std::size_t i = 0; i < text.size();) {
    const std::size_t end = std::min(text.find('\n', i), text.size());
    lines.push_back(text.substr(i, end - i));
    i = end + 1;
  }
  return lines;
}

/// True if a line is `# <word> ...`. Then `rest` is what follows the word.
bool is_directive(const std::string& line, const std::string& word, std::string* rest = nullptr) {
  auto skip = [&](std::size_t i) { return std::min(line.find_first_not_of(" \t", i), line.size()); };
  std::size_t i = skip(0);
  if (i == line.size() || line[i] != '#') return false;
  i = skip(i + 1);
  if (line.compare(i, word.size(), word) != 0) return false;
  if (rest != nullptr) *rest = line.substr(skip(i + word.size()));
  return true;
}

/// The branches of `#if`s on MOTIONLANG_INSTANTIATED, which is undefined. Asked once for every line, in order.
class Instantiated {
 public:
  /// True if the line is left out: it is a directive of such an #if, or below one that does not hold.
  bool decides(const std::string& line) {
    std::string rest;
    if (is_directive(line, "if", &rest)) {
      const bool mine = rest == "def MOTIONLANG_INSTANTIATED" || rest == "ndef MOTIONLANG_INSTANTIATED";
      open_.push_back({mine, !mine || rest[0] == 'n'});
      return mine || !holds();
    }
    if (open_.empty()) return false;
    const bool mine = open_.back().mine, held = holds();
    if (is_directive(line, "else") && mine) open_.back().holds = !open_.back().holds;
    if (is_directive(line, "endif")) open_.pop_back();
    return !held || (mine && (is_directive(line, "else") || is_directive(line, "endif")));
  }

 private:
  struct If {
    bool mine, holds;
  };
  bool holds() const {
    return std::all_of(open_.begin(), open_.end(), [](const If& i) { return i.holds; });
  }

  std::vector<If> open_;
};

class Amalgamation {
 public:
  /// `repeated` are the files *.inc that are written once; none yet in a first pass, which counts them.
  Amalgamation(fs::path include, std::string name, std::set<std::string> repeated = {})
      : include_(std::move(include)), name_(std::move(name)), repeated_(std::move(repeated)) {}

  /// Appends the text of `header`, a path below the include folder, or of all headers of a folder.
  void add(const std::string& header) {
    if (fs::is_directory(include_ / header)) return add_folder(header);
    const auto lines = read_lines(include_ / header);
    const bool once =
        std::any_of(lines.begin(), lines.end(), [](const auto& l) { return is_directive(l, "pragma once"); });
    if (!once) return add_part(header, lines);
    if (in_part_) throw std::runtime_error("amalgamate: a file *.inc includes " + header);
    if (is_present(header)) return;
    present_[header].push_back(conditions_);
    const std::string guard = macro_of(header, "HAS");
    append("");
    append("#ifndef " + guard + "  // <" + header + ">");
    append("#define " + guard);
    add_lines(lines);
    append("#endif");
  }
  /// Goes on as if the text of `header` came from an include line.
  void include(const std::string& header) {
    add(header);
    text_ = "#include <" + header + ">\n";
    parts_.clear();
    times_.clear();
  }
  /// The whole file, except its first lines.
  std::string text() const {
    if (parts_.empty()) return "#pragma once\n\n" + text_;
    std::string none, parts;
    for (const auto& [header, part] : parts_) {
      const std::string defined = "defined(" + macro_of(header, "TEXT") + ")";
      none += " && !" + defined;
      parts += "#elif " + defined + "  // <" + header + ">\n" + part;
    }
    const std::string guard = macro_of("single_include/" + name_, "SINGLE");
    return "#if" + none.substr(3) + "\n#ifndef " + guard + "\n#define " + guard + "\n\n" + text_ + "\n#endif\n" +
           parts + "#endif\n";
  }
  /// Files *.inc that were included several times.
  std::set<std::string> repeated() const {
    std::set<std::string> out;
    for (const auto& [header, times] : times_) {
      if (times > 1) out.insert(header);
    }
    return out;
  }

 private:
  /// A file without #pragma once: its text stands at every place, or it is included from the end of the file.
  void add_part(const std::string& header, const std::vector<std::string>& lines) {
    if (in_part_) return add_lines(lines);
    ++times_[header];
    const bool apart = repeated_.contains(header);
    if (!apart || !parts_.contains(header)) {
      std::string outer = apart ? std::exchange(text_, "") : "";
      in_part_ = true;
      add_lines(lines);
      in_part_ = false;
      if (apart) parts_[header] = std::exchange(text_, std::move(outer));
    }
    if (!apart) return;
    const std::string macro = macro_of(header, "TEXT");
    append("#define " + macro);
    append("#include \"" + name_ + "\"");
    append("#undef " + macro);
  }
  void add_folder(const std::string& folder) {
    std::set<std::string> headers;
    for (const auto& entry : fs::directory_iterator(include_ / folder)) {
      if (entry.path().extension() == ".hpp") headers.insert(folder + "/" + entry.path().filename().string());
    }
    for (const auto& header : headers) add(header);
  }
  void add_lines(const std::vector<std::string>& lines) {
    Instantiated instantiated;
    for (const std::string& line : lines) {
      if (instantiated.decides(line)) continue;
      std::string included;
      if (is_directive(line, "include", &included)) {
        add_include(line, included.substr(1, included.find_first_of(">\"", 1) - 1));
        continue;
      }
      if (is_directive(line, "pragma once") || line.starts_with("// SPDX-License-Identifier")) continue;
      if (is_directive(line, "if")) conditions_.push_back(line);
      if (is_directive(line, "el")) conditions_.back() += "\n" + line;
      if (is_directive(line, "endif")) conditions_.pop_back();
      append(line);
    }
  }
  void add_include(const std::string& line, const std::string& included) {
    if (included.starts_with("motionlang/")) {
      add(included);
    } else if (!is_present(included)) {
      present_[included].push_back(conditions_);
      append(line);
    }
  }
  /// True if `header` was included before under no other conditions than those that hold here.
  bool is_present(const std::string& header) {
    const std::set<std::string> here(conditions_.begin(), conditions_.end());
    return std::any_of(present_[header].begin(), present_[header].end(), [&](const auto& conditions) {
      return std::all_of(conditions.begin(), conditions.end(), [&](const auto& c) { return here.contains(c); });
    });
  }
  /// No second empty line where includes stood.
  void append(const std::string& line) {
    if (line.empty() && (text_.empty() || text_.ends_with("\n\n"))) return;
    text_ += line + "\n";
  }
  static std::string macro_of(const std::string& header, const std::string& kind) {
    std::string name;
    for (const char c : header.substr(header.find('/') + 1)) {
      const auto u = static_cast<unsigned char>(c);
      name += std::isalnum(u) ? static_cast<char>(std::toupper(u)) : '_';
    }
    return "MOTIONLANG_" + kind + "_" + name;
  }

  fs::path include_;
  std::string name_;                // of the file that is written
  std::set<std::string> repeated_;  // written once
  std::string text_;
  bool in_part_ = false;                                                  // in the text of a file without #pragma once
  std::map<std::string, int> times_;                                      // of their inclusions
  std::map<std::string, std::string> parts_;                              // texts of those that are repeated
  std::vector<std::string> conditions_;                                   // of the line being read, outermost first
  std::map<std::string, std::vector<std::vector<std::string>>> present_;  // the conditions of every inclusion
};

std::string version_of(const fs::path& include) {
  const std::string text = read_text(include / "motionlang/version.hpp"), key = "#define MOTIONLANG_VERSION \"";
  const std::size_t begin = text.find(key) + key.size();
  return text.substr(begin, text.find('"', begin) - begin);
}

std::string text_of(const Output& output, const fs::path& include) {
  const auto amalgamated = [&](std::set<std::string> repeated) {
    Amalgamation all(include, output.name, std::move(repeated));
    if (!output.base.empty()) all.include(output.base);
    for (const auto& header : output.headers) all.add(header);
    return all;
  };
  const Amalgamation all = amalgamated(amalgamated({}).repeated());
  return "// SPDX-License-Identifier: MIT\n/// motionlang " + version_of(include) +
         ", generated from include/ by tests/tools/amalgamate.cpp. Changes belong there.\n" + all.text();
}

}  // namespace

int main(int argc, char** argv) try {
  const bool check = argc == 3 && std::string(argv[2]) == "--check";
  if (argc != 2 && !check) throw std::runtime_error("usage: amalgamate <repository> [--check]");
  const fs::path repository = argv[1], folder = repository / "single_include/motionlang";
  int stale = 0;
  for (const Output& output : outputs) {
    const fs::path path = folder / output.name;
    const std::string text = text_of(output, repository / "include");
    if (fs::exists(path) && read_text(path) == text) continue;
    ++stale;
    std::cout << path.string() << (check ? " is not current: build the target amalgamate\n" : "\n");
    if (check) continue;
    fs::create_directories(folder);
    std::ofstream file(path, std::ios::binary);
    if (!(file << text).flush()) throw std::runtime_error("amalgamate: cannot write " + path.string());
  }
  return check && stale > 0 ? 1 : 0;
} catch (const std::exception& e) {
  std::cerr << e.what() << "\n";
  return 1;
}
