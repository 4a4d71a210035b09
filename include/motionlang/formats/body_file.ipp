// SPDX-License-Identifier: MIT
// Bodies of body_file.hpp.
#pragma once

#include <unistd.h>  // access
#include <variant>   // one of two forms

#include <motionlang/file/detail/bytes.hpp>
#include <motionlang/file/npz.hpp>
#include <motionlang/file/pickle_arrays.hpp>
#include <motionlang/formats/body_file.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

struct BodyArrays::Source {
  std::variant<NpzArchive, Pickle> file;

  static std::shared_ptr<const Source> open(const FilePath& path) {
    auto file = MappedFile::open(path);
    if (as_text(file->bytes()).starts_with("PK\x03\x04"))
      return std::make_shared<const Source>(Source{NpzArchive(ZipArchive(file->bytes(), path.string(), file))});
    return std::make_shared<const Source>(Source{Pickle(file->bytes(), path.string(), {}, file)});
  }
};

MOTIONLANG_BODY BodyArrays::BodyArrays(const FilePath& path) : file_(path.string()), source_(Source::open(path)) {}

MOTIONLANG_BODY bool BodyArrays::has(const char* name) const {
  if (const auto* npz = std::get_if<NpzArchive>(&source_->file)) return npz->has(name);
  return std::get<Pickle>(source_->file).root().find(name).has_value();
}

MOTIONLANG_BODY NpyArray BodyArrays::read(const char* name) const {
  if (const auto* npz = std::get_if<NpzArchive>(&source_->file)) return npz->read(name);
  return to_array(std::get<Pickle>(source_->file).root()[name]);
}

template <class T>
std::vector<T> BodyArrays::read(const char* name, std::vector<Index> wanted, std::vector<Index>* found) const {
  const NpyArray array = read(name);
  bool fits = array.shape.size() == wanted.size();
  for (std::size_t i = 0; fits && i < wanted.size(); ++i) fits = wanted[i] < 0 || array.shape[i] == wanted[i];
  if (!fits)
    raise<io_error>(407, file_, ": '", name, "' is ", detail::shape_text(array.shape), ", expected ",
                    detail::shape_text(wanted));
  if (found != nullptr) *found = array.shape;
  std::vector<T> values = array.to<T>();
  for (const T x : values) {
    if (!std::isfinite(static_cast<double>(x))) raise<numeric_error>(301, file_, ": '", name, "' is not finite");
  }
  return values;
}
#ifdef MOTIONLANG_INSTANTIATED
template std::vector<float> BodyArrays::read<float>(const char*, std::vector<Index>, std::vector<Index>*) const;
template std::vector<double> BodyArrays::read<double>(const char*, std::vector<Index>, std::vector<Index>*) const;
template std::vector<std::int64_t> BodyArrays::read<std::int64_t>(const char*, std::vector<Index>,
                                                                  std::vector<Index>*) const;
#endif

MOTIONLANG_BODY std::vector<int> body_parents(const BodyArrays& arrays) {
  std::vector<Index> shape;
  const auto table = arrays.read<double>("kintree_table", {2, -1}, &shape);
  const auto joints = static_cast<std::size_t>(shape[1]);
  std::vector<int> parents;
  for (std::size_t j = 0; j < joints; ++j) {
    if (table[joints + j] != static_cast<double>(j)) {
      raise<io_error>(403, arrays.file(), ": 'kintree_table' calls joint ", j, " ", table[joints + j]);
    }
    if (j > 0 && !(table[j] >= 0 && table[j] < static_cast<double>(j))) {
      raise<io_error>(403, arrays.file(), ": 'kintree_table': joint ", j, " has parent ", table[j],
                      ", which does not come before it");
    }
    parents.push_back(j == 0 ? -1 : static_cast<int>(table[j]));
  }
  if (joints == 0) raise<io_error>(403, arrays.file(), ": 'kintree_table' has no joints");
  return parents;
}

