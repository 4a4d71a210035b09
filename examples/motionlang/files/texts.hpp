// Texts of motions in several kinds of files: BABEL, the annotation JSON of TMR and STMC, texts/ of HumanML3D.
#pragma once

#include <filesystem>
#include <string>

namespace program {

/// True if the file holds texts of motions rather than motions.
bool is_texts(const std::filesystem::path& path);
/// Converts BABEL or annotation JSON to annotation JSON (.json), or to files of captions as in HumanML3D and KIT-ML.
/// The latter go into the folder texts/ of a folder without extension. Returns a line about the files. Throws
/// config_error 103 for another extension; what the reader throws; timeline_error 510 for a text that a file of
/// captions cannot hold.
std::string convert_texts(const std::filesystem::path& in, const std::filesystem::path& out);

}  // namespace program
