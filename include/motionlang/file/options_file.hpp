// SPDX-License-Identifier: MIT
/// Options of a training run in a flat list: config.json, args.json (JSON), opt.yaml, config.yaml (YAML), opt.txt.
///
///     const auto options = read_options("run/opt.yaml");
///     const FileValue* width = find_value(options, "model/latent_dim");
///
/// Reads the YAML that programs write: nested mappings and lists by indentation, plain and quoted texts, numbers, flat
/// lists and mappings in brackets, and tags (which are ignored). Texts of several lines and anchors are not supported.
/// text-to-motion, TM2T and MotionDiffuse write opt.txt: a banner of dashes, lines of "key: value", a banner. A whole
/// number of more than 64 bits is stored as a text of its digits. A duplicate name is refused. OmegaConf's references
/// "${model.latent_dim}" are texts; `find_option` follows them.
#pragma once

#include <string_view>  // texts
#include <vector>       // values

#include <motionlang/file/file_path.hpp>
#include <motionlang/file/file_value.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// The values of a text. It is JSON if it begins with a brace, and an opt.txt if it begins with a banner. Messages
/// contain `name`.
/// Throws  io_error 403 with the line if it is malformed, 404 for unsupported YAML, 405 if it is too large
std::vector<FileValue> parse_options(std::string_view text, std::string_view name);
/// Throws io_error 401, and as above.
std::vector<FileValue> read_options(const FilePath& path);

/// The value at a path. If that is a reference "${a.b}", the value at "a/b", and so on. Null if there is none.
const FileValue* find_option(const std::vector<FileValue>& values, std::string_view path);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/file/options_file.ipp>
#endif