MOTIONLANG_BODY std::vector<std::array<Index, 3>> body_faces(const BodyArrays& arrays, Index vertices) {
  std::vector<std::array<Index, 3>> faces;
  const auto numbers = arrays.read<std::int64_t>("f", {-1, 3});
  for (std::size_t i = 0; i < numbers.size(); i += 3) {
    std::array<Index, 3> face{};
    for (std::size_t c = 0; c < 3; ++c) {
      face[c] = static_cast<Index>(numbers[i + c]);
      if (face[c] < 0 || face[c] >= vertices) {
        raise<io_error>(403, arrays.file(), ": face ", i / 3, " has vertex ", face[c], " of ", vertices);
      }
    }
    faces.push_back(face);
  }
  return faces;
}

MOTIONLANG_BODY Index first_expression(BodyKind kind, Index directions, Index told) {
  if (kind != BodyKind::smplx) return directions;
  if (told > 0) return std::min(told, directions);
  return directions > 300 ? 300 : directions == 20 ? 10 : directions;
}

MOTIONLANG_BODY std::vector<SurfacePoints> rows_of_points(const BodyArrays& arrays, const char* triangles,
                                                          const char* weights,
                                                          std::span<const std::array<Index, 3>> faces) {
  std::vector<SurfacePoints> out;
  if (!arrays.has(triangles)) return out;
  std::vector<Index> shape = arrays.read(triangles).shape;
  if (shape.empty() || shape.size() > 2)
    raise<io_error>(407, arrays.file(), ": '", triangles, "' has ", counted(shape.size(), "axis", "axes"),
                    ", expected 1 or 2");
  const auto numbers = arrays.read<std::int64_t>(triangles, shape);
  const auto columns = static_cast<std::size_t>(shape.back());
  shape.push_back(3);
  const auto shares = arrays.read<double>(weights, shape);
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    if (numbers[i] < 0 || numbers[i] >= std::ssize(faces)) {
      raise<io_error>(403, arrays.file(), ": '", triangles, "' has triangle ", numbers[i], " of ", faces.size());
    }
    if (i % columns == 0) out.emplace_back();
    out.back().corners.push_back(faces[static_cast<std::size_t>(numbers[i])]);
    out.back().weights.push_back({shares[3 * i], shares[3 * i + 1], shares[3 * i + 2]});
  }
  return out;
}

MOTIONLANG_BODY bool readable(const FilePath& path) { return ::access(path.c_str(), R_OK) == 0; }

}  // namespace detail

MOTIONLANG_BODY FilePath find_body_file(const FilePath& root, BodyKind kind, BodyGender gender) {
  if (kind == BodyKind::other) raise<config_error>(101, "find_body_file: a body of kind 'other' has no usual name");
  struct Names {
    const char *small, *large, *letter;
  };
  constexpr Names names[] = {{"neutral", "NEUTRAL", "neutral"}, {"male", "MALE", "m"}, {"female", "FEMALE", "f"}};
  const Names& g = names[static_cast<std::size_t>(gender)];
  constexpr const char* folders[] = {"smpl", "smplh", "smplx"};
  constexpr const char* prefixes[] = {"SMPL_", "SMPLH_", "SMPLX_"};
  const std::string folder = concat_text(root.string(), "/", folders[static_cast<std::size_t>(kind)], "/");
  const std::string usual = concat_text(folder, prefixes[static_cast<std::size_t>(kind)], g.large);
  std::vector<std::string> candidates{usual + ".npz", usual + ".pkl", concat_text(folder, g.small, "/model.npz"),
                                      concat_text(folder, g.small, "/model.pkl")};
  for (const char* model : {"basicmodel_", "basicModel_"}) {
    for (const char* version : {"_lbs_10_207_0_v1.1.0.pkl", "_lbs_10_207_0_v1.0.0.pkl"}) {
      if (kind == BodyKind::smpl) candidates.push_back(concat_text(folder, model, g.letter, version));
    }
  }
  for (const std::string& c : candidates) {
    if (detail::readable(c)) return c;
  }
  const BodyKindInfo& info = body_kinds[static_cast<std::size_t>(kind)];
  raise<io_error>(401, "no ", info.name, " file such as ", usual, kind == BodyKind::smpl ? ".pkl" : ".npz",
                  ": register at ", info.site, " to download it (free for research, no redistribution)");
}

MOTIONLANG_NAMESPACE_END
