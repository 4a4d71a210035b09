// SPDX-License-Identifier: MIT
/// Names of files.
#pragma once

#include <string>   // the name
#include <utility>  // move

#include <motionlang/core/error.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// The name of a file: a string, or a std::filesystem::path, whose header takes longer to compile than this library's
/// own.
class FilePath {
 public:
  FilePath(const char* text) : text_(text) {}
  FilePath(std::string text) : text_(std::move(text)) {}
  template <class Path>
  requires requires(const Path& path) { path.lexically_normal().string(); }
  FilePath(const Path& path) : text_(path.string()) {}

  const std::string& string() const { return text_; }
  const char* c_str() const { return text_.c_str(); }
  /// The name of a file in this folder. "" is the current folder, like parent_path() of a bare name.
  std::string inside(const std::string& name) const { return text_.empty() ? name : text_ + "/" + name; }
  /// The last part without its extension: "walk" of "clips/walk.bvh".
  std::string stem() const {
#if defined(_WIN32)
    constexpr const char* separators = "/\\";
#else
    constexpr const char* separators = "/";
#endif
    const std::string name = text_.substr(text_.find_last_of(separators) + 1);
    const std::size_t dot = name.find_last_of('.');
    return dot == 0 ? name : name.substr(0, dot);
  }

 private:
  std::string text_;
};

MOTIONLANG_NAMESPACE_END
