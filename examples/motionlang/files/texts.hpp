// Texts of motions, by their files: BABEL, the annotation JSON of TMR and STMC, texts/ of HumanML3D.
#pragma once

#include <filesystem>
#include <string>

namespace program {

/// True if the file holds texts of motions rather than motions.
bool is_texts(const std::filesystem::path& path);
/// BABEL or annotation JSON as annotation JSON (.json), or as files of captions in the folder texts/ of a folder
/// without extension, as HumanML3D and KIT-ML have them. Returns a line about what it wrote. Throws config_error 103
/// for another extension; what the reader throws; timeline_error 510 for a text that cannot stand in a file of
/// captions.
std::string convert_texts(const std::filesystem::path& in, const std::filesystem::path& out);

}  // namespace program
