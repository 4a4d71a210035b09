// SPDX-License-Identifier: MIT
/// Options of a training run, flat: config.json, args.json (JSON), opt.yaml, config.yaml (YAML), opt.txt.
///
///     const auto options = read_options("run/opt.yaml");
///     const FileValue* width = find_value(options, "model/latent_dim");
///
/// Reads the part of YAML that programs write: nested mappings and lists by indentation, plain and quoted texts,
/// numbers, flat lists and mappings in brackets, tags (which are ignored). No texts of several lines, no anchors.
/// opt.txt is what text-to-motion, TM2T and MotionDiffuse write: a banner of dashes, lines of "key: value", a banner.
/// A whole number of more than 64 bits is a text, its digits. A name that is duplicated is refused.
/// OmegaConf's references "${model.latent_dim}" are texts; `find_option` follows them.
#pragma once

#include <string_view>  // texts
#include <vector>       // values

#include <motionlang/file/file_path.hpp>
#include <motionlang/file/file_value.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// The values of a text, JSON if it begins with a brace, an opt.txt if with a banner. `name` stands in messages.
/// Throws  io_error 403 with the line if it is malformed, 404 for YAML that is not read, 405 if it is too large
std::vector<FileValue> parse_options(std::string_view text, std::string_view name);
/// Throws io_error 401, and as above.
std::vector<FileValue> read_options(const FilePath& path);

/// The value at a path; if that is a reference "${a.b}", the value at "a/b", and so on. Null if there is none.
const FileValue* find_option(const std::vector<FileValue>& values, std::string_view path);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/file/options_file.ipp>
#endif
